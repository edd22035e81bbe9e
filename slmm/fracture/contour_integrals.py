"""What drives a crack tip, from domains around it: the vector J and the stress intensities K_I and K_II.

A weight q is 1 at the tip, falls to 0 at a radius R and moves the material with it. The energy that this releases is

    J_k = - sum over nodes of  q CF_k  +  integral over both crack faces of  q (e n_k - t . du/dX_k) dS,

the domain form of thesis Eq. 3.14 and 3.15: CF are the nodal configurational forces, n the outward normal, e the energy
density and t the traction. Along a straight crack the energy's term vanishes; across it, it must not be left out where
K_II and a stress parallel to the crack meet (Schmitz and Ricoeur). The traction's term, and the same one in the
interaction integral, is that of `slmm.fracture.face_traction`. The stress intensities follow from the interaction of
the field with that of K_I = 1 or K_II = 1 (Stern, Becker and Dunham 1976).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from slmm.fracture.face_traction import (
    TIP_EDGES,
    LoadedFace,
    edge_shape,
    traction_in_interaction,
    traction_in_j,
)
from slmm.fracture.tip_field import tip_gradients
from slmm.fracture.tips import CrackTip
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named

#: the weight is 1 up to this share of the radius; chosen
PLATEAU = 0.5
#: the fewest edges to infer the strain at the tip from; chosen
FIT_EDGES = 4
#: the strain is inferred from the faces up to this share of what is clear, and used up to half of that; chosen
FIT_SHARE = 0.5
#: powers of the distance in the strain along the faces: in the part that both have alike, and in the opposite part
ALIKE, OPPOSITE = np.arange(3), np.arange(4) - 0.5
#: steps that find a place on an edge whose middle node is not in its middle, at a quarter at the worst; chosen
NEWTON = 6
#: Gauss points per edge of the faces: where quadratic elements' strains are most accurate, and of linear ones
X_SERIES, W_SERIES = np.polynomial.legendre.leggauss(16)
QUADRATIC, LINEAR = np.polynomial.legendre.leggauss(2), np.polynomial.legendre.leggauss(1)


def weight(distance: np.ndarray, radius: float) -> np.ndarray:
    """The weight q at distances from the tip: 1 near it, 0 from the radius outwards."""
    return np.clip((radius - distance) / (radius * (1 - PLATEAU)), 0.0, 1.0)


def j_vector(
    results: ElementResults,
    forces: np.ndarray,
    tip: CrackTip,
    radius: float,
    elasticity: Elasticity | None,
    faces: tuple[LoadedFace, LoadedFace] | None = None,
) -> np.ndarray:
    """J (2,) along the crack's direction and left of it, N/mm.

    Parameters
    ----------
    results : ElementResults
    forces : ndarray (n, 2)
        Nodal configurational forces, N.
    tip : CrackTip
    radius : float
        Of the domain, mm, at most ``tip.clear``.
    elasticity : Elasticity or None
        Of the material at the tip. Without it the energy at the faces is not known, nor the second component: NaN.
    faces : pair of LoadedFace, optional
        From `slmm.fracture.face_traction.loaded_faces`; by default free of traction.

    Raises
    ------
    ValueError
        For a radius that reaches past what is clear.
    """
    _check_clear(tip, radius)
    q = weight(np.linalg.norm(results.points - tip.position, axis=1), radius)
    J = -(q @ forces) @ tip.axes.T / results.thickness
    J[1] = np.nan if elasticity is None else J[1] + face_term(results, tip, radius, elasticity)
    return J if faces is None else J + traction_in_j(faces, q, elasticity, results.method == "mbf")


def _check_clear(tip: CrackTip, radius: float) -> None:
    if not 0 < radius <= tip.clear * (1 + 1e-9):
        x, y = tip.position
        raise ValueError(
            f"radius = {radius:g} mm: at most {tip.clear:g} mm are clear around the tip at ({x:g}, {y:g}) mm"
        )


def face_term(results: ElementResults, tip: CrackTip, radius: float, elasticity: Elasticity) -> float:
    """What the energy of the crack faces adds to J left of the direction, N/mm.

    The strain along the face has the energy density E'/2 times its square; of its part alike on both faces and its
    opposite part, the product alone makes a difference. Next to the tip the finite elements' strain is not good enough:
    there the series that fits it further out takes its place, T + C r + ... and a/sqrt(r) + b sqrt(r) + ...
    """
    r, ds, alike, opposite = _face_strains(results, tip)
    middle = r.mean(axis=1)
    fit = (np.arange(len(r)) >= TIP_EDGES) & (middle < FIT_SHARE * tip.clear)
    jump = -2 * alike * opposite * weight(r, radius) * ds
    # too few edges leave nothing to infer the tip from
    if fit.sum() < FIT_EDGES:
        return float(elasticity.E_prime * jump.sum())
    series = fit & (middle < 0.5 * FIT_SHARE * tip.clear)
    series[:TIP_EDGES] = True
    end = np.linalg.norm(results.points[tip.upper[series][-1, 1]] - tip.position)
    inner = _inner_jump(r[fit], ds[fit], alike[fit], opposite[fit], float(end), radius)
    return float(elasticity.E_prime * (inner + jump[~series].sum()))


def _inner_jump(
    r: np.ndarray, ds: np.ndarray, alike: np.ndarray, opposite: np.ndarray, end: float, radius: float
) -> float:
    """Integral of q times the jump, over E', from the tip to a distance, by series that fit the strains given."""
    # r = end t^2 takes the root out of the integrand; two pieces, as the weight has a kink
    total = 0.0
    kinks = np.sqrt(np.clip([0.0, PLATEAU * radius / end, radius / end], 0.0, 1.0))
    for low, high in pairwise(kinks):
        t = low + (high - low) * (1 + X_SERIES) / 2
        parts = []
        for strain, powers in ((alike, ALIKE), (opposite, OPPOSITE)):
            # errors of the strain that are a share of the singular term count alike at all distances
            scale = np.sqrt(ds * r).ravel()
            basis = (r.ravel()[:, None] / end) ** powers
            fitted = np.linalg.lstsq(basis * scale[:, None], strain.ravel() * scale, rcond=None)[0]
            parts.append((t[:, None] ** 2) ** powers @ fitted)
        q = weight(end * t**2, radius)
        total += np.sum(-2 * parts[0] * parts[1] * q * end * t * W_SERIES) * (high - low)
    return float(total)


