"""What an event makes of a part: a crack that is longer or new."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.events import Event, Kind
from slmm.fracture.growth import Surroundings
from slmm.part.crack import TIP, End
from slmm.part.part import Part

Array = NDArray[np.float64]


class GrownPart(NamedTuple):
    """A part after an event.

    Attributes
    ----------
    part : Part
    crack : int
        Which of its cracks is new or longer.
    end : ndarray, shape (2,)
        Where it ends there, mm.
    arrested_by : End
        What it ran into; a tip while it has one.
    """

    part: Part
    crack: int
    end: Array
    arrested_by: End


def grown_part(
    part: Part, event: Event, surroundings: Surroundings, length: float, ahead: float
) -> GrownPart:
    """The part after an event.

    Parameters
    ----------
    part : Part
    event : Event
    surroundings : Surroundings
    length, ahead : float
        Of the increment, and how far beyond its end a surface draws it, mm.
    """
    starts = event.kind is Kind.START
    crack = len(part.cracks) if starts else crack_of(part, event.tip)
    own = -1 if starts else crack
    increment = surroundings.increment(part, event.point, event.direction, length, ahead, own)
    if starts:
        grown = part.with_crack([event.point, increment.end])
    else:
        go_on = part.grown if increment.arrested else part.grown_inside
        grown = go_on(event.tip, increment.end)
    at_start = not starts and bool((part.cracks[crack].points[0] == event.point).all())
    its = grown.cracks[crack]
    met = its.start if at_start else its.end
    end = its.points[0 if at_start else -1]
    return GrownPart(grown, crack, end, met if increment.arrested else TIP)


def crack_of(part: Part, tip: int) -> int:
    """The crack that a tip belongs to."""
    return [k for k, crack in enumerate(part.cracks) for _ in crack.tips][tip]
