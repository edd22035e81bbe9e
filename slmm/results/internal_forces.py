"""Internal nodal forces: what the stresses of the elements ask of their nodes.

They are zero where nothing but elements acts on a node; on a loaded or held boundary they are the forces that it
carries, exactly those that the program put there, whatever the mesh.
"""

from __future__ import annotations

import numpy as np

from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named
from slmm.mechanics.kinematics import deformation_gradients, piola_stresses


def nodal_internal_forces(results: ElementResults) -> np.ndarray:
    """Sum over the elements of  P . dN/dX  (n, d), N: the loads and reactions that balance the stresses.

    Examples
    --------
    A square, pulled along x by 100 MPa.

    >>> from slmm.mechanics.elasticity import Elasticity
    >>> from slmm.mechanics.element_results import linear_elastic
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> pulled = linear_elastic(
    ...     square, {"CPE4": np.array([[0, 1, 2, 3]])}, 1e-3 * square * [1, 0], Elasticity(100e3, 0.0)
    ... )
    >>> (nodal_internal_forces(pulled).round(9) + 0.0).tolist()
    [[-50.0, 0.0], [50.0, 0.0], [50.0, 0.0], [-50.0, 0.0]]
    """
    total = np.zeros_like(results.points)
    for name, nodes in results.cells.items():
        element, X = element_named(name), results.points[nodes]
        P = results.stress[name]
        if results.method != "linear":
            P = piola_stresses(deformation_gradients(X, results.u[nodes], element.gradient_at_points), P)
        jacobian = np.einsum("eni,pnj->epij", X, element.gradient_at_points)
        volume = np.linalg.det(jacobian) * element.weights
        flux = np.einsum("epij,epkj,ep->epik", P, np.linalg.inv(jacobian), volume)
        forces = np.einsum("pnk,epik->eni", element.gradient_at_points, flux)
        for i in range(total.shape[1]):
            total[:, i] += np.bincount(nodes.ravel(), forces[..., i].ravel(), len(total))
    return results.thickness * total
