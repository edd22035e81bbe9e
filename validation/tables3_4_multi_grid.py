"""Paper C, Tables 3 and 4, Fig. 11c and 12: the 48 x 16 cantilever on one grid and on nine, 11 runs each.

Required: the median of the multi-grid runs at least as good as the published one; every final value confirmed by a
sparse direct solve. Told: single grid, numbers of simulations, times (the paper: hours on four cores). A run that is
done is kept in validation/results/tables3_4_multi_grid.csv; started again, the script goes on with those that are not.
All of them take 40 minutes on two cores; ``--quick`` takes two grids, up to 12 x 8.
"""

from __future__ import annotations

import csv
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm.optimization.cantilever import Cantilever
from slmm.optimization.search import SearchResult, search
from slmm.plot_optimization import draw_design

matplotlib.use("Agg")
import matplotlib.pyplot as plt

NAME = "tables3_4_multi_grid"
RUNS = 11
BEAM = Cantilever(48, 16)
#: medians of value (mm), simulations and time (s); best and worst value
PUBLISHED = {
    "MG": (-13.98, 707768, 7813, -14.98, -0.40),
    "TBFSL(4, 2)": (-6.69, 222134, 15868, -17.62, -0.58),
}
SMALL = ((8, 5, "tbfsl", {"depth": 4, "radius": 2}), (12, 8, "tbfsl", {"depth": 2, "radius": 2}))


def one_run(task: tuple[str, int]) -> dict[str, Any]:
    """What the table shows of a search, and its last grid's convergence."""
    name, seed = task
    start = time.perf_counter()
    algorithm, settings = ("mg", {}) if name == "MG" else ("tbfsl", {"depth": 4, "radius": 2})
    found = search(BEAM, algorithm, seed=seed, **settings)
    return {
        "algorithm": name,
        "seed": seed,
        "value": found.value,
        "simulations": found.simulations,
        "seconds": time.perf_counter() - start,
        "off": confirmed(BEAM, found),
        "design": "".join("1" if cell else "0" for cell in found.best_design.ravel()),
    }


def finished() -> list[dict[str, Any]]:
    """The runs that are in the file already."""
    path = RESULTS / f"{NAME}.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [
        {**row, "seed": int(row["seed"]), "simulations": int(row["simulations"])}
        | {key: float(row[key]) for key in ("value", "seconds", "off")}
        for row in rows
    ]


def confirmed(beam: Cantilever, found: SearchResult) -> float:
    """Relative difference of the final value from a direct solve."""
    return abs(found.value / beam.solved_directly(found.best_design) - 1)


def draw(rows: list[dict[str, Any]]) -> None:
    """Values over time (Fig. 11c) and the designs of the median runs (Fig. 12)."""
    figure = plt.figure(figsize=(13, 7), layout="constrained")
    axes = figure.subplot_mosaic([["c", "m"], ["c", "s"]])
    for name, colour, panel in (("TBFSL(4, 2)", "tab:blue", "s"), ("MG", "tab:red", "m")):
        runs = sorted((row for row in rows if row["algorithm"] == name), key=lambda row: row["value"])
        seconds, values = [row["seconds"] for row in runs], [row["value"] for row in runs]
        axes["c"].plot(seconds, values, "o", color=colour, label=name)
        middle = runs[len(runs) // 2]
        design = np.array([cell == "1" for cell in middle["design"]]).reshape(BEAM.shape)
        draw_design(axes[panel], BEAM, design)
        axes[panel].set_title(f"{name}, median run: {middle['value']:.2f} mm")
    axes["c"].set(xlabel="s on one core", ylabel="final endpoint displacement in mm")
    axes["c"].legend(frameon=False)
    figure.savefig(RESULTS / f"{NAME}.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    if quick:
        beam = Cantilever(12, 8)
        several = [search(beam, "mg", stages=SMALL, seed=seed) for seed in range(3)]
        alone = [search(beam, "tbfsl", depth=2, radius=2, seed=seed) for seed in range(3)]
        checks = [
            Check("12 x 8, two grids", "median, mm, against one grid", np.median([f.value for f in alone]),
                  np.median([f.value for f in several]), rule="told"),
            Check("12 x 8", "final values against direct solves", 1e-6,
                  max(confirmed(beam, f) for f in several + alone), rule="at most", source="sparse LU"),
        ]  # fmt: skip
        show("Multi-grid", checks)
        return checks
    rows = finished()
    tasks = [
        (name, seed)
        for name in PUBLISHED
        for seed in range(RUNS)
        if not any((row["algorithm"], row["seed"]) == (name, seed) for row in rows)
    ]
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        for row in pool.map(one_run, tasks):
            rows.append(row)
            save(NAME, sorted(rows, key=lambda r: (r["algorithm"], r["value"])))
            print(
                f"{row['algorithm']}, seed {row['seed']}: {row['value']:.3f} mm, {row['seconds']:.0f} s",
                flush=True,
            )
    checks = []
    for name, (u, n, t, best, worst) in PUBLISHED.items():
        value, simulations, seconds, off = (
            np.array([row[key] for row in rows if row["algorithm"] == name], dtype=float)
            for key in ("value", "simulations", "seconds", "off")
        )
        rule = "at most" if name == "MG" else "told"
        checks += [
            Check(name, "median, mm", u, float(np.median(value)), rule=rule, source="Paper C"),
            Check(name, "best, mm", best, value.min(), rule="told", source="Paper C"),
            Check(name, "worst, mm", worst, value.max(), rule="told", source="Paper C"),
            Check(
                name,
                "median of the simulations",
                n,
                float(np.median(simulations)),
                rule="told",
                source="Paper C",
            ),
            Check(
                name,
                "median time, s (ours: one core)",
                t,
                float(np.median(seconds)),
                rule="told",
                source="Paper C",
            ),
            Check(
                name,
                "final values against direct solves",
                1e-6,
                off.max(),
                rule="at most",
                source="sparse LU",
            ),
        ]
    show("One grid and nine", checks)
    draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
