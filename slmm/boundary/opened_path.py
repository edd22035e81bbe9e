"""The energy that a crack along a straight path sets free, also one that goes through a whole ligament.

It is half of the traction that was there times the crack's jump (Clapeyron's theorem), so that one crack tells it, and
none that are shorter. What is left of a ligament matters little to it, however the last of it goes.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import legendre

from slmm.boundary.crack_panels import tip_rule
from slmm.boundary.model import BoundaryModel
from slmm.boundary.rules import Array, Complex, rule, values_at
from slmm.part.part import Part

#: points on a panel of the rule that integrates (chosen)
POINTS = 16
#: panels lie on a path within this share of its length; round-off
ON_PATH = 1e-6
#: faces that overlap by this share of the largest jump count as open; round-off
CLOSED = 1e-9


def with_path(part: Part, start: Array, end: Array, tip: int | None = None) -> Part:
    """The part with a crack from a place of its surface, or from a tip, straight to a point (2,), mm.

    Where that lies on a surface or on a crack, the crack ends there.
    """
    return part.with_crack(np.array([start, end])) if tip is None else part.grown(tip, end)


class OpenedPath:
    """A straight crack beside all that the part has.

    Parameters
    ----------
    before, after : BoundaryModel
        The part without the crack, and with it.
    start, end : complex
        Where it runs, mm.

    Examples
    --------
    One that cuts the ligament between a hole and an edge sets a finite energy free, the whole way open.

    >>> from slmm.mechanics.material import Material
    >>> from slmm.part.outline import Outline
    >>> from slmm.part.shapes import circle
    >>> from slmm.scene.loading import plate_loading
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1, state="plane stress")
    >>> plate = Part.plate(40.0, 80.0, holes=[Outline.through(circle((6.0, 40.0), 5.0))])
    >>> before = BoundaryModel(plate, material, plate_loading(40.0, 80.0, stress=10.0))
    >>> cracked = before.with_cracks_of(with_path(plate, np.array([1.0, 40.0]), np.array([0.0, 40.0])))
    >>> cut = OpenedPath(before, cracked, 1 + 40j, 40j)
    >>> cut.is_open, cut.energy > 0
    (True, True)
    """

    def __init__(self, before: BoundaryModel, after: BoundaryModel, start: complex, end: complex) -> None:
        """Find the panels."""
        self.start, self.end = start, end
        self._before, self._after = before, after

    @cached_property
    def _rows(self) -> list[int]:
        """Panels on the path."""
        cracks = self._after.cracks
        assert cracks is not None, "the part after it has no crack"
        way = self.end - self.start
        on = np.ones(len(cracks.starts), dtype=bool)
        for z in (cracks.starts, cracks.ends):
            place = (z - self.start) / way
            on &= (np.abs(place.imag) < ON_PATH) & (np.abs(place.real - 0.5) < 0.5 + ON_PATH)
        return list(np.flatnonzero(on))

    @cached_property
    def _along(self) -> tuple[Complex, Array, Complex, Complex]:
        """Points (n,) of the path, weights of the rule there, mm, unit vectors along the panels, and jumps, mm."""
        cracks = self._after.cracks
        assert cracks is not None
        jumps = self._after.c.reshape(-1, cracks.p) * self._before.body.scale
        found = []
        for k in self._rows:
            start, along = complex(cracks.starts[k]), complex(cracks.ends[k] - cracks.starts[k])
            share, weight, spread = (_at_tip if cracks.is_tip[k] else _between)(cracks.p)
            found.append(
                (
                    start + along * share,
                    abs(along) * weight,
                    np.full(len(share), along / abs(along)),
                    spread @ jumps[k],
                )
            )
        z, weight, e, jump = (np.concatenate(values) for values in zip(*found, strict=True))
        return z, weight, e, jump

    @property
    def energy(self) -> float:
        """What it sets free, N mm for each mm of thickness."""
        z, weight, e, jump = self._along
        xx, yy, xy = self._before.stress(np.column_stack([z.real, z.imag])).T
        left = 1j * e
        traction = xx * left.real + xy * left.imag + 1j * (xy * left.real + yy * left.imag)
        return 0.5 * float(weight @ (traction * jump.conj()).real)

    @property
    def is_open(self) -> bool:
        """Whether its faces overlap nowhere, but for round-off."""
        _, _, e, jump = self._along
        return bool((jump * e.conj()).imag.min() > -CLOSED * np.abs(jump).max())


@lru_cache
def _between(p: int) -> tuple[Array, Array, Array]:
    """Places of a panel as shares of it, weights, and from values at its points to those at the places.

    Equal steps of the angle: roots of the distance from either end are smooth in it.
    """
    x, w = rule(POINTS)
    angle = 0.5 * np.pi * (1 + x)
    share = 0.5 * (1 - np.cos(angle))
    return share, 0.25 * np.pi * w * np.sin(angle), values_at(2 * share - 1, p)


@lru_cache
def _at_tip(p: int) -> tuple[Array, Array, Array]:
    """The same on a panel that ends at a tip."""
    x, w = rule(POINTS)
    angle = 0.25 * np.pi * (1 + x)
    _, _, inverse = tip_rule(p)
    spread = legendre.legvander(np.cos(angle), 2 * p - 1)[:, 1::2] @ inverse
    return np.sin(angle) ** 2, 0.25 * np.pi * w * np.sin(2 * angle), spread
