"""Neighbours of designs on the 48 x 16 cantilever by a few unknowns, against a sparse solve for each, in the same run.

The whole neighbourhood of TBFSL(4, 2), some 6000 valid designs, of random designs and of two that a search comes by:
required are 200 times the speed of a fresh sparse solve, the model's making included, and no neighbour off by more than
1e-4. Of designs made to be floppy the same is told: a coil that hangs on one cell, and mazes, in which single cells
hold much. For all of them it is required that no neighbour is off by more than the model says of it, since a search
takes its word for what is worse; how many it would evaluate in vain, as they might be better, is told.
Writes validation/results/neighbourhood.csv, three minutes; ``--quick`` takes one design of each kind on 16 x 8.
"""

from __future__ import annotations

import time

import numpy as np
from checks import Check, run, save, show

from slmm.optimization.algorithms.breadth_first import flips_within
from slmm.optimization.ask import Flipped
from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.neighbourhood_model import NeighbourhoodModel
from slmm.optimization.search import search


def neighbours(beam: Cantilever, design: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Flips (n, k) and designs (n, rows, columns) of the valid neighbours, for k of 1 to 4."""
    levels, valid = [], []
    for k in (1, 2, 3, 4):
        flips = flips_within(~beam.fixed, k, 2)
        designs = Flipped(design, flips)[:]
        there = beam.valid(designs)
        levels.append(flips[there])
        valid.append(designs[there])
    return levels, valid


def compared(beam: Cantilever, name: str, design: np.ndarray, required: bool) -> list[Check]:
    levels, valid = neighbours(beam, design)
    designs = np.concatenate(valid)
    NeighbourhoodModel(beam, design).evaluate(levels[0])  # compiles
    seconds, again, fresh = [], [], []
    for _ in range(3):
        start = time.perf_counter()
        model = NeighbourhoodModel(beam, design)
        values, errors = np.concatenate([model.evaluate(flips) for flips in levels], axis=1)
        seconds.append(time.perf_counter() - start)
        start = time.perf_counter()
        for flips in levels:
            model.evaluate(flips)
        again.append(time.perf_counter() - start)
        start = time.perf_counter()
        for one in designs[::500][:10]:
            beam.solved_directly(one)
        fresh.append((time.perf_counter() - start) / len(designs[::500][:10]))
    each, later, direct = min(seconds) / len(designs), min(again) / len(designs), min(fresh)
    some = np.random.default_rng(0).choice(len(designs), min(1000, len(designs)), replace=False)
    exact = beam.endpoint_displacement(designs[some])
    off = np.abs(values[some] - exact)
    # what a search would evaluate that looks for less than the centre, and need not
    in_vain = ~(values - errors > model.sag) & ~(values < model.sag)
    case = f"{beam.columns} x {beam.rows}, {name}, {len(designs)} neighbours"
    rule = "at most" if required else "told"
    return [
        Check(case, "time over a sparse solve's", 1 / 200, each / direct, rule=rule, source="required"),
        Check(case, f"the same, model made ({1e6 * later:.0f} us, {1e3 * direct:.1f} ms)", 1 / 200, later / direct,
              rule="told"),
        Check(case, "largest relative error of 1000", 1e-4, float(np.nanmax(off / np.abs(exact))), rule=rule,
              source="direct"),
        Check(case, "largest error over what the model says", 1.0, float(np.nanmax(off / errors[some])), rule="at most",
              source="direct"),
        Check(case, "share evaluated in vain", 0.0, float(in_vain.mean()), rule="told"),
    ]  # fmt: skip


def coil(beam: Cantilever) -> np.ndarray:
    """One cell wide, up and down, from under the corner back to the left edge."""
    design = beam.fixed.copy()
    last, bottom = beam.columns - 1, beam.rows - 1
    design[1, last] = design[2:, last:1:-2] = True
    design[bottom, last - 1 : 2 : -4] = design[2, last - 3 : 2 : -4] = True
    return beam.repaired(design)


def maze(beam: Cantilever, rng: np.random.Generator) -> np.ndarray:
    """Paths that hardly meet: single cells hold much."""
    design = beam.fixed.copy()
    for _ in range(10):
        for i, j in rng.permutation(np.argwhere(~beam.fixed)):
            beside = np.pad(design, 1).astype(int)
            if beside[i, j + 1] + beside[i + 2, j + 1] + beside[i + 1, j] + beside[i + 1, j + 2] == 1:
                design[i, j] = True
    return design


def main(quick: bool = False) -> list[Check]:
    beam = Cantilever(16, 8) if quick else Cantilever(48, 16)
    rng = np.random.default_rng(1)
    checks = []
    for share in [0.6] if quick else [0.5, 0.6, 0.8]:
        design = beam.repaired(beam.fixed | (rng.random(beam.shape) < share))
        checks += compared(beam, f"random, {share:g} full", design, not quick)
    for most in [300] if quick else [3000, 100_000]:
        found = search(beam, "tbfsl", seed=0, max_simulations=most)
        checks += compared(beam, f"searched to {found.value:.3g} mm", found.best_design, not quick)
    checks += compared(beam, "a coil", coil(beam), False)
    checks += compared(beam, "a maze", maze(beam, rng), False)
    checks += compared(
        Cantilever(beam.rows, beam.columns), "a maze", maze(Cantilever(beam.rows, beam.columns), rng), False
    )
    show("Neighbours of a design", checks)
    if not quick:
        save("neighbourhood", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
