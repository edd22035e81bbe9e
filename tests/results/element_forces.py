"""What the tests of files share: an element of any type with its nodes, and the forces on the nodes of results."""

import numpy as np

from slmm.fracture.configurational_forces import nodal_configurational_forces
from slmm.mechanics.elasticity import Elasticity

STEEL = Elasticity(210e3, 0.3)


def distorted(element):
    """Nodes (n, d) of an element, stretched and sheared."""
    d = element.dimension
    return element.nodes @ np.array([[2.0, 0.3, 0.1], [-0.2, 1.5, 0.2], [0.1, -0.1, 1.2]])[:d, :d].T


def forces_of(results):
    """Configurational forces (n, d) on the nodes, by the method and the thickness of the results."""
    return nodal_configurational_forces(
        results.points,
        results.cells,
        results.u,
        results.stress,
        results.energy,
        results.method,
        results.thickness,
    )
