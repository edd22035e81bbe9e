"""Which event comes next: the lowest load, and where several tie what a mirrored or turned part does alike."""

import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.events import TIED, Event, Kind, next_event
from slmm.optimization import HolePattern

NEAR = np.array([10.0, 40.0])


def start(load, x, y, hole=0):
    return Event(load, Kind.START, np.array([x, y]), np.array([1.0, 0.0]), hole=hole)


def moved(event, motion):
    return Event(event.load, event.kind, motion(event.point), motion(event.direction), hole=9 - event.hole)


MOTIONS = {
    "upside down": lambda p: p * [1, -1] + [0, 80],
    "left to right": lambda p: p * [-1, 1] + [80, 0],
    "a quarter turn": lambda p: np.array([80 - p[1], p[0]]),
}


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("higher", [0.0, 0.5 * TIED, -0.5 * TIED], ids=["equal", "above", "below"])
def test_ties_are_decided_by_places_that_move_with_the_part(name, higher):
    """And not by what round-off makes of their loads."""
    events, motion = [start(1.0, 30.0, 60.0, 1), start(1.0 + higher, 50.0, 20.0, 2)], MOTIONS[name]
    event, _ = next_event(events, NEAR)
    image, _ = next_event([moved(each, motion) for each in events[::-1]], motion(NEAR))
    assert event is events[0] and image.point == pytest.approx(motion(event.point))


def test_a_tip_comes_before_starts_that_tie_with_it_however_near_they_are():
    tip = Event(1.0, Kind.GROWTH, np.array([70.0, 40.0]), np.array([1.0, 0.0]), tip=0)
    assert next_event([start(1.0, 11.0, 40.0), tip], NEAR)[0] is tip


def test_mirrored_places_go_by_the_lowest_hole():
    above, below = start(1.0, 30.0, 60.0, 0), start(1.0, 30.0, 20.0, 1)
    assert next_event([below, above], NEAR)[0] is above


def test_a_lower_load_decides_before_any_place():
    far, near = start(1.0, 70.0, 40.0), start(1.0 + 3 * TIED, 11.0, 40.0)
    event, gap = next_event([near, far], NEAR)
    assert event is far and gap == pytest.approx(3 * TIED)


def test_mirrored_places_of_a_symmetric_plate_tie_and_the_lower_one_cracks():
    """Though what the model says of their loads differs."""
    scene = HolePattern(7, "full").scene(np.ones((7, 7), dtype=bool))
    result = simulate(scene, 2.0, first_length=1.0, errors=False)
    start = int((result.event.values == "start").argmax())
    assert result.tie.values[start] == 2 and float(result.gap[start]) < TIED
    assert float(result.y[start]) < 40.0 and set(result.tie.values.tolist()) == {1, 2}
