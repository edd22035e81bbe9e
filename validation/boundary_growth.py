"""How the time of boundary integrals grows with the number of panels: plates with 2 to 400 holes.

Round holes of random radii in the squares of a grid, the narrowest ligaments a tenth of their diameters, and up to 25
of them an edge crack. First solve and K, another increment of the crack, and memory, on one core with the default
orders; the least CPU time of three, of one where that takes more than two seconds. By factors up to 2000 points, by
skeletons up to 8000, beyond by iterations; at some sizes by two ways, of which K and the stress at the holes are
compared.

Required: the first solve grows no faster than the square of the number of panels up to 500; these agree to 1e-6;
100 holes take less than a minute and 1 GB. Writes validation/results/boundary_growth.csv, ten minutes; ``--quick`` up
to 16 holes, no file.
"""

from __future__ import annotations

import os

# times are those of one core
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import itertools
import resource
import time
from collections.abc import Callable

import numpy as np
from checks import Check, run, save, show

from slmm.boundary import base_system
from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")
SIDE = 100.0
HOLES = (100, 400, 2, 4, 6, 9, 16, 25)
#: up to so many with a crack; those without come first, since memory is the most that was taken so far
CRACKED = 25
#: sizes at which two ways are compared
BOTH = (6, 9)
#: radii over the sides of the grid's squares, and what is left between a hole and its square at least
RADII, LEFT = (0.25, 0.38), 0.05
#: an increment of the crack over the sides of the squares
STEP = 0.05
#: s above which a time is taken once
LONG = 2.0
Row = dict[str, float | int | str]


def plate(count: int, tip: float) -> Part:
    """A square plate with holes and a crack from its left edge to x = tip, mm."""
    rng = np.random.default_rng(count)
    across = int(np.ceil(np.sqrt(count)))
    side = SIDE / across
    holes = []
    for k in range(count):
        radius = side * rng.uniform(*RADII)
        slack = side * (0.5 - LEFT) - radius
        x, y = (np.array([k % across, k // across]) + 0.5) * side + rng.uniform(-slack, slack, 2)
        holes.append(Outline.through(circle((x, y), radius)))
    # between the rows of holes
    height = side * (across // 2)
    crack = [(0.0, height), (0.1 * side, height), (tip * side, height)]
    return Part.plate(SIDE, SIDE, holes, [crack] if count <= CRACKED else [])


def measured(count: int, most: int) -> tuple[Row, np.ndarray]:
    """Times of a plate whose equations are factorised up to so many points, and what is compared."""
    base_system.MOST_FACTORISED = most
    loading = plate_loading(SIDE, SIDE, displacement=0.1)
    part = plate(count, 0.2)
    first, model = least(lambda: solved(BoundaryModel(part, PMMA, loading)))
    compared, again = [model.stress_intensities().ravel(), model.hoop], float("nan")
    if part.cracks:
        x, y = part.cracks[0].points[-1]
        longer, other = (
            part.grown(0, (float(x) + step * SIDE / np.ceil(np.sqrt(count)), float(y)))
            for step in (STEP, 0.99 * STEP)
        )
        # in turn, for what is known of an increment is kept
        turns = itertools.cycle((longer, other))
        again, _ = least(lambda: solved(model.with_cracks_of(next(turns))), model.body.serves(longer))
        grown = solved(model.with_cracks_of(longer))
        compared.append(grown.stress_intensities().ravel())
    return {
        "holes": count,
        "panels": len(model.panels.ends) + len(model.cracks.starts if model.cracks else ()),
        "points": model.panels.n,
        "way": type(model.body.base.solver).__name__,
        "first_s": first,
        "increment_s": again,
        "memory_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }, np.concatenate(compared)


def solved(model: BoundaryModel) -> BoundaryModel:
    """With its stress intensities computed."""
    model.stress_intensities()
    return model


def least(what: Callable[[], BoundaryModel], repeated: bool = True) -> tuple[float, BoundaryModel]:
    """Least CPU time of three runs, s, and the result; of one run that is long or not to be repeated."""
    taken = []
    for _ in range(3 if repeated else 1):
        begin = time.process_time()
        result = what()
        taken.append(time.process_time() - begin)
        if taken[-1] > LONG:
            break
    return min(taken), result


def growth(rows: list[Row], key: str) -> float:
    """Exponent of a time in the number of panels, from 100 to 500 of them."""
    chosen = [r for r in rows if 100 <= int(r["panels"]) <= 500]
    panels, times = (np.array([float(r[k]) for r in chosen]) for k in ("panels", key))
    return float(np.polyfit(np.log(panels), np.log(times), 1)[0])


def main(quick: bool = False) -> list[Check]:
    """Measure all; see the module."""
    default = base_system.MOST_FACTORISED
    measured(2, default)  # compiles the kernels
    measured(2, 0)
    rows, checks = [], []
    for count in HOLES:
        if quick and count > 16:
            continue
        row, values = measured(count, default)
        rows.append(row)
        if count in BOTH:
            other_row, other = measured(count, 0 if row["way"] == "Factorised" else 10**6)
            rows.append(other_row)
            apart = float(np.abs(other - values).max() / np.abs(values).max())
            checks.append(Check(f"{count} holes", "factors against skeletons", 1e-6, apart, rule="at most"))
        print(rows[-1])
    base_system.MOST_FACTORISED = default
    by_default = [r for r in rows if (r["way"] == "Factorised") == (int(r["points"]) <= default)]
    checks.append(
        Check(
            "up to 500 panels",
            "exponent of the first solve",
            2.0,
            growth(by_default, "first_s"),
            rule="at most",
        )
    )
    checks.append(
        Check(
            "up to 500 panels",
            "exponent of an increment",
            2.0,
            growth(by_default, "increment_s"),
            rule="told",
        )
    )
    for row in rows:
        if row["holes"] == 100:
            checks.append(Check("100 holes", "first solve, s", 60.0, float(row["first_s"]), rule="at most"))
            checks.append(Check("100 holes", "memory, MB", 1000.0, float(row["memory_MB"]), rule="at most"))
    show("Growth of the time of boundary integrals", checks)
    if not quick:
        save("boundary_growth", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
