"""The picture of a fracture process: cracks by their steps on the part, and the curve F(u) with its area U_T."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from slmm.pictures.style import CRITICAL, PALETTE, STYLE
from slmm.pictures.supports import draw_supports, room_for_supports
from slmm.scene.scene import Scene

#: perceptually uniform and safe for the colour-blind
STEP_COLOURS = "viridis"
#: room around the part over its size, and the light grey of the material
MARGIN, MATERIAL = 0.03, "0.92"


def plot_fracture(scene: Scene, result: xr.Dataset) -> Figure:
    """Crack paths coloured by the step that made them, and beside them the force over the displacement.

    Parameters
    ----------
    scene : Scene
        What was simulated.
    result : Dataset
        From `slmm.fracture.simulate`.

    Returns
    -------
    Figure
        Not known to pyplot; ``figure.savefig("fracture.pdf")`` writes it.
    """
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(12.5, 5.8), layout="constrained")
        part, curve = figure.subplots(1, 2, width_ratios=(1.0, 1.05))
        _draw_part(part, scene)
        _draw_cracks(part, result)
        _draw_curve(curve, result)
        figure.suptitle(scene.title or "Fracture", parse_math=False)
    return figure


def _draw_part(axes: Axes, scene: Scene) -> None:
    """Material, holes, what holds and loads it."""
    (x0, y0), (x1, y1) = scene.box
    axes.add_patch(Polygon(scene.part.outer, fc=MATERIAL, ec="0.35", lw=1.0, zorder=1))
    for outline in scene.part.holes:
        axes.add_patch(Polygon(outline.polygon(720), fc="white", ec="0.35", lw=1.0, zorder=2))
    draw_supports(axes, scene)
    room = max(MARGIN * scene.size, room_for_supports(scene))
    axes.set(xlim=(x0 - room, x1 + room), ylim=(y0 - room, y1 + room), aspect="equal")
    axes.set(xlabel="x in mm", ylabel="y in mm")


def _draw_cracks(axes: Axes, result: xr.Dataset) -> None:
    """Initial cracks black, increments by their step, starts numbered in their order."""
    steps = max(result.sizes["step"], 1)
    scale = Normalize(1, max(steps, 2))
    for x, y, step in zip(
        result.crack_x.values, result.crack_y.values, result.crack_step.values, strict=True
    ):
        known = np.isfinite(x)
        points, step = np.column_stack([x, y])[known], step[known]
        # an increment leads from one point to the next, whichever end of the crack grew
        made = np.maximum(step[:-1], step[1:])
        pieces = np.stack([points[:-1], points[1:]], axis=1)
        old = made < 0
        axes.add_collection(LineCollection(list(pieces[old]), colors="black", linewidths=2.0, zorder=5))
        grown = LineCollection(
            list(pieces[~old]), array=made[~old] + 1, cmap=STEP_COLOURS, norm=scale, linewidths=2.4, zorder=4
        )
        axes.add_collection(grown)
    for number, k in enumerate(np.flatnonzero(result.event.values == "start").tolist(), start=1):
        crack = int(result.tip[k])
        axes.annotate(
            str(number),
            (float(result.crack_x[crack, 0]), float(result.crack_y[crack, 0])),
            xytext=(3, 4),
            textcoords="offset points",
            color=CRITICAL,
            weight="bold",
            zorder=6,
        )
    axes.figure.colorbar(
        ScalarMappable(scale, STEP_COLOURS), ax=axes, label="step", shrink=0.8, pad=0.02, aspect=30
    )
    axes.set_title("cracks; new ones are numbered")


def _draw_curve(axes: Axes, result: xr.Dataset) -> None:
    """F(u) with the area below it, and the critical state of each step."""
    u, F = result.u.values, result.F.values
    axes.fill_between(u, F, color=PALETTE[4], alpha=0.3, lw=0, zorder=1)
    axes.plot(u, F, color=PALETTE[0], lw=2.0, zorder=3, label="F(u)")
    u_c, stiffness = result.u_c.values, result.stiffness.values
    start = result.event.values == "start"
    for which, marker, colour, label in (
        (~start, ".", "0.45", "a crack grows"),
        (start, "x", CRITICAL, "a crack starts"),
    ):
        if which.any():
            force = (stiffness * u_c)[which]
            axes.plot(u_c[which], force, marker, color=colour, ms=6, zorder=4, label=f"critical: {label}")
    error = float(result.U_T_error)
    axes.set(xlabel="displacement u in mm", ylabel="force F in N")
    axes.set_xlim(left=0)
    axes.set_ylim(0, 1.3 * max(float(F.max()), 1e-9))  # room for the legend
    axes.legend(loc="upper left", frameon=False)
    toughness = f"{float(result.U_T):.5g}" + (f" ± {error:.1g}" if np.isfinite(error) else "")
    axes.set_title(f"tensile toughness $U_T$ = {toughness} mJ, the area below F(u)")
