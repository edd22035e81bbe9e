"""Energy of one crack by what it opens: against shorter ones, against the part's work, and scaled."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.boundary.opened_path import OpenedPath, with_path
from slmm.boundary.trial_cracks import TrialCracks
from slmm.scene import gallery

GAP = 0.5
SCENE = gallery.two_holes(GAP)
START, END = np.array([50.0 - GAP / 2, 50.0]), np.array([50.0 + GAP / 2, 50.0])
MODEL = BoundaryModel(SCENE.part, SCENE.material, SCENE.loading, 10)


def test_one_crack_tells_what_all_shorter_ones_do():
    """Clapeyron's theorem against the integral of G over the length."""
    length = 0.6 * GAP
    tip = START + length * np.array([1.0, 0.0])
    cracked = MODEL.with_cracks_of(MODEL.part.with_short_crack(START, tip))
    energy = OpenedPath(MODEL, cracked, complex(*START), complex(*tip)).energy
    shorter = TrialCracks(MODEL, START, np.array([1.0, 0.0]), length).incremental(np.array([length]))
    assert energy == pytest.approx(shorter[0] * length, rel=1e-4)


def test_the_part_does_as_much_work_as_the_cut_sets_free():
    """Held edges do none: what is stored is less by that. The part's own work has lost four digits of it."""
    cracked = MODEL.with_cracks_of(with_path(MODEL.part, START, END))
    cut = OpenedPath(MODEL, cracked, complex(*START), complex(*END))
    assert cut.energy == pytest.approx(0.5 * (MODEL.work - cracked.work), rel=2e-3)
    assert cut.is_open


def test_a_crack_that_goes_on_has_set_free_what_its_tips_did():
    """The traction that was there is infinite at the old tip; G times the step, where K hardly changes along it."""
    scene = gallery.edge_crack(10.0)
    model = BoundaryModel(scene.part, scene.material, scene.loading, 10)
    tip = np.array(scene.part.tips[0][-1])
    end = tip + np.array([0.5, 0.0])
    longer = model.with_cracks_of(model.part.grown(0, end))
    energy = OpenedPath(model, longer, complex(*tip), complex(*end)).energy
    G = [each.energy_release_rates()[0] for each in (model, longer)]
    assert energy == pytest.approx(0.5 * np.mean(G), rel=1e-3)


def test_faces_that_are_pressed_together_are_not_open():
    scene = gallery.two_holes(GAP, e_yy=-0.01)
    model = BoundaryModel(scene.part, scene.material, scene.loading, 10)
    cracked = model.with_cracks_of(with_path(model.part, START, END))
    cut = OpenedPath(model, cracked, complex(*START), complex(*END))
    assert not cut.is_open and cut.energy > 0
