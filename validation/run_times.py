"""Run times of Paper A, section 3.2, and what the fast ways of this package save.

Beside the paper's seconds (4 cores of an i5-6500; told, the machines differ): the table of one material, the local
model with 10^6 voxels, one position by SLMM+AC and by full FEA, 50 positions by both. Ours: circular hole of Fig. 13,
PMMA; full FEA of all 50 positions (*) is extrapolated from a few.

Required, by the CPU time of the same run on the same machine:

- full FEA of one position with 25 crack lengths takes at most a tenth of one solve for each length at the same
  accuracy: the same three meshes and stresses, and for each of the 26 states of the crack a factorisation by SuperLU
  with its best ordering for symmetric matrices (MMD_AT_PLUS_A, SymmetricMode, no pivoting), a solve and the potential
  energy. Told beside it: the same solves in the ordering of METIS, which this package uses and scipy does not have.
- dislocations at 50 positions take at most a tenth of full FEA there.

Writes validation/results/run_times.csv (checks), _levels.csv and .png; three minutes, ``--quick`` half a minute, two of
the three meshes and no files.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import scipy.sparse as sp
from checks import RESULTS, Check, run, save, show
from matplotlib.ticker import NullFormatter
from scipy.sparse.linalg import SuperLU, splu
from speed import per_position

from precompute.spec import PUBLISHED_CURVATURES, SweepSpec
from precompute.sweep import run_sweep
from slmm import Scene, failure_indices
from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import PlateMesh, plate_mesh
from slmm.fem.plate_model import PlateModel, SlitModel
from slmm.fem.sparse_factor import factorised, nested_dissection
from slmm.initiation.by_full_fea import LENGTHS, SPAN
from slmm.initiation.full_fea import LEVELS, nodes_per_length, path_depths
from slmm.initiation.local_model import solve_local_model
from slmm.initiation.paths import trial_paths
from slmm.initiation.positions import find_positions
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

POSITIONS, VOXELS = 50, 1_000_000
#: of the time of the slow way, at most
SHARE = 0.1
#: difference of the released energies over that of the longest crack, at most: the slow way subtracts energies of
#: the whole plate, up to 2e7 times as large as what a short crack releases, and loses the digits of those
AGREEMENT = 1e-9
SOURCE = "Paper A, 3.2"
#: angles of the positions that stand for all 50 in full FEA, degrees
SOME = (0.0, 30.0, 60.0, 90.0)

Factorise = Callable[[sp.csr_array, np.ndarray], tuple[SuperLU, np.ndarray]]


@dataclass(frozen=True)
class Seconds:
    """Time of one piece of work."""

    wall: float
    cpu: float


def clocked(work: Callable[[], Any], repeats: int = 1) -> tuple[Any, Seconds]:
    """Result and the best of some times."""
    times = []
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        result = work()
        times.append((time.perf_counter() - wall, time.process_time() - cpu))
    return result, Seconds(min(t[0] for t in times), min(t[1] for t in times))


def by_superlu(K: sp.csr_array, free: np.ndarray) -> tuple[SuperLU, np.ndarray]:
    """Factor of the free unknowns, ordered by SuperLU, and the unknowns in the factor's order."""
    matrix = K[free][:, free].tocsc()
    factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return factor, free


def by_metis(K: sp.csr_array, free: np.ndarray) -> tuple[SuperLU, np.ndarray]:
    """The same, ordered by nested dissection."""
    order = free[nested_dissection(K, free)]
    return factorised(K, order), order


class OneSolvePerLength(PlateModel):
    """A plate model that is factorised and solved for each of some cracks along its path.

    Attributes
    ----------
    released : ndarray (n,)
        Potential energy without a crack less that with each of the cracks, per thickness, N.
    """

    def __init__(self, mesh: PlateMesh, scene: Scene, tips: np.ndarray, factorise: Factorise) -> None:
        """Solve for cracks whose tips are the path's vertices ``tips`` (n,), and without one."""
        self._tips, self._factorise = tips, factorise
        super().__init__(mesh, scene.material, scene.loading)

    def _solve(self, force: np.ndarray, value: np.ndarray, jump: np.ndarray) -> None:
        closed = np.setdiff1d(np.flatnonzero(~self.load.prescribed.ravel()), jump)
        potential = []
        for tip in [*self._tips[::-1], 0]:  # without a crack last: that state is the model's displacements
            # corners and midsides before the tip, two components each
            free = np.union1d(closed, jump[: 4 * tip])
            value[free] = value[jump] = 0.0
            factor, order = self._factorise(self.K, free)
            value[order] = factor.solve((force - self.K @ value)[order])
            potential.append(0.5 * value @ (self.K @ value) - force @ value)
        self.released = potential[-1] - np.array(potential[-2::-1])


