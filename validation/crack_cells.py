"""Crack cells: discretisation, interpolation and speed; writes validation/results/crack_cells_*.

``python validation/crack_cells.py`` takes about ten minutes, ``--quick`` one to two.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import matplotlib
import numpy as np
from crack_cell_speed import Row, speed_study
from crack_cell_states import fitted_states, released, stress_error
from numpy.polynomial import legendre
from rich.console import Console
from rich.table import Table
from scipy.interpolate import BarycentricInterpolator
from threadpoolctl import threadpool_limits

from precompute.crack_cell import CellResult, solve_cell
from precompute.grading import Fineness
from precompute.modes import Mode
from precompute.spec import SweepSpec
from precompute.unbounded import unbounded_compliance
from slmm.initiation.meta_model import load_meta_model

matplotlib.use("Agg")
import matplotlib.pyplot as plt

RESULTS = Path(__file__).parent / "results"
SPEC = SweepSpec()
LENGTHS = np.array(SPEC.crack_length)


def solve(curvature: float, nu: float, fineness: Fineness) -> CellResult:
    return solve_cell(curvature, nu, LENGTHS, SPEC.eta, SPEC.mode_list, fineness)


def mesh_study(curvatures: tuple[float, ...], ratios: tuple[float, ...]) -> list[Row]:
    """Error of the default mesh against a finer one, extrapolated in the tip size."""
    rows: list[Row] = []
    for curvature in curvatures:
        for nu in ratios:
            ours = solve(curvature, nu, SPEC.fineness)
            coarse, fine = (
                solve(curvature, nu, Fineness(tip, growth=1.3, coarsest=0.05)) for tip in (0.002, 0.001)
            )
            states = fitted_states(curvature, nu, SPEC.mode_list)
            G = released(ours.K[0] - ours.K[1:], states)
            G_coarse, G_fine = (released(cell.K[0] - cell.K[1:], states) for cell in (coarse, fine))
            # the error is linear in the element size at the tip
            error = np.abs(G / (2 * G_fine - G_coarse) - 1).max(axis=1)
            stress = stress_error(ours.stress, fine.stress, states)
            rows += [
                {"curvature": curvature, "nu": nu, "a": a, "G_inc error": e, "stress error": stress}
                for a, e in zip(LENGTHS, error, strict=True)
            ]
    return rows


def interpolation_study(curvatures: tuple[float, ...], ratios: tuple[float, ...]) -> list[Row]:
    """Error of the meta-model between the stored cells against cells solved there."""
    rows: list[Row] = []
    for nu in ratios:
        model = load_meta_model(nu)
        # the meta-model may hold the modes in another order
        modes = [Mode(*(int(power) for power in powers)) for powers in model.powers]
        for curvature in curvatures:
            states = fitted_states(curvature, nu, modes)
            exact = solve_cell(curvature, nu, LENGTHS, SPEC.eta, modes, SPEC.fineness)
            at = np.array([curvature])
            Psi = model.stiffness_loss(at)[0]
            G, G_exact = released(Psi, states), released(exact.K[0] - exact.K[1:], states)
            unit = np.eye(len(modes))
            stress = model.path_stress(np.repeat(at, len(modes)), unit)
            values = np.linalg.eigvalsh(Psi)
            rows.append(
                {
                    "curvature": curvature,
                    "nu": nu,
                    "G_inc error": float(np.abs(G / G_exact - 1).max()),
                    "at a": float(LENGTHS[np.abs(G / G_exact - 1).max(axis=1).argmax()]),
                    "stress error": stress_error(stress, exact.stress, states),
                    "eigenvalue": float((values[:, 0] / values[:, -1]).min()),
                }
            )
    return rows


def compliance_study(curvatures: tuple[float, ...]) -> list[Row]:
    """Error of the interpolated compliance of an unbounded body, for the stress at Kirsch's hole."""
    model = load_meta_model(0.3)
    rows: list[Row] = []
    x, w = legendre.leggauss(40)
    orders = model.compliance.shape[-1]
    for curvature in curvatures:
        exact = unbounded_compliance(curvature, LENGTHS, orders, SPEC.fineness)[0]
        R = -0.5 / curvature if curvature < 0 else np.inf
        error = []
        stress = np.zeros((1, 3, len(model.eta)))
        q = 1 / (1 + model.eta / R)
        stress[0, 0] = 1 + 0.5 * q**2 + 1.5 * q**4 if curvature < 0 else 1.0
        G = model.unbounded_release(np.array([curvature]), stress)[0][0]
        nodal = BarycentricInterpolator(model.eta, stress[0, 0])
        for k, a in enumerate(LENGTHS):
            p = legendre.legvander(x, orders - 1).T @ (w * nodal(a * (x + 1) / 2)) * (np.arange(orders) + 0.5)
            error.append(abs(G[k] / (0.5 * a * p @ exact[k] @ p) - 1))
        rows.append({"curvature": curvature, "G_inc error": float(max(error))})
    return rows


