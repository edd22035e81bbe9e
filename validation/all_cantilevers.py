"""Paper C, Fig. 7 and 8: all valid designs of the 8 x 5 cantilever, and the exact optimum of the 9 x 5 one.

Required: the published number of valid designs and the best value; all of them in less than 30 s on one core after
compilation (the paper: 10 h on four); each of 1000 random ones within 1e-9 of a sparse direct solve of all its nodes.
Writes validation/results/all_cantilevers.csv and .png, 8 minutes with 9 x 5; ``--quick`` takes the 6 x 5 grid alone.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.brute_force import brute_force
from slmm.optimization.cantilever.exhaustive import all_designs, count_valid, design_of

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from slmm.pictures.optimization import draw_design

#: bins of the endpoint displacement, mm
BINS = np.linspace(-0.02, 0.8, 165)
#: what one core is asked for, in a process of its own: the first grid compiles, the second is timed
ONE_CORE = """
import time
from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.exhaustive import all_designs
sum(b.value.size for b in all_designs(Cantilever(6, 5)))
start = time.process_time(), time.perf_counter()
n = sum(b.value.size for b in all_designs(Cantilever(8, 5)))
print(n, time.process_time() - start[0], time.perf_counter() - start[1])
"""


def values_agree(beam: Cantilever, n: int, seed: int = 0) -> Check:
    """Random valid designs by halves against direct solves."""
    total = count_valid(beam)
    chosen = np.sort(np.random.default_rng(seed).choice(total, n, replace=False))
    worst, before = 0.0, 0
    for block in all_designs(beam):
        here = (
            chosen[np.searchsorted(chosen, before) : np.searchsorted(chosen, before + block.value.size)]
            - before
        )
        for k in here:
            direct = beam.solved_directly(design_of(beam, block.code.flat[k]))
            worst = max(worst, abs(block.value.flat[k] / direct - 1))
        before += block.value.size
    case = f"{beam.columns} x {beam.rows}"
    return Check(
        case,
        f"largest relative difference, {n} designs",
        1e-9,
        worst,
        rule="at most",
        source="sparse LU",
    )


def histogram(beam: Cantilever) -> tuple[np.ndarray, dict[str, int]]:
    """Number of designs by cells and endpoint displacement, and the codes of the four designs of Fig. 8."""
    fixed = int(beam.fixed.sum())
    free = (beam.columns - 1) * (beam.rows - 1)
    counts = np.zeros((free + 1, len(BINS) - 1), dtype=np.int64)
    extremes = {"best": (np.inf, 0), "worst": (-np.inf, 0)}
    for block in all_designs(beam):
        cells = np.bitwise_count(block.code).astype(int)
        place = np.clip(np.searchsorted(BINS, block.value, side="right") - 1, 0, len(BINS) - 2)
        counts += np.bincount((cells * (len(BINS) - 1) + place).ravel(), minlength=counts.size).reshape(
            counts.shape
        )
        for name, at in (("best", block.value.argmin()), ("worst", block.value.argmax())):
            value = block.value.flat[at]
            if (value < extremes[name][0]) == (name == "best"):
                extremes[name] = value, int(block.code.flat[at])
    assert counts.sum() == count_valid(beam)
    return counts, {
        "a: best": extremes["best"][1],
        "b: worst": extremes["worst"][1],
        f"c: lightest, {fixed} cells": 0,
        f"d: heaviest, {fixed + free} cells": 2**free - 1,
    }


def draw(beam: Cantilever, counts: np.ndarray, codes: dict[str, int]) -> None:
    figure = plt.figure(figsize=(13, 7), layout="constrained")
    axes = figure.subplot_mosaic([["h", "h", "a", "b"], ["h", "h", "c", "d"]])
    fixed = int(beam.fixed.sum())
    shown = np.where(counts > 0, counts, np.nan)
    picture = axes["h"].pcolormesh(
        np.arange(fixed, fixed + len(counts) + 1) - 0.5,
        BINS,
        shown.T,
        norm=matplotlib.colors.LogNorm(),
        cmap="viridis",
    )
    axes["h"].set(xlabel="cells", ylabel="endpoint displacement in mm", ylim=(-0.02, 0.6))
    figure.colorbar(picture, ax=axes["h"], label="designs")
    for name, code in codes.items():
        design = design_of(beam, np.array(code))
        draw_design(axes[name[0]], beam, design)
        (u,) = beam.endpoint_displacement(design[None])
        axes[name[0]].set_title(f"{name}: u = {u:.4g} mm", fontsize=10)
    figure.savefig(RESULTS / "all_cantilevers.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    if quick:
        beam = Cantilever(6, 5)
        found = brute_force(beam, best=10)
        direct = beam.solved_directly(found.best_design.values)
        best = float(found.endpoint_displacement[0])
        checks = [
            values_agree(beam, 100),
            Check("6 x 5", "best value against a direct solve, mm", direct, best, 1e-9, source="sparse LU"),
        ]
        show("All cantilevers of a grid", checks)
        return checks
    beam = Cantilever(8, 5)
    counts, codes = histogram(beam)
    best = design_of(beam, np.array(codes["a: best"]))
    checks = [
        Check("8 x 5", "valid designs", 59_554_032, float(counts.sum()), 1e-12, source="Paper C"),
        Check(
            "8 x 5",
            "best value, mm",
            -0.00986,
            beam.endpoint_displacement(best[None])[0],
            1e-3,
            source="Paper C",
        ),
        values_agree(beam, 1000),
    ]
    one = subprocess.run(
        [sys.executable, "-c", ONE_CORE],
        env={**os.environ, "NUMBA_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    _, cpu, wall = (float(x) for x in one.stdout.split())
    checks.append(
        Check(
            "8 x 5, one core",
            f"CPU s ({wall:.0f} s on the clock)",
            30.0,
            cpu,
            rule="at most",
            source="required",
        )
    )
    start = time.perf_counter()
    larger = Cantilever(9, 5)
    found = brute_force(larger, best=1000)
    seconds = time.perf_counter() - start
    checks += [
        Check("9 x 5", "valid designs", 776_083_856, float(found.n_valid), 1e-12, source="design.md"),
        Check("9 x 5", "best value against a direct solve, mm", larger.solved_directly(found.best_design.values),
              float(found.endpoint_displacement[0]), 1e-9, source="sparse LU"),
        Check("9 x 5", "minutes, all cores", 10.0, seconds / 60, rule="at most", source="minutes"),
    ]  # fmt: skip
    show("All cantilevers of a grid", checks)
    save("all_cantilevers", [check.row() for check in checks])
    draw(beam, counts, codes)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
