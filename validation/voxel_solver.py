"""The voxel solver against SuperLU and smoothed aggregation, and its displacement error at a circular hole.

Plate 100 x 100 mm, hole r = 20 mm, void stiffness 1e-6, nu = 0.35. Every solve is measured in a process of its
own: wall and CPU seconds (the best of several; ratios are only as good as the machine was idle), iterations,
peak memory beyond imports and compiled kernels. Writes validation/results/voxel_solver.csv and .png; about three
minutes, with --quick 20 s and no files.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import RectBivariateSpline

from slmm.initiation.local_model import bilinear
from slmm.mechanics.stress import plane_stiffness_constants
from slmm.part.coverage import area_fraction
from slmm.voxels.element import element_matrix
from slmm.voxels.model import solve_voxels

RESULTS = Path(__file__).parent / "results"
SIDE, RADIUS, NU, VOID = 100.0, 20.0, 0.35, 1e-6
LOADS = {"strain": (0.0, 0.1, 0.0), "displacement": 10.0, "stress": 0.1}  # stress for E = 1
REPEATS = 7


def load(name):
    return SimpleNamespace(**{key: LOADS[key] if key == name else None for key in LOADS})


def plate(n):
    angle = np.linspace(0, 2 * np.pi, 50 * n, endpoint=False)
    hole = SIDE / 2 + RADIUS * np.stack([np.cos(angle), np.sin(angle)], -1)
    return VOID + (1 - VOID) * (1 - area_fraction([hole], SIDE, SIDE, n, n))


def assembled(n):
    """The same system as a matrix and a right-hand side, under prescribed strain; coordinates of the unknowns."""
    node = np.arange((n + 1) ** 2, dtype=np.int32).reshape(n + 1, n + 1)
    corners = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, :-1], node[1:, 1:]], -1).reshape(-1, 4)
    dofs = np.stack([2 * corners, 2 * corners + 1], -1).reshape(-1, 8)
    values = element_matrix(1.0, 1.0, NU) * plate(n).reshape(-1, 1, 1)
    rows, columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, (1, 8)).ravel()
    A = sp.coo_array((values.ravel(), (rows, columns)), shape=(2 * node.size,) * 2).tocsr()
    x = np.linspace(0, SIDE, n + 1)
    X, Y = np.meshgrid(x, x)
    u = np.stack([np.zeros_like(X), LOADS["strain"][1] * Y], -1).ravel()
    free = np.zeros((n + 1, n + 1, 2), bool)
    free[1:-1, 1:-1] = True
    i = np.flatnonzero(free)
    b = -(A[i] @ np.where(free.ravel(), 0.0, u))
    return A[i][:, i].tocsc(), b, X[1:-1, 1:-1].ravel(), Y[1:-1, 1:-1].ravel()


def memory_now():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def measured(solve, repeats=1):
    """Best wall and CPU time of ``solve()``, its last result, and the peak memory of this process."""
    wall, cpu = [], []
    for _ in range(repeats):
        w, c = time.perf_counter(), time.process_time()
        result = solve()
        wall.append(time.perf_counter() - w)
        cpu.append(time.process_time() - c)
    return result, {"wall_s": min(wall), "cpu_s": min(cpu)}


def measure(solver, n, load_name):
    """One measurement, in this process."""
    if solver == "multigrid":
        # loads the compiled kernels and starts the threads; small, so that it leaves no memory to be reused
        solve_voxels(plate(40), SIDE, SIDE, NU, load(load_name))
        before = memory_now()
        stiffness = plate(n)
        solution, row = measured(lambda: solve_voxels(stiffness, SIDE, SIDE, NU, load(load_name)), REPEATS)
        row |= {"iterations": solution.iterations, "residual": solution.residual}
    else:
        before = memory_now()
        A, b, x, y = assembled(n)
        repeats = 2 if n < 400 else 1
        if solver == "smoothed aggregation":
            u, row = measured(lambda: smoothed_aggregation(A, b, x, y), repeats)
        else:
            u, row = measured(lambda: super_lu(A, b, tuned=solver.endswith("tuned")), repeats)
        row |= {"iterations": 0, "residual": float(np.linalg.norm(A @ u - b) / np.linalg.norm(b))}
    peak = peak_memory()
    return {"solver": solver, "load": load_name, "n": n, "bytes_per_voxel": (peak - before) / n**2, **row}


def super_lu(A, b, tuned):
    from scipy.sparse.linalg import splu

    if tuned:
        return splu(
            A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        ).solve(b)
    return splu(A).solve(b)


def smoothed_aggregation(A, b, x, y):
    from pyamg import smoothed_aggregation_solver

    rigid = np.zeros((len(b), 3))
    rigid[0::2, 0], rigid[1::2, 1] = 1, 1
    rigid[0::2, 2], rigid[1::2, 2] = -(y - SIDE / 2), x - SIDE / 2
    solver = smoothed_aggregation_solver(sp.bsr_matrix(A.tocsr(), blocksize=(2, 2)), B=rigid)
    return solver.solve(b, tol=1e-8, accel="cg", maxiter=300)


def peak_memory():
    """Largest memory of this program so far, bytes; ru_maxrss would start from that of the parent process."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) * 1024
    raise OSError("/proc/self/status has no VmHWM: peak memory is measured on Linux only")


