"""How honest the estimated errors of the failure index are: random scenes against full FEA.

Random outlines, loads and materials as in stability.py, from seeds that no estimate was fitted to; Irwin's length is
0.02 to 1 times the radius of the notch where the stress is highest. At two random positions of each scene with any
tension, and at the most critical one, `slmm+ac`, `dislocations` and `auto` are held against full FEA (whose own error,
0.03 % on average, is taken off). Required: at least 95 % of the errors lie below their estimates, and half of the
estimates are less than ten times too wide.

Writes validation/results/estimates.csv (one line for each position) and .png; ten minutes on two cores, ``--quick`` six
scenes and no files.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import matplotlib
import numpy as np
import stability
from checks import RESULTS, Check, at_spread_positions, run, save, show

from slmm import Scene, failure_indices

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FIRST_SEED, SCENES, QUICK = 10_000, 110, 6
METHODS = ("slmm+ac", "dislocations", "auto")
COVERED, WIDE = 0.95, 10.0

Row = dict[str, object]


def with_irwin_length(scene: Scene, length: float) -> Scene:
    """The scene with another toughness, such that Irwin's length is as given, mm."""
    m = scene.material
    G_c = length * m.sigma_c**2 / m.plane_stress_equivalent[0]
    constants = {"E": m.E, "nu": m.nu, "sigma_c": m.sigma_c, "G_c": G_c, "state": m.state}
    return scene.with_(material=constants)


def notch_radius(scene: Scene) -> float | None:
    """Radius of the notch where the stress is highest, mm; None without tension anywhere."""
    result = failure_indices(scene, "rankine")
    FI = result.failure_index.values
    if not np.nanmax(FI, initial=0.0) > 0:
        return None
    i = int(np.nanargmax(FI))
    outline = scene.outlines[int(result.hole[i])]
    local = 1 / abs(float(outline.curvatures(float(result.arc_length[i]))))
    return min(local, 1.5 * outline.length / (2 * np.pi))


def examine(seed: int) -> list[Row]:
    """Errors and estimates at some positions of one random scene."""
    rng = np.random.default_rng([seed, 1])
    scene = stability.scene(np.random.default_rng(seed))
    radius = notch_radius(scene)
    if radius is None:
        return []
    share = float(np.exp(rng.uniform(np.log(0.02), 0.0)))
    scene = with_irwin_length(scene, share * radius)
    scene = at_spread_positions(scene, scene.analysis.positions)
    results = {method: failure_indices(scene, method) for method in METHODS}
    FI = results["dislocations"].failure_index.values
    positive = np.flatnonzero(FI > 0)
    if not len(positive):
        return []
    top = int(np.nanargmax(FI))
    others = rng.permutation(positive[positive != top])[:2]
    chosen = [top, *others.tolist()]
    at = results["dislocations"].isel(position=chosen)
    points = np.column_stack([at.x, at.y]).tolist()
    truth = failure_indices(scene.with_(analysis={"points": points}), "full-fea")
    rows: list[Row] = []
    for k, i in enumerate(chosen):
        true = float(truth.failure_index[k])
        own = float(truth.failure_index_error[k])
        if not true > 0:
            continue
        for method, result in results.items():
            value, estimate = (float(result[name][i]) for name in ("failure_index", "failure_index_error"))
            rows.append(
                {
                    "seed": seed,
                    "position": i,
                    "method": method,
                    "l_ch_over_radius": share,
                    "relative_index": FI[i] / FI[top],
                    "FI_full_FEA": true,
                    "FI": value,
                    "error": max(abs(value - true) - own, 0.0) / true,
                    "estimate": estimate / true,
                    "used_method": str(result.used_method.values[i]),
                    "status": str(result.status.values[i]),
                }
            )
    return rows


def gathered(seeds: range) -> list[Row]:
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1), get_context("spawn")) as pool:
        return [row for rows in pool.map(examine, seeds) for row in rows]


def judged(rows: list[Row]) -> list[Check]:
    checks = []
    for method in METHODS:
        mine = [row for row in rows if row["method"] == method]
        known = [row for row in mine if row["status"] == "ok" and np.isfinite(float(row["estimate"]))]
        error, estimate = (np.array([float(row[name]) for row in known]) for name in ("error", "estimate"))
        width = estimate / np.maximum(error, 1e-12)
        case = f"{method}, {len(known)} of {len(mine)} positions"
        checks += [
            Check(
                case,
                "errors above their estimate",
                1 - COVERED,
                float(np.mean(error > estimate)),
                rule="at most",
            ),
            Check(case, "estimate over error, median", WIDE, float(np.median(width)), rule="at most"),
            Check(case, "error, median", np.nan, float(np.median(error)), rule="told"),
            Check(case, "error, 95 % of all below", np.nan, float(np.quantile(error, 0.95)), rule="told"),
            Check(case, "estimate, median", np.nan, float(np.median(estimate)), rule="told"),
        ]
    tolerated = [
        row
        for row in rows
        if row["method"] == "auto"
        and float(row["estimate"]) * float(row["FI_full_FEA"]) <= 0.02 * float(row["FI"])
    ]
    worst = max((float(row["error"]) for row in tolerated), default=np.nan)
    checks.append(
        Check(
            f"auto, {len(tolerated)} positions within the tolerance",
            "largest error",
            0.02,
            worst,
            rule="told",
        )
    )
    return checks


def draw(rows: list[Row]) -> None:
    figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained", sharex=True, sharey=True)
    limits = np.array([1e-6, 1.0])
    for axis, method in zip(axes, METHODS, strict=True):
        mine = [row for row in rows if row["method"] == method and row["status"] == "ok"]
        estimate = np.array([float(row["estimate"]) for row in mine])
        error = np.maximum([float(row["error"]) for row in mine], limits[0])
        relative = [float(row["relative_index"]) for row in mine]
        dots = axis.scatter(estimate, error, c=relative, s=12, cmap="viridis", vmin=0, vmax=1)
        axis.fill_between(limits, limits, limits[1], color="0.92", zorder=0)
        axis.plot(limits, limits, color="0.35", lw=1)
        axis.plot(limits, limits / 10, color="0.35", lw=1, ls=":")
        axis.set(
            xscale="log",
            yscale="log",
            xlim=(1e-5, 1),
            ylim=limits,
            title=method,
            xlabel="estimated error of FI",
        )
    axes[0].set_ylabel("error of FI against full FEA")
    figure.colorbar(dots, ax=axes, label="FI over the scene's largest")
    figure.savefig(RESULTS / "estimates.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    rows = gathered(range(FIRST_SEED, FIRST_SEED + (QUICK if quick else SCENES)))
    checks = judged(rows)
    show("Estimated errors against true ones, random scenes", checks)
    if not quick:
        save("estimates", rows)
        draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
