"""The full FEA against published values; writes validation/results/full_fea.csv (about a minute)."""

from __future__ import annotations

import csv
import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.interpolate import CubicSpline

from slmm.contours.outline import Outline
from slmm.contours.shapes import circle
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import SlitModel
from slmm.initiation.body_fitted import notch_stress, solve_body_fitted
from slmm.initiation.full_fea import FullFEA, full_fea_curves, path_depths
from slmm.material import Material

PMMA = Material.from_name("PMMA")
RESULTS = Path(__file__).parent / "results"

#: case, quantity, ours, reference, its source
Row = tuple[str, str, float, float, str]


def scene(width, height, outlines=(), **load):
    return SimpleNamespace(
        plate=SimpleNamespace(width=width, height=height, thickness=1.0),
        outlines=tuple(outlines),
        cracks=(),
        material=PMMA,
        load=SimpleNamespace(**({"strain": None, "displacement": None, "stress": None} | load)),
    )


def stress_intensity(curves: FullFEA, a: np.ndarray) -> np.ndarray:
    """K = sqrt(E G) with the energy release rate G = d(a G_inc)/da."""
    exponent = CubicSpline(np.log(curves.a), np.log(curves.G_inc))
    G = np.exp(exponent(np.log(a))) * (1 + exponent(np.log(a), 1))
    return np.sqrt(PMMA.E * G)


def edge_crack() -> list[Row]:
    W = 10.0
    curves = full_fea_curves(
        scene(W, 6 * W, stress=1.0), start=(0, 3 * W), direction=(1, 0), a_min=0.5, a_max=5.6, n_lengths=40
    )
    a = W * np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    F = stress_intensity(curves, a) / np.sqrt(np.pi * a)
    published = [1.1892, 1.3673, 1.6599, 2.1114, 2.8246]
    rows = [
        ("edge crack in tension", f"F, a/W = {share / W:.1f}", ours, reference, "p-version FE, 1e-4")
        for share, ours, reference in zip(a, F, published, strict=True)
    ]
    curves = full_fea_curves(
        scene(100.0, 250.0, stress=1.0), start=(0, 125), direction=(1, 0), a_min=10, a_max=45, n_lengths=20
    )
    K = stress_intensity(curves, np.array([37.5]))[0]
    return [*rows, ("Code_Aster SSLP101", "K_I, MPa sqrt(mm)", K, 21.44, "Tada, 0.5 %")]


def crack_at_a_hole() -> list[Row]:
    R = 1.0
    plate = scene(400.0, 400.0, [Outline.through(circle((200, 200), R))], stress=1.0)
    curves = full_fea_curves(plate, 0, 0.0, a_max=2.4, a_min=0.008, n_lengths=48)
    L = R * np.array([0.01, 0.1, 0.2, 0.5, 1, 2])
    F = stress_intensity(curves, L) / np.sqrt(np.pi * L)
    published = [3.2932, 2.7727, 2.3746, 1.7279, 1.3061, 1.0307]
    rows = [
        ("one crack at a circular hole", f"F, L/R = {length / R:g}", ours, reference, "p-version FE, 1e-4")
        for length, ours, reference in zip(L, F, published, strict=True)
    ]
    q = R / (R + curves.eta)
    kirsch = 1 + q**2 / 2 + 1.5 * q**4
    for depth in (0.0, 0.1, 0.5, 1.0):
        k = int(np.argmin(np.abs(curves.eta - depth * R)))
        label = f"sigma_I, eta/R = {curves.eta[k] / R:.3f}"
        rows.append(
            ("circular hole, stress on the path", label, curves.sigma_I[k], kirsch[k], "Kirsch, exact")
        )
    surface = notch_stress(solve_body_fitted(plate), plate.outlines, n=72)[0]
    rows.append(("circular hole, surface stress", "maximum", surface.sigma_I.max(), 3.0, "Kirsch, exact"))
    return rows


def convergence() -> list[Row]:
    """Rate at which the released energy converges, as it is and freed of the tip's linear error."""
    part = scene(100.0, 100.0, [Outline.through(circle((50, 50), 20.0))], strain=(0.0, 0.1, 0.0))
    a = np.geomspace(1.0, 10.0, 12)
    path = np.array([70.0, 50.0]) + path_depths(a)[:, None] * [1, 0]
    mesh = plate_mesh(100.0, 100.0, part.outlines, path)
    W = []
    for level in range(4):
        W.append(SlitModel(mesh, part).released_energy()[:: 2**level][-len(a) :])
        mesh = mesh.refined()
    once = [2 * fine - coarse for coarse, fine in pairwise(W)]
    rows: list[Row] = []
    for name, series, rate in (("as computed", W, 1.0), ("extrapolated", once, 4.0)):
        change = np.abs(np.diff(series, axis=0)).sum(axis=1)
        ours = float(np.log2(change[-2] / change[-1]))
        source = "theory of the tip" if series is W else "observed; only its order counts"
        rows.append(("convergence of the released energy", f"rate, {name}", ours, rate, source))
    return rows


def main() -> None:
    start = time.perf_counter()
    rows = [*edge_crack(), *crack_at_a_hole(), *convergence()]
    RESULTS.mkdir(exist_ok=True)
    with open(RESULTS / "full_fea.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "quantity", "ours", "reference", "deviation_percent", "source"])
        for case, quantity, ours, reference, source in rows:
            deviation = 100 * (ours / reference - 1)
            writer.writerow([case, quantity, f"{ours:.6g}", f"{reference:.6g}", f"{deviation:.3f}", source])
            print(f"{case:36s} {quantity:24s} {ours:10.5f} {reference:10.5f} {deviation:8.3f} %  {source}")
    print(f"{time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