def in_own_process(solver, n, load_name="strain"):
    command = [sys.executable, __file__, "--measure", solver, str(n), load_name]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    row = json.loads(answer.stdout.splitlines()[-1])
    print(
        f"{row['solver']:21s}{row['load']:13s}{n:5d}^2 {row['wall_s']:9.3f} s wall {row['cpu_s']:9.3f} s CPU"
        f"{row['iterations']:5d} iterations {row['bytes_per_voxel']:8.0f} bytes/voxel  residual {row['residual']:.1e}",
        flush=True,
    )
    return row


def extrapolated(rows, solver, key, n=1000):
    """What a solver would need for n x n voxels, by the growth between its two largest measurements."""
    (n1, t1), (n2, t2) = sorted((r["n"], r[key]) for r in rows if r["solver"] == solver)[-2:]
    return t2 * (n / n2) ** (math.log(t2 / t1) / math.log(n2 / n1)) if n2 < n else t2


def body_fitted(radial=60, around=256):
    """Displacements of the quarter plate by quadratic body-fitted quadrilaterals (scikit-fem), as splines."""
    import skfem
    from skfem.models.elasticity import linear_elasticity

    angle, share = np.linspace(0, np.pi / 2, around + 1), np.linspace(0, 1, radial + 1) ** 1.5
    T, S = np.meshgrid(angle, share)
    R = RADIUS + (SIDE / 2 / np.maximum(np.cos(T), np.sin(T)) - RADIUS) * S
    points = np.stack([R * np.cos(T), R * np.sin(T)]).reshape(2, -1)
    k = np.arange(points.shape[1]).reshape(T.shape)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]]).reshape(4, -1)
    mesh = skfem.MeshQuad2.from_mesh(skfem.MeshQuad(points, quads))
    nodes = mesh.doflocs.copy()
    r = np.hypot(*nodes)
    rim = abs(r - RADIUS) < 0.01
    nodes[:, rim] *= RADIUS / r[rim]
    basis = skfem.Basis(skfem.MeshQuad2(nodes, mesh.t), skfem.ElementVector(skfem.ElementQuad2()), intorder=5)
    _, C12, C33 = plane_stiffness_constants(NU)
    K = linear_elasticity(C12, C33).assemble(basis)  # Lame's lambda of plane stress is C12
    x, y = basis.doflocs
    along_x = np.zeros(basis.N, bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        along_x[dofs[0]] = True
    edge = np.maximum(x, y) > SIDE / 2 - 1e-9
    held = edge | ((x < 1e-9) & along_x) | ((y < 1e-9) & ~along_x)
    u = np.where(edge & ~along_x, LOADS["strain"][1] * y, 0.0)
    u = skfem.solve(*skfem.condense(K, np.zeros(basis.N), u, D=np.flatnonzero(held)))
    u = u[basis.nodal_dofs[:, : points.shape[1]]].reshape(2, *T.shape)
    # one spline on either side of the corner, where the mesh lines have a kink
    half = around // 2
    sides = (slice(0, half + 1), slice(half, None))
    return [[RectBivariateSpline(share, angle[s], u[c][:, s]) for c in (0, 1)] for s in sides]


def reference_at(splines, angle, distance):
    """Reference displacements at a distance from the hole's edge, for angles of the full circle."""
    cos, sin = np.cos(angle), np.sin(angle)
    folded = np.arctan2(abs(sin), abs(cos))
    share = distance / (SIDE / 2 / np.maximum(abs(cos), abs(sin)) - RADIUS)
    u = np.where(
        folded <= np.pi / 4,
        [splines[0][c].ev(share, folded) for c in (0, 1)],
        [splines[1][c].ev(share, folded) for c in (0, 1)],
    )
    return np.stack([np.sign(cos) * u[0], np.sign(sin) * u[1] + LOADS["strain"][1] * SIDE / 2], -1)


def displacement_errors(sizes):
    """Error at the hole's edge and 0.5, 1, 2 voxels away from it, % of the largest displacement of the rim."""
    splines = body_fitted()
    angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    rim = reference_at(splines, angle, 0.0)
    scale = np.abs(rim - rim.mean(axis=0)).max()
    rows = []
    for n in sizes:
        u, h = solve_voxels(plate(n), SIDE, SIDE, NU, load("strain")).u, SIDE / n
        for voxels_away in (0.0, 0.5, 1.0, 2.0):
            r = RADIUS + voxels_away * h
            points = SIDE / 2 + r * np.stack([np.cos(angle), np.sin(angle)], -1)
            ours = np.array([bilinear(u, h, h, x, y) for x, y in points])
            error = np.linalg.norm(ours - reference_at(splines, angle, r - RADIUS), axis=1) / scale
            rms, largest = 100 * np.sqrt(np.mean(error**2)), 100 * error.max()
            rows.append({"n": n, "voxels_away": voxels_away, "error_rms": rms, "error_max": largest})
            print(
                f"{n:5d}^2  {voxels_away:3.1f} voxels from the edge: error {rms:.3f} % rms, {largest:.3f} % max"
            )
    return rows


def draw(rows, errors, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    for solver in dict.fromkeys(r["solver"] for r in rows):
        picked = sorted(
            (r["n"] ** 2, r["cpu_s"]) for r in rows if (r["solver"], r["load"]) == (solver, "strain")
        )
        left.loglog(*zip(*picked, strict=True), "o-", label=solver)
    left.set(xlabel="voxels", ylabel="CPU time (s)")
    times = {r["n"]: r["cpu_s"] for r in rows if (r["solver"], r["load"]) == ("multigrid", "strain")}
    for away, label in ((0.0, "at the hole's edge"), (2.0, "two voxels away")):
        picked = [
            (times[e["n"]], e["error_rms"]) for e in errors if e["voxels_away"] == away and e["n"] in times
        ]
        right.loglog(*zip(*picked, strict=True), "o-", label=label)
    right.set(xlabel="CPU time (s)", ylabel="error of the displacement, rms (%)")
    right.xaxis.set_minor_formatter("")  # the labels between the decades would overlap
    for axes in (left, right):
        axes.grid(which="both", alpha=0.3)
        axes.legend()
    figure.savefig(path, dpi=150)


def main(quick):
    rows = [
        in_own_process("multigrid", n, name)
        for n in ((250,) if quick else (125, 250, 500, 1000))
        for name in LOADS
    ]
    if quick:
        rows += [in_own_process("SuperLU tuned", n) for n in (88, 125)]
        rows += [in_own_process("smoothed aggregation", 125)]
        displacement_errors((125,))
        return
    rows += [in_own_process("SuperLU", n) for n in (177, 250, 354)]
    rows += [in_own_process("SuperLU tuned", n) for n in (250, 354, 500)]
    rows += [in_own_process("smoothed aggregation", n) for n in (250, 500, 1000)]
    ours = next(r for r in rows if (r["solver"], r["n"], r["load"]) == ("multigrid", 1000, "strain"))
    print("\n1000 x 1000 voxels, times of the multigrid solver (extrapolated where not measured)")
    for solver in ("SuperLU", "SuperLU tuned", "smoothed aggregation"):
        cpu, wall = (extrapolated(rows, solver, key) for key in ("cpu_s", "wall_s"))
        print(
            f"  {solver:21s}{cpu:8.1f} CPU s: {cpu / ours['cpu_s']:6.0f} x CPU, {wall / ours['wall_s']:6.0f} x wall"
        )
    ratio = extrapolated(rows, "SuperLU tuned", "cpu_s") / ours["cpu_s"]
    print(f"  at least 100 times faster than tuned SuperLU: {'yes' if ratio >= 100 else 'NO'} ({ratio:.0f})")
    most = max(r["bytes_per_voxel"] for r in rows if (r["solver"], r["n"]) == ("multigrid", 1000))
    print(f"  less than 200 bytes per voxel: {'yes' if most < 200 else 'NO'} ({most:.0f})\n")
    errors = displacement_errors((125, 250, 500, 1000))
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "voxel_solver.csv").open("w", newline="") as file:
        fields = [*rows[0], *(k for k in errors[0] if k != "n")]
        writer = csv.DictWriter(file, fields, restval="")
        writer.writeheader()
        writer.writerows(rows)
        writer.writerows({"solver": "multigrid", "load": "strain", **e} for e in errors)
    draw(rows, errors, RESULTS / "voxel_solver.png")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small grids only, writes nothing")
    parser.add_argument("--measure", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        solver, n, load_name = arguments.measure
        print(json.dumps(measure(solver, int(n), load_name)))
    else:
        main(arguments.quick)
