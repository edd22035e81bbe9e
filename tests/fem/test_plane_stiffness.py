"""The stiffness of quadratic triangles is that of a general form, and passes the patch test."""

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri2
from skfem.models.elasticity import linear_elasticity

from slmm.fem.plane_stiffness import plane_stiffness


def disk():
    """Curved sides at the rim."""
    mesh = MeshTri2.init_circle(2)
    return mesh, np.concatenate([mesh.t, mesh.nvertices + mesh.t2f]).T


@pytest.mark.parametrize("lam, mu", [(1.0, 2.0), (100.0, 0.5), (0.0, 1.0)])
def test_it_is_that_of_a_general_form(lam, mu):
    mesh, triangles = disk()
    wanted = linear_elasticity(lam, mu).assemble(Basis(mesh, ElementVector(ElementTriP2()), intorder=4))
    found = plane_stiffness(mesh, triangles, lam, mu)
    assert np.abs(found - wanted).max() < 1e-13 * np.abs(wanted).max()


def test_a_constant_strain_needs_forces_at_the_rim_alone():
    mesh, triangles = disk()
    x, y = mesh.doflocs
    inside = np.hypot(x, y) < 0.999
    force = plane_stiffness(mesh, triangles, 1.0, 2.0) @ np.stack([x + 2 * y, 3 * x - y], axis=1).ravel()
    force = force.reshape(-1, 2)
    assert np.abs(force[inside]).max() < 1e-12 < 0.1 < np.abs(force[~inside]).max()
