"""Speed of the meta-model: 50 positions after the local model, and the start of the command line.

Required: at most 1 ms for each position (placement, fit, superposition, both criteria), and a second start of the main
job, ``slmm initiation examples/notch.toml``, here also with its file and picture, in under 5 s. The best of several
runs counts. On a machine that others keep busy (load above 1) wall times are told without a verdict; the CPU time of
all threads, which is no less than the wall time of an idle machine, is held to the same limits. A whole process of
a circle takes at most 12 times the CPU time of ``import numpy``, by SLMM+AC and by the default method, taken by turns:
the median of the ratios. Python keeps its modules compiled there, as it does where the package has been installed.

Writes validation/results/speed.csv and .png; half a minute, ``--quick`` 20 s and no files.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm.criteria.coupled_curves import criticals
from slmm.initiation.cells import cell_curves, place_cells, select_modes
from slmm.initiation.local_model import solve_local_model
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

EXAMPLES = Path(__file__).parents[1] / "examples"
MILLISECONDS, SECONDS = 1.0, 5.0
#: starts of a circle by method, as multiples of ``import numpy``
STARTS = {"slmm+ac": 12.0, "auto": 12.0}
SLMM = Path(sys.executable).parent / "slmm"
#: load of the machine above which wall times are not judged
BUSY = 1.0


def per_position(counts: tuple[int, ...], repeats: int) -> list[dict[str, float]]:
    """Best wall and CPU time for each position in ms, over numbers of positions."""
    scene = gallery.circular_hole()
    outline, material = scene.outlines[0], scene.material
    _, nu = material.plane_stress_equivalent
    meta = select_modes(load_meta_model(nu), DEFAULT.modes)
    local = solve_local_model(scene, 250_000)
    rows = []
    for n in counts:
        s = find_positions(scene, n).s
        wall, cpu = [], []
        for _ in range(repeats):
            w, c = time.perf_counter(), time.process_time()
            placed = place_cells(scene, outline, s, local, meta, DEFAULT, DEFAULT.fine)
            curves, _, _ = cell_curves(scene, outline, placed, meta, DEFAULT, True)
            criticals(curves, material, average=False)
            wall.append(time.perf_counter() - w)
            cpu.append(time.process_time() - c)
        # the first run compiles or loads the kernels
        rows.append({"positions": n, "wall_ms": 1e3 * min(wall[1:]) / n, "cpu_ms": 1e3 * min(cpu[1:]) / n})
    return rows


def second_start(repeats: int) -> tuple[float, float]:
    """Best wall and CPU time of the main job in its own process, after one that fills the caches, s."""
    wall, cpu = [], []
    with tempfile.TemporaryDirectory() as folder:
        command = [SLMM, "initiation", EXAMPLES / "notch.toml"]
        command += ["-o", f"{folder}/notch.nc", "--plot", f"{folder}/notch.png"]
        for _ in range(repeats + 1):
            w = time.perf_counter()
            cpu.append(cpu_time(command))
            wall.append(time.perf_counter() - w)
    return min(wall[1:]), min(cpu[1:])


def cpu_time(command: Sequence[str | Path]) -> float:
    """CPU time of all threads of a process, s."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def starts_over_numpy(repeats: int) -> dict[str, float]:
    """CPU time of a circle in its own process over that of ``import numpy``, by method."""
    of_numpy = [sys.executable, "-c", "import numpy"]
    ratios: dict[str, list[float]] = {method: [] for method in STARTS}
    for _ in range(repeats + 1):
        numpy_takes = cpu_time(of_numpy)
        for method, ratio in ratios.items():
            command = [SLMM, "initiation", EXAMPLES / "circle.toml", "--method", method]
            ratio.append(cpu_time(command) / numpy_takes)
    # the first start may compile
    return {method: float(np.median(ratio[1:])) for method, ratio in ratios.items()}


def draw(rows: list[dict[str, float]]) -> None:
    figure, axis = plt.subplots(figsize=(5, 3.5), layout="constrained")
    n = [row["positions"] for row in rows]
    axis.loglog(n, [row["wall_ms"] for row in rows], "o-", mfc="none", label="wall")
    axis.loglog(n, [row["cpu_ms"] for row in rows], "s--", mfc="none", label="CPU")
    axis.axhline(MILLISECONDS, color="0.5", lw=0.8)
    axis.set(xlabel="positions", ylabel="ms per position")
    axis.legend(frameon=False)
    figure.savefig(RESULTS / "speed.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    load = os.getloadavg()[0]  # before our own work counts
    rows = per_position((50,) if quick else (1, 5, 20, 50, 100, 200), 10 if quick else 40)
    fifty = next(row for row in rows if row["positions"] == 50)
    wall, cpu = second_start(1 if quick else 4)
    starts = starts_over_numpy(1 if quick else 9)
    by_wall = "at most" if load < BUSY else "told"
    checks = [
        Check("50 positions, circular hole", "wall ms each", MILLISECONDS, fifty["wall_ms"], rule=by_wall),
        Check("50 positions, circular hole", "CPU ms each", MILLISECONDS, fifty["cpu_ms"], rule="at most"),
        Check("second start of the main job", "wall s", SECONDS, wall, rule=by_wall),
        Check("second start of the main job", "CPU s", SECONDS, cpu, rule="at most"),
        *(
            Check(
                f"start of a circle, {method}", "CPU over import numpy", STARTS[method], ratio, rule="at most"
            )
            for method, ratio in starts.items()
        ),
    ]
    show(f"Speed, {os.cpu_count()} cores, load of the machine {load:.1f}", checks)
    if not quick:
        save("speed", [check.row() | {"machine_load": load} for check in checks])
        save("speed_positions", [{k: float(np.round(v, 4)) for k, v in row.items()} for row in rows])
        draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
