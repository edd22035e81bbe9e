"""Curves of a fracture process: force over displacement, the equilibrium path, critical displacements by step."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from slmm.pictures.cracked_part import first_steps
from slmm.pictures.style import CRITICAL, PALETTE


def draw_force(axes: Axes, result: xr.Dataset) -> None:
    """F(u) with the area below it, the equilibrium path beside it, and the critical state of each step."""
    u, F = result.u.values, result.F.values
    axes.fill_between(u, F, color=PALETTE[4], alpha=0.3, lw=0, zorder=1)
    axes.plot(u, F, color=PALETTE[0], lw=2.0, zorder=3, label="F(u), displacement controlled")
    _draw_path(axes, result)
    u_c, F_c = result.u_c.values, (result.stiffness * result.u_c).values
    start = result.event.values == "start"
    for which, marker, colour, label in (
        (~start, ".", "0.45", "a crack grows"),
        (start, "x", CRITICAL, "a crack starts"),
    ):
        if which.any():
            axes.plot(u_c[which], F_c[which], marker, color=colour, ms=6, zorder=4, label=label)
    _draw_numbers(axes, result, u_c, F_c)
    highest = max(float(F.max()), float(F_c.max(initial=0.0)), 1e-9)
    axes.set(xlabel="displacement u in mm", ylabel="force F in N", ylim=(0, 1.45 * highest))
    axes.set_xlim(left=0)
    axes.legend(loc="upper left", frameon=False, ncols=2)
    axes.set_title(f"toughness $U_T$ = {toughness_text(result)} mJ, the area below F(u)")


def _draw_path(axes: Axes, result: xr.Dataset) -> None:
    """The equilibrium path, broken where a crack starts at once with its first length."""
    u, F, jump = (result[f"equilibrium_{name}"].values for name in ("u", "F", "jump"))
    first = [0, *np.flatnonzero(jump).tolist(), len(u)]
    for k, (a, b) in enumerate(pairwise(first)):
        axes.plot(u[a:b], F[a:b], color="0.45", lw=1.0, zorder=2, label=None if k else "equilibrium path")


def draw_critical_displacements(axes: Axes, result: xr.Dataset) -> None:
    """What was in question in each step: tips of each crack, and surfaces."""
    step, u_c, crack = (result[f"candidate_{name}"].values for name in ("step", "u_c", "tip"))
    for k, number in enumerate(np.unique(crack[crack >= 0]).tolist()):
        own = crack == number
        order = np.argsort(step[own], kind="stable")
        colour = PALETTE[k % len(PALETTE)]
        axes.plot(
            step[own][order] + 1, u_c[own][order], ".-", color=colour, lw=1.2, ms=4, label=f"crack {number}"
        )
    surfaces = crack < 0
    if surfaces.any():
        axes.plot(step[surfaces] + 1, u_c[surfaces], "x", color=CRITICAL, ms=6, label="a surface")
    steps = np.arange(result.sizes["step"]) + 1
    axes.plot(steps, result.u_load, color="0.45", lw=1.0, ls="--", zorder=1, label="$u$ of the part")
    _draw_numbers(axes, result, steps, result.u_c.values)
    axes.set(xlabel="step", ylabel="critical $u_c$ in mm", title="what was in question in each step")
    axes.set_ylim(0, 1.12 * float(u_c.max(initial=1e-9)))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if len(steps):
        axes.legend(loc="best", frameon=False, ncols=2)


def _draw_numbers(axes: Axes, result: xr.Dataset, x: np.ndarray, y: np.ndarray) -> None:
    """Numbers of cracks at their first steps, as in the picture of the part."""
    for k in first_steps(result):
        axes.annotate(
            str(int(result.tip[k])),
            (x[k], y[k]),
            xytext=(4, 4),
            textcoords="offset points",
            color=CRITICAL,
            weight="bold",
        )


def toughness_text(result: xr.Dataset) -> str:
    """U_T with its error, where that is known."""
    error = float(result.U_T_error)
    return f"{float(result.U_T):.5g}" + (f" ± {float(f'{error:.1g}'):g}" if np.isfinite(error) else "")
