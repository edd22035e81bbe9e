"""What loads the voxel model: the kinds of load, and the nodal forces of a stress on its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.scene.load_checks import Load


@dataclass(frozen=True)
class Problem:
    """A load in the terms of the solver, scaled to about one."""

    scale: float  # what the solution has to be multiplied with
    start: tuple[float, float, float]  # affine field to start from: u_x = a x, u_y = b y, and the shear c
    free_rows: NDArray[np.bool_]
    free_sides: bool
    rigid: tuple[str, ...]
    traction: bool


def pose(load: Load, nx: int, ny: int, height: float, nu: float, E: float) -> Problem:
    """A load for a plate of voxels of Young's modulus 1; refused unless it is one, and finite."""
    given = [name for name in ("strain", "displacement", "stress") if getattr(load, name) is not None]
    if len(given) != 1:
        raise ValueError(
            f"load has {given or 'nothing'}: exactly one of strain, displacement, stress is needed"
        )
    value = getattr(load, given[0])
    if not np.isfinite(value).all():
        raise ValueError(f"load.{given[0]} = {value!r}: must be finite")
    free_rows = np.ones((2, ny + 1), bool)
    uniaxial = (-nu, 1.0, 0.0)
    if load.strain is not None:
        scale = max(abs(e) for e in load.strain) or 1.0
        e_xx, e_yy, g_xy = (e / scale for e in load.strain)
        free_rows[:, [0, -1]] = False
        return Problem(scale, (e_xx, e_yy, g_xy), free_rows, False, (), False)
    if load.displacement is not None:
        free_rows[1, [0, -1]] = False
        return Problem(load.displacement / height, uniaxial, free_rows, True, ("x",), False)
    assert load.stress is not None
    return Problem(load.stress / E, uniaxial, free_rows, True, ("x", "y", "rotation"), True)


def apply_traction(loads: NDArray[np.float64], edges: NDArray[np.float64], hx: float) -> None:
    """Consistent nodal loads of a unit tension on the material of the bottom and top edge (for E = 1)."""
    bottom, top = (hx / 2 * (np.append(share, 0.0) + np.insert(share, 0, 0.0)) for share in edges)
    x = np.arange(len(top)) - (len(top) - 1) / 2
    force, moment = top.sum() - bottom.sum(), x @ (top - bottom)
    if not min(top.sum(), bottom.sum()) > 0 or max(abs(force), abs(moment) / len(x)) > 1e-3 * top.sum():
        raise ValueError(
            f"load.stress: the material of the top edge carries {top.sum():.6g}, that of the bottom edge "
            f"{bottom.sum():.6g} times the stress, and they are not in equilibrium (a notch cuts them "
            "differently); prescribe a displacement or a strain instead"
        )
    # what is left is rounding of the shares, but a residual cannot fall below it: balance it exactly
    basis = np.array([bottom, bottom * x])
    bottom += np.linalg.solve(basis @ np.array([np.ones_like(x), x]).T, [force, moment]) @ basis
    loads[1, -4, 1:-3] += top
    loads[1, 1, 1:-3] -= bottom
