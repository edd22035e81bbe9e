"""What the table of V-notches is computed with: openings, crack lengths, sizes of elements."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class NotchSpec:
    """Settings of the table. The unit of length is the root's half width, at a sharp notch the crack length.

    Attributes
    ----------
    openings : tuple of float
        Opening angles below 180 degrees, ascending.
    shortest, longest : float
        Crack lengths that are kept.
    step : float
        Size of an element over its distance from the notch; the second mesh has half of it.
    coarse : float
        Factor on ``step`` away from the bisector and from the crack lengths that are kept.
    near, far : float
        Radius of the hole that stands for a sharp tip, and of the outer boundary.
    """

    openings: tuple[float, ...] = tuple(float(angle) for angle in range(0, 180, 10))
    shortest: float = 0.01
    longest: float = 100.0
    step: float = 0.075
    coarse: float = 3.0
    near: float = 1e-5
    far: float = 1e6
