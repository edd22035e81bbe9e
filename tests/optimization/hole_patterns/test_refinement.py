"""Refined designs: never worse, symmetric, of the same topology, and the same when they are resumed.

Most are made stiffer, which takes one solution an evaluation.
"""

import numpy as np
import pytest

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.continuous import connected
from slmm.optimization.hole_patterns.margins import SHIFTS
from slmm.optimization.hole_patterns.plate import CrackedPlate
from slmm.optimization.hole_patterns.refinement import REACH, STRETCH, refine
from slmm.running.line_journal import open_lines

STIFF = HolePattern(4, "rotated", figure="stiffness")
DESIGN = np.array([[True, False], [False, False]])


def test_a_stiffer_plate_has_smaller_holes_of_the_same_topology():
    found = refine(STIFF, DESIGN, 16)
    values = found.support.values
    assert float(found.by_direction[0]) > float(found.by_direction_before[0])
    assert float(found.by_direction_before[0]) == STIFF.by_direction(DESIGN)[0]
    assert (np.rot90(values) == values).all()
    plate = CrackedPlate(frame=float(found.frame))
    assert plate.weight(values) > STIFF.plate.weight(STIFF.whole(DESIGN))
    assert (connected(plate.level_set(values)) == connected(STIFF.level_set(found.design.values))).all()
    assert np.abs(values - found.design.values).max() <= REACH
    spacing = STIFF.level_set(found.design.values).spacing
    assert abs(float(found.spacing) / spacing - 1) <= STRETCH
    # what is told is what a simulation of these values gives
    again = STIFF.fracture(plate.scene(values), 1e-9)
    assert float(again.F[-1] / again.u[-1]) == float(found.by_direction[0]) == float(found.value[-1])
    assert (np.diff(found.value) > 0).all()


def test_equal_designs_are_refined_alike_and_a_resumed_run_is_the_same_run(tmp_path, monkeypatch):
    mirrored = np.array([[False, False], [False, True]])
    assert STIFF.key(mirrored) == STIFF.key(DESIGN)
    calm = refine(STIFF, DESIGN, 9)
    assert refine(STIFF, mirrored, 9).identical(calm)
    journal = tmp_path / "run.jsonl"
    refine(STIFF, DESIGN, 4, journal=journal)
    with pytest.raises(ValueError, match="is there already; resume it"):
        refine(STIFF, DESIGN, 9, journal=journal)
    asked, fracture = [], HolePattern.fracture

    def counted(self, *arguments):
        asked.append(arguments)
        return fracture(self, *arguments)

    monkeypatch.setattr(HolePattern, "fracture", counted)
    assert refine(STIFF, DESIGN, 9, journal=journal, resume=True).identical(calm)
    assert 0 < len(asked) <= 5
    asked.clear()
    assert refine(STIFF, DESIGN, 9, journal=journal, resume=True).identical(calm) and not asked


def test_the_worst_of_shifted_plates_counts():
    """Of a design that is as it is, shifted up and shifted down."""
    problem = HolePattern(1, "full", sides="left", figure="stiffness")
    plain, shifted = (refine(problem, [[True]], 4, shifted=shifted) for shifted in (False, True))
    plate = problem.plate
    each = [problem.fracture(plate.scene(np.ones((1, 1)), (0.0, by)), 1e-9) for by in (0.0, *SHIFTS)]
    worst = min(float(result.F[-1] / result.u[-1]) for result in each)
    assert float(shifted.by_direction_before[0]) == worst <= float(plain.by_direction_before[0])


def test_plates_that_fail_are_recorded_and_passed_over(tmp_path, monkeypatch):
    def heavy_only(self, values, shift=(0.0, 0.0)):
        if not np.isin(values, (0, 1)).all():
            raise ValueError("the mesh is lost")
        return scene(self, values, shift)

    scene = CrackedPlate.scene
    monkeypatch.setattr(CrackedPlate, "scene", heavy_only)
    journal = tmp_path / "run.jsonl"
    found = refine(STIFF, DESIGN, 5, journal=journal)
    # the first steps are along the four support values
    assert (
        int(found.refused) == 4 and found.value.values.tolist() == found.by_direction_before.values.tolist()
    )
    run = {}
    with pytest.raises(ValueError, match="is that of another run"), open_lines(journal, run, resume=True):
        pass
    assert "the mesh is lost" in journal.read_text()


@pytest.mark.parametrize(
    ("problem", "design", "words"),
    [
        (STIFF, np.zeros((2, 2), bool), "design: has no hole"),
        (HolePattern(4, "rotated", heaviest=0.5), DESIGN, "design: must be a valid one of"),
    ],
)
def test_what_cannot_be_refined_is_refused(problem, design, words):
    with pytest.raises(ValueError, match=words):
        refine(problem, design, 3)


def test_toughness_is_refined_from_every_direction_that_differs():
    problem = HolePattern(4, "reflected", increment=8.0)
    design = np.array([[False, False], [True, False]])
    found = refine(problem, design, 3)
    assert found.sizes["direction"] == 2
    # four holes around the middle break alike from below
    assert float(found.by_direction[0]) == float(found.by_direction[1])
    assert float(found.by_direction.min()) >= float(found.by_direction_before.min())
