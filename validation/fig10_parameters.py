"""Paper C, Fig. 10: depth and radius of TBFSL on the 8 x 5 cantilever, 100 runs for each pair.

Required, as published: all settings cost less than a tenth of random sampling in the median; the median rank is below
300 for every depth of two cells or more with a radius of two or more; radius 9 is BFSL. And beyond the paper:
TBFSL(2, 2) from the full design, which costs less than TBFSL(4, 2) from random ones and ends at a better rank.
Writes validation/results/fig10_parameters.csv and .png, five minutes on two cores; ``--quick`` takes depth 1 and 2, 20
runs, and no ranks.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show
from table2_searches import BEAM, relative_cost

from slmm.optimization.cantilever.brute_force import ranks
from slmm.optimization.cantilever.exhaustive import count_valid
from slmm.optimization.search import search

matplotlib.use("Agg")
import matplotlib.pyplot as plt

RUNS = 100
DEPTHS, RADII = (1, 2, 3, 4), (0, 1, 2, 3, 4, 6, 9)


def one_run(task: tuple[int, int, int, bool]) -> tuple[float, int]:
    """Value and number of simulations, from a random design or the full one."""
    depth, radius, seed, full = task
    start = np.ones(BEAM.shape, dtype=bool) if full else None
    found = search(BEAM, "tbfsl", depth=depth, radius=radius, seed=seed, start=start)
    return found.value, found.simulations


def main(quick: bool = False) -> list[Check]:
    if quick:
        depth_1 = [one_run((1, radius, seed, False)) for radius in (0, 9) for seed in range(20)]
        deeper = [one_run((2, 2, seed, False)) for seed in range(20)]
        checks = [
            Check("TBFSL(1, 0) and TBFSL(1, 9)", "values that differ", 0.0,
                  float(np.abs(np.subtract(depth_1[:20], depth_1[20:])[:, 0]).max()), rule="at most", source="Paper C"),
            Check("TBFSL(2, 2)", "median, mm", 0.00582 + 5e-6, float(np.median([v for v, _ in deeper])),
                  rule="at most", source="rank 247"),
        ]  # fmt: skip
        show("Depth and radius", checks)
        return checks
    pairs = [(depth, radius, False) for depth in DEPTHS for radius in RADII] + [(2, 2, True)]
    tasks = [(depth, radius, seed, full) for depth, radius, full in pairs for seed in range(RUNS)]
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        outcome = list(pool.map(one_run, tasks, chunksize=10))
    values, simulations = (
        np.array(x, dtype=float).reshape(len(pairs), RUNS) for x in zip(*outcome, strict=True)
    )
    distinct, back = np.unique(values, return_inverse=True)
    place = ranks(BEAM, distinct)[back].reshape(values.shape)
    cost = relative_cost(simulations, place, count_valid(BEAM))
    rows = []
    for k, (depth, radius, full) in enumerate(pairs):
        low, middle, high = np.quantile(cost[k], [0.25, 0.5, 0.75])
        rows.append(
            {
                "depth": depth,
                "radius": radius,
                "start": "full" if full else "random",
                "cost": middle,
                "cost_iqr": high - low,
                "rank": float(np.median(place[k])),
                "simulations": float(np.median(simulations[k])),
                "rank_1": int((place[k] == 1).sum()),
            }
        )
    random_starts = [row for row in rows if row["start"] == "random"]
    published = next(row for row in random_starts if (row["depth"], row["radius"]) == (4, 2))
    deep = [row for row in random_starts if row["depth"] > 1 and row["radius"] > 1]
    full = rows[-1]
    checks = [
        Check("all settings", "largest median cost, %", 10.0, max(row["cost"] for row in random_starts),
              rule="at most", source="Paper C"),
        Check("depth and radius 2 and more", "largest median rank", 300.0, max(row["rank"] for row in deep),
              rule="at most", source="Paper C"),
        Check("TBFSL(2, 2) from the full design", "median cost over that of TBFSL(4, 2)", 1.0,
              full["cost"] / published["cost"], rule="at most", source="beyond the paper"),
        Check("TBFSL(2, 2) from the full design", "median rank", published["rank"], full["rank"], rule="at most",
              source="TBFSL(4, 2)"),
        Check("all settings", "runs that find rank 1", 0.0, float(sum(row["rank_1"] for row in rows)), rule="told"),
    ]  # fmt: skip
    show("Depth and radius", checks)
    save("fig10_parameters", rows)
    draw(random_starts)
    return checks


def draw(rows: list[dict]) -> None:
    figure, axes = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    for depth in DEPTHS:
        here = [row for row in rows if row["depth"] == depth]
        radius = [row["radius"] for row in here]
        axes[0].errorbar(radius, [row["cost"] for row in here], [row["cost_iqr"] / 2 for row in here],
                         marker="o", capsize=3, label=f"depth {depth}")  # fmt: skip
        axes[1].plot(radius, [row["rank"] for row in here], "o-", label=f"depth {depth}")
    axes[0].axhline(10.0, color="red", lw=1)
    axes[0].set(xlabel="radius", ylabel="median relative cost in % (bars: interquartile range)", yscale="log")
    axes[1].set(xlabel="radius", ylabel="median rank", yscale="log")
    axes[0].legend(frameon=False)
    figure.savefig(RESULTS / "fig10_parameters.png", dpi=130)
    plt.close(figure)


if __name__ == "__main__":
    run(main, __doc__)
