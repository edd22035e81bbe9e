"""Paper C, Tables 3 and 4, Fig. 11 and 12: the 48 x 16 cantilever on one grid and on nine, 11 runs each.

Required: the median of the multi-grid runs at least as good as the published one; every final value confirmed by a
sparse direct solve. Told: single grid, numbers of simulations, times (the paper: hours on four cores). A run that is
done is kept in validation/results/tables3_4_multi_grid.csv, and how its values came down in _curves.csv; started again,
the script goes on with those that are not. All of them take 11 minutes on two cores; ``--quick`` takes two grids, up to
12 x 8.
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

from slmm.optimization.algorithms.multi_grid import PUBLISHED as STAGES
from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.search import SearchResult, search
from slmm.pictures.optimization import draw_design

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


def one_run(task: tuple[str, int]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """What the tables show of a search, and how its value came down."""
    name, seed = task
    start = time.perf_counter()
    curve: list[dict[str, Any]] = []

    def tell(simulations: int, value: float) -> None:
        # an improvement by less than a hundredth does not show
        if not curve or abs(value - curve[-1]["value"]) > 1e-2 * abs(value):
            seconds = time.perf_counter() - start
            curve.append({"algorithm": name, "seed": seed, "simulations": simulations, "seconds": round(seconds, 2),
                          "value": value})  # fmt: skip

    algorithm, settings = ("mg", {}) if name == "MG" else ("tbfsl", {"depth": 4, "radius": 2})
    found = search(BEAM, algorithm, seed=seed, progress=tell, **settings)
    row = {
        "algorithm": name,
        "seed": seed,
        "value": found.value,
        "simulations": found.simulations,
        "seconds": time.perf_counter() - start,
        "off": confirmed(BEAM, found),
        "design": "".join("1" if cell else "0" for cell in found.best_design.ravel()),
    }
    return row, [*curve, {key: row[key] for key in ("algorithm", "seed", "simulations", "seconds", "value")}]


def finished(name: str) -> list[dict[str, Any]]:
    """The rows that are in a file already."""
    path = RESULTS / f"{name}.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    whole, real = {"seed", "simulations"}, {"value", "seconds", "off"}
    return [
        {key: int(x) if key in whole else float(x) if key in real else x for key, x in row.items()}
        for row in rows
    ]


def confirmed(beam: Cantilever, found: SearchResult) -> float:
    """Relative difference of the final value from a direct solve."""
    return abs(found.value / beam.solved_directly(found.best_design) - 1)


def draw(rows: list[dict[str, Any]], curves: list[dict[str, Any]]) -> None:
    """Values over time (Fig. 11), and designs (Fig. 12): e and f stand for a and c of the multi-grid run on the way."""
    colours = {"MG": "tab:red", "TBFSL(4, 2)": "tab:blue"}
    runs = {
        name: sorted((row for row in rows if row["algorithm"] == name), key=lambda row: row["value"])
        for name in colours
    }
    middle = {name: some[len(some) // 2] for name, some in runs.items()}
    figure = plt.figure(figsize=(15, 11), layout="constrained")
    panels = [["one", "all", "final"], ["first", "second", "last"], ["single", "best", "best multi"]]
    axes = figure.subplot_mosaic(panels, height_ratios=[1.3, 1, 1])
    for name, colour in colours.items():
        for row in runs[name]:
            points = [p for p in curves if (p["algorithm"], p["seed"]) == (name, row["seed"])]
            x, y = ([p[key] for p in points] for key in ("seconds", "value"))
            axes["all"].step(x, y, where="post", color=colour, lw=0.8)
            if row is middle[name]:
                axes["one"].step(x, y, where="post", color=colour, label=f"{name}, seed {row['seed']}")
        seconds, values = [row["seconds"] for row in runs[name]], [row["value"] for row in runs[name]]
        axes["final"].plot(seconds, values, "o", color=colour, label=name)
    for panel in ("one", "all", "final"):
        axes[panel].set(xlabel="s on one core", ylabel="endpoint displacement in mm")
    for panel in ("one", "all"):
        axes[panel].set_yscale("symlog", linthresh=0.1)
    axes["one"].legend(frameon=False)
    axes["final"].legend(frameon=False)
    seed = middle["MG"]["seed"]
    for panel, stages in (("first", STAGES[:1]), ("second", STAGES[:-1])):
        beam = Cantilever(*stages[-1][:2])
        found = search(beam, "mg", stages=stages, seed=seed)
        draw_design(axes[panel], beam, found.best_design)
        axes[panel].set_title(f"MG, median run, on {beam.columns} x {beam.rows}: {found.value:.2f} mm")
    for panel, row, title in (
        ("last", middle["MG"], "MG, median run"),
        ("single", middle["TBFSL(4, 2)"], "TBFSL(4, 2), median run"),
        ("best", runs["TBFSL(4, 2)"][0], "TBFSL(4, 2), best run"),
        ("best multi", runs["MG"][0], "MG, best run"),
    ):
        design = np.array([cell == "1" for cell in row["design"]]).reshape(BEAM.shape)
        draw_design(axes[panel], BEAM, design)
        axes[panel].set_title(f"{title}: {row['value']:.2f} mm")
    figure.savefig(RESULTS / f"{NAME}.png", dpi=110)
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
    rows, curves = finished(NAME), finished(f"{NAME}_curves")
    tasks = [
        (name, seed)
        for name in PUBLISHED
        for seed in range(RUNS)
        if not any((row["algorithm"], row["seed"]) == (name, seed) for row in rows)
    ]
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        for row, curve in pool.map(one_run, tasks):
            rows.append(row)
            # those of a run that was not finished are not known twice
            curves = [p for p in curves if (p["algorithm"], p["seed"]) != (row["algorithm"], row["seed"])]
            curves += curve
            save(f"{NAME}_curves", curves)
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
    draw(rows, curves)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
