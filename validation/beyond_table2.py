"""A search that finds the global optimum of Table 2's benchmark, where TBFSL, the best one of the paper, does not.

Tabu search (slmm.optimization.algorithms.tabu) beside TBFSL(4, 2) from random designs: 100 runs on the 8 x 5
cantilever, with seeds that its settings were not chosen on, and some on 9 x 5, where nothing but the number of steps
is another. Ranks are exact, from all valid designs; relative costs are those of Table 2. The best 112 designs of 8 x 5
carry a counterweight below the free end; they are far from those at rank 203 and 247, where TBFSL ends, and its
descents reach rank 1 three times in 40 000.
Required: the median relative cost is at most that of TBFSL, and no more than half of the runs miss rank 1. On 9 x 5,
with 13 times as many designs, that takes more steps; what comes of the default number there is told.
Writes validation/results/beyond_table2.csv, half an hour on two cores; ``--quick`` does six runs on 5 x 7 with half as
many steps.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import Any

import numpy as np
from checks import Check, run, save, show
from table2_searches import quartiles, relative_cost

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.brute_force import ranks
from slmm.optimization.cantilever.exhaustive import count_valid
from slmm.optimization.search import search

FIRST_SEED = 1000


@dataclass(frozen=True)
class Runs:
    """Runs of one search, with seeds that follow."""

    name: str
    number: int
    algorithm: str = "tabu"
    settings: dict[str, Any] = field(default_factory=dict)
    must_win: bool = True


def tbfsl(number: int) -> Runs:
    return Runs("TBFSL(4, 2)", number, "tbfsl", {"depth": 4, "radius": 2})


#: on each beam, TBFSL and what is compared with it
COMPARED = {
    Cantilever(8, 5): [tbfsl(100), Runs("tabu", 100)],
    Cantilever(9, 5): [
        tbfsl(20),
        Runs("tabu", 20, must_win=False),
        Runs("tabu, 30 000 steps", 12, settings={"steps": 30_000}),
    ],
}
QUICK = {Cantilever(5, 7): [tbfsl(6), Runs("tabu, 2500 steps", 6, settings={"steps": 2500})]}


def one_run(task: tuple[Cantilever, str, dict[str, Any], int]) -> tuple[float, int]:
    """Value and number of simulations."""
    beam, algorithm, settings, seed = task
    found = search(beam, algorithm, seed=seed, **settings)
    return found.value, found.simulations


def all_runs(tasks: list[tuple[Cantilever, str, dict[str, Any], int]], processes: int) -> np.ndarray:
    """Values and numbers of simulations (2, n)."""
    if processes == 1:
        return np.array([one_run(task) for task in tasks]).T
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        return np.array(list(pool.map(one_run, tasks))).T


def compared(
    beam: Cantilever, searches: list[Runs], processes: int
) -> tuple[list[Check], list[dict[str, object]]]:
    """Checks, and rows of the file."""
    tasks = [
        (beam, its.algorithm, its.settings, FIRST_SEED + k) for its in searches for k in range(its.number)
    ]
    values, simulations = all_runs(tasks, processes)
    distinct, back = np.unique(values, return_inverse=True)
    rank = ranks(beam, distinct)[back].astype(float)
    cost = relative_cost(simulations, rank, count_valid(beam))
    quantities = {"u, mm": values, "rank": rank, "simulations": simulations, "relative cost, %": cost}
    ends = np.cumsum([its.number for its in searches])[:-1]
    of_each = {quantity: np.split(of_all, ends) for quantity, of_all in quantities.items()}
    missed = [float((of != 1).mean()) for of in of_each["rank"]]
    size = f"{beam.columns} x {beam.rows}"
    checks: list[Check] = []
    rows: list[dict[str, object]] = []
    for k, its in enumerate(searches):
        medians = {}
        for quantity, found in of_each.items():
            low, middle, high = quartiles(found[k])
            medians[quantity] = float(np.median(found[0])), middle
            rows.append({"case": size, "algorithm": its.name, "runs": its.number, "quantity": quantity,
                         "low": low, "median": middle, "high": high, "missed_rank_1": missed[k]})  # fmt: skip
        if k == 0:
            continue
        case, rule = f"{size}, {its.name}", "at most" if its.must_win else "told"
        source = "required" if its.must_win else ""
        cost_of_both = medians.pop("relative cost, %")
        checks += [
            Check(case, "median relative cost, %, beside TBFSL's", *cost_of_both, rule=rule, source=source),
            Check(case, "share of runs that miss rank 1", 0.5, missed[k], rule=rule, source=source),
            Check(case, "share of runs that miss rank 1, beside TBFSL's", missed[0], missed[k], rule="told"),
            *(Check(case, f"median {name}, beside TBFSL's", *both, rule="told") for name, both in medians.items()),
        ]  # fmt: skip
    return checks, rows


def main(quick: bool = False) -> list[Check]:
    checks, rows = [], []
    for beam, searches in (QUICK if quick else COMPARED).items():
        its_checks, its_rows = compared(beam, searches, processes=1 if quick else 2)
        checks += its_checks
        rows += its_rows
    show("Tabu search beside TBFSL(4, 2)", checks)
    if not quick:
        save("beyond_table2", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
