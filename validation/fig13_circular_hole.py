"""Fig. 13 of Paper A: full FEA, SLMM and SLMM+AC at a circular hole, with the published cell of h = 38.7 mm.

r = 20 mm in a square of 100 mm, e_yy = 0.1, PMMA. The paper shows three positions, of which its text calls the most
critical one red and another one cyan, but not where they are. A cell of that height fits the plate at the angles of 0,
45 and 90 degrees and not in between (its corners would leave the plate), so these three are taken: red at 0 (the most
critical one), golden at 45 and cyan at 90 degrees, where sigma_xx is what the cell misses most. Where the published
cell does not fit, the failure index is that of the largest published cell that does. Beside them: the package's own
settings and dislocations.

Compared with the paper: FI over full FEA at the red position, 7.96 % (SLMM) and 7.98 % (SLMM+AC). Told: sigma_I at the
cyan position, -7.7 %; the depth is not published, and where sigma_I is highest we find nearly that. The failure index
of full FEA is computed on a quarter of the hole and mirrored.

Writes validation/results/fig13_circular_hole.csv (checks), _index.csv, _curves.csv and .png; a minute, ``--quick``
15 s and no files.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import matplotlib
import numpy as np
from accuracy import reference, with_irwin_length
from checks import RESULTS, Check, run, save, show
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle
from scipy.interpolate import CubicSpline

from slmm import Scene, coupled_criterion, failure_indices
from slmm.initiation.cells import cell_stress, place_cells, select_modes
from slmm.initiation.full_fea import FullFEA
from slmm.initiation.local_model import solve_local_model
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT, PUBLISHED, Settings
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

RADIUS, HEIGHT = 20.0, 38.7
LONGEST = HEIGHT / 2
VOXELS = 1_000_000
FIXED = replace(PUBLISHED, height=HEIGHT)
#: colour and angle, degrees
POSITIONS = {"red": 0.0, "gold": 45.0, "cyan": 90.0}
#: positions on the hole for the failure index; a quarter of them by full FEA
AROUND = 48
STRESSES = ("xx", "yy", "xy")
#: label, method, settings, line
METHODS = (
    ("SLMM, published", "slmm", FIXED, ":"),
    ("SLMM+AC, published", "slmm+ac", FIXED, "--"),
    ("SLMM+AC, default", "slmm+ac", DEFAULT, "-."),
    ("dislocations", "dislocations", DEFAULT, (0, (1, 4))),
)


@dataclass(frozen=True)
class Curve:
    """Curves along a crack path; ``stress`` (3, n) is None where a method has only the principal one."""

    a: np.ndarray
    G_inc: np.ndarray
    sigma_I: np.ndarray
    stress: np.ndarray | None


def hole_scene(degrees: np.ndarray) -> Scene:
    angle = np.radians(degrees)
    points = 50 + RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    return gallery.circular_hole(RADIUS, analysis={"points": points.tolist(), "voxels": VOXELS})


def by_full_fea(scene: Scene) -> list[FullFEA]:
    return [reference(scene, list(point), LONGEST) for point in scene.analysis.points or ()]


def stress_of_cells(scene: Scene, settings: Settings, depths: np.ndarray) -> np.ndarray:
    """Stress xx, yy, xy (n, 3, k) at depths (n, k) by the cells that the settings place, MPa."""
    _, nu = scene.material.plane_stress_equivalent
    meta = select_modes(load_meta_model(nu), settings.modes)
    void = settings.void_stiffness or scene.analysis.void_stiffness
    local = solve_local_model(scene.with_(analysis={"void_stiffness": void}), VOXELS)
    outline, s = scene.outlines[0], find_positions(scene).s
    placed = place_cells(scene, outline, s, local, meta, settings, settings.fine)
    across, along, shear = np.array(
        [cell_stress(placed.only(i), meta, scene, row)[0][0] for i, row in enumerate(depths)]
    ).swapaxes(0, 1)
    (tx, ty), (nx, ny) = (v.T[..., None] for v in (outline.tangents(s), outline.normals(s)))
    return np.stack(
        [
            across * tx * tx + along * nx * nx + 2 * shear * tx * nx,
            across * ty * ty + along * ny * ny + 2 * shear * ty * ny,
            across * tx * ty + along * nx * ny + shear * (tx * ny + ty * nx),
        ],
        axis=1,
    )


def by_method(scene: Scene, method: str, settings: Settings) -> list[Curve]:
    """Curves of every position; the trial cracks of dislocations are made as long as the published cell's."""
    long = with_irwin_length(scene, 2 * LONGEST) if method == "dislocations" else scene
    result = failure_indices(long, method, curves=True, settings=settings)
    a = result.a.values
    stress = None if method == "dislocations" else stress_of_cells(scene, settings, a)
    return [
        Curve(a[i], result.G_inc.values[i], result.sigma_I.values[i], None if stress is None else stress[i])
        for i in range(len(a))
    ]


