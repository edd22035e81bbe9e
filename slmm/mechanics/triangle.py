"""The quadratic triangle: shape functions in closed form, their gradients, and where a point lies in an element."""

from __future__ import annotations

import numpy as np

from slmm.mechanics.element_types import ELEMENT_TYPES

#: reference coordinates of the six nodes, corners first, then the middles of edges 0-1, 1-2, 2-0
NODES = ELEMENT_TYPES["triangle6"].element.nodes


def shape(xi: np.ndarray) -> np.ndarray:
    """Shape functions (k, 6) at reference coordinates (k, 2).

    Examples
    --------
    >>> np.array_equal(shape(NODES), np.eye(6))
    True
    """
    r, t = xi.T
    q = 1 - r - t
    return np.stack(
        [q * (2 * q - 1), r * (2 * r - 1), t * (2 * t - 1), 4 * q * r, 4 * r * t, 4 * q * t], axis=-1
    )


def gradients(xi: np.ndarray) -> np.ndarray:
    """Derivatives (k, 6, 2) of the shape functions by the reference coordinates (k, 2)."""
    r, t = xi.T
    q, zero = 1 - r - t, np.zeros_like(r)
    by_r = [1 - 4 * q, 4 * r - 1, zero, 4 * (q - r), 4 * t, -4 * t]
    by_t = [1 - 4 * q, zero, 4 * t - 1, -4 * r, 4 * r, 4 * (q - t)]
    return np.stack([np.stack(by_r, axis=-1), np.stack(by_t, axis=-1)], axis=-1)


def nodal_strain(points: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Strain xx, yy, gamma_xy (m, 6, 3) at the nodes of m elements.

    Parameters
    ----------
    points, u : ndarray (m, 6, 2)
        Nodes and their displacements, mm.
    """
    local = gradients(NODES)
    jacobian = np.einsum("pna,mni->mpia", local, points)
    gradient = np.einsum("pna,mni->mpia", local, u) @ np.linalg.inv(jacobian)
    return np.stack(
        [gradient[..., 0, 0], gradient[..., 1, 1], gradient[..., 0, 1] + gradient[..., 1, 0]], axis=-1
    )


def reference_coordinates(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Reference coordinates (k, 2) of points (k, 2) in elements with nodes (k, 6, 2): Newton's method."""
    xi = np.full(points.shape, 1 / 3)
    for _ in range(8):
        residual = points - np.einsum("kn,kni->ki", shape(xi), nodes)
        jacobian = np.einsum("kna,kni->kia", gradients(xi), nodes)
        xi = np.clip(xi + np.linalg.solve(jacobian, residual[..., None])[..., 0], -1.0, 2.0)
    return xi
