"""Sweeps over a thousand loads and materials: what they cost beside single runs, and that each variant is its own run.

Ten loads, strengths and toughnesses each (strengths of 50 to 90 MPa, K_Ic of 0.8 to 1.6 MPa sqrt(m): Irwin's lengths
over 13), on a plate with a circular hole, a V-notch or an edge crack; on the hole also a decade of strengths and
toughnesses each (Irwin's lengths over 10^4), where every fourfold length is computed for itself, and the longest cracks
are longer than any cell: these variants have no value, which is told. Required:

- the CPU time of a thousand variants is at most three times that of one run at the longest Irwin's length, in the same
  process, and on the hole as a whole command;
- a sample of variants is the same as its own runs: to 1e-9 where the curves do not depend on the material, else within
  what both tell as their error.

Writes validation/results/sweeps.csv; four minutes, ``--quick`` a quarter of a minute for the hole alone, without
commands and files.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
import xarray as xr
from checks import Check, run, save, show

from slmm import Scene, failure_indices, read_scene
from slmm.scene.variants import Variants, variants_of

EXAMPLES = Path(__file__).parents[1] / "examples"
MATERIALS = {"material.sigma_c": "50:90:10", "material.K_Ic": "0.8:1.6:10"}
DECADES = {"material.sigma_c": "20:200:10:log", "material.K_Ic": "0.3:3:10:log"}
#: single runs that a sweep may take, and the difference where curves are the same
SINGLE_RUNS, EXACT = 3.0, 1e-9
SAMPLE = 4


class Case(NamedTuple):
    """A scene, a method, and what is varied."""

    name: str
    file: str
    method: str
    load: tuple[str, str]
    materials: Mapping[str, str] = MATERIALS
    exact: bool = False
    repeats: int = 3

    @property
    def vary(self) -> dict[str, str]:
        """All keys with their values."""
        return dict([self.load]) | dict(self.materials)


STRAIN = ("load.strain", "0.001:0.1:10")
CASES = (
    Case("hole", "circle.toml", "auto", STRAIN),
    Case("hole", "circle.toml", "slmm+ac", STRAIN, exact=True),
    Case("hole", "circle.toml", "point", STRAIN),
    Case("hole", "circle.toml", "line", STRAIN),
    Case("V-notch", "v_notch.toml", "auto", ("load.stress", "1:10:10"), repeats=1),
    Case("edge crack", "edge_crack.toml", "auto", ("load.stress", "1:10:10")),
    Case("hole, decades", "circle.toml", "auto", STRAIN, DECADES, repeats=1),
    Case("hole, decades", "circle.toml", "slmm+ac", STRAIN, DECADES, exact=True),
)


def variant(variants: Variants, k: int) -> Scene:
    """The scene of one variant."""
    table = variants.made_of[variants.material[k]].material_table
    return variants.loaded[variants.load[k]].with_(material=table.model_dump(exclude_none=True))


def clocked(work: Callable[[], xr.Dataset], repeats: int) -> tuple[xr.Dataset, float]:
    """What a call gives, and its median CPU time, s; after a first one where there are several."""
    times = []
    for _ in range(repeats if repeats == 1 else repeats + 1):
        began = time.process_time()
        found = work()
        times.append(time.process_time() - began)
    return found, median(times[-repeats:])


def in_one_process(case: Case) -> list[Check]:
    """CPU time of the sweep over that of a single run, and the largest difference of a sample."""
    scene = read_scene(EXAMPLES / case.file)
    variants = variants_of(scene, case.vary)
    lengths = [one.material.irwin_length for one in variants.made_of]
    toughest = variant(variants, int(np.flatnonzero(variants.material == np.argmax(lengths))[-1]))
    _, single = clocked(lambda: failure_indices(toughest, case.method), case.repeats)
    result, swept = clocked(lambda: failure_indices(scene, case.method, vary=case.vary), case.repeats)
    rows = np.random.default_rng(0).choice(len(variants.load), SAMPLE, replace=False)
    name = f"{case.name}, {case.method}"
    count = len(variants.load)
    # cracks that are longer than any cell have none by cells
    without = "told" if case.exact and case.materials is DECADES else "at most"
    checks = [
        Check(
            name, f"CPU time of {count} variants over one run", SINGLE_RUNS, swept / single, rule="at most"
        ),
        Check(name, "CPU time of one run, s", float("nan"), single, rule="told"),
        Check(name, "variants without a value", 0.0, float((result.status != "ok").sum()), rule=without),
    ]
    away, told = differences(case, variants, result, rows)
    if case.exact:
        checks.append(Check(name, "largest difference from its own run", EXACT, away.max(), rule="at most"))
    else:
        checks.append(Check(name, "difference over what is told", 1.0, (away / told).max(), rule="at most"))
        checks.append(
            Check(name, "largest difference from its own run", float("nan"), away.max(), rule="told")
        )
    return checks


def differences(
    case: Case, variants: Variants, result: xr.Dataset, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Relative differences of some variants from their own runs, and the sums of the errors told, both (k,)."""
    away, told = [], []
    for k in rows:
        own = failure_indices(variant(variants, int(k)), case.method)
        worst = own.isel(position=int(np.nanargmax(own.failure_index)))
        ours = float(result.failure_index.values.ravel()[k])
        index = float(worst.failure_index)
        away.append(abs(ours / index - 1))
        error = float(worst.failure_index_error) + float(result.failure_index_error.values.ravel()[k])
        told.append(error / index)
    return np.array(away), np.array(told)


def as_commands(case: Case) -> Check:
    """CPU time of the whole command over that of the command for one run."""
    with tempfile.TemporaryDirectory() as folder:
        common = ["initiation", str(EXAMPLES / case.file), "--method", case.method, "-o", f"{folder}/out.nc"]
        vary = [word for key, values in case.vary.items() for word in ("--vary", f"{key}={values}")]
        single, swept = (median(_command([*common, *more]) for _ in range(3)) for more in ([], vary))
    name = f"{case.name}, {case.method}"
    return Check(name, "CPU time of the command over one run's", SINGLE_RUNS, swept / single, rule="at most")


def _command(arguments: list[str]) -> float:
    """CPU time of a command, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = "from slmm.command.cli import app; app()"
    subprocess.run([sys.executable, "-c", start, *arguments], check=False, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(quick: bool = False) -> list[Check]:
    """All cases; the checks."""
    checks = []
    for case in CASES[:2] if quick else CASES:
        found = in_one_process(case)
        if not quick and case.load == STRAIN:
            found.append(as_commands(case))
        show("Sweeps over loads and materials", found)
        checks += found
    if not quick:
        save("sweeps", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
