"""Compliance of crack faces in an unbounded body: the energy that tractions on the faces release.

By superposition the energy released by a new crack is that of the stress on the uncracked path, applied to
the crack's faces. Written as Legendre polynomials over the crack length, p(eta) = sum_k p_k P_k(2 eta/a - 1),
it is 1/2 p^T C p with a small matrix C(a). In an unbounded body C depends on the notch's curvature only: a
circular hole where it is concave, a half plane where it is straight, a parabolic bulge where it is convex.
Such a body carries no outer supports near the crack, so C bounds from above what a supported part releases.
E C does not depend on Poisson's ratio (plane stress), because stresses in a body under self-equilibrated
tractions do not.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from precompute.grading import Fineness, crack_line, graded
from precompute.half_body import HalfBody
from slmm.mechanics.crack_line import crack_factor

#: outer boundary, in multiples of the larger of notch radius and longest crack
FAR = 60.0


def unbounded_body(curvature: float, lengths: np.ndarray, fineness: Fineness, direction: int) -> HalfBody:
    """Half of an unbounded body with a notch of the given curvature c' (eta' = c' xi'^2).

    ``direction`` 0 is the symmetric half, whose crack line can open, 1 the antisymmetric one; it decides what
    holds the ligament on the far side of a hole.
    """
    longest = lengths[-1]
    finest = fineness.tip * lengths[0]
    if curvature < 0:
        radius = -0.5 / curvature
        end = FAR * max(radius, longest)
        angle = graded(np.pi, finest / radius, np.inf, fineness.growth, 0.15)

        def place(theta, depth):
            return (radius + depth) * np.sin(theta), (radius + depth) * np.cos(theta) - radius

        def held(theta, depth, unknown):
            behind = (theta > np.pi * (1 - 1e-9)) & (unknown == direction)
            return behind | (depth > end * (1 - 1e-9))

        return HalfBody(angle, crack_line(lengths, end, fineness, np.inf), place, held)

    end = FAR * longest
    half_width = end if curvature == 0 else min(end, 0.6 * np.sqrt(end / curvature))
    across = graded(half_width, finest, np.inf, fineness.growth)

    def place_bulge(xi, depth):
        surface = curvature * xi**2
        return xi, surface + (end - surface) * depth / end

    along = crack_line(lengths, end, fineness, np.inf)
    return HalfBody(across, along, place_bulge, lambda _, depth, unknown: depth > end * (1 - 1e-9))


def legendre_loads(line_eta: np.ndarray, length: float, orders: int) -> np.ndarray:
    """Nodal forces of the tractions P_k(2 eta/length - 1) on the quadratic edges of the crack line.

    Returns
    -------
    ndarray, shape (n, orders)
        For the nodes nearer to the mouth than the tip; the tip itself stays closed.
    """
    n = int(np.searchsorted(line_eta, length * (1 - 1e-9)))
    loads = np.zeros((n + 1, orders))
    x, w = legendre.leggauss(orders + 2)
    shape = np.array([0.5 * x * (x - 1), 1 - x**2, 0.5 * x * (x + 1)])
    for first in range(0, n, 2):
        a, b = line_eta[first], line_eta[first + 2]
        eta = a + (b - a) * (x + 1) / 2
        P = legendre.legvander(2 * eta / length - 1, orders - 1)
        loads[first : first + 3] += (shape * w) @ P * (b - a) / 2
    return loads[:n]


def unbounded_compliance(
    curvature: float, lengths: np.ndarray, orders: int, fineness: Fineness
) -> np.ndarray:
    """Compliance of the crack faces for E = 1 MPa and thickness 1 mm, divided by the length squared.

    Parameters
    ----------
    curvature : float
        c' of the notch, 1/mm; negative at a hole.
    lengths : ndarray, shape (n,)
        Crack lengths a' > 0, ascending, mm.
    orders : int
        Number of Legendre polynomials.
    fineness : Fineness
        Of the mesh.

    Returns
    -------
    ndarray, shape (2, n, orders, orders)
        C/a'^2 (1/MPa) for opening (normal traction) and sliding (shear traction).
    """
    # a tip and all nodes beyond it stay closed: a leading block of S is the stiffness of an open part
    C = np.zeros((2, len(lengths), orders, orders))
    for d in (0, 1):
        body = unbounded_body(curvature, lengths, fineness, d)
        S = body.factorise(body.stiffness(0.3)).line_stiffness(d)
        for j, a in enumerate(lengths):
            loads = legendre_loads(body.line_eta, a, orders)
            y = crack_factor(S[: len(loads), : len(loads)], loads)
            C[d, j] = 2 * y.T @ y / a**2  # both halves of the body
    return C
