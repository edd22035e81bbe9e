"""The bilinear rectangle (Q4, fully integrated) of the voxel model: coefficients, scale, bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.stress import plane_stiffness_constants


def coefficients(hx: float, hy: float, nu: float) -> NDArray[np.float64]:
    """The numbers of which the 8 x 8 element stiffness (E = 1, unit thickness) consists.

    A rectangle's stiffness between two corners depends only on how they lie to each other: the same corner,
    neighbours along x, neighbours along y, or opposite. In this order: four for x-x, four for y-y. The x-y
    coupling is +-P for the same and opposite corners and +-M for neighbours. The one that ends the list
    carries the precision of these numbers into the kernels.

    Parameters
    ----------
    hx, hy : float
        Sides of the voxel, mm.
    nu : float
        Poisson's ratio (plane stress, or its equivalent for plane strain).
    """
    C11, C12, C33 = plane_stiffness_constants(nu)
    flat, steep = hy / hx, hx / hy
    x_x = _by_position(C11 * flat, C33 * steep)
    y_y = _by_position(C33 * flat, C11 * steep)
    return np.array([*x_x, *y_y, (C12 + C33) / 4, (C12 - C33) / 4, 1.0])


def _by_position(along_x: float, along_y: float) -> tuple[float, float, float, float]:
    same = (along_x + along_y) / 3
    return same, along_y / 6 - along_x / 3, along_x / 6 - along_y / 3, -same / 2


def element_matrix(hx: float, hy: float, nu: float) -> NDArray[np.float64]:
    """8 x 8 stiffness for E = 1 and unit thickness; u_x, u_y of corners (0,0), (1,0), (0,1), (1,1)."""
    c = coefficients(hx, hy, nu)
    P, M = c[8], c[9]
    K = np.empty((8, 8))
    for a in range(4):
        sign = 1.0 if a in (0, 3) else -1.0
        for b in range(4):
            position = (a % 2 != b % 2) + 2 * (a // 2 != b // 2)
            K[2 * a, 2 * b], K[2 * a + 1, 2 * b + 1] = c[position], c[4 + position]
            K[2 * a, 2 * b + 1] = sign * (P, M, -M, -P)[position]
            K[2 * a + 1, 2 * b] = sign * (P, -M, M, -P)[position]
    return K


def largest_eigenvalue(hx: float, hy: float, nu: float) -> float:
    """Bound of the Jacobi-scaled stiffness of *any* assembly of such voxels, whatever their densities.

    A = sum rho_e K_e and D = sum rho_e D_e, so the largest eigenvalue of D^-1 A cannot exceed that of
    D_e^-1 K_e.
    """
    K = element_matrix(hx, hy, nu)
    scale = 1 / np.sqrt(np.diag(K))
    return float(np.linalg.eigvalsh(K * scale[:, None] * scale)[-1])