def index_around(scene: Scene, method: str, settings: Settings) -> np.ndarray:
    """Failure indices; where a cell of fixed height does not fit, by the largest one of the same kind that does."""
    found = failure_indices(scene, method, settings=settings).failure_index.values
    if settings.height:
        grown = failure_indices(scene, method, settings=replace(settings, height=0.0)).failure_index.values
        found = np.where(np.isfinite(found), found, grown)
    return found


def judged(scene: Scene, full: list[FullFEA], curves: dict[str, list[Curve]]) -> list[Check]:
    """Failure index at the red position, energy at its longest crack, stress at the cyan one."""
    red, cyan = 0, list(POSITIONS).index("cyan")
    truth = coupled_criterion(full[red].a, full[red].G_inc, full[red].sigma_I[1:], scene.material)
    checks = []
    for label, method, settings, _ in METHODS:
        FI = failure_indices(scene, method, settings=settings).failure_index.values[red]
        over, case = float(FI) / truth.failure_index, f"red, {label}"
        published = {"SLMM, published": 1.0796, "SLMM+AC, published": 1.0798}.get(label)
        if published:
            # one part in a hundred of FI: the published cell's mesh and its fitting points are not known to more
            checks.append(Check(case, "FI over full FEA", published, over, 0.01, source="Paper A, 3.1.1"))
        else:
            checks.append(Check(case, "error of FI", 0.03, abs(over - 1), rule="at most"))
    for label, mine in curves.items():
        end = min(mine[red].a[-1], full[red].a[-1])
        G = np.interp(end, mine[red].a, mine[red].G_inc)
        G_full = float(CubicSpline(full[red].a, full[red].G_inc)(end))
        checks.append(
            Check(f"red, {label}", f"G_inc at {end:.3g} mm, N/mm; wanted: full FEA", G_full, G, rule="told")
        )
    # the paper does not say at which depth it compares; the cell of the default settings ends before the highest
    highest = int(np.argmax(full[cyan].sigma_I))
    for label, k, where, wanted in (
        ("SLMM, published", highest, f"depth of {full[cyan].eta[highest]:.2g} mm, highest", 1 - 0.077),
        ("SLMM, published", 0, "surface", 1.0),
        ("SLMM+AC, default", 0, "surface", 1.0),
    ):
        curve = curves[label][cyan]
        over = float(np.interp(full[cyan].eta[k], curve.a, curve.sigma_I) / full[cyan].sigma_I[k])
        checks.append(Check(f"cyan, {label}", f"sigma_I over full FEA, {where}", wanted, over, rule="told"))
    return checks


def around() -> list[dict[str, object]]:
    """Failure index by every method around the hole."""
    degrees = np.arange(AROUND) * 360 / AROUND
    scene = hole_scene(degrees)
    values = {label: index_around(scene, method, settings) for label, method, settings, _ in METHODS}
    quarter = degrees[degrees <= 90]
    by_quarter = failure_indices(hole_scene(quarter), "full-fea").failure_index.values
    folded = np.minimum(degrees % 180, 180 - degrees % 180)
    values = {"full FEA": by_quarter[np.searchsorted(quarter, folded)]} | values
    return [
        {
            "degrees": float(d),
            "s": float(np.radians(d) * RADIUS),
            **{k: float(v[i]) for k, v in values.items()},
        }
        for i, d in enumerate(degrees)
    ]


def curve_rows(full: list[FullFEA], curves: dict[str, list[Curve]]) -> list[dict[str, object]]:
    every = {"full FEA": [Curve(f.a, f.G_inc, f.sigma_I[1:], f.sigma[1:].T) for f in full]} | curves
    rows = []
    for label, mine in every.items():
        for name, curve in zip(POSITIONS, mine, strict=True):
            stress = np.full((3, len(curve.a)), np.nan) if curve.stress is None else curve.stress
            for k in range(0, len(curve.a), 1 if label == "full FEA" else 10):
                row = {
                    "position": name,
                    "method": label,
                    "a": float(curve.a[k]),
                    "G_inc": float(curve.G_inc[k]),
                }
                row |= {"sigma_I": float(curve.sigma_I[k])}
                rows.append(row | {f"sigma_{c}": float(stress[i, k]) for i, c in enumerate(STRESSES)})
    return rows