@dataclass(frozen=True)
class TrialPath:
    """The path of a position and the crack lengths on it."""

    scene: Scene
    start: np.ndarray
    direction: np.ndarray
    a: np.ndarray

    @classmethod
    def at_the_critical_position(cls) -> TrialPath:
        """At the hole of Fig. 13."""
        scene = hole(np.zeros(1))
        paths = trial_paths(scene, find_positions(scene))
        a = np.geomspace(1 / SPAN, 1.0, LENGTHS) * float(paths.longest[0])
        return cls(scene, paths.start[0], paths.direction[0], a)

    def meshes(self, levels: int) -> Iterator[tuple[PlateMesh, np.ndarray]]:
        """The meshes of full FEA, and which vertices of the path the cracks end at."""
        depth, plate = path_depths(self.a), self.scene.plate
        path = self.start + depth[:, None] * self.direction
        size = min(plate.width, plate.height) / 8
        mesh = plate_mesh(self.scene.part, path, SizePolicy(size, 0.25))
        tips = len(depth) - 1 - nodes_per_length(self.a) * np.arange(LENGTHS)[::-1]
        for level in range(levels):
            yield mesh, tips * 2**level
            mesh = mesh.refined()

    def stress(self, model: PlateModel) -> np.ndarray:
        """Stress of a model along the path."""
        return model.stress(self.start + self.a[:, None] * self.direction)


def hole(degrees: np.ndarray) -> Scene:
    angle = np.radians(degrees)
    points = 50 + 20 * np.column_stack([np.cos(angle), np.sin(angle)])
    return gallery.circular_hole(analysis={"points": points.tolist()})


def one_factorisation(mesh: PlateMesh, path: TrialPath, tips: np.ndarray) -> np.ndarray:
    model = SlitModel(mesh, path.scene.material, path.scene.loading)
    path.stress(model)
    return model.released_energy()[tips]


def one_for_each(mesh: PlateMesh, path: TrialPath, tips: np.ndarray, factorise: Factorise) -> np.ndarray:
    model = OneSolvePerLength(mesh, path.scene, tips, factorise)
    path.stress(model)
    return model.released


def lengths_compared(levels: int, repeats: int, with_metis: bool) -> list[dict[str, float]]:
    """Times and energies of both ways on each mesh, and of the meshing."""
    path = TrialPath.at_the_critical_position()
    rows = []
    for level, (mesh, tips) in enumerate(path.meshes(levels)):
        W, ours = clocked(lambda m=mesh, t=tips: one_factorisation(m, path, t), repeats)
        naive_W, naive = clocked(lambda m=mesh, t=tips: one_for_each(m, path, t, by_superlu))
        row = {
            "level": level,
            "nodes": float(len(mesh.vertices)),
            "ours_cpu": ours.cpu,
            "ours_wall": ours.wall,
            "each_cpu": naive.cpu,
            "each_wall": naive.wall,
            "difference": float(np.abs(naive_W - W).max() / W[-1]),
        }
        if with_metis:
            _, metis = clocked(lambda m=mesh, t=tips: one_for_each(m, path, t, by_metis))
            row["each_metis_cpu"] = metis.cpu
        rows.append(row)
    return rows


def meshing(levels: int, repeats: int) -> Seconds:
    path = TrialPath.at_the_critical_position()
    return clocked(lambda: list(path.meshes(levels)), repeats)[1]


def many_lengths(quick: bool) -> tuple[list[Check], list[dict[str, float]]]:
    """Full FEA of one position against one solve for each length."""
    levels, repeats = (2, 2) if quick else (LEVELS, 4)
    rows = lengths_compared(levels, repeats, not quick)
    mesh = meshing(levels, repeats)
    total = {key: sum(row[key] for row in rows) for key in rows[0] if key.endswith(("cpu", "wall"))}
    # both ways mesh alike
    share = (total["ours_cpu"] + mesh.cpu) / (total["each_cpu"] + mesh.cpu)
    walls = (total["ours_wall"] + mesh.wall) / (total["each_wall"] + mesh.wall)
    case = f"one position, {LENGTHS} lengths, {levels} meshes"
    # the coarser meshes alone say less: their solves are small against the assembly
    rule = "told" if quick else "at most"
    checks = [
        Check(case, "CPU time over that of a solve per length", SHARE, share, rule=rule),
        Check(case, "wall time over that of a solve per length", SHARE, walls, rule="told"),
        Check(
            case,
            "difference of the energies, over the longest crack's",
            AGREEMENT,
            max(r["difference"] for r in rows),
            rule="at most",
        ),
    ]
    if not quick:
        metis = (total["ours_cpu"] + mesh.cpu) / (total["each_metis_cpu"] + mesh.cpu)
        checks.append(Check(case, "the same, solves in the ordering of METIS", SHARE, metis, rule="told"))
    return checks, rows


