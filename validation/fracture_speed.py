"""CPU time, memory and accuracy of simulated fracture: a plate with one hole, and random hole patterns as searches ask.

Patterns are random designs of the full 7 x 7 grid, everything included: outlines, checks of the scene, simulation. U_T
is compared with that of the next finer order; where events compete the path may fork, and the share of such is told.
Writes validation/results/fracture_speed.csv, some minutes; ``--quick`` takes three designs and writes nothing.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Callable

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.objectives import LARGEST
from slmm.scene.gallery import tensile_plate
from slmm.scene.scene import Scene

#: random patterns: their number, points along a side, seed
DESIGNS, GRID, SEED = 20, 7, 0
#: evaluations over which memory must stay what it was, and by how much it may grow, MB
EVALUATIONS, GROWTH = 200, 20.0
#: relative error of U_T that patterns may have in the median
TOLERANCE = 3e-3


def seconds(what: Callable[[], object], times: int = 3) -> float:
    """Median CPU time, s."""
    taken = []
    for _ in range(times):
        begin = time.process_time()
        what()
        taken.append(time.process_time() - begin)
    return float(np.median(taken))


def plate() -> list[Check]:
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    simulate(scene, 2.0)  # kernels
    return [
        Check(
            "plate with one hole, 27 steps",
            f"CPU time, errors={errors}, s",
            np.nan,
            seconds(lambda errors=errors: simulate(scene, 2.0, errors=errors), 5),
            rule="told",
        )
        for errors in (False, True)
    ]


def designs(number: int) -> tuple[HolePattern, list[np.ndarray]]:
    problem, rng = HolePattern(GRID, "full"), np.random.default_rng(SEED)
    found: list[np.ndarray] = []
    while len(found) < number:
        design = rng.random((GRID, GRID)) < rng.uniform(0.1, 0.6)
        if problem.valid(design[None])[0]:
            found.append(design)
    return problem, found


def toughness(problem: HolePattern, scene: Scene, tolerance: float = 0.01, errors: bool = False) -> float:
    result = simulate(
        scene,
        problem.increment,
        first_length=problem.first_length,
        largest_displacement=LARGEST,
        tolerance=tolerance,
        errors=errors,
    )
    return float(result.U_T)


def patterns(number: int) -> list[Check]:
    problem, found = designs(number)
    whole = [seconds(lambda d=d: toughness(problem, problem.scene(d)), 1) for d in found]
    scenes = [problem.scene(design) for design in found]
    making = [seconds(lambda d=d: problem.scene(d), 1) for d in found]
    with_errors = [seconds(lambda s=s: toughness(problem, s, errors=True), 1) for s in scenes]
    off = [abs(toughness(problem, s) / toughness(problem, s, 1e-3) - 1) for s in scenes]
    case = f"{number} random patterns of {GRID} x {GRID}"
    told = (
        ("CPU time, outlines and scene included, median, s", np.median(whole)),
        ("the same, largest, s", np.max(whole)),
        ("of this outlines and scene, median, s", np.median(making)),
        ("simulation with errors=True, median, s", np.median(with_errors)),
        ("share with U_T off by more than 1 %: forks", np.mean(np.array(off) > 0.01)),
    )
    return [
        Check(case, "U_T against the next order, median", TOLERANCE, float(np.median(off)), rule="at most"),
        *(Check(case, name, np.nan, float(value), rule="told") for name, value in told),
    ]


def memory(evaluations: int) -> list[Check]:
    """What the largest memory grows by, after a first share of evaluations."""
    problem, found = designs(8)

    def largest() -> float:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    for design in found:
        toughness(problem, problem.scene(design))
    before = largest()
    for k in range(evaluations):
        toughness(problem, problem.scene(found[k % len(found)]))
    case = f"{evaluations} evaluations"
    return [
        Check(case, "growth of memory, MB", GROWTH, largest() - before, rule="at most"),
        Check(case, "memory, MB", np.nan, largest(), rule="told"),
    ]


def main(quick: bool = False) -> list[Check]:
    checks = [*plate(), *patterns(3 if quick else DESIGNS), *memory(3 if quick else EVALUATIONS)]
    show("Speed of simulated fracture", checks)
    if not quick:
        save("fracture_speed", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
