"""Other objectives of hole patterns: figures of simulations, what counts of directions, limits, weight."""

from dataclasses import replace

import numpy as np
import pytest

from slmm.fracture.simulation import simulate
from slmm.mechanics.material import Material
from slmm.optimization import Bound, HolePattern, Value, search
from slmm.optimization.hole_patterns.plate import PMMA, CrackedPlate

SLIT = np.array([[False, True, False]] * 3)
PROBLEM = HolePattern(3, "full")


def test_figures_are_those_of_the_simulation():
    problem = replace(PROBLEM, sides="left")
    result = simulate(problem.scene(SLIT), 2.0, first_length=1.0, largest_displacement=2.0, errors=False)
    found = {
        figure: replace(problem, figure=figure).by_direction(SLIT)[0] for figure in ("U_T", "peak force")
    }
    assert found == {"U_T": float(result.U_T), "peak force": float(result.F.max())}
    # up to the first event F = S u
    stiffness = replace(problem, figure="stiffness").by_direction(SLIT)[0]
    assert stiffness == pytest.approx(float(result.stiffness[0]), rel=1e-9)


def test_the_mean_is_that_of_the_directions_and_limits_change_nothing():
    problem = HolePattern(3, "reflected", increment=4.0, over="mean")
    design = np.array([[False, True], [False, True]])
    value = problem.evaluate(design, np.inf)
    assert value.value == -sum(problem.tensile_toughness(design)) / 2
    assert problem.evaluate(design, np.nextafter(value.value, np.inf)) == value
    # 20 J are out of reach for what the first direction leaves to the second
    assert problem.evaluate(design, -1e4) == Bound(-1e4)


def test_a_slit_across_the_crack_is_told_from_one_along_it_only_from_one_side():
    left = replace(PROBLEM, sides="left", figure="stiffness")
    assert left.directions == 1 and left.key(SLIT) != left.key(SLIT.T)
    assert PROBLEM.key(SLIT) == PROBLEM.key(SLIT.T)
    upright, level = (left.evaluate(design, np.inf).value for design in (SLIT, SLIT.T))
    # holes across the load are what makes a plate soft
    assert upright < level
    both = replace(PROBLEM, figure="stiffness").evaluate(SLIT, np.inf)
    assert both == Value(max(upright, level))


def test_toughness_grows_with_the_energy_that_cracks_take():
    """Solid plates break by Griffith: U_T goes with G_c at the same stiffness."""
    twice = Material(PMMA.E, PMMA.nu, 2 * PMMA.sigma_c, 2 * PMMA.G_c, PMMA.state)
    solid = np.zeros((1, 1), bool)
    one, other = (
        HolePattern(1, "rotated", plate=CrackedPlate(material=material)).tensile_toughness(solid)[0]
        for material in (PMMA, twice)
    )
    assert other == pytest.approx(2 * one, rel=1e-9)


def test_too_heavy_plates_are_no_designs_and_are_repaired():
    problem = HolePattern(4, "reflected", figure="stiffness", heaviest=0.9)
    solid = problem.start
    assert problem.valid(np.array([solid])).tolist() == [False]
    lighter = problem.repaired(solid)
    assert problem.plate.weight(problem.whole(lighter)) <= 0.9
    found = search(problem, "ga", seed=1, population=4, recombinations=2, max_simulations=12)
    best = search(problem, "bf")
    assert problem.plate.weight(problem.whole(best.best_design)) <= 0.9
    assert best.value <= found.value < 0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"figure": "beauty"}, "figure = 'beauty': must be one of U_T, peak force, stiffness"),
        ({"over": "median"}, "over = 'median': must be one of least, mean"),
        ({"sides": "right"}, "sides = 'right': must be one of all, left"),
        ({"heaviest": 0.0}, "heaviest = 0.0: must lie above 0"),
    ],
)
def test_unknown_objectives_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        HolePattern(3, "full", **changes)


def test_every_parameter_tells_a_problem_from_others():
    changes = [
        {"plate": CrackedPlate(crack=12.0)},
        {"sides": "left"},
        {"figure": "stiffness"},
        {"heaviest": 0.5},
    ]
    assert len({repr(replace(PROBLEM, **change)) for change in ({}, *changes)}) == 5
