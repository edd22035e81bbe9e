"""Linear elastic models of any elements of `slmm.mechanics.elements`, small enough for a direct solve: for checks only.

Plates with notches have `slmm.fem.plate_model`; here the elements, their integration rule and their mesh are what is
being checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults, linear_elastic
from slmm.mechanics.elements import element_named


def solved(
    points: np.ndarray,
    cells: Mapping[str, np.ndarray],
    elasticity: Elasticity | Sequence[Elasticity],
    prescribed: np.ndarray,
    values: np.ndarray,
    region: Mapping[str, np.ndarray] | None = None,
    force: np.ndarray | None = None,
) -> ElementResults:
    """Results of a body that is held, and loaded by nodal forces.

    Parameters
    ----------
    points : ndarray (n, d)
    cells : mapping of str to ndarray (el, k)
    elasticity : Elasticity or sequence of Elasticity
    prescribed, values : ndarray (n, d)
        Which displacements are prescribed, and what they are, mm.
    region : mapping of str to ndarray (el,), optional
        Which material each element is of.
    force : ndarray (n, d), optional
        N, for a thickness of 1 mm; by default none.
    """
    materials = [elasticity] if isinstance(elasticity, Elasticity) else list(elasticity)
    n, d = points.shape
    K = sp.csr_array((n * d, n * d))
    for name, nodes in cells.items():
        number = np.zeros(len(nodes), dtype=int) if region is None else region[name]
        K_e = np.empty((len(nodes), nodes.shape[1] * d, nodes.shape[1] * d))
        for k, material in enumerate(materials):
            K_e[number == k] = _stiffness(name, points[nodes[number == k]], material)
        dofs = (nodes[..., None] * d + np.arange(d)).reshape(len(nodes), -1)
        row, column = np.repeat(dofs, dofs.shape[1], axis=1), np.tile(dofs, dofs.shape[1])
        K = K + sp.csr_array((K_e.ravel(), (row.ravel(), column.ravel())), K.shape)
    u = np.where(prescribed, values, 0.0).ravel()
    used = np.zeros(n, dtype=bool)
    for nodes in cells.values():
        used[nodes] = True
    load = (0.0 if force is None else force.ravel()) - K @ u
    free = np.flatnonzero(~prescribed.ravel() & np.repeat(used, d))
    u[free] = splu(K[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A").solve(load[free])
    return linear_elastic(points, cells, u.reshape(n, d), elasticity, region)


def _stiffness(name: str, X: np.ndarray, elasticity: Elasticity) -> np.ndarray:
    """Stiffness (el, k d, k d) of elements with nodes (el, k, d)."""
    element = element_named(name)
    jacobian = np.einsum("eni,pnj->epij", X, element.gradient_at_points)
    gradient = element.gradient_at_points @ np.linalg.inv(jacobian)
    volume = np.linalg.det(jacobian) * element.weights
    d = X.shape[-1]
    unit = np.eye(d * d).reshape(d * d, d, d)
    # stress of each unit displacement gradient
    C = elasticity.stress(unit).reshape(d, d, d, d)
    K = np.einsum(
        "epnj,ijkl,epml,ep->enimk", gradient, np.moveaxis(C, (0, 1), (2, 3)), gradient, volume, optimize=True
    )
    return K.reshape(len(X), -1, X.shape[1] * d)
