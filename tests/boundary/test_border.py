"""Divided panels and cracks as a border of a factorised body: the same as a body factorised with these panels."""

import copy

import numpy as np
import pytest

from slmm.boundary.base_system import BaseSystem
from slmm.boundary.border import Border
from slmm.boundary.growing_factors import GrowingFactors
from slmm.boundary.model import BoundaryModel
from slmm.boundary.stretches import COARSE
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")
#: a crack that runs into a hole, starts behind it, passes another one, and meets the edge nearly
PATH = [
    lambda part: part.grown(0, (22.0, 50.4)),
    lambda part: part.grown(0, (25.0, 50.6)),
    lambda part: part.grown(0, (30.0, 50.0)),
    lambda part: part.with_crack([(50.0, 50.0), (52.0, 50.3)]),
    lambda part: part.grown(0, (58.0, 50.1)),
    lambda part: part.grown(0, (74.0, 49.6)),
    lambda part: part.grown(0, (92.0, 50.0)),
]


def of_its_own(model: BoundaryModel) -> BoundaryModel:
    """The same panels, all of them factorised."""
    body = copy.copy(model.body)
    body.base = BaseSystem(body.panels, body.known, body.kappa, body.base.tractions.size)
    body.border = Border(body.base)
    body.of_base, body.removed = np.arange(len(body.panels.intervals)), np.empty(0, dtype=int)
    for name in ("acted_points", "outside"):
        body.__dict__.pop(name, None)
    return BoundaryModel(model.part, PMMA, body.loading, body.p, model.crack_p, body)


@pytest.mark.parametrize("load", [{"displacement": 0.1}, {"stress": 5.0}, {"strain": (1e-3, 2e-3, 1e-3)}])
def test_a_body_whose_panels_are_divided_is_the_one_factorised_with_them(load):
    holes = [Outline.through(circle(at, r)) for at, r in (((40.0, 50.0), 10.0), ((62.0, 58.0), 5.0))]
    part = Part.plate(100.0, 100.0, holes, [[(0.0, 50.0), (20.0, 50.0)]])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, **load), 6, 5, grading=COARSE)
    first = model.body.base
    # at the right edge are tractions where all of it is held
    for step in PATH[:-1] if "strain" in load else PATH:
        part = step(part)
        model = model.with_cracks_of(part)
        assert model.body.base is first
        other = of_its_own(model)
        for ours, wanted in (
            (model.c, other.c),
            (model.t, other.t),
            (model.hoop, other.hoop),
            (model.energy_release_rates(), other.energy_release_rates()),
            (model.stress(np.array([[55.0, 20.0]])), other.stress(np.array([[55.0, 20.0]]))),
        ):
            # of loads that balance to the error of the panels a share of that moves the part
            assert ours == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max(initial=0.0))
        assert model.work == pytest.approx(other.work, rel=1e-9)
    assert len(model.body.removed) > 5


def test_panels_near_a_held_edge_are_divided_and_all_factorised_anew():
    part = Part.plate(100.0, 100.0, cracks=[[(0.0, 50.0), (20.0, 50.0)]])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, displacement=0.1), 6, 5, grading=COARSE)
    near = model.with_cracks_of(part.with_crack([(50.0, 4.0), (50.0, 20.0)]))
    assert near.body.base is not model.body.base
    assert near.body.serves(near.part)


def test_models_that_share_a_body_do_not_disturb_each_other():
    part = Part.plate(100.0, 100.0, cracks=[[(0.0, 50.0), (20.0, 50.0)]])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, displacement=0.1))
    up, down = (model.with_cracks_of(part.grown(0, (24.0, 50.0 + y))) for y in (1.0, -1.0))
    again = model.with_cracks_of(part.grown(0, (24.0, 51.0)))
    assert again.stress_intensities() == pytest.approx(up.stress_intensities(), rel=1e-10)
    mirrored = down.stress_intensities() * [1.0, -1.0]
    assert mirrored == pytest.approx(up.stress_intensities(), rel=1e-6)


def test_a_model_goes_on_after_others_have_divided_more_of_their_shared_body():
    part = Part.plate(100.0, 100.0, [Outline.through(circle((50.0, 50.0), 4.0))])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, stress=5.0))
    tips = [complex(54.0 + a, 50.0) for a in (0.05, 0.2, 0.8)]
    longer = part.with_crack([(54.0, 50.0), (58.0, 50.0)])
    trial = BoundaryModel(longer, PMMA, model.body.loading, body=model.body.divided(longer, tips))
    cracked = model.with_cracks_of(longer)
    assert len(cracked.body.removed) < len(trial.body.removed)
    other = of_its_own(cracked)
    assert cracked.stress_intensities() == pytest.approx(other.stress_intensities(), rel=1e-9, abs=1e-8)
    assert cracked.work == pytest.approx(other.work, rel=1e-10)


def test_what_was_broken_off_is_computed_when_it_is_asked_again(monkeypatch):
    part = Part.plate(100.0, 100.0, cracks=[[(0.0, 50.0), (20.0, 50.0)]])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, displacement=0.1))
    longer = part.grown(0, (22.0, 50.4))

    def breaks_off(*arguments):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("slmm.boundary.elimination._direct", breaks_off)
        with pytest.raises(KeyboardInterrupt):
            model.with_cracks_of(longer)
    found = model.with_cracks_of(longer)
    expected = of_its_own(found).stress_intensities()
    assert found.stress_intensities() == pytest.approx(expected, rel=1e-9, abs=1e-8)


def test_factors_that_grow_and_shrink_solve():
    rng = np.random.default_rng(3)
    matrix = rng.normal(size=(700, 700)) + 40.0 * np.eye(700)
    factors = GrowingFactors()
    sizes = [20, 21, 90, 300, 640]
    for m in sizes:
        factors.append(matrix[:m, :m])
    factors.truncate(301)  # within the last block
    assert factors.size == 300
    matrix[300:] += 1.0
    factors.append(matrix)
    right = rng.normal(size=700)
    assert matrix @ factors.solve(right) == pytest.approx(right, abs=1e-11)
    factors.truncate(0)
    assert factors.solve(np.empty(0)).shape == (0,)


def test_blocks_that_come_at_once_are_those_that_come_one_by_one():
    rng = np.random.default_rng(4)
    matrix = rng.normal(size=(90, 90)) + 10.0 * np.eye(90)
    right = rng.normal(size=90)
    one_by_one, at_once = GrowingFactors(), GrowingFactors()
    for m in (40, 70, 80, 90):
        one_by_one.append(matrix[:m, :m])
    at_once.append(matrix[:40, :40])
    at_once.append(matrix, 70, 80)
    assert at_once.solve(right) == pytest.approx(one_by_one.solve(right), abs=1e-12)
    for factors in (one_by_one, at_once):
        factors.truncate(79)
        assert factors.size == 70
        assert matrix[:70, :70] @ factors.solve(right[:70]) == pytest.approx(right[:70], abs=1e-11)


def test_an_odd_number_of_points_is_refused():
    """On a straight edge that rolls their equations would be singular."""
    with pytest.raises(ValueError, match="p = 5: must be even"):
        BoundaryModel(Part.plate(80.0, 80.0), PMMA, plate_loading(80.0, 80.0, displacement=1.0), p=5)
