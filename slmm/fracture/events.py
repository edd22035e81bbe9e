"""What happens next: the tip that grows or the surface that cracks at the lowest load (Paper D, section 2.2.3)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from slmm.criteria.griffith import energy_release_rate
from slmm.fracture.directions import Direction
from slmm.fracture.surface_peaks import Site
from slmm.mechanics.material import Material

Array = NDArray[np.float64]

#: loads that differ by less are one, and a rule decides: those of mirrored places differ by 3e-4 at tolerance 0.01, for
#: panels are not mirrored; chosen
TIED = 5e-4
#: places whose distances differ by less are equally far, over the distance; chosen
AS_FAR = 1e-3
#: loads so near to the lowest one compete: a small change of the part may turn the order round; chosen
COMPETING = 0.005


class Kind(StrEnum):
    """What an event is."""

    GROWTH = "growth"
    START = "start"


@dataclass(frozen=True, eq=False)
class Event:
    """A crack that grows or starts.

    Parameters
    ----------
    load : float
        Critical load, over the scene's own.
    kind : Kind
    point, direction : ndarray, shape (2,)
        Where from, mm, and which way.
    tip : int
        Which of the part's tips, -1 of a start.
    hole : int
        Which outline it starts at, -1 for a straight outer edge.
    K : (float, float)
        K_I and K_II under the scene's own load, MPa sqrt(mm); NaN of a start.
    T : float
        Stress along the crack under the scene's own load, MPa; NaN of a start and where no criterion asks for it.
    length : float
        With which a crack starts, mm, by its criterion; 0 where that has none.
    criterion : str
        By which it happens.
    excluded : str
        Why it does not happen, for all that its load is critical; empty where it may.
    """

    load: float
    kind: Kind
    point: Array
    direction: Array
    tip: int = -1
    hole: int = -1
    K: tuple[float, float] = field(default=(math.nan, math.nan))
    T: float = math.nan
    length: float = 0.0
    criterion: str = "griffith"
    excluded: str = ""

    @property
    def rank(self) -> tuple[bool, int, float, float]:
        """What decides a tie of mirrored places: holes before the edge, then the lowest hole, y and x."""
        x, y = self.point.tolist()
        return self.hole < 0, self.hole, y, x


def growths(
    tips: Sequence[Array], K: Array, T: Array, material: Material, direction: Direction
) -> list[Event]:
    """Tips that grow where G of the straight crack reaches G_c, whichever criterion finds their direction.

    Parameters
    ----------
    tips : sequence of ndarray, shape (n, 2)
        The line that leads to each tip, mm, the tip last.
    K : ndarray, shape (k, 2)
        K_I and K_II, MPa sqrt(mm). Closed tips have no K_I; those without either do not grow.
    T : ndarray, shape (k,)
        MPa; NaN where the direction does not ask for it.
    material : Material
    direction : Direction
    """
    found = []
    for k, (line, (K_I, K_II), along_crack) in enumerate(zip(tips, K.tolist(), T.tolist(), strict=True)):
        if K_I == K_II == 0:
            continue
        along = (line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2])
        kink = direction.angle(K_I, K_II, along_crack)
        turned = np.array([[math.cos(kink), -math.sin(kink)], [math.sin(kink), math.cos(kink)]]) @ along
        load = math.sqrt(material.G_c / energy_release_rate(K_I, K_II, material))
        found.append(Event(load, Kind.GROWTH, line[-1], turned, tip=k, K=(K_I, K_II), T=along_crack))
    return found


def starts(sites: Iterable[Site], material: Material) -> list[Event]:
    """Cracks that start at sites, straight into the material, by the point method."""
    return [
        Event(
            material.sigma_c / site.stress,
            Kind.START,
            site.point,
            site.inward,
            hole=site.hole,
            criterion="point",
            excluded=site.excluded,
        )
        for site in sites
    ]


def next_event(events: Sequence[Event], near: Array) -> tuple[Event, float]:
    """The event at the lowest load, and by which share the next one's load is higher.

    Of those that tie a tip comes before starts, then what is nearest to a place (2,), mm: where a mirrored or turned
    part has its image. Only what is as far, too, is decided by the rank.

    Examples
    --------
    >>> up, down = (Event(1.0, Kind.START, np.array([4.0, y]), np.array([1.0, 0.0])) for y in (2.0, 1.0))
    >>> [next_event([up, down], np.array(near))[0].point.tolist() for near in ([4.0, 9.0], [0.0, 1.5])]
    [[4.0, 2.0], [4.0, 1.0]]
    """
    lowest = min(event.load for event in events)
    tied = [event for event in events if event.load <= lowest * (1 + TIED)]
    if any(event.kind is Kind.GROWTH for event in tied):
        tied = [event for event in tied if event.kind is Kind.GROWTH]
    away = np.array([np.linalg.norm(event.point - near) for event in tied])
    as_near = np.flatnonzero(away <= away.min() * (1 + AS_FAR))
    chosen = min((tied[k] for k in as_near), key=lambda event: event.rank)
    others = [event.load for event in events if event is not chosen]
    return chosen, max(min(others) / lowest - 1, 0.0) if others else math.nan
