"""Half of a body that is symmetric about a straight crack line, as a finite element model.

Structured 8-node elements with 2 x 2 points, as in Paper A; xi = 0 is the crack line, eta runs along it from
the mouth inwards. In plane stress the stiffness is K = (K_a + nu K_b) / (1 - nu^2) for E = 1, so a body is
assembled once for all Poisson's ratios. The crack line is left open: one factorisation then gives its
compliance for opening (symmetric) and sliding (antisymmetric) alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
import skfem
from skfem.helpers import sym_grad


@skfem.BilinearForm
def _normal_and_shear(u, v, _):
    e, d = sym_grad(u), sym_grad(v)
    # engineering shear: (1 - nu)/2 * gamma gamma' = (1 - nu) * 2 e_xy d_xy
    return e[0, 0] * d[0, 0] + e[1, 1] * d[1, 1] + 2 * e[0, 1] * d[0, 1]


@skfem.BilinearForm
def _lateral(u, v, _):
    e, d = sym_grad(u), sym_grad(v)
    return e[0, 0] * d[1, 1] + e[1, 1] * d[0, 0] - 2 * e[0, 1] * d[0, 1]


class HalfBody:
    """Finite element model of the half body xi >= 0, E = 1 MPa, thickness 1 mm, plane stress.

    Parameters
    ----------
    across, along : ndarray
        Element ends across (xi-like) and along (eta-like) the crack line, both from 0.
    place : callable
        Maps the square's coordinates (across, along) to (xi, eta); (0, along) must go to xi = 0.
    held : callable
        Tells from the square's coordinates (across, along) and the direction (0: xi, 1: eta) whether an
        unknown is prescribed.

    Attributes
    ----------
    line_eta : ndarray
        Positions of the free nodes on the crack line, from the mouth inwards, mm.
    line : tuple of ndarray
        Indices of their xi- and eta-displacements among the free unknowns.
    """

    def __init__(
        self,
        across: np.ndarray,
        along: np.ndarray,
        place: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
        held: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    ) -> None:
        """Divide the square, place it and assemble its stiffness."""
        square = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(across, along))
        element = skfem.ElementVector(skfem.ElementQuadS2())
        corner_dofs = skfem.Basis(square, element, intorder=1)
        at = corner_dofs.doflocs  # in the square's coordinates
        mesh = replace(square, doflocs=np.array(place(*square.doflocs)))
        self.basis = skfem.Basis(mesh, element, intorder=3)
        self.direction = np.zeros(self.basis.N, dtype=int)
        for dofs in (self.basis.nodal_dofs, self.basis.facet_dofs):
            self.direction[dofs[1::2]] = 1
        self.where = self.basis.doflocs
        self.held = held(at[0], at[1], self.direction)
        self.free = ~self.held
        local = np.cumsum(self.free) - 1
        on_line = (at[0] < 1e-12) & self.free
        order = [np.flatnonzero(on_line & (self.direction == d)) for d in (0, 1)]
        order = [dofs[np.argsort(self.where[1, dofs])] for dofs in order]
        self.line_eta = self.where[1, order[0]]
        self.line = (local[order[0]], local[order[1]])
        self.strip = np.flatnonzero(square.p[0][square.t[:4]].min(axis=0) < 1e-12)
        self._Ka = _normal_and_shear.assemble(self.basis).tocsr()
        self._Kb = _lateral.assemble(self.basis).tocsr()

    def stiffness(self, nu: float) -> sp.csr_matrix:
        """Stiffness of all unknowns, N/mm."""
        return (self._Ka + nu * self._Kb) / (1 - nu**2)

    def factorise(self, K: sp.csr_matrix) -> spla.SuperLU:
        """Sparse factor of the free unknowns."""
        return spla.splu(
            K[self.free][:, self.free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def unit_solutions(self, lu: spla.SuperLU, direction: int, count: int) -> np.ndarray:
        """Displacements of the free unknowns under a unit force on each of the first ``count`` line nodes."""
        rhs = np.zeros((int(self.free.sum()), count))
        rhs[self.line[direction][:count], np.arange(count)] = 1.0
        return lu.solve(rhs)
