"""Panels of Gauss points around a part, graded towards corners and crack mouths; the body lies on their left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from slmm.boundary.rules import Array, Complex, rule
from slmm.boundary.stretches import Stretch
from slmm.part.part import Part

#: panel on an outline over its smallest radius of curvature there, over its distance from other surfaces and from crack
#: tips, and on straight edges over the part's smaller side (chosen on the cases of tests/boundary)
PER_RADIUS, PER_DISTANCE, PER_SIDE = 0.8, 1.0, 0.25
#: points on all panels, at most: beyond, what is kept takes more than 2 GB (chosen)
MOST_POINTS = 60_000


class TooManyPointsError(ValueError):
    """A part with more outlines than can be solved."""


@dataclass(frozen=True, eq=False)
class Panels:
    """Gauss points on all panels, contour by contour.

    Attributes
    ----------
    p : int
        Points on each panel.
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

    @property
    def fine_chi(self) -> Complex:
        """conj(dz)/dz at the fine points."""
        return self.fine_tangent.conj() / self.fine_tangent

    @property
    def length(self) -> Array:
        """Of each panel (m,), mm."""
        return np.abs(self.dz).reshape(-1, self.p).sum(axis=1)

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self.z)

    def chosen(self, which: NDArray[np.int64]) -> Panels:
        """Some of the panels."""
        panels, points = len(self.ends), self.n

        def of(name: str, values: Array) -> Array:
            if len(values) == panels:
                return values[which]
            return values.reshape(panels, points // panels, *values.shape[1:])[which].reshape(
                -1, *values.shape[1:]
            )

        values = {f.name: of(f.name, getattr(self, f.name)) for f in fields(self) if f.name != "p"}
        return Panels(self.p, **values)


def panelled(contours: Sequence[Sequence[Stretch]], part: Part, tips: Sequence[complex], p: int) -> Panels:
    """Panels on all contours."""
    side = float(np.ptp(part.outer, axis=0).min())
    sampled = [_samples(stretches) for stretches in contours]
    parts: list[tuple[Stretch, float, float, int, int]] = []
    number = 0
    for c, stretches in enumerate(contours):
        longest = PER_SIDE * side + max(stretch.length for stretch in stretches)
        others = _near(sampled, c, longest / PER_DISTANCE, np.array(tips, dtype=complex))
        for stretch in stretches:
            cuts = _cuts(stretch, others, side)
            parts += [(stretch, a, b, c, number) for a, b in pairwise(cuts)]
            number += 1
    if len(parts) * p > MOST_POINTS:
        raise TooManyPointsError(
            f"boundary integrals: the outlines need {len(parts) * p} points, and at most {MOST_POINTS} can be solved; "
            "use voxels or a body-fitted model"
        )
    x, w = rule(p)
    xf, _ = rule(2 * p)
    z, dz, tangent, curvature, ends, fine, fine_tangent, span = [], [], [], [], [], [], [], []
    for stretch, a, b in _by_stretch(parts):
        middle, half = 0.5 * (a + b)[:, None], 0.5 * (b - a)[:, None]
        points, along, bend = stretch.at((middle + half * x).ravel())
        z.append(points)
        tangent.append(along)
        curvature.append(bend)
        dz.append(along * (w * half * stretch.length).ravel())
        points, along, _ = stretch.at((middle + half * xf).ravel())
        fine.append(points)
        fine_tangent.append(along)
        ends.append(stretch.at(np.column_stack([a, b]).ravel())[0])
        curved = np.column_stack([stretch.s[0] - a * stretch.length, stretch.s[0] - b * stretch.length])
        span.append(np.full((len(a), 2), np.nan) if stretch.outline is None else curved)
    all_z = np.concatenate(z)
    ends_of, fine_of = np.concatenate(ends).reshape(-1, 2), np.concatenate(fine).reshape(-1, 2 * p)
    return Panels(
        p,
        all_z,
        np.concatenate(dz),
        np.concatenate(tangent),
        np.concatenate(curvature),
        ends_of,
        np.array([stretch.outline is None for stretch, *_ in parts]),
        np.concatenate(span),
        np.array([c for *_, c, _ in parts]),
        np.array([stretch.hole for stretch, *_ in parts]),
        np.array([number for *_, number in parts]),
        fine_of,
        np.concatenate(fine_tangent).reshape(-1, 2 * p),
        _inverses(all_z.reshape(-1, p), ends_of),
        _inverses(fine_of, ends_of),
    )


def _by_stretch(
    parts: Sequence[tuple[Stretch, float, float, int, int]],
) -> list[tuple[Stretch, Array, Array]]:
    """The stretches in turn, with the shares at which their panels begin and end."""
    found = []
    for _, group in groupby(parts, key=lambda part: part[4]):
        panels = list(group)
        a, b = (np.array([panel[k] for panel in panels]) for k in (1, 2))
        found.append((panels[0][0], a, b))
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


def _samples(stretches: Sequence[Stretch]) -> Complex:
    return np.concatenate([stretch.at(np.linspace(0.0, 1.0, 200))[0] for stretch in stretches])


def _near(sampled: Sequence[Complex], number: int, reach: float, tips: Complex) -> Complex:
    """Tips, and samples of the other curves that may be within reach of one, mm."""
    own = sampled[number]
    middle = own.mean()
    reach += float(np.abs(own - middle).max())
    others = [z[np.abs(z - middle) < reach] for k, z in enumerate(sampled) if k != number]
    return np.concatenate([*others, tips])


def _cuts(stretch: Stretch, others: Complex, side: float) -> list[float]:
    """Shares of a stretch at which its panels end, halved until each is short enough."""
    length = stretch.length
    a = np.arange(4) / 4 if stretch.closed else np.zeros(1)
    b = a + 1 / len(a)
    done = [np.zeros(1)]
    tree = cKDTree(np.column_stack([others.real, others.imag])) if len(others) else None
    while len(a):
        share = a[:, None] + (b - a)[:, None] * np.linspace(0.0, 1.0, 9)
        z, _, bend = stretch.at(share.ravel())
        allowed = np.full(len(a), PER_SIDE * side)
        if stretch.outline is not None:
            sharpest = np.abs(bend).reshape(share.shape).max(axis=1)
            allowed = np.minimum(allowed, PER_RADIUS / np.maximum(sharpest, 1e-12))
        if tree is not None:
            nearest = tree.query(np.column_stack([z.real, z.imag]))[0].reshape(share.shape).min(axis=1)
            allowed = np.minimum(allowed, PER_DISTANCE * nearest)
        if not stretch.closed:
            # towards both ends panels become as short as their distance from there
            first, last = stretch.last
            towards_ends = np.minimum(np.maximum(a, first), np.maximum(1.0 - b, last))
            allowed = np.minimum(allowed, towards_ends * length)
        long = (b - a) * length > np.maximum(allowed, 1e-7 * length) * (1 + 1e-9)
        done.append(b[~long])
        middle = 0.5 * (a + b)[long]
        a, b = np.concatenate([a[long], middle]), np.concatenate([middle, b[long]])
    cuts: list[float] = np.sort(np.concatenate(done)).tolist()
    return cuts
