"""Energy and stress along the crack at the most critical position: the coupled criterion in one panel."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from slmm.initiation.summary import by_criticality
from slmm.pictures.style import CRITICAL, PALETTE
from slmm.scene.scene import Scene


def draw_criterion(axes: Axes, scene: Scene, result: xr.Dataset) -> None:
    """Energy and stress at the most critical position under the critical load: they meet at 1 and a_c."""
    axes.set(xlabel="crack length a, depth η in mm", ylabel="share of critical value")
    ranked = by_criticality(result)
    critical = result.isel(position=ranked[0]) if ranked else None
    reason = _no_curves(result, critical)
    if critical is None or reason:
        axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
        axes.set_axis_off()
        return
    lf, a_c = float(critical["load_factor"]), float(critical["crack_length"])
    a, G_inc, sigma_I = (critical[name].values for name in ("a", "G_inc", "sigma_I"))
    material = scene.material
    # energy grows with the square of the load, stress with the load
    energy, stress = lf**2 * G_inc / material.G_c, lf * sigma_I / material.sigma_c
    longest = float(np.nanmax(a))
    end = min(longest, 4 * a_c) if a_c > 0 else longest
    at = np.linspace(0.0, end, 400)
    shown = []
    for values, label, colour, dashes in (
        (energy, r"energy, $lf^2\, G_{inc}(a) / G_c$", PALETTE[0], "-"),
        (stress, r"stress, $lf\, \sigma_I(\eta) / \sigma_c$", PALETTE[2], "--"),
    ):
        known = np.isfinite(a) & np.isfinite(values)
        if known.any():
            curve = np.interp(at, a[known], values[known], left=np.nan, right=np.nan)
            axes.plot(at, curve, dashes, color=colour, lw=1.8, label=label)
            shown.append(curve)
    axes.axhline(1.0, color="0.35", lw=0.8)
    if np.isfinite(a_c):
        axes.plot([a_c, a_c], [0.0, 1.0], color=CRITICAL, lw=1.0, ls=":")
        axes.plot(a_c, 1.0, "o", ms=10, mfc="none", mec=CRITICAL, mew=2, label=f"$a_c$ = {a_c:.3g} mm")
    top = float(np.clip(np.nanmax(shown), 1.5, 3.0))
    axes.set(xlim=(0, end), ylim=(0, 1.4 * top))
    axes.set_title(f"load factor {lf:.3f}, governed by {critical['governed_by'].values}", loc="left")
    axes.legend(loc="upper right", ncols=2, frameon=False, borderaxespad=0.1)


def _no_curves(result: xr.Dataset, critical: xr.Dataset | None) -> str:
    """Why there are no curves to show; empty where there are."""
    if "G_inc" not in result:
        return "no curves in the result"
    if critical is None or not np.isfinite(critical["load_factor"]):
        return "no crack starts at any position"
    if not np.isfinite(critical["a"]).any():
        return f"method {critical['used_method'].values} has no curves along a crack path"
    return ""
