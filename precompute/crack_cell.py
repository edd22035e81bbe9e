"""One crack cell: stiffness for every crack length and stress on the crack path (Paper A, section 2.2.3).

The cell is symmetric about the crack line xi = 0, so its half 0 <= xi <= 1 serves both the symmetric and
the antisymmetric deformation modes, which never couple. One sparse factorisation of the half cell with the
whole crack line open gives the stiffness S of the crack line that `crack_factor` needs, for the symmetric
modes from the xi-displacements of the line and for the antisymmetric ones from its eta-displacements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import skfem
from numpy.polynomial.chebyshev import chebvander

from precompute.grading import Fineness, crack_line, graded
from precompute.half_body import HalfBody
from precompute.modes import Mode
from slmm.mechanics.crack_line import crack_factor

#: half of the cell's height h' = 2 mm in the image space (Paper A, Table 1)
HALF_HEIGHT = 1.0

#: length l' of the cell's straight edges from the curved side to the opposite one, mm (Paper A, Table 1)
LENGTH = 2.0

#: degree of the polynomial through the path stress
PATH_DEGREE = 14


def right_edge(curvature: float) -> float:
    """eta' of the straight edge opposite the curved side, mm.

    The published length of 2 mm includes the extension towards the curved side, whose corners lie at
    eta' = c'; at a hole (c' < 0) the cell reaches less deep than 2 mm.
    """
    return LENGTH + curvature


@dataclass(frozen=True)
class CellResult:
    """What the database keeps of one cell, for E = 1 MPa and a thickness of 1 mm.

    Attributes
    ----------
    K : ndarray, shape (1 + n_lengths, m, m)
        Stiffness between modes, N/mm; the first without a crack (Eq. 7).
    stress : ndarray, shape (m, 3, n_eta)
        Stress xi-xi, eta-eta, xi-eta on the uncracked path for each mode, MPa (Eq. 10).
    """

    K: np.ndarray
    stress: np.ndarray


def cell_body(curvature: float, lengths: np.ndarray, fineness: Fineness) -> HalfBody:
    """Finite element model of half the cell with the curved side eta' = c' xi'^2."""
    end = right_edge(curvature)
    across = graded(HALF_HEIGHT, fineness.tip * lengths[0], np.inf, fineness.growth, fineness.coarsest)
    along = crack_line(lengths, end, fineness, fineness.coarsest)

    def place(xi, depth):
        surface = curvature * xi**2
        return xi, surface + (end - surface) * depth / end

    def held(xi, depth, _):
        return (xi > HALF_HEIGHT - 1e-9) | (depth > end - 1e-9)

    return HalfBody(across, along, place, held)


def solve_cell(
    curvature: float,
    nu: float,
    lengths: np.ndarray,
    eta: np.ndarray,
    modes: list[Mode],
    fineness: Fineness,
) -> CellResult:
    """Stiffness and path stress of one cell in plane stress.

    Parameters
    ----------
    curvature : float
        c' of the curved side eta' = c' xi'^2, 1/mm; negative at a hole.
    nu : float
        Effective Poisson's ratio: nu in plane stress, nu/(1 - nu) in plane strain.
    lengths : ndarray
        Crack lengths a' > 0, ascending, mm.
    eta : ndarray
        Where the path stress is wanted, mm.
    modes : list of Mode
        Deformation modes prescribed on the three straight edges.
    fineness : Fineness
        Of the mesh.
    """
    body = cell_body(curvature, lengths, fineness)
    K = body.stiffness(nu)
    open_body = body.factorise(K)
    symmetric = np.array([mode.symmetric for mode in modes])

    u = np.zeros((len(body.free), len(modes)))
    for k, mode in enumerate(modes):
        dofs = np.flatnonzero(body.held & (body.direction == mode.direction))
        u[dofs, k] = mode(*body.where[:, dofs])
    u_free = -open_body.solve(np.asarray((K @ u)[body.free]))  # with the whole crack line open

    # the tip itself stays closed
    opened = np.searchsorted(body.line_eta, lengths * (1 - 1e-9))
    Psi = np.zeros((len(lengths), len(modes), len(modes)))
    for parity, d in ((True, 0), (False, 1)):
        which = np.flatnonzero(symmetric == parity)
        if len(which) == 0:
            continue
        S = open_body.line_stiffness(d)
        closing = np.zeros((len(u_free), len(which)))  # forces on the line
        closing[body.line[d]] = -S @ u_free[np.ix_(body.line[d], which)]
        u_free[:, which] += open_body.solve(closing)
        y = crack_factor(S, closing[body.line[d]])
        for j, k in enumerate(opened):
            Psi[j][np.ix_(which, which)] = 2 * y[:k].T @ y[:k]  # both halves of the cell
    u[body.free] = u_free

    K0 = 2 * u.T @ (K @ u)
    K0[symmetric[:, None] != symmetric[None, :]] = 0.0
    K0 = 0.5 * (K0 + K0.T)
    stress = path_stress(body, u, nu, eta)
    stress[symmetric, 2] = 0.0
    stress[~symmetric, :2] = 0.0
    return CellResult(np.concatenate([K0[None], K0 - Psi]), stress)


def path_stress(body: HalfBody, u: np.ndarray, nu: float, eta: np.ndarray) -> np.ndarray:
    """Stress on the crack line from the elements beside it, shape (modes, 3, len(eta)), MPa."""
    # the 2 x 2 integration points, where 8-node elements give their best stresses
    inner = 0.5 - np.sqrt(1 / 12)
    points = np.array([[inner, inner, 1 - inner, 1 - inner], [inner, 1 - inner, inner, 1 - inner]])
    strip = skfem.Basis(
        body.basis.mesh, body.basis.elem, elements=body.strip, quadrature=(points, np.full(4, 0.25))
    )
    at = strip.global_coordinates()[1]
    length = np.broadcast_to(np.ptp(at, axis=1, keepdims=True), at.shape)
    rows = np.arange(at.size).reshape(at.shape)
    strain = []
    for pick in ((0, 0), (1, 1), (0, 1)):
        B = sp.csr_matrix((at.size, strip.N))
        for i in range(strip.Nbfun):
            grad = strip.basis[i][0].grad
            value = grad[pick] + grad[pick[::-1]] if pick == (0, 1) else grad[pick]
            columns = np.broadcast_to(strip.element_dofs[i][:, None], at.shape)
            entries = (np.broadcast_to(value, at.shape).ravel(), (rows.ravel(), columns.ravel()))
            B = B + sp.csr_matrix(entries, shape=B.shape)
        strain.append(B @ u)
    exx, eyy, gxy = strain
    stress = np.stack([exx + nu * eyy, eyy + nu * exx, (1 - nu) / 2 * gxy], axis=1) / (1 - nu**2)
    # Strains of the tiny elements at the tips carry round-off; their integral does not. A least-squares
    # polynomial that weighs each point with the length it stands for sees the integral.
    end = min(body.where[1].max(), 1.2 * eta.max())
    near = at.ravel() < end
    weight = np.sqrt(length.ravel()[near])[:, None]
    basis = chebvander(2 * at.ravel()[near] / end - 1, PATH_DEGREE)
    fit = np.linalg.lstsq(weight * basis, weight * stress.reshape(at.size, -1)[near], rcond=None)[0]
    values = chebvander(2 * eta / end - 1, PATH_DEGREE) @ fit
    return values.reshape(len(eta), 3, -1).transpose(2, 1, 0)