def of_section(quick: bool) -> tuple[list[Check], dict[str, tuple[float, float]]]:
    """The paper's seconds and ours, and dislocations against full FEA."""
    scene = gallery.circular_hole(analysis={"positions": POSITIONS, "voxels": VOXELS})
    solve_local_model(scene, VOXELS // 4)  # the first call loads or compiles the kernels
    failure_indices(scene, "dislocations", positions=2)
    repeats = 1 if quick else 3
    some = SOME[:1] if quick else SOME
    local = clocked(lambda: solve_local_model(scene, VOXELS), repeats)[1]
    cells = clocked(lambda: failure_indices(scene, "slmm+ac"), repeats)[1]
    dislocations = clocked(lambda: failure_indices(scene, "dislocations"), repeats)[1]
    full = clocked(lambda: failure_indices(hole(np.array(some)), "full-fea"))[1]
    each = full.wall / len(some)
    position = per_position((POSITIONS,), 4)[0]["wall_ms"] / 1e3
    seconds = {
        "local model, 1e6 voxels": (168.0, local.wall),
        "one position by SLMM+AC": (0.66, position),
        "50 positions by SLMM+AC": (200.0, cells.wall),
        "one position by full FEA": (170.0, each),
        "50 positions by full FEA*": (8460.0, POSITIONS * each),
        "50 positions by dislocations": (np.nan, dislocations.wall),
    }
    if not quick:
        seconds = {"table of one material": (6360.0, table_of_one_material())} | seconds
    checks = [
        Check(what, "wall s", paper, ours, rule="told", source=SOURCE)
        for what, (paper, ours) in seconds.items()
    ]
    ratio = POSITIONS * each / cells.wall
    checks.append(
        Check("50 positions", "full FEA over SLMM+AC", 8460 / 200, ratio, rule="told", source=SOURCE)
    )
    share = dislocations.cpu / (POSITIONS * full.cpu / len(some))
    checks.append(
        Check("50 positions", "CPU time of dislocations over full FEA", SHARE, share, rule="at most")
    )
    return checks, seconds


def table_of_one_material() -> float:
    """Wall time of the sweep of Paper A: 16 curvatures, 16 modes, 10 lengths, on two processes."""
    spec = SweepSpec(
        curvature=PUBLISHED_CURVATURES,
        poisson=(0.35,),
        modes="published",
        crack_length=tuple(np.geomspace(0.02, 1.0, 10).round(6).tolist()),
    )
    with tempfile.TemporaryDirectory() as folder:
        return clocked(lambda: run_sweep(spec, Path(folder), workers=2))[1].wall


def draw(seconds: dict[str, tuple[float, float]], rows: list[dict[str, float]]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained", width_ratios=(1.3, 1))
    y = np.arange(len(seconds))
    for k, label in enumerate(("Paper A, 4 cores", f"this package, {os.cpu_count()} cores")):
        values = [pair[k] for pair in seconds.values()]
        bars = left.barh(y + 0.36 * (k - 0.5), values, 0.34, color=("0.6", "C0")[k], label=label)
        left.bar_label(bars, [_digits(v) for v in values], padding=2, fontsize=8)
    left.set_yticks(y, list(seconds))
    left.invert_yaxis()
    left.set(xscale="log", xlabel="wall time in s", xlim=(1e-4, 1e6))
    left.legend(frameon=False, loc="lower right", fontsize=8)
    nodes = [row["nodes"] for row in rows]
    for key, label, marker in (
        ("each_cpu", "one solve per length, SuperLU's ordering", "s--"),
        ("each_metis_cpu", "one solve per length, METIS", "d:"),
        ("ours_cpu", "one factorisation for all", "o-"),
    ):
        right.loglog(nodes, [row[key] for row in rows], marker, mfc="none", label=label)
    right.set_ylim(top=60)
    right.set_xticks(nodes, [f"{n:.0f}" for n in nodes])
    right.xaxis.set_minor_formatter(NullFormatter())
    right.set(
        xlabel="vertices of the mesh", ylabel="CPU time in s", title=f"full FEA, {LENGTHS} crack lengths"
    )
    right.legend(frameon=False, fontsize=8, loc="upper left")
    figure.savefig(RESULTS / "run_times.png", dpi=150)
    plt.close(figure)


def _digits(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.0f}" if value >= 100 else f"{value:.2g}"


def main(quick: bool = False) -> list[Check]:
    load = os.getloadavg()[0]  # before our own work counts
    lengths, rows = many_lengths(quick)
    section, seconds = of_section(quick)
    checks = [*section, *lengths]
    show(f"Run times, {os.cpu_count()} cores, load of the machine {load:.1f}", checks)
    if not quick:
        save("run_times", [check.row() | {"machine_load": load} for check in checks])
        save("run_times_levels", rows)
        draw(seconds, rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
