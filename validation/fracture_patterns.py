"""Random hole patterns broken from four sides: whether every simulation ends as it should, and its energy is told.

500 designs of the full grid of 3 to 10 support points, drawn as those of `fracture_speed.py`, with the settings of a
search. Required: at most 0.1 % of the increments fail (Paper D: 0.14 %), each with a reason and with the steps before
it; no simulation raises or takes more CPU time than a limit; work is what steps set free and what is stored, no step
makes the plate stiffer, and in a severed plate cracks take no more than was set free and nothing stays stored. Writes
validation/results/fracture_patterns.csv a simulation at a time, goes on where it was stopped, and judges all;
an hour of CPU as a whole. ``--quick`` breaks two designs from two sides and writes nothing.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import numpy as np
from checks import Check, append, run, saved, show

from slmm.fracture import simulate
from slmm.fracture.history import Outcome
from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.objectives import LARGEST

DESIGNS, DIRECTIONS, SEED = 500, 4, 0
#: support points along a side; required
GRIDS = tuple(range(3, 11))
#: shares of holes; chosen, as in fracture_speed.py
LEAST, MOST = 0.1, 0.6
#: share of increments that may fail; required
FAILING = 1e-3
#: CPU time of a simulation above which it counts as one that hangs, s; chosen, some eighty times the median
LIMIT = 60.0
#: work that may be missing, over U_T; round-off
ROUND_OFF = 1e-9
#: energy that steps may take up instead of setting it free, over U_T; what the model resolves at tolerance 0.01
RESOLVED = 2e-3
NAME = "fracture_patterns"
#: of a simulation; ``stiffened`` is what steps took up because the plate became stiffer, mJ
NUMBERS = ("steps", "U_T", "imbalance", "released", "dissipated", "stiffened", "stored")

Row = dict[str, object]


def design_of(number: int) -> tuple[HolePattern, np.ndarray]:
    """A design by its number, without islands and not empty."""
    rng = np.random.default_rng([SEED, number])
    problem = HolePattern(GRIDS[number % len(GRIDS)], "full")
    while True:
        design = rng.random(problem.shape) < rng.uniform(LEAST, MOST)
        if design.any() and problem.valid(design[None])[0]:
            return problem, design


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise TimeoutError after so much CPU time."""

    def stop(signum: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"more than {seconds:g} s of CPU time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def broken(number: int, direction: int) -> Row:
    """What comes of a design from one side; ``raised`` if nothing does."""
    problem, design = design_of(number)
    row: Row = {
        "design": number,
        "grid": problem.grid,
        "direction": direction,
        "holes": " ".join("".join("o" if hole else "." for hole in line) for line in design),
        "raised": "",
        "outcome": "",
        "severed": False,
        "failed": False,
    }
    numbers = dict.fromkeys(NUMBERS, np.nan)
    begin = time.process_time()
    try:
        with limited(LIMIT):
            result = simulate(
                problem.scene(design, direction),
                problem.increment,
                first_length=problem.first_length,
                largest_displacement=LARGEST,
                errors=False,
            )
    except Exception as error:  # what a user would see as a crash is what is counted
        row["raised"] = f"{type(error).__name__}: {error}"
    else:
        outcome = str(result.attrs["outcome"])
        row |= {"outcome": outcome, "severed": outcome == Outcome.SEVERED}
        row["failed"] = outcome.startswith(Outcome.FAILED)
        numbers = {name: float(result[name].sum()) for name in NUMBERS if name in result}
        numbers["steps"] = float(result.sizes["step"])
        numbers["stiffened"] = float(np.maximum(-result.released, 0.0).sum())
    return row | {name: numbers[name] for name in NUMBERS} | {"cpu": time.process_time() - begin}


def rows_of(quick: bool) -> list[Row]:
    """All simulations, those of a file first; the same words and numbers whether read or computed."""
    if quick:
        return [broken(number, direction) for number in (0, 1) for direction in (0, 1)]
    done = {(int(row["design"]), int(row["direction"])) for row in saved(NAME)}
    for number in range(DESIGNS):
        for direction in range(DIRECTIONS):
            if (number, direction) not in done:
                append(NAME, [broken(number, direction)])
    return [dict(row) for row in saved(NAME)]


def checks_of(rows: list[Row]) -> list[Check]:
    """What is required of them together."""
    raised = [row for row in rows if row["raised"]]
    ended = [row for row in rows if not row["raised"]]
    failed, severed = ([row for row in ended if str(row[name]) == "True"] for name in ("failed", "severed"))

    def values(name: str, of: list[Row]) -> np.ndarray:
        return np.array([float(str(row[name])) for row in of])

    steps, U_T = values("steps", ended), values("U_T", ended)
    lost = values("steps", failed) == 0
    unsaid = [row for row in failed if str(row["outcome"]).partition(": ")[2] == ""]
    case = f"{len({row['design'] for row in rows})} designs, {len(rows)} simulations"
    limits = (
        ("simulations that raise or hang", 0, len(raised)),
        ("share of increments that fail", FAILING, len(failed) / (steps.sum() + len(failed))),
        ("failures without a reason or without earlier steps", 0, len(unsaid) + lost.sum()),
        (
            "work that is neither set free nor stored, over U_T",
            ROUND_OFF,
            np.max(np.abs(values("imbalance", ended)) / U_T),
        ),
        (
            "energy that cracks take over what is set free",
            1.0,
            np.max(values("dissipated", severed) / values("released", severed), initial=0.0),
        ),
        ("energy that steps take up, over U_T", RESOLVED, np.max(values("stiffened", ended) / U_T)),
        ("energy that severed plates store, mJ", 0.0, np.max(values("stored", severed), initial=0.0)),
    )
    told = (
        ("increments", steps.sum()),
        ("severed", len(severed)),
        (
            "energy set free that cracks do not take, over U_T, median",
            np.median((values("released", ended) - values("dissipated", ended)) / U_T),
        ),
        ("CPU time, median, s", np.median(values("cpu", rows))),
        ("CPU time, largest, s", np.max(values("cpu", rows))),
    )
    return [
        *(
            Check(case, what, wanted, float(ours), rule="at most", source="required")
            for what, wanted, ours in limits
        ),
        *(Check(case, what, np.nan, float(ours), rule="told") for what, ours in told),
    ]


def main(quick: bool = False) -> list[Check]:
    checks = checks_of(rows_of(quick))
    show("Random hole patterns, broken from four sides", checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
