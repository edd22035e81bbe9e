"""The field at a crack tip: displacements of the stress intensities K_I and K_II (Paper B, Eq. 6, after Anderson).

The tip is the origin, the crack lies on the negative x axis, and u = sqrt(r / 2 pi) / (2 mu) g(theta).
"""

from __future__ import annotations

import numpy as np

from slmm.mechanics.elasticity import Elasticity


def tip_displacement(points: np.ndarray, K: np.ndarray, elasticity: Elasticity) -> np.ndarray:
    """Displacements (..., 2), mm, of stress intensities K = (K_I, K_II), MPa sqrt(mm), at points (..., 2), mm.

    On the crack itself y = +0 is the upper face and y = -0 the lower one.

    Examples
    --------
    >>> steel = Elasticity(210e3, 0.3)
    >>> upper, lower = tip_displacement(np.array([[-1.0, 0.0], [-1.0, -0.0]]), np.array([100.0, 0.0]), steel)
    >>> float(upper[1] - lower[1]), float(8 * 100 / steel.E_prime / np.sqrt(2 * np.pi))  # the opening
    (0.00138299..., 0.00138299...)
    """
    r, theta = np.hypot(points[..., 0], points[..., 1]), np.arctan2(points[..., 1], points[..., 0])
    g, _ = _angular(theta, elasticity.kappa)
    return np.einsum("...,...mi,m->...i", np.sqrt(r / (2 * np.pi)) / (2 * elasticity.mu), g, K)


def tip_gradients(points: np.ndarray, elasticity: Elasticity) -> np.ndarray:
    """Displacement gradients (..., 2, 2, 2) of K_I = 1 and of K_II = 1 (third axis from the end) at points (..., 2)."""
    r, theta = np.hypot(points[..., 0], points[..., 1]), np.arctan2(points[..., 1], points[..., 0])
    g, slope = _angular(theta, elasticity.kappa)
    scale = (1 / (2 * elasticity.mu * np.sqrt(2 * np.pi * r)))[..., None, None]
    by_r, by_theta = scale * g / 2, scale * slope
    c, s = np.cos(theta)[..., None, None], np.sin(theta)[..., None, None]
    return np.stack([c * by_r - s * by_theta, s * by_r + c * by_theta], axis=-1)


def _angular(theta: np.ndarray, kappa: float) -> tuple[np.ndarray, np.ndarray]:
    """g (..., mode, component) and its derivative."""
    c, s, cos, sin = np.cos(theta / 2), np.sin(theta / 2), np.cos(theta), np.sin(theta)
    g = [[c * (kappa - cos), s * (kappa - cos)], [s * (kappa + 2 + cos), -c * (kappa - 2 + cos)]]
    slope = [
        [-s * (kappa - cos) / 2 + c * sin, c * (kappa - cos) / 2 + s * sin],
        [c * (kappa + 2 + cos) / 2 - s * sin, s * (kappa - 2 + cos) / 2 + c * sin],
    ]
    return np.moveaxis(np.array(g), (0, 1), (-2, -1)), np.moveaxis(np.array(slope), (0, 1), (-2, -1))
