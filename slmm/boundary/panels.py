"""Panels of Gauss points on intervals of the curves around a part; the body lies on their left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.rules import Array, Complex, rule
from slmm.boundary.stretches import Stretch


class Interval(NamedTuple):
    """Where on a curve a panel lies.

    Attributes
    ----------
    smooth : int
        Number of the curve.
    low, high : float
        Shares of its length.
    contour : int
        The closed curve that it is part of.
    stretch : Stretch
    """

    smooth: int
    low: float
    high: float
    contour: int
    stretch: Stretch

    @property
    def key(self) -> tuple[int, float, float]:
        """What no other panel has."""
        return self[:3]


@dataclass(frozen=True, eq=False)
class Panels:
    """Gauss points on all panels, contour by contour.

    Attributes
    ----------
    p : int
        Points on each panel.
    intervals : tuple of Interval
        Where the panels lie.
    z, dz : ndarray, shape (n,)
        Points, mm, and integration weights along the curve.
    tangent : ndarray, shape (n,)
        Unit tangents.
    curvature : ndarray, shape (n,)
        1/mm.
    ends : ndarray, shape (m, 2)
        First and last point of each panel.
    straight : ndarray, shape (m,) of bool
    span : ndarray, shape (m, 2)
        Arc lengths on its hole at the ends of a panel, mm, descending; NaN on the outer edge.
    contour, hole : ndarray, shape (m,) of int
        The closed curve, and the hole, of a panel; -1 for none.
    smooth : ndarray, shape (m,) of int
        Panels of one smooth curve have the same number.
    fine, fine_tangent : ndarray, shape (m, 2 p)
        Twice as many points on each panel, and the unit tangents there.
    inverse : ndarray, shape (m, p, p); fine_inverse : ndarray, shape (m, 2 p, 2 p)
        From values at the points to coefficients of Legendre polynomials in the panel's chord.
    """

    p: int
    intervals: tuple[Interval, ...]
    z: Complex
    dz: Complex
    tangent: Complex
    curvature: Array
    ends: Complex
    straight: NDArray[np.bool_]
    span: Array
    contour: NDArray[np.int64]
    hole: NDArray[np.int64]
    smooth: NDArray[np.int64]
    fine: Complex
    fine_tangent: Complex
    inverse: Complex
    fine_inverse: Complex

    @cached_property
    def fine_chi(self) -> Complex:
        """conj(dz)/dz at the fine points."""
        return self.fine_tangent.conj() / self.fine_tangent

    @cached_property
    def length(self) -> Array:
        """Of each panel (m,), mm."""
        return np.abs(self.dz).reshape(-1, self.p).sum(axis=1)

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self.z)

    def chosen(self, rows: NDArray[np.int64]) -> Panels:
        """Some of them."""
        m = len(self.intervals)

        def of(values: Array) -> Array:
            return values.reshape(m, -1)[rows].ravel() if len(values) == m * self.p else values[rows]

        arrays = [of(getattr(self, field.name)) for field in fields(self)[2:]]
        return Panels(self.p, tuple(self.intervals[k] for k in rows.tolist()), *arrays)

    def with_new(self, kept: NDArray[np.int64], more: Panels) -> Panels:
        """Some of them and more, in the order in which they lie on their curves."""
        both = [
            np.concatenate([getattr(self, field.name), getattr(more, field.name)])
            for field in fields(self)[2:]
        ]
        intervals = self.intervals + more.intervals
        rows = [*kept.tolist(), *range(len(self.intervals), len(intervals))]
        order = np.array(sorted(rows, key=lambda k: intervals[k][:3]), dtype=int)
        return Panels(self.p, intervals, *both).chosen(order)


def panels_on(intervals: Sequence[Interval], p: int) -> Panels:
    """Panels of p points on intervals, of which those on one curve are neighbours."""
    x, w = rule(p)
    xf, _ = rule(2 * p)
    z, dz, tangent, curvature, ends, fine, fine_tangent, span = [], [], [], [], [], [], [], []
    for stretch, a, b in _by_stretch(intervals):
        middle, half = 0.5 * (a + b)[:, None], 0.5 * (b - a)[:, None]
        share = np.concatenate([(middle + half * x).ravel(), (middle + half * xf).ravel(), a, b])
        points, along, bend = stretch.at(share)
        n, m = p * len(a), 3 * p * len(a)
        z.append(points[:n])
        tangent.append(along[:n])
        curvature.append(bend[:n])
        dz.append(along[:n] * (w * half * stretch.length).ravel())
        fine.append(points[n:m])
        fine_tangent.append(along[n:m])
        ends.append(points[m:].reshape(2, -1).T)
        curved = np.column_stack([stretch.s[0] - a * stretch.length, stretch.s[0] - b * stretch.length])
        span.append(np.full((len(a), 2), np.nan) if stretch.outline is None else curved)
    all_z = np.concatenate(z)
    # of one layout whatever they are made of: kernels are compiled, and loaded, for each
    ends_of = np.ascontiguousarray(np.concatenate(ends))
    fine_of = np.concatenate(fine).reshape(-1, 2 * p)
    return Panels(
        p,
        tuple(intervals),
        all_z,
        np.concatenate(dz),
        np.concatenate(tangent),
        np.concatenate(curvature),
        ends_of,
        np.array([interval.stretch.outline is None for interval in intervals]),
        np.concatenate(span),
        np.array([interval.contour for interval in intervals]),
        np.array([interval.stretch.hole for interval in intervals]),
        np.array([interval.smooth for interval in intervals]),
        fine_of,
        np.concatenate(fine_tangent).reshape(-1, 2 * p),
        _inverses(all_z.reshape(-1, p), ends_of),
        _inverses(fine_of, ends_of),
    )


def _by_stretch(intervals: Sequence[Interval]) -> list[tuple[Stretch, Array, Array]]:
    """The stretches in turn, with the shares at which their panels begin and end."""
    found = []
    for _, group in groupby(intervals, key=lambda interval: interval.smooth):
        of_stretch = list(group)
        a, b = (np.array([interval[k] for interval in of_stretch]) for k in (1, 2))
        found.append((of_stretch[0].stretch, a, b))
    return found


def _inverses(z: Complex, ends: Complex) -> Complex:
    """Inverse Vandermonde matrices (m, k, k) of points (m, k) in the chords of their panels."""
    middle, half = 0.5 * ends.sum(axis=1), 0.5 * (ends[:, 1] - ends[:, 0])
    zeta = (z - middle[:, None]) / half[:, None]
    n = z.shape[1]
    V = np.empty((*z.shape, n), dtype=complex)
    V[..., 0] = 1.0
    V[..., 1] = zeta
    for k in range(1, n - 1):
        V[..., k + 1] = ((2 * k + 1) * zeta * V[..., k] - k * V[..., k - 1]) / (k + 1)
    return np.linalg.inv(V)
