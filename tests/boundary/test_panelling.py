"""Panels around a part: as long as they may be, divided where mouths and tips ask for it, and nowhere else."""

import numpy as np
import pytest

from slmm.boundary.densities import Targets, displacement_of_boundary
from slmm.boundary.panelling import Panelling
from slmm.boundary.panels import panels_on
from slmm.boundary.stretches import COARSE, FINE, boundary_of
from slmm.boundary.tractions import Tractions
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

RADIUS = 8.0
PART = Part.plate(100.0, 100.0, [Outline.through(circle((50.0, 50.0), RADIUS))])
CONTOURS = boundary_of(PART, plate_loading(100.0, 100.0, stress=1.0))
NOWHERE = np.empty(0, dtype=complex)


def curves(grading=COARSE) -> Panelling:
    return Panelling(CONTOURS, 100.0, PART.tolerance, grading)


@pytest.mark.parametrize("grading", [COARSE, FINE])
def test_panels_of_a_circle_are_equal_and_no_longer_than_they_may_be(grading):
    panels = curves(grading).first(6)
    length = panels.length[~panels.straight]
    assert length == pytest.approx(np.full(len(length), 2 * np.pi * RADIUS / len(length)), rel=1e-5)
    assert length.max() <= grading.radius * RADIUS * (1 + 1e-4)
    assert len(length) == np.ceil(2 * np.pi / grading.radius)
    assert panels.length.sum() == pytest.approx(400.0 + 2 * np.pi * RADIUS, rel=1e-8)


def test_a_mouth_is_the_end_of_panels_that_shrink_towards_it_and_others_stay():
    mouth = 50.0 + RADIUS * np.exp(2.0j) + 50.0j
    with_mouth = curves().with_mouths([mouth])
    before = curves().first(6)
    after = with_mouth.divided(before, NOWHERE)
    assert np.abs(after.ends - mouth).min() < 1e-5 * RADIUS
    away = np.abs(after.fine.reshape(-1, 12) - mouth).min(axis=1)
    shortest = COARSE.side * 2 * np.pi * RADIUS
    assert (after.length[~after.straight] <= np.maximum(1.1 * away, shortest * 1.001)[~after.straight]).all()
    kept = {interval.key for interval in before.intervals} & {interval.key for interval in after.intervals}
    assert len(before.intervals) - len(kept) <= 3
    # once more there is nothing to do
    assert with_mouth.divided(after, NOWHERE) is after
    assert after.length.sum() == pytest.approx(before.length.sum(), rel=1e-8)


def test_panels_near_a_tip_are_short_and_in_their_order():
    tip = np.array([50.0 + 50.0j - (RADIUS + 1.0)])
    after = curves().divided(curves().first(6), tip)
    nearest = np.abs(after.fine - tip).min(axis=1)
    assert (after.length <= COARSE.tip * nearest * 1.01).all()
    assert [i.key for i in after.intervals] == sorted(i.key for i in after.intervals)
    # each closed curve goes on where the panel before ends
    on = after.contour[1:] == after.contour[:-1]
    assert np.abs(after.ends[1:, 0] - after.ends[:-1, 1])[on].max() < 1e-9


def test_tractions_act_the_same_however_their_panels_are_divided():
    """By the force behind each panel the parts of one cause what the whole does."""
    whole = curves().first(6)
    interval = whole.intervals[0]
    middle = 0.5 * (interval.low + interval.high)
    halves = panels_on([interval._replace(high=middle), interval._replace(low=middle)], 6)
    z = np.array([3.0 + 30.0j, 55.0 + 20.0j, 1.0 + 2.0j])
    load = 3.0 - 2.0j
    at = Targets.beside(z)
    caused = []
    for panels in (whole.chosen(np.array([0])), halves):
        _, by_q = displacement_of_boundary(panels, 2.0, at)
        caused.append(Tractions(panels, 2.0, 100.0).displacement(at, by_q)(np.full(panels.n, load)))
    assert caused[0] == pytest.approx(caused[1], rel=1e-6)
    along = [
        Tractions(panels, 2.0, 100.0).along(z, np.exp(1j * np.arange(3)))(np.full(panels.n, load))
        for panels in (whole.chosen(np.array([0])), halves)
    ]
    assert along[0] == pytest.approx(along[1], rel=1e-5)
