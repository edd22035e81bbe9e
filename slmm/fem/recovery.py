"""Stress at the nodes from a finite element displacement field: superconvergent patch recovery.

Within the elements around a vertex the stress at the integration points, where quadratic triangles are more accurate
than elsewhere, is fitted by a quadratic polynomial (Zienkiewicz and Zhu, 1992). A vertex on the boundary has too few
elements around it and takes the polynomials of its neighbours inside.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from slmm.mechanics import triangle

#: the integration points where the derivatives of quadratic triangles are most accurate; published
POINTS = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
#: points that a patch needs for the six coefficients of its polynomial; computed
FEWEST = 4 * len(POINTS)


def recovered_stress(
    points: np.ndarray, triangles: np.ndarray, u: np.ndarray, C: np.ndarray, interior: np.ndarray
) -> np.ndarray:
    """Stress (n, 3) xx, yy, xy at the nodes of quadratic triangles, MPa.

    Parameters
    ----------
    points, u : ndarray (n, 2)
        Nodes and displacements, mm.
    triangles : ndarray (m, 6)
        Nodes of the elements, corners first.
    C : ndarray (3, 3)
        Stiffness, MPa: sigma = C epsilon.
    interior : ndarray (n,) of bool
        Vertices that elements surround on all sides.
    """
    stress, at = _at_integration_points(points, triangles, u, C)
    vertices = triangles[:, :3]
    n = len(points)
    size = np.ones(n)
    edge = np.linalg.norm(points[vertices] - points[np.roll(vertices, 1, axis=1)], axis=-1)
    np.maximum.at(size, vertices, edge)
    # normal equations of every patch, in coordinates relative to its vertex
    A, b = np.zeros((n, 6, 6)), np.zeros((n, 6, 3))
    for corner in range(3):
        v = vertices[:, corner]
        P = _polynomial((at - points[v, None]) / size[v, None, None])
        np.add.at(A, v, np.einsum("mqi,mqj->mij", P, P))
        np.add.at(b, v, np.einsum("mqi,mqs->mis", P, stress))
    count = np.bincount(vertices.ravel(), minlength=n) * len(POINTS)
    fitted = np.flatnonzero(interior & (count >= FEWEST))
    coefficients = np.zeros((n, 6, 3))
    coefficients[fitted] = np.linalg.solve(A[fitted], b[fitted])
    return _at_nodes(points, triangles, size, coefficients, fitted, stress)


def _at_integration_points(points, triangles, u, C):
    """Stress (m, 3, 3) at the integration points and where these are (m, 3, 2)."""
    local = triangle.gradients(POINTS)
    X = points[triangles]
    jacobian = np.einsum("pna,mni->mpia", local, X)
    gradient = np.einsum("pna,mni->mpia", local, u[triangles]) @ np.linalg.inv(jacobian)
    strain = np.stack(
        [gradient[..., 0, 0], gradient[..., 1, 1], gradient[..., 0, 1] + gradient[..., 1, 0]], axis=-1
    )
    return strain @ C, np.einsum("pn,mni->mpi", triangle.shape(POINTS), X)


def _polynomial(x: np.ndarray) -> np.ndarray:
    """1, x, y, x^2, x y, y^2 (..., 6) at points (..., 2)."""
    x, y = np.moveaxis(x, -1, 0)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def _at_nodes(points, triangles, size, coefficients, fitted, stress):
    """Mean, at every node, of the polynomials of the fitted vertices that share an element with it."""
    n = len(points)
    is_fitted = np.zeros(n, dtype=bool)
    is_fitted[fitted] = True
    corner, node = triangles[:, [0, 1, 2]], triangles
    pairs = np.stack(np.broadcast_arrays(node[:, :, None], corner[:, None, :]), axis=-1).reshape(-1, 2)
    own = pairs[:, 0] == pairs[:, 1]
    # a fitted vertex takes its own polynomial, a midside node those of its edge's ends where these are fitted
    use = is_fitted[pairs[:, 1]] & (own | ~is_fitted[pairs[:, 0]])
    ends = np.zeros((len(triangles), 6, 3), dtype=bool)
    ends[:, 3, [0, 1]] = ends[:, 4, [1, 2]] = ends[:, 5, [2, 0]] = True
    on_edge = ends.ravel()
    has_end = np.zeros(n, dtype=bool)
    has_end[pairs[on_edge & use, 0]] = True
    use &= on_edge | ~has_end[pairs[:, 0]]
    key = np.unique(pairs[use] @ [n, 1])
    at, of = np.divmod(key, n)
    P = _polynomial((points[at] - points[of]) / size[of, None])
    value = np.einsum("ki,kis->ks", P, coefficients[of])
    mean = sp.csr_array((np.ones(len(at)), (at, np.arange(len(at)))), shape=(n, len(at)))
    count = np.bincount(at, minlength=n)
    result = (mean @ value) / np.maximum(count, 1)[:, None]
    # where the body is one element wide, no vertex is surrounded: the mean of the elements around
    alone = count == 0
    total = np.zeros((n, 3))
    np.add.at(total, triangles, np.broadcast_to(stress.mean(axis=1)[:, None], (*triangles.shape, 3)))
    around = np.bincount(triangles.ravel(), minlength=n)
    result[alone] = total[alone] / np.maximum(around, 1)[alone, None]
    return result