def sketch(axis: plt.Axes) -> None:
    axis.add_patch(Rectangle((0, 0), 100, 100, fc="0.9", ec="0.4"))
    axis.add_patch(Circle((50, 50), RADIUS, fc="w", ec="0.4"))
    for colour, degrees in POSITIONS.items():
        direction = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        path = 50 + np.outer([RADIUS, RADIUS + LONGEST], direction)
        axis.plot(*path.T, color=COLOURS[colour], lw=2.5)
        axis.plot(*path[0], "o", color=COLOURS[colour], mec="k", mew=0.5)
    for x in np.linspace(10, 90, 5):
        for y, way in ((100, 8), (0, -8)):
            axis.annotate("", (x, y + way), (x, y), arrowprops={"arrowstyle": "-|>", "lw": 0.8})
    axis.annotate("$\\epsilon_{yy}$ = 0.1", (50, 110), ha="center")
    axis.set(aspect="equal", xlim=(-6, 106), ylim=(-12, 120), xlabel="x in mm", ylabel="y in mm")


#: of the positions, readable on white
COLOURS = {"red": "red", "gold": "goldenrod", "cyan": "darkturquoise"}
#: full FEA is a broad pale line: what follows it stays visible
REFERENCE: dict[str, Any] = {"lw": 5, "alpha": 0.3, "solid_capstyle": "butt"}


def draw(full: list[FullFEA], curves: dict[str, list[Curve]], index: list[dict[str, object]]) -> None:
    figure, axes = plt.subplots(2, 4, figsize=(15, 7), layout="constrained")
    (model, energy, principal, FI), (*components, legend) = axes
    sketch(model)
    for k, colour in enumerate(COLOURS.values()):
        energy.plot(full[k].a, full[k].G_inc, color=colour, **REFERENCE)
        principal.plot(full[k].eta, full[k].sigma_I, color=colour, **REFERENCE)
        for i, axis in enumerate(components):
            axis.plot(full[k].eta, full[k].sigma[:, i], color=colour, **REFERENCE)
        for label, _, _, line in METHODS:
            curve = curves[label][k]
            energy.plot(curve.a, curve.G_inc, ls=line, color=colour)
            principal.plot(curve.a, curve.sigma_I, ls=line, color=colour)
            if curve.stress is not None and label != "SLMM+AC, published":
                for axis, sigma in zip(components, curve.stress, strict=True):
                    axis.plot(curve.a, sigma, ls=line, color=colour)
    s = [float(row["s"]) for row in index]
    FI.plot(s, [row["full FEA"] for row in index], "k", **REFERENCE)
    for label, _, _, line in METHODS:
        FI.plot(s, [row[label] for row in index], ls=line, color="k")
    for colour, degrees in POSITIONS.items():
        FI.axvline(np.radians(degrees) * RADIUS, color=COLOURS[colour], lw=1)
    model.set_title("a)", loc="left")
    energy.set(
        ylabel="$G_{inc}$ in N/mm", xlabel="virtual crack length a in mm", xlim=(0, LONGEST), ylim=(0, None)
    )
    energy.set_title("b)", loc="left")
    principal.set(ylabel="$\\sigma_I$ in MPa")
    principal.set_title("c)", loc="left")
    for axis, name, letter in zip(components, STRESSES, "def", strict=True):
        axis.set(ylabel=f"$\\sigma_{{{name}}}$ in MPa")
        axis.set_title(f"{letter})", loc="left")
    for axis in (principal, *components):
        axis.set(xlabel="depth $\\eta$ in mm", xlim=(0, LONGEST))
    FI.set(xlabel="position s in mm", ylabel="failure index FI", ylim=(0, None))
    FI.set_title("g)", loc="left")
    lines = [Line2D([], [], color="k", label="full FEA", **REFERENCE)]
    lines += [Line2D([], [], color="k", ls=line, label=label) for label, _, _, line in METHODS]
    lines += [
        Line2D([], [], color=COLOURS[c], marker="o", label=f"{c}, {d:g} degrees")
        for c, d in POSITIONS.items()
    ]
    legend.axis("off")
    legend.legend(handles=lines, loc="center left", frameon=False)
    figure.savefig(RESULTS / "fig13_circular_hole.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    scene = hole_scene(np.array(list(POSITIONS.values())))
    full = by_full_fea(scene)
    curves = {label: by_method(scene, method, settings) for label, method, settings, _ in METHODS}
    checks = judged(scene, full, curves)
    show("Circular hole of Fig. 13", checks)
    if not quick:
        index = around()
        save("fig13_circular_hole", [check.row() for check in checks])
        save("fig13_circular_hole_index", index)
        save("fig13_circular_hole_curves", curve_rows(full, curves))
        draw(full, curves, index)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
