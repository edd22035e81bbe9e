"""Half of a body that is symmetric about a straight crack line, as a finite element model.

Structured 8-node elements with 2 x 2 points, as in Paper A; xi = 0 is the crack line, eta runs along it from
the mouth inwards. The crack line is left open and eliminated last: the last block of one factorisation is
then the stiffness of the crack line, for opening (symmetric) and sliding (antisymmetric) alike, many times
faster than solving with a right-hand side for every unknown of the line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
import skfem

from slmm.mechanics.crack_line import crack_factor


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
        """Divide the square, place it, and order its unknowns."""
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
        # last, so that they are the last block of the factor
        inner = np.setdiff1d(np.arange(self.free.sum()), np.concatenate(self.line))
        place_on_grid = [np.unique(np.round(x[self.free], 12), return_inverse=True)[1][inner] for x in at]
        self._order = np.concatenate([inner[nested_dissection(*place_on_grid)], *self.line])

    def stiffness(self, nu: float) -> sp.csr_matrix:
        """Stiffness of all unknowns, N/mm."""
        D = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]]) / (1 - nu**2)
        dx = self.basis.dx
        # strains from each unknown of an element at its points: (element, unknown, strain, point)
        B = np.zeros((len(dx), self.basis.Nbfun, 3, dx.shape[1]))
        for i, (shape,) in enumerate(self.basis.basis):
            B[:, i, 0], B[:, i, 1] = shape.grad[0, 0], shape.grad[1, 1]
            B[:, i, 2] = shape.grad[0, 1] + shape.grad[1, 0]
        stress = np.einsum("ab,eibq->eiaq", D, B) * dx[:, None, None, :]
        flat = (len(dx), self.basis.Nbfun, -1)
        K = B.reshape(flat) @ stress.reshape(flat).swapaxes(1, 2)
        dofs = self.basis.element_dofs.T
        rows, columns = (np.broadcast_to(d, K.shape).ravel() for d in (dofs[:, :, None], dofs[:, None, :]))
        return sp.csr_matrix((K.ravel(), (rows, columns)), shape=(self.basis.N, self.basis.N))

    def factorise(self, K: sp.csr_matrix) -> OpenBody:
        """Factor of the body with its crack line open."""
        return OpenBody(K[self.free][:, self.free], self._order, len(self.line_eta))


class OpenBody:
    """Sparse factor of a half body whose crack line is open.

    Parameters
    ----------
    K : sparse matrix, shape (m, m)
        Stiffness of the free unknowns, N/mm.
    order : ndarray, shape (m,)
        In which they are eliminated; the 2 n of the crack line last, xi- before eta-displacements.
    n : int
        Number of free nodes on the crack line.
    """

    def __init__(self, K: sp.csr_matrix, order: np.ndarray, n: int) -> None:
        """Factorise."""
        self._order = order
        self._lu = spla.splu(
            K[order][:, order].tocsc(),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        # SuperLU may still exchange equivalent unknowns; those of the line it keeps last
        at = self._lu.perm_c[-2 * n :] - (len(order) - 2 * n)
        L, U = (factor[-2 * n :, -2 * n :].toarray() for factor in (self._lu.L, self._lu.U))
        S = (L @ U)[np.ix_(at, at)]
        self._line = 0.5 * (S + S.T)

    def solve(self, f: np.ndarray) -> np.ndarray:
        """Displacements (m, k) of the free unknowns under the nodal forces (m, k)."""
        u = np.empty_like(f)
        u[self._order] = self._lu.solve(f[self._order])
        return u

    def line_stiffness(self, direction: int) -> np.ndarray:
        """Stiffness (n, n) of the line's displacements in one direction; all else moves freely, N/mm."""
        n = len(self._line) // 2
        mine, other = np.arange(n) + direction * n, np.arange(n) + (1 - direction) * n
        coupling = self._line[np.ix_(other, mine)]
        y = crack_factor(self._line[np.ix_(other, other)], coupling)
        return self._line[np.ix_(mine, mine)] - y.T @ y


def nested_dissection(i: np.ndarray, j: np.ndarray, leaf: int = 32) -> np.ndarray:
    """Order of elimination for the nodes of a grid of 8-node elements: halves first, what parts them last.

    Parameters
    ----------
    i, j : ndarray, shape (n,)
        Place of each unknown on the grid, counted in half elements: element ends are even.
    leaf : int
        Number of unknowns that are not divided any further.
    """

    def divide(part: np.ndarray) -> list[np.ndarray]:
        if len(part) <= leaf:
            return [part]
        x = max((i[part], j[part]), key=np.ptp)
        middle = 2 * round((int(x.min()) + int(x.max())) / 4)
        if not x.min() < middle < x.max():
            return [part]
        return [*divide(part[x < middle]), *divide(part[x > middle]), part[x == middle]]

    return np.concatenate(divide(np.arange(len(i))))
