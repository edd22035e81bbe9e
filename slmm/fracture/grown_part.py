"""What an event makes of a part: a crack that is longer or new, and whether the part is in pieces then."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.fracture.events import Event, Kind
from slmm.fracture.growth import Surroundings
from slmm.part.crack import TIP, End
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: places along a straight stretch that tell which pieces it holds or loads; chosen
MIDDLES = (np.arange(20) + 0.5) / 20


class GrownPart(NamedTuple):
    """A part after an event.

    Attributes
    ----------
    part : Part
    crack : int
        Which of its cracks is new or longer.
    at_start : bool
        Whether that is longer at its first point.
    end : ndarray, shape (2,)
        Where it ends there, mm.
    arrested_by : str
        What it ran into; empty while it has a tip.
    """

    part: Part
    crack: int
    at_start: bool
    end: Array
    arrested_by: str


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
        grown, at_start = part.with_crack([event.point, increment.end]), False
    else:
        grown = part.grown(event.tip, increment.end)
        at_start = bool((part.cracks[crack].points[0] == event.point).all())
    its = grown.cracks[crack]
    met = its.start if at_start else its.end
    end = its.points[0 if at_start else -1]
    return GrownPart(grown, crack, at_start, end, _name(met, grown) if increment.arrested else "")


def crack_of(part: Part, tip: int) -> int:
    """The crack that a tip belongs to."""
    return [k for k, crack in enumerate(part.cracks) for _ in crack.tips][tip]


def _name(end: End, part: Part) -> str:
    """What a crack ends at, in words."""
    if end == TIP:
        return ""
    if end.kind == "crack":
        return f"crack {end.number}"
    return f"hole {end.number}" if 0 <= end.number < len(part.holes) else "edge"


def is_carried(piece: shapely.Polygon, loading: Loading, near: float) -> bool:
    """Whether a piece of a part is held or loaded, on what lies as near to it, mm."""
    for condition in loading:
        points, traction, _ = condition.rule
        if condition.span is None:
            points = np.array(condition.start) + MIDDLES[:, None] * np.subtract(
                condition.end, condition.start
            )
        elif not any(condition.is_held):
            points = points[np.hypot(*traction.T) > 0]
        if shapely.dwithin(piece, shapely.points(points), near).any():
            return True
    return False
