"""How the path of a tip bends, from the directions that the criterion found along it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.events import Event, Kind
from slmm.fracture.history import Step

Array = NDArray[np.float64]


class Bend(NamedTuple):
    """Of a path at its tip.

    Attributes
    ----------
    turned : float
        Angle from the criterion's direction at the tip before to the one here, radians; 0 where there was none.
    rate : float
        By which the path is expected to turn on, radians for each mm.
    """

    turned: float
    rate: float


def bend_at(steps: Sequence[Step], event: Event) -> Bend:
    """The bend of the path at a tip that is about to grow.

    Along a smooth path the criterion's direction turns steadily, and an increment that leads half of its next turn
    ahead ends on the path but for the third order of its length (as the method of Adams and Bashforth does). How fast
    it turns is taken from the last two increments, the slower of both, and none where they turn to different sides: a
    crack that has just kinked corrects itself so. The first direction of a crack does not count, for its kink is none
    of a smooth path.

    Parameters
    ----------
    steps : sequence of Step
        All that has happened.
    event : Event
        Growth.
    """
    way = _way(steps, event.point)[:-1]  # the first direction of a crack is not on a smooth path
    directions = [event.direction, *(step.event.direction for step in way)]
    turns = [_angle(before, after) for after, before in pairwise(directions)]
    rates = [turn / step.length for turn, step in zip(turns, way, strict=True)]
    slower = min(rates, key=abs) if len(rates) > 1 and rates[0] * rates[1] > 0 else 0.0
    return Bend(turns[0] if turns else 0.0, slower)


def ahead(direction: Array, bend: Bend, length: float) -> Array:
    """Direction (2,) of an increment that ends on a path which turns on as expected."""
    turn = 0.5 * bend.rate * length
    c, s = math.cos(turn), math.sin(turn)
    return np.asarray(np.array([[c, -s], [s, c]]) @ direction)


def _way(steps: Sequence[Step], tip: Array) -> list[Step]:
    """The last three increments that led to a tip, the latest first."""
    found: list[Step] = []
    for step in reversed(steps):
        if step.kind is Kind.GROWTH and step.end == tuple(tip.tolist()):
            found.append(step)
            tip = step.event.point
        if len(found) == 3:
            break
    return found


def _angle(before: Array, after: Array) -> float:
    """From one direction (2,) to another, radians."""
    return math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
