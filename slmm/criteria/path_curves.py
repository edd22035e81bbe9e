"""Energy and stress along the trial paths of some positions, and what a criterion makes of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from slmm.criteria.coupled import NONE, STRESS

#: points of the curves along a crack path, dense towards the surface; chosen
CURVE_POINTS = 201


@dataclass(frozen=True)
class PathCurves:
    """What a source says about n positions, at CURVE_POINTS points of each path.

    Attributes
    ----------
    a : ndarray (n, CURVE_POINTS)
        Crack length and, alike, distance from the notch, mm, ascending from 0; NaN where there is no curve.
    G_inc : ndarray (n, CURVE_POINTS)
        Incremental energy release rate, N/mm.
    sigma_I : ndarray (n, CURVE_POINTS)
        Maximum principal stress without the new crack, MPa; inf at a corner or a crack tip.
    G_error, sigma_error : ndarray (n, CURVE_POINTS)
        Estimates of the relative errors; NaN where the source has none.
    """

    a: np.ndarray
    G_inc: np.ndarray
    sigma_I: np.ndarray
    G_error: np.ndarray
    sigma_error: np.ndarray

    @classmethod
    def empty(cls, n: int) -> PathCurves:
        """Curves without values."""
        return cls(*(np.full((n, CURVE_POINTS), np.nan) for _ in fields(cls)))

    def rows(self, rows: np.ndarray) -> PathCurves:
        """The curves of some positions."""
        return PathCurves(*(getattr(self, field.name)[rows] for field in fields(self)))

    def put(self, rows: np.ndarray, other: PathCurves) -> None:
        """Take over the curves of another source at some positions."""
        for field in fields(self):
            getattr(self, field.name)[rows] = getattr(other, field.name)


@dataclass(frozen=True)
class Critical:
    """The criterion applied to n positions, or with m materials to each of them: then all arrays are (m, n).

    Attributes
    ----------
    load_factor, crack_length : ndarray (n,)
        NaN where the curves end before both conditions meet; infinite load factor where there is no tension.
    governed_by : ndarray (n,) of int
        Index into `coupled.GOVERNED_BY`.
    error : ndarray (n,)
        Estimate of the relative error of the load factor and of the failure index; where no load starts a crack, the
        index that the errors of the stress allow.
    refused : ndarray (n,) of str
        Why the criterion does not apply; empty where it does, and where the curves only end too early.
    """

    load_factor: np.ndarray
    crack_length: np.ndarray
    governed_by: np.ndarray
    error: np.ndarray
    refused: np.ndarray

    @classmethod
    def empty(cls, shape: int | tuple[int, int]) -> Critical:
        """No value anywhere."""
        nothing = np.full(shape, np.nan)
        return cls(
            nothing, nothing.copy(), np.full(shape, NONE), nothing.copy(), np.full(shape, "", dtype=object)
        )

    def of(self, material: int) -> Critical:
        """What was found for one of the materials."""
        return Critical(*(getattr(self, field.name)[material] for field in fields(self)))

    @classmethod
    def stacked(cls, by_material: Sequence[Critical]) -> Critical:
        """What was found for each material alone, as (m, n)."""
        return cls(*(np.stack([getattr(one, field.name) for one in by_material]) for field in fields(cls)))

    def put_stress(
        self, at: tuple[Any, ...], stress: np.ndarray, error: np.ndarray, sigma_c: np.ndarray | float
    ) -> None:
        """Values (k,) at places where one stress decides, with its error, MPa; without tension, what there may be."""
        tension = stress > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            self.load_factor[at] = np.where(tension, sigma_c / stress, np.inf)
            self.error[at] = np.where(tension, error / stress, np.maximum(stress + error, 0.0) / sigma_c)
        self.governed_by[at] = np.where(tension, STRESS, NONE)


def path_points(a_max: np.ndarray) -> np.ndarray:
    """Points (n, CURVE_POINTS) from 0 to a_max (n,), dense towards the surface, mm."""
    return a_max[:, None] * np.linspace(0.0, 1.0, CURVE_POINTS) ** 2
