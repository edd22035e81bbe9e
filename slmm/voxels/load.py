"""What loads the voxel model: the loadings that it knows, and the nodal forces of a stress on its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.scene.loading import Affine, Loading, plate_edges


@dataclass(frozen=True)
class Problem:
    """A load in the terms of the solver, scaled to about one."""

    scale: float  # what the solution has to be multiplied with
    start: tuple[float, float, float]  # affine field to start from: u_x = a x, u_y = b y, and the shear c
    free_rows: NDArray[np.bool_]
    free_sides: bool
    rigid: tuple[str, ...]
    traction: bool


def pose(loading: Loading, nx: int, ny: int, width: float, height: float, nu: float, E: float) -> Problem:
    """A loading of a plate of voxels of Young's modulus 1.

    Raises
    ------
    ValueError
        When it is none of the three that the solver knows: the whole edge displaced by one strain, bottom and top each
        displaced in y as one, or pulled there uniformly in y.
    """
    free_rows = np.ones((2, ny + 1), bool)
    uniaxial = (-nu, 1.0, 0.0)
    bottom, right, top, left = (loading.at_edge(*edge) for edge in plate_edges(width, height))
    conditions = {condition for condition in (bottom, right, top, left) if condition in loading.conditions}
    if conditions != set(loading.conditions):
        raise ValueError("load: voxels know conditions on the whole edges of a plate alone")
    if len(conditions) == 4 and loading.strain is not None:
        scale = max(abs(e) for e in loading.strain) or 1.0
        e_xx, e_yy, g_xy = (e / scale for e in loading.strain)
        free_rows[:, [0, -1]] = False
        return Problem(scale, (e_xx, e_yy, g_xy), free_rows, False, (), False)
    if conditions == {bottom, top}:
        (u_x, low), (u_x_top, high) = bottom.displacement, top.displacement
        if u_x is None and u_x_top is None and low == Affine() and high == Affine(high.at if high else 0.0):
            free_rows[1, [0, -1]] = False
            return Problem(high.at / height, uniaxial, free_rows, True, ("x",), False)
        pull = top.traction[1]
        free = bottom.is_held == top.is_held == (False, False)
        if free and bottom.traction == (0.0, -pull) and top.traction == (0.0, pull):
            return Problem(pull / E, uniaxial, free_rows, True, ("x", "y", "rotation"), True)
    raise ValueError(
        "load: voxels know a strain on all edges, a displacement of the top edge, and a stress on top and bottom"
    )


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
