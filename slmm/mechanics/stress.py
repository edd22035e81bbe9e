"""Plane stress: from strains, its principal value, and the constants of plane elasticity.

Whatever the state, a plane problem is one of plane stress with the material's equivalent constants
(`Material.plane_stress_equivalent`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def plane_stiffness_constants(nu: float) -> tuple[float, float, float]:
    """C11, C12 and C33 of plane stress for E = 1, with the shear strain gamma_xy.

    Examples
    --------
    >>> plane_stiffness_constants(0.0)
    (1.0, 0.0, 0.5)
    """
    return 1 / (1 - nu**2), nu / (1 - nu**2), 0.5 / (1 + nu)


def plane_stiffness_matrix(E: float, nu: float) -> np.ndarray:
    """Plane stress (3, 3): sigma = C epsilon with epsilon = (xx, yy, gamma_xy); MPa.

    Examples
    --------
    >>> plane_stiffness_matrix(2.0, 0.0).tolist()
    [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]
    """
    C11, C12, C33 = plane_stiffness_constants(nu)
    return E * np.array([[C11, C12, 0.0], [C12, C11, 0.0], [0.0, 0.0, C33]])


def kolosov(nu: float) -> float:
    """Kolosov's constant of plane stress, 3 - 4 nu' in plane strain, where nu is nu'/(1 - nu').

    Examples
    --------
    >>> kolosov(0.25 / (1 - 0.25)) == 3 - 4 * 0.25
    True
    """
    return (3 - nu) / (1 + nu)


def shear_modulus(E: float, nu: float) -> float:
    """E/(2 (1 + nu)), the same for a material and its plane stress equivalent."""
    return E / (2 * (1 + nu))


def principal(one: ArrayLike, other: ArrayLike, shear: ArrayLike) -> np.ndarray:
    """Maximum principal stress of two normal stresses at right angles and the shear stress between them, MPa.

    Examples
    --------
    >>> float(principal(3.0, 1.0, 0.0)), float(principal(0.0, 0.0, 2.0))
    (3.0, 2.0)
    """
    one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return 0.5 * (one + other) + np.hypot(0.5 * (one - other), shear)


def principal_stress(sigma: ArrayLike) -> np.ndarray:
    """Maximum principal stress of plane stresses (..., 3) given as xx, yy, xy.

    Examples
    --------
    >>> principal_stress(np.array([[3.0, 1.0, 0.0], [0.0, 0.0, 2.0]]))
    array([3., 2.])
    """
    return principal(*np.moveaxis(np.asarray(sigma, dtype=float), -1, 0))
