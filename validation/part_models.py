"""Local models on the example parts: stress along all surfaces by boundary integrals, body-fitted meshes and voxels.

Each scene of examples/parts three times, by the strength criterion at the surface, where a crack could start. Estimated
errors have to cover what sets the models apart: at most 5 % of the positions of any two may lie farther apart than both
estimates and 0.3 % of the part's largest index, which stands for supports and loads that are shorter than an element.

Writes validation/results/part_models.csv, some minutes; ``--quick`` takes two parts and writes nothing.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from pathlib import Path
from time import process_time

import numpy as np
import xarray as xr
from checks import Check, run, save, show

from slmm import failure_indices, read_scene

PARTS = sorted((Path(__file__).parents[1] / "examples" / "parts").glob("*.toml"))
QUICK = ("lug", "shouldered_bar")
MODELS = ("boundary", "body-fitted", "voxels")
POSITIONS = 24
#: share of the largest index below which differences do not count
FLOOR = 3e-3
#: positions beyond the estimates, at most
ALLOWED = 0.05


def places(result: xr.Dataset) -> dict[tuple[int, float, float], int]:
    """Where the positions are that have a value: models may have asked for more between the common ones."""
    return {
        (int(hole), round(float(x), 6), round(float(y), 6)): k
        for k, (hole, x, y, FI) in enumerate(
            zip(
                result.hole.values, result.x.values, result.y.values, result.failure_index.values, strict=True
            )
        )
        if np.isfinite(FI)
    }


def compared(one: xr.Dataset, other: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """How far two results are apart (k,), and what both estimate (k,), over the largest index."""
    here, there = places(one), places(other)
    common = [place for place in here if place in there]
    a, b = (result.isel(position=[at[p] for p in common]) for result, at in ((one, here), (other, there)))
    largest = float(np.nanmax(one.failure_index))
    apart = np.abs(a.failure_index.values - b.failure_index.values)
    return apart / largest, (a.failure_index_error.values + b.failure_index_error.values) / largest


def part(path: Path) -> list[Check]:
    """All pairs of models on one part."""
    scene, results, seconds = read_scene(path), {}, {}
    for model in MODELS:
        began = process_time()
        results[model] = failure_indices(
            scene.with_(analysis={"local_model": model}), "rankine", positions=POSITIONS
        )
        seconds[model] = process_time() - began
    checks = []
    for one, other in (("boundary", "voxels"), ("boundary", "body-fitted"), ("body-fitted", "voxels")):
        apart, told = compared(results[one], results[other])
        case = f"{path.stem}, {one} and {other}"
        beyond = float((apart > told + FLOOR).mean())
        checks += [
            Check(case, f"beyond the estimates, of {len(apart)}", ALLOWED, beyond, rule="at most"),
            Check(case, "apart, median", float(np.median(told)), float(np.median(apart)), rule="told"),
            Check(case, "apart, largest", float(told[apart.argmax()]), float(apart.max()), rule="told"),
        ]
    checks.append(
        Check(path.stem, "CPU seconds, voxels; boundary", seconds["boundary"], seconds["voxels"], rule="told")
    )
    return checks


def main(quick: bool = False) -> list[Check]:
    paths = [path for path in PARTS if not quick or path.stem in QUICK]
    checks = [check for path in paths for check in part(path)]
    show("Local models on the example parts", checks)
    if not quick:
        save("part_models", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
