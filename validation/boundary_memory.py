"""Memory of a whole process that reads a scene and tells K of an edge crack in a plate with three holes.

What it has taken at most after each step, in a process of its own with compiled kernels at hand, on Linux: the package
with the scene, numba's first kernel, the answer; and in another process, libraries one after the other. Half of it are
pages of libraries' files, which processes share and the system may drop; what is the process's own is read 500 times a
second.

Required: less than 200 MB in all; what is its own is told. Writes validation/results/boundary_memory.csv, ten seconds;
``--quick`` no file.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from checks import Check

SCENE = """
[plate]
width = 100.0
height = 100.0
[[holes]]
shape = "circle"
center = [28.0, 44.0]
radius = 6.0
[[holes]]
shape = "circle"
center = [46.0, 30.0]
radius = 5.0
[[holes]]
shape = "circle"
center = [70.0, 60.0]
radius = 7.0
[[cracks]]
points = [[0.0, 50.0], [15.0, 50.0]]
[material]
name = "PMMA"
[load]
displacement = 0.1
"""
MOST = 200.0
#: s between two looks at the memory
READ_EVERY = 0.002
#: what the package is built on and loads for this, in its order
LIBRARIES = ("pydantic", "numpy", "shapely", "scipy.linalg", "numba")


def taken() -> float:
    """Largest memory of this process so far, MB; ru_maxrss would start from that of the parent process."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    raise OSError("/proc/self/status has no VmHWM: peak memory is measured on Linux only")


def measure_libraries() -> None:
    """Print what has been taken after each of them."""
    steps = {"python": taken()}
    for name in LIBRARIES:
        importlib.import_module(name)
        steps[name] = taken()
    print(json.dumps(steps))


def measure(path: str) -> None:
    """Print K and what has been taken after each step."""
    import numpy as np

    from slmm import read_scene
    from slmm.boundary.linear import real_matrix
    from slmm.boundary.model import BoundaryModel

    scene = read_scene(path)
    steps = {"slmm and the scene": taken()}
    real_matrix(*np.zeros((2, 1, 1), dtype=complex))
    steps["the first kernel"] = taken()
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    K = model.stress_intensities()[0]
    steps["the answer"] = taken()
    print(json.dumps({"K": K.tolist(), "points": model.panels.n, "steps": steps}))


def watched(command: list[str], environment: dict[str, str]) -> tuple[str, float]:
    """What a process prints, and how much memory was its own at most, MB: resident pages that are of no file."""
    page, own = os.sysconf("SC_PAGE_SIZE") / 1024**2, 0
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        pages = Path(f"/proc/{process.pid}/statm")
        while process.poll() is None:
            _, resident, of_files, *_ = (int(number) for number in pages.read_text().split())
            own = max(own, resident - of_files)
            time.sleep(READ_EVERY)
        assert process.stdout is not None
        printed = process.stdout.read()
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command, printed)
    return printed, own * page


def main(quick: bool = False) -> list[Check]:
    """Measure in processes of their own; of two that answer the second one: the first compiles the kernels."""
    from checks import Check, save, show

    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "three_holes.toml"
        path.write_text(SCENE)
        libraries, _ = watched([sys.executable, __file__, "--libraries"], environment)
        for _ in range(2):
            answer, own = watched([sys.executable, __file__, "--measure", str(path)], environment)
    found = json.loads(answer.splitlines()[-1])
    case = f"plate with three holes and a crack, {found['points']} points"
    checks = [
        Check(case, f"MB with {name}", float("nan"), most, rule="told")
        for name, most in (json.loads(libraries) | found["steps"]).items()
    ]
    checks.append(Check(case, "MB of the process's own, at most", float("nan"), own, rule="told"))
    checks.append(Check(case, "MB of the whole process", MOST, found["steps"]["the answer"], rule="at most"))
    show("Memory of a process", checks)
    if not quick:
        save("boundary_memory", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure(sys.argv[2])
    elif sys.argv[1:] == ["--libraries"]:
        measure_libraries()
    else:
        from checks import run

        run(main, __doc__)
