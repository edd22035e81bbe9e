"""Energy that a crack releases in its true surroundings, from the compliance of its faces beside a hole or an edge."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from slmm.initiation.contact import tip_opening, until_closed
from slmm.initiation.dipole import mirror_stress
from slmm.initiation.face_compliance import legendre_coefficients
from slmm.initiation.meta_model import polynomial_matrix


def one_degree_less(D: np.ndarray) -> np.ndarray:
    """Samples (2 m, 2 m) at Chebyshev points without the highest degree of the polynomial through them."""
    m = len(D) // 2
    highest = np.cos((m - 1) * np.pi * (np.arange(m) + 0.5) / m)
    keep = np.eye(m) - np.outer(highest, highest) / (highest @ highest)
    keep = np.kron(np.eye(2), keep)
    return keep @ D @ keep.T


class Bend:
    """What a notch's curvature adds to a straight edge: near the mouth not smooth, but known.

    To leading order a surface that bends the other way adds the opposite.
    """

    def __init__(self, curvature: float, mu: float, kappa: float):
        """Of a notch's curvature, 1/mm, and a material's constants."""
        self.curvature = curvature
        self.mu, self.kappa = mu, kappa

    def __call__(self, at: np.ndarray) -> np.ndarray:
        """Stress (2, n, n) at depths by dipoles at the same depths (n,), opening and sliding, MPa/mm^2."""
        if self.curvature == 0:
            return np.zeros((2, len(at), len(at)))
        hole = mirror_stress(at, at, 1 / abs(self.curvature), self.mu, self.kappa)
        edge = mirror_stress(at, at, np.inf, self.mu, self.kappa)
        return -np.sign(self.curvature) * (hole - edge)


def released(
    a: np.ndarray,
    C: np.ndarray,
    D: np.ndarray,
    depths: np.ndarray,
    eta: np.ndarray,
    traction: np.ndarray,
    bend: Bend,
) -> np.ndarray:
    """Incremental energy release rate (n,), N/mm, of cracks of lengths a (n,).

    Parameters
    ----------
    a : ndarray (n,)
        Crack lengths, mm.
    C : ndarray (n, 2, k, k)
        Compliance of the faces in the unbounded body for Legendre tractions, mm^2/MPa.
    D : ndarray (2 m, 2 m)
        Stress by what the surroundings answer, sampled at depths (m,), MPa/mm^2.
    depths, eta : ndarray (m,), (q,)
        Where D and the stress are sampled, mm.
    traction : ndarray (2, q)
        Normal and shear stress on the uncracked path, MPa.
    bend : Bend
        The part of D that is not smooth.
    """
    n, k, m = len(a), C.shape[-1], len(depths)
    t, w = legendre.leggauss(24)
    # dense towards the mouth, where the bend is singular
    x, w = 2 * ((t + 1) / 2) ** 2 - 1, w * (t + 1)
    project = legendre_coefficients(k, x, w)
    at = a[:, None] * (x + 1) / 2
    smooth, near = D.copy(), bend(depths)
    smooth[:m, :m] -= near[0]
    smooth[m:, m:] -= near[1]
    p = np.einsum("kq,nqe,de->ndk", project, _polynomials(eta, at), traction).reshape(n, 2 * k)
    basis = project @ _polynomials(depths, at)
    lift, compliance = np.zeros((n, 2 * k, 2 * m)), np.zeros((n, 2 * k, 2 * k))
    lift[:, :k, :m] = lift[:, k:, m:] = basis
    compliance[:, :k, :k], compliance[:, k:, k:] = C.swapaxes(0, 1)
    answer = lift @ smooth @ lift.swapaxes(1, 2)
    bent = project @ np.stack([bend(points) for points in at]) @ project.T
    answer[:, :k, :k] += bent[:, 0]
    answer[:, k:, k:] += bent[:, 1]
    opening = np.linalg.solve(np.eye(2 * k) - compliance @ answer, compliance @ p[..., None])[..., 0]
    energy = 0.5 * np.einsum("nk,nk->n", p, opening)
    return until_closed(energy, tip_opening(opening[:, :k])) / a


def _polynomials(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """From values at ``nodes`` (k,) to those of the polynomial through them at ``at`` (n, q), shape (n, q, k)."""
    return polynomial_matrix(nodes, at.ravel()).reshape(*at.shape, len(nodes))