def _face_strains(
    results: ElementResults, tip: CrackTip
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """At Gauss points (e, g) of the faces: distance from the tip, length, strain alike on both faces, and opposite."""
    along = tip.axes[0]
    x, w = QUADRATIC if tip.upper.shape[1] == 3 else LINEAR
    shape, slope = edge_shape(tip.upper.shape[1], x)
    # s grows outwards from the tip, against the crack's direction
    s, u = -(results.points[tip.upper] - tip.position) @ along, -results.u[tip.upper] @ along
    r, ds = s @ shape.T, s @ slope.T
    upper = (u @ slope.T) / ds
    lower = _strain_at(
        r.ravel(), *(-(a[tip.lower]) @ along for a in (results.points - tip.position, results.u))
    )
    lower = lower.reshape(r.shape)
    return r, ds * w, (upper + lower) / 2, (upper - lower) / 2


def _strain_at(r: np.ndarray, s: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Strain along a face at distances r (k,) from the tip, of edges whose nodes (e, 2 or 3) are at s and move by u."""
    edge = np.clip(np.searchsorted(s[:, 1], r), 0, len(s) - 1)
    s, u = s[edge], u[edge]
    t = 2 * (r - s[:, 0]) / (s[:, 1] - s[:, 0]) - 1
    for _ in range(NEWTON if s.shape[1] == 3 else 0):
        shape, slope = edge_shape(3, t)
        t = np.clip(t - ((s * shape).sum(axis=1) - r) / (s * slope).sum(axis=1), -1.0, 1.0)
    slope = edge_shape(s.shape[1], t)[1]
    return (u * slope).sum(axis=1) / (s * slope).sum(axis=1)


def stress_intensities(
    results: ElementResults,
    tip: CrackTip,
    radius: float,
    elasticity: Elasticity,
    faces: tuple[LoadedFace, LoadedFace] | None = None,
) -> np.ndarray:
    """K_I and K_II (2,), MPa sqrt(mm), by the interaction integral.

    Parameters and errors are those of `j_vector`; stresses and displacements must be those of linear elasticity.
    """
    total = interaction(results, tip, radius, elasticity, tip_gradients)
    if faces is not None:
        at_nodes = weight(np.linalg.norm(results.points - tip.position, axis=1), radius)
        total = total + traction_in_interaction(faces, at_nodes, elasticity)
    return elasticity.E_prime / 2 * total


def interaction(
    results: ElementResults,
    tip: CrackTip,
    radius: float,
    elasticity: Elasticity,
    gradients: Callable[[np.ndarray, Elasticity], np.ndarray],
) -> np.ndarray:
    """Interaction (m,) of the results with m fields that leave the faces free, N/mm; parameters as of `j_vector`.

    Parameters
    ----------
    gradients : callable
        Displacement gradients (..., m, 2, 2) of the fields at points (..., 2) of the tip's axes, as
        `slmm.fracture.tip_field.tip_gradients`.
    """
    _check_clear(tip, radius)
    total = np.zeros(1)
    for name, nodes in results.cells.items():
        q = weight(np.linalg.norm(results.points[nodes] - tip.position, axis=-1), radius)
        # where the weight is constant nothing is added
        ring = np.ptp(q, axis=1) > 0
        if ring.any():
            total = total + _interaction(results, tip, name, ring, q[ring], elasticity, gradients)
    return total


def _interaction(
    results: ElementResults,
    tip: CrackTip,
    name: str,
    ring: np.ndarray,
    q: np.ndarray,
    elasticity: Elasticity,
    gradients: Callable[[np.ndarray, Elasticity], np.ndarray],
) -> np.ndarray:
    """Interaction (m,) in some elements of one type, N/mm."""
    element, nodes, axes = element_named(name), results.cells[name][ring], tip.axes
    X, u = (results.points[nodes] - tip.position) @ axes.T, results.u[nodes] @ axes.T
    jacobian = np.einsum("eni,pnj->epij", X, element.gradient_at_points)
    gradient = element.gradient_at_points @ np.linalg.inv(jacobian)
    volume = np.linalg.det(jacobian) * element.weights
    H, dq = np.einsum("eni,epnj->epij", u, gradient), np.einsum("en,epnj->epj", q, gradient)
    sigma = axes @ results.stress[name][ring] @ axes.T
    H_tip = gradients(np.einsum("pn,eni->epi", element.shape(element.points), X), elasticity)
    sigma_tip = elasticity.stress(H_tip)
    # sigma_ij u'_i,1 + sigma'_ij u_i,1 - (sigma : grad u') delta_1j
    flux = np.einsum("epij,epmi->epmj", sigma, H_tip[..., 0]) + np.einsum(
        "epmij,epi->epmj", sigma_tip, H[..., 0]
    )
    flux[..., 0] -= np.einsum("epij,epmij->epm", sigma, H_tip)
    return np.einsum("epmj,epj,ep->m", flux, dq, volume)
