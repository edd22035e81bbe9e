"""Results of crack initiation without a computation, for what shows or sums them up."""

import math

import numpy as np
import xarray as xr

from slmm.initiation.positions import find_positions
from slmm.scene.scene import Scene

REASON = "leaves the plate"


def made_up(scene: Scene, positions: int = 24, missing: tuple[int, ...] = ()) -> xr.Dataset:
    """A result with Kirsch's stresses and a straight G_inc, the form of `slmm.failure_indices`."""
    where = find_positions(scene, positions)
    material = scene.material
    n = len(where.s)
    kappa = np.full(n, np.nan)
    for k, outline in enumerate(scene.outlines):
        kappa[where.hole == k] = outline.curvatures(where.s[where.hole == k])
    radius = scene.outlines[0].length / (2 * math.pi) if scene.outlines else 1.0
    # tips have no arc length, and at tips and corners the stress is infinite
    theta = np.nan_to_num(where.s) / radius
    FI = np.abs(1.0 - 2.0 * np.cos(2 * theta)) / 2.2
    a = np.linspace(0.0, 1.0, 41) * np.ones((n, 1))
    lf, a_c = 1 / FI, np.full(n, 0.3)
    sigma_I = FI[:, None] * material.sigma_c * (1 + 2 * a_c[:, None] / radius - 2 * a / radius)
    sigma_I[np.isfinite(where.corner), 0] = np.nan
    G_inc = FI[:, None] ** 2 * material.G_c * a / a_c[:, None]
    status = np.full(n, "ok", dtype=object)
    for i in missing:
        FI[i] = lf[i] = a_c[i] = sigma_I[i] = G_inc[i] = a[i] = np.nan
        status[i] = REASON
    one_each = {
        "x": (where.points[:, 0], "mm"),
        "y": (where.points[:, 1], "mm"),
        "arc_length": (where.s, "mm"),
        "hole": (where.hole, "1"),
        "curvature": (kappa, "1/mm"),
        "failure_index": (FI, "1"),
        "failure_index_error": (np.full(n, np.nan), "1"),
        "load_factor": (lf, "1"),
        "crack_length": (a_c, "mm"),
        "governed_by": (np.where(np.isfinite(FI), "stress and energy", "none"), "1"),
        "status": (status.astype(str), "1"),
        "used_method": (np.full(n, "slmm+ac"), "1"),
        "reason": (np.full(n, ""), "1"),
    }
    curves = {"a": (a, "mm"), "G_inc": (G_inc, "N/mm"), "sigma_I": (sigma_I, "MPa")}
    return xr.Dataset(
        {name: (("position",), values, {"units": units}) for name, (values, units) in one_each.items()}
        | {
            name: (("position", "crack"), values, {"units": units})
            for name, (values, units) in curves.items()
        },
        attrs={"title": scene.title, "method": "slmm+ac", "settings": '{"absolute": Infinity}'},
    )
