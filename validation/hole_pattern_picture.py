"""The toughest hole pattern of the grid and the toughest refined one, and how they break beside a plate without holes.

Designs are those of table1_toughness.csv, hole_pattern_optima.csv and hole_pattern_refined.csv, or the optima of the
spaces whose values are all known. Each is shown with its cracks from its weakest direction; F(u) is that of all three.
Writes examples/hole_pattern.png, half a minute. ``--quick`` takes the smallest space and writes nothing.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
import xarray as xr
from checks import Check, run
from hole_pattern_robustness import toughest
from hole_pattern_spaces import all_listed
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.plate import Values
from slmm.pictures.cracked_part import draw_cracks, draw_part
from slmm.pictures.style import STYLE
from slmm.scene.scene import Scene

TARGET = Path(__file__).parents[1] / "examples" / "hole_pattern.png"
DPI = 80
Drawn = tuple[str, Scene, xr.Dataset]


def weakest(problem: HolePattern, values: Values, name: str) -> Drawn:
    """Name, plate and fracture of the direction of least U_T."""
    scenes = [problem.plate.scene(np.rot90(values, k)) for k in range(problem.directions)]
    each = [(scene, problem.fracture(scene)) for scene in scenes]
    scene, result = min(each, key=lambda pair: float(pair[1].U_T))
    return f"{name}: {float(result.U_T):.0f} mJ", scene, result


def chosen(quick: bool) -> list[Drawn]:
    """The plates of the picture."""
    grid: tuple[float, HolePattern, Values] | None = None
    refined: tuple[float, HolePattern, Values] | None = None
    for space in list(all_listed())[: 1 if quick else None]:
        whole, U_T = space.ranked()[0]
        if grid is None or grid[0] < U_T:
            grid = U_T, HolePattern(space.grid, space.pattern), whole
    for U_T, problem, values, name in [] if quick else toughest():
        if name.startswith("refined"):
            refined = max(refined or (0.0, problem, values), (U_T, problem, values), key=lambda each: each[0])
        elif grid is None or grid[0] < U_T:
            grid = U_T, problem, values
    assert grid is not None
    solid = HolePattern(1, "full", sides="left")
    drawn = [weakest(solid, solid.start, "no holes"), weakest(*grid[1:], f"{grid[1].pattern} {grid[1].grid}")]
    if refined is not None:
        drawn.append(weakest(*refined[1:], "support values refined"))
    return drawn


def picture(drawn: list[Drawn]) -> Figure:
    """Plates with their cracks, and all F(u)."""
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        plates = drawn[1:]
        figure = Figure(figsize=(4.2 * (len(plates) + 1), 4.2), layout="constrained")
        axes = figure.subplots(1, len(plates) + 1, width_ratios=[*[1.0] * len(plates), 1.25])
        for ax, (name, scene, result) in zip(axes, plates, strict=False):
            draw_part(ax, scene)
            draw_cracks(ax, result, result.sizes["step"])
            ax.set_title(name)
        draw_curves(axes[-1], drawn)
    return figure


def draw_curves(ax: Axes, drawn: list[Drawn]) -> None:
    """F(u), the areas below which are U_T."""
    for (name, _, result), colour in zip(drawn, ("0.5", "C0", "C3"), strict=False):
        ax.plot(result.u, result.F, color=colour, label=name)
        ax.fill_between(result.u, result.F, color=colour, alpha=0.12, linewidth=0)
    ax.set_xlabel("displacement u / mm")
    ax.set_ylabel("force F / N")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.legend(loc="upper left")


def main(quick: bool = False) -> list[Check]:
    drawn = chosen(quick)
    figure = picture(drawn)
    if not quick:
        figure.savefig(TARGET, dpi=DPI)
    values = [float(result.U_T) for _, _, result in drawn]
    return [
        Check(name, "U_T, mJ", values[0], value, rule="told")
        for (name, _, _), value in zip(drawn, values, strict=True)
    ]


if __name__ == "__main__":
    run(main, __doc__)
