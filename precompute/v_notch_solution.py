"""Stress on the bisector of a V-notch, and the energy that a crack there releases, under the first Williams term."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import skfem
from numpy.polynomial.chebyshev import chebfit, chebval

from precompute.half_body import HalfBody
from precompute.v_notch_mesh import rounded_body, sharp_body
from precompute.v_notch_spec import NotchSpec
from slmm.mechanics.crack_line import crack_factor
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.williams import release_coefficient, singular_exponent, williams_fields

#: Poisson's ratio of the models; no result depends on it
NU = 0.3
#: the path stress is fitted by a polynomial of this degree in ln(1 + eta/BEND)
PATH_DEGREE, BEND = 24, 0.3


def released_energy(
    body: HalfBody, opening: float, origin: float, symmetric: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Energy released by a crack on the bisector under the first Williams term, E = 1 MPa, thickness 1 mm.

    Parameters
    ----------
    body : HalfBody
        Half of the notch.
    opening : float
        Opening angle, radians.
    origin : float
        eta of the tip that the prescribed displacements belong to, mm.
    symmetric : bool
        Which of the two fields; its amplitude is 1.

    Returns
    -------
    energy : ndarray
        Both halves, N mm; entry j with the tip at the j-th element end.
    u : ndarray
        Displacements without a crack, mm.
    """
    direction = 0 if symmetric else 1
    field = williams_fields(opening, symmetric, 1)[0]
    dofs = np.flatnonzero(body.held)
    xi, eta = body.where[0, dofs], body.where[1, dofs] - origin
    along, across = field.displacement(np.hypot(xi, eta), np.arctan2(xi, eta), 1.0, NU)
    K = body.stiffness(NU)
    u = np.zeros(len(body.free))
    u[dofs] = np.where(body.direction[dofs] == 0, across, along)

    open_body = body.factorise(K)
    u_free = -open_body.solve((K @ u)[body.free][:, None])
    line = body.line[direction]
    S = open_body.line_stiffness(direction)
    closing = np.zeros_like(u_free)
    closing[line] = -S @ u_free[line]
    y = crack_factor(S, closing[line])[:, 0]
    u[body.free] = (u_free + open_body.solve(closing))[:, 0]
    energy = np.concatenate([[0.0], np.cumsum(y**2)])  # 1/2 y^2 in each half
    return energy[::2], u  # the tip at an element end: nodes before it, those in the middle of elements too


def sharp_release(opening: float, symmetric: bool, spec: NotchSpec) -> float:
    """Release coefficient E' B of a sharp notch by finite elements."""
    energy = []
    for fine in (False, True):
        body, tip = sharp_body(opening, spec, fine)
        energy.append(released_energy(body, opening, 0.0, symmetric)[0][tip])
    return float(extrapolated(energy[0], energy[1], order=1)[0])


def rounded_notch(opening: float, spec: NotchSpec) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stress and energy at one opening angle, for k_1 = 1, E = 1 MPa and a root of half width 1.

    Returns
    -------
    length : ndarray (n,)
        0 and the crack lengths from shortest to longest, mm.
    release : ndarray (n,)
        G_inc over the length, N/mm2; at 0 its limit, that of a straight edge under the stress of the root.
    stress : ndarray (2, n)
        Stress across the bisector and along it at these distances, MPa.
    """
    # far away the root is a point: the sharp tip where flanks meet, Creager's origin where they are parallel
    radius = 1 / math.cos(0.5 * opening)
    origin = radius / math.sin(0.5 * opening) - radius if opening > 0 else -0.5 * radius
    energies = []
    for fine in (False, True):
        body, tips = rounded_body(opening, spec, fine)
        energy, u = released_energy(body, opening, origin, True)
        energies.append(energy[: len(tips)])
    length = tips[::2]
    keep = length > spec.shortest * (1 - 1e-9)
    a = length[keep]
    release = extrapolated(energies[0], energies[1][::2], order=1)[0][keep] / a**2
    distance = np.concatenate([[0.0], a])
    stress = bisector_stress(body, u, singular_exponent(opening), distance)
    root = release_coefficient(math.pi) * stress[0, 0] ** 2
    return distance, np.concatenate([[root], release]), stress


def bisector_stress(body: HalfBody, u: np.ndarray, exponent: float, distance: np.ndarray) -> np.ndarray:
    """Stress across and along the bisector, shape (2, len(distance)), MPa.

    Least-squares polynomial in ln(1 + eta/BEND) through the stress of the elements beside the bisector, freed of its
    decrease far away.
    """
    # the 2 x 2 integration points, where 8-node elements give their best stresses
    inner = 0.5 - math.sqrt(1 / 12)
    points = np.array([[inner, inner, 1 - inner, 1 - inner], [inner, 1 - inner, inner, 1 - inner]])
    strip = skfem.Basis(
        body.basis.mesh, body.basis.elem, elements=body.strip, quadrature=(points, np.full(4, 0.25))
    )
    gradient = strip.interpolate(u).grad
    strain = np.array([gradient[0, 0], gradient[1, 1]])
    stress = (strain + NU * strain[::-1]) / (1 - NU**2)
    eta = strip.global_coordinates()[1]
    near = eta < 2 * distance[-1]
    end = math.log1p(2 * distance[-1] / BEND)

    def on_unit_interval(eta):
        return 2 * np.log1p(eta / BEND) / end - 1

    growth = (1 + eta[near]) ** (1 - exponent)
    fit = chebfit(on_unit_interval(eta[near]), (growth * stress[:, near]).T, PATH_DEGREE)
    return chebval(on_unit_interval(distance), fit) / (1 + distance) ** (1 - exponent)


@dataclass(frozen=True)
class NotchResult:
    """What the table keeps of one opening angle, lengths over the root's half width.

    Attributes
    ----------
    length : ndarray (n,)
        0 and the crack lengths.
    release : ndarray (n,)
        E' G_inc/(k_1^2 l^(2 lambda_1 - 1)) over the length at the rounded notch.
    stress : ndarray (2, n)
        Stress across and along the bisector of the rounded notch over k_1 l^(lambda_1 - 1).
    sharp_release : tuple of float
        E' B of the sharp notch for either mode, NaN where its field is not singular.
    """

    length: np.ndarray
    release: np.ndarray
    stress: np.ndarray
    sharp_release: tuple[float, float]


def solve_notch(opening: float, spec: NotchSpec) -> NotchResult:
    """Rounded and sharp notch of one opening angle (radians)."""
    symmetric, antisymmetric = (
        sharp_release(opening, parity, spec) if singular_exponent(opening, parity) < 1 else math.nan
        for parity in (True, False)
    )
    return NotchResult(*rounded_notch(opening, spec), (symmetric, antisymmetric))


def straight_edge(length: np.ndarray) -> NotchResult:
    """The limit of an opening of 180 degrees in tension, in closed form."""
    edge = release_coefficient(math.pi)
    uniform = np.stack([np.ones_like(length), np.zeros_like(length)])
    return NotchResult(length, np.full_like(length, edge), uniform, (edge, math.nan))
