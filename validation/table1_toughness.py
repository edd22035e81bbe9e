"""Table 1 of Paper D: its 21 searches for the toughest hole pattern, by boundary integrals.

Each run is TBFSL(3, 3) from the solid plate, as published, its neighbours in the order of one seed. Every value is kept
in a journal, so that a run that was stopped goes on; a line of validation/results/table1_toughness.csv is written when
a run is complete: U_T* of the paper and ours, designs and simulations of both, CPU time, how near a saddle is, and
the rank of what was found where all values of a space are known (`hole_pattern_values.py`).

Required: at least 98 % of the published U_T* (whose solid plate is 1.9 % high), and all runs of the file in an hour on
two cores. ``--runs reflected-8 rotated-7`` does these, by default all, the small ones first; ``--workers 2`` on so many
processes. ``--quick`` does the smallest and writes nothing.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
from checks import Check, append, saved, show
from hole_pattern_spaces import (
    JOURNALS,
    TABLE1,
    CountedPattern,
    by_size,
    counted,
    designs_in,
    listed,
    text_of,
    variables,
)

from slmm.optimization import search

NAME = "table1_toughness"
#: of TBFSL; published
DEPTH, RADIUS, SEED = 3, 3, 0
#: share of the published value that is required, and CPU time of all runs: an hour of two cores, s
LEAST, MOST = 0.98, 7200.0
Row = dict[str, object]


def run(pattern: str, grid: int, workers: int, folder: Path) -> Row:
    """A line of the file, from journals in a folder."""
    journal = folder / f"table1_{pattern}_{grid}.db"
    problem = CountedPattern(grid, pattern, log=journal.with_suffix(".log"))
    found = search(
        problem,
        "tbfsl",
        seed=SEED,
        start=problem.start,
        workers=workers,
        journal=journal,
        resume=True,
        depth=DEPTH,
        radius=RADIUS,
    )
    published, whole, space = TABLE1[pattern, grid], problem.whole(found.best_design), listed(pattern, grid)
    simulations, cpu = counted(problem.log)
    return {
        "pattern": pattern,
        "grid": grid,
        "variables": variables(pattern, grid),
        "U_T": -found.value,
        "U_T_paper": published.U_T,
        "designs": designs_in(journal),
        "designs_paper": published.iterations,
        "simulations": simulations,
        "simulations_paper": published.evaluations,
        "failed": found.failed,
        "cpu": cpu,
        "margin": problem.level_set(whole).margin(),
        "rank": "" if space is None else space.rank(space.values[space.key(found.best_design)]),
        "design": text_of(whole),
    }


def gathered(runs: list[tuple[str, int]], workers: int) -> list[dict[str, str]]:
    """The file, what is missing of these runs computed and added to it."""
    JOURNALS.mkdir(exist_ok=True)
    done = {(row["pattern"], int(row["grid"])) for row in saved(NAME)}
    for pattern, grid in runs:
        if (pattern, grid) not in done:
            row = run(pattern, grid, workers, JOURNALS)
            append(NAME, [row])
            print(row, flush=True)
    return saved(NAME)


def judged(rows: list[dict[str, str]]) -> list[Check]:
    checks = []
    for row in rows:
        case = f"{row['pattern']} {row['grid']}"
        paper, ours = float(row["U_T_paper"]), float(row["U_T"])
        checks += [
            Check(case, "U_T*, mJ", paper, ours, rule="told", source="Paper D, Table 1"),
            Check(case, "short of it", 1 - LEAST, 1 - ours / paper, rule="at most", source="required"),
            Check(
                case,
                "simulations",
                float(row["simulations_paper"]),
                float(row["simulations"]),
                rule="told",
                source="Paper D, Table 1",
            ),
            Check(case, "CPU time, s", np.nan, float(row["cpu"]), rule="told"),
        ]
    together = sum(float(row["cpu"]) for row in rows)
    checks.append(
        Check(f"{len(rows)} of 21 runs", "CPU time, s", MOST, together, rule="at most", source="required")
    )
    return checks


def main(quick: bool = False, runs: list[tuple[str, int]] | None = None, workers: int = 1) -> list[Check]:
    if quick:
        with tempfile.TemporaryDirectory() as folder:
            rows = [{name: str(value) for name, value in run("rotated", 3, 1, Path(folder)).items()}]
    else:
        rows = gathered(runs or by_size(), workers)
    checks = judged(rows)
    show("Hole patterns beside Table 1 of Paper D", checks)
    return checks


def space_of(text: str) -> tuple[str, int]:
    """A run by its name, as reflected-8."""
    pattern, _, grid = text.partition("-")
    if not grid.isdigit() or (pattern, int(grid)) not in TABLE1:
        raise argparse.ArgumentTypeError(f"{text}: must be a run of Table 1, as reflected-8")
    return pattern, int(grid)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="the smallest rotated pattern, no files")
    parser.add_argument("--runs", nargs="+", type=space_of, help="which, as reflected-8")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    given = parser.parse_args()
    raise SystemExit(0 if all(c.holds for c in main(given.quick, given.runs, given.workers)) else 1)
