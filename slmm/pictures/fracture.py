"""The picture of a fracture process: cracks by their steps on the part, F(u), and what was in question in each step."""

from __future__ import annotations

import math

import matplotlib
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from slmm.fracture.critical_state import critical_state, number_of_states
from slmm.pictures.cracked_part import (
    STEP_COLOURS,
    draw_cracks,
    draw_numbers,
    draw_open_part,
    draw_part,
    step_scale,
)
from slmm.pictures.fracture_curves import draw_critical_displacements, draw_force
from slmm.pictures.style import STYLE
from slmm.scene.scene import Scene


def plot_fracture(scene: Scene, result: xr.Dataset, magnified: float = 0.0) -> Figure:
    """Crack paths coloured by the step that made them; the force over the displacement; critical displacements.

    In the manner of Figures 6 and 18 of Paper D, the cracks numbered as in the result.

    Parameters
    ----------
    scene : Scene
        What was simulated.
    result : Dataset
        From `slmm.fracture.simulate`.
    magnified : float
        How many times as large displacements are drawn, which shows cracks open at the last critical load; 0 for none.

    Returns
    -------
    Figure
        Not known to pyplot; ``figure.savefig("fracture.pdf")`` writes it.

    Raises
    ------
    ValueError
        When the magnification is negative, or no number.
    """
    check_magnified(magnified)
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(12.5, 6.6), layout="constrained")
        axes = figure.subplot_mosaic([["part", "force"], ["part", "steps"]], width_ratios=(1.0, 1.05))
        part = axes["part"]
        if magnified and number_of_states(result):
            last = number_of_states(result) - 1
            state = critical_state(scene, result, last)
            draw_open_part(part, scene, result, state, magnified)
            draw_numbers(part, result, state, magnified)
            part.set_title(f"at u = {state.u:.3g} mm, displacements {magnified:g} times as large")
        else:
            draw_part(part, scene)
            draw_cracks(part, result, result.sizes["step"])
            draw_numbers(part, result)
            part.set_title("cracks, by their numbers")
        colours = ScalarMappable(step_scale(result), STEP_COLOURS)
        whole = MaxNLocator(integer=True)
        figure.colorbar(colours, ax=part, label="step", shrink=0.7, pad=0.02, aspect=35, ticks=whole)
        draw_force(axes["force"], result)
        draw_critical_displacements(axes["steps"], result)
        figure.suptitle(scene.title or "Fracture", parse_math=False)
    return figure


def check_magnified(magnified: float) -> None:
    """Refuse what no displacements can be multiplied by."""
    if not (math.isfinite(magnified) and magnified >= 0):
        raise ValueError(f"magnified = {magnified!r}: must be a positive number, or 0 for closed cracks")