def save(name: str, rows: list[Row]) -> None:
    RESULTS.mkdir(exist_ok=True)
    names = list(dict.fromkeys(key for row in rows for key in row))
    with open(RESULTS / f"crack_cells_{name}.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, names)
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{v:.6g}" if isinstance(v, float) else v for key, v in row.items()})


def show(title: str, rows: list[tuple[str, str, str, str]]) -> None:
    table = Table("quantity", "required", "ours", "difference", title=title)
    for row in rows:
        table.add_row(*row)
    Console(width=140).print(table)


def against(required: float, ours: float) -> tuple[str, str, str]:
    """Required at most, ours, and how far that is from the limit."""
    return (
        f"<= {required:.3g}",
        f"{ours:.3g}",
        f"{ours - required:+.2g}" + ("" if ours <= required else " FAILS"),
    )


def plot(mesh: list[Row], between: list[Row], times: list[Row]) -> None:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(15, 4.2), layout="constrained")
    for curvature in sorted({row["curvature"] for row in mesh}):
        mine = [row for row in mesh if row["curvature"] == curvature]
        worst = [max(float(r["G_inc error"]) for r in mine if r["a"] == a) for a in LENGTHS]
        left.loglog(LENGTHS, worst, "o-", label=f"c' = {curvature}")
    left.axhline(2e-3, color="k", ls="--")
    left.set(xlabel="crack length a' (mm)", ylabel="error of G_inc", title="mesh")
    left.legend()
    for nu in sorted({float(row["nu"]) for row in between}):
        mine = [row for row in between if row["nu"] == nu]
        (line,) = middle.semilogy(
            [r["curvature"] for r in mine], [r["G_inc error"] for r in mine], "o-", label=f"nu = {nu:.3g}"
        )
        middle.semilogy(
            [r["curvature"] for r in mine], [r["stress error"] for r in mine], "s:", color=line.get_color()
        )
    middle.axhline(1e-3, color="k", ls="--")
    middle.set(xlabel="curvature c' (1/mm)", ylabel="error of G_inc (o), stress (s)", title="interpolation")
    middle.legend()
    shown = [row for row in times if "CPU" in str(row["what"])]
    right.barh(
        [str(r["what"]).replace(": CPU", "").replace(", ", ",\n") for r in shown],
        [r["seconds"] for r in shown],
    )
    right.set(xscale="log", xlabel="CPU time (s)", title="one material: 16 curvatures, 10 lengths")
    right.invert_yaxis()
    figure.savefig(RESULTS / "crack_cells.png", dpi=130)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer cells")
    quick = parser.parse_args().quick
    with threadpool_limits(1):
        mesh = mesh_study(
            (-0.5,) if quick else (-1.0, -0.5, 0.0, 0.5), (0.3,) if quick else (-0.5, 0.3, 0.96)
        )
        save("mesh", mesh)
        show(
            "Mesh: default against extrapolated",
            [
                (
                    f"G_inc, a' = {a:g} mm",
                    *against(2e-3, max(float(r["G_inc error"]) for r in mesh if r["a"] == a)),
                )
                for a in LENGTHS
            ]
            + [("stress on the path", *against(2e-3, max(float(r["stress error"]) for r in mesh)))],
        )
        off_grid = (
            (-0.955, -0.25, 0.42)
            if quick
            else (-0.99, -0.955, -0.92, -0.85, -0.65, -0.45, -0.25, -0.05, 0.05, 0.25, 0.42, 0.455, 0.49)
        )
        between = interpolation_study(off_grid, (0.35,) if quick else (-0.85, 0.2, 0.35, 0.49 / 0.51))
        save("interpolation", between)
        lines = []
        ends = -0.9, 0.4  # beyond them the database is denser
        for nu in sorted({float(r["nu"]) for r in between}):
            for place, outermost in (("inside", False), ("outermost intervals", True)):
                rows = [
                    r
                    for r in between
                    if r["nu"] == nu and (not ends[0] < float(r["curvature"]) < ends[1]) == outermost
                ]
                for what in ("G_inc", "stress"):
                    worst = max(rows, key=lambda r: float(r[f"{what} error"]))
                    where = f"nu = {nu:.3g}: {what}, {place}, worst at c' = {worst['curvature']:g}"
                    lines.append((where, *against(1e-3, float(worst[f"{what} error"]))))
        smallest = min(float(r["eigenvalue"]) for r in between)
        verdict = "" if smallest >= -1e-12 else " FAILS"
        lines.append(("smallest eigenvalue of Psi over the largest", ">= -1e-12", f"{smallest:.2g}", verdict))
        compliance = compliance_study(off_grid[:3] if quick else off_grid[::2])
        save("compliance", compliance)
        worst_c = max(compliance, key=lambda r: float(r["G_inc error"]))
        lines.append(
            (
                f"unbounded body: G_inc, worst at c' = {worst_c['curvature']:g}",
                *against(1e-3, float(worst_c["G_inc error"])),
            )
        )
        show("Interpolation between stored cells", lines)
        times = speed_study(quick)
    save("speed", times)
    rows = [(str(times[0]["what"]), *against(60.0, float(times[0]["seconds"])))]
    for row in times[1:3]:
        rows.append((str(row["what"]), "", f"{row['seconds']:.1f} s", ""))
    for row in times[3:]:
        ratio = float(row["ratio"])
        rows.append(
            (
                str(row["what"]),
                "20 times ours",
                f"{row['seconds']:.0f} s, {ratio:.1f} times",
                f"{ratio - 20:+.1f}" + ("" if ratio >= 20 else " FAILS"),
            )
        )
    show("Sweep of one material: 16 curvatures, 16 modes, 10 lengths", rows)
    plot(mesh, between, times)


if __name__ == "__main__":
    main()
