"""What a picture leaves open about an outline that was traced in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Accuracy:
    """How far a traced outline may be from the true one.

    Attributes
    ----------
    offset : float
        By which the whole outline may lie too far inside or outside, mm.
    points : (n, 2) array
        Along its smooth stretches, mm, with the following at each of them.
    stress : (n,) array
        Relative error of the stress along the surface that the waves left or taken out there make.
    wavelength : (n,) array
        Of these waves, mm: into the material they decay over a sixth of it.
    tips : (k, 2) array
        Corners and roots of tight bends, mm, with the following at each of them.
    turns, spreads : (k,) array
        Angle by which the outline turns there, rad, positive where it bulges into the material; and its standard
        deviation.
    radii : (k, 3) array
        Radius as it is in the outline (0: a corner), the least and the largest that the picture allows, mm.
    """

    offset: float
    points: Array
    stress: Array
    wavelength: Array
    tips: Array
    turns: Array
    spreads: Array
    radii: Array

    @classmethod
    def of_all(cls, parts: Sequence[Accuracy]) -> Accuracy:
        """What several outlines leave open together."""
        names = ("points", "stress", "wavelength", "tips", "turns", "spreads", "radii")
        return cls(
            max(part.offset for part in parts),
            *(np.concatenate([getattr(part, name) for part in parts]) for name in names),
        )
