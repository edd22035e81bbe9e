"""Matched asymptotics: crack initiation at sharp and rounded V-notches (Leguillon; thesis section 3.3.4.3).

Around the tip of a V-notch the part is described by its generalised stress intensities k_1 and k_2 alone
(`generalised_intensity` finds them in a displacement field). Energy and stress of a crack on the bisector are then
known: in closed form at a sharp notch (thesis Eq. 3.22, 3.23), from a table at a rounded one whose root radius is
small in the part. Young's modulus and Poisson's ratio are those of plane stress, or their equivalents in plane strain
(`Material.plane_stress_equivalent`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from slmm.mechanics.material import Material
from slmm.mechanics.stress import principal
from slmm.mechanics.williams import (
    decaying_fields,
    half_angle,
    release_coefficient,
    singular_exponent,
    williams_fields,
)


class GeneralisedIntensity(NamedTuple):
    """Generalised stress intensities of a notch, with what is known of their error.

    Attributes
    ----------
    k_1, k_2 : float
        sigma_theta_theta = k_1 r^(lambda_1 - 1), sigma_r_theta = k_2 r^(lambda_2 - 1) on the bisector,
        MPa mm^(1 - lambda). For a crack k = K/sqrt(2 pi).
    misfit : float
        Root mean square of what the series leaves of the displacements, over that of the displacements without
        their rigid motion.
    error_1, error_2 : float
        Largest change of k_1 and k_2 with one term less of either kind, and with the outer half of the annulus.
    """

    k_1: float
    k_2: float
    misfit: float
    error_1: float
    error_2: float


def generalised_intensity(
    displacement: Callable[[np.ndarray], np.ndarray],
    tip: ArrayLike,
    direction: ArrayLike,
    opening: float,
    E: float,
    nu: float,
    inner: float,
    outer: float,
    terms: int = 4,
    decaying: int = 2,
    off_flanks: float = 0.05,
    rings: int = 12,
    rays: int = 48,
) -> GeneralisedIntensity:
    """Fit Williams' series to displacements on an annulus around the tip.

    Least squares over a rigid motion and the first terms of either symmetry, those with complex exponents included.

    Parameters
    ----------
    displacement : callable
        From points (n, 2), mm, to displacements (n, 2), mm.
    tip : array_like (2,)
        Where the flanks meet, mm.
    direction : array_like (2,)
        Bisector, from the tip into the material; its length does not matter.
    opening : float
        Opening angle of the notch, radians.
    E, nu : float
        Plane stress equivalents, E in MPa.
    inner, outer : float
        Radii of the annulus, mm; it must not reach other boundaries.
    terms : int
        Exponents of either symmetry, at least 2.
    off_flanks : float
        Angle between the outermost points and the flanks, radians.
    rings, rays : int
        Number of radii and of directions.

    Returns
    -------
    GeneralisedIntensity

    Raises
    ------
    ValueError
        When the annulus, the direction or the number of points is impossible, or the displacements are not finite.

    Examples
    --------
    The edge of a strip in tension, sigma = E = 1, is a notch with an opening of 180 degrees.

    >>> strip = lambda x: np.stack([-0.3 * x[:, 0], x[:, 1]], axis=1)
    >>> k = generalised_intensity(strip, (0, 0), (1, 0), np.pi, E=1.0, nu=0.3, inner=0.5, outer=1.0)
    >>> round(k.k_1, 6), bool(k.misfit < 1e-9)
    (1.0, True)
    """
    if not 0 < inner < outer:
        raise ValueError(f"inner = {inner!r}, outer = {outer!r}: must be radii with 0 < inner < outer")
    if terms < 2:
        raise ValueError(f"terms = {terms!r}: at least 2, the error is judged with one less")
    bisector = np.asarray(direction, dtype=float)
    if not np.linalg.norm(bisector) > 0:
        raise ValueError(f"direction = {direction!r}: must point from the tip into the material")
    axes = np.array([bisector, [-bisector[1], bisector[0]]]) / np.linalg.norm(bisector)
    widest = half_angle(opening) - off_flanks
    r = np.repeat(np.linspace(inner, outer, rings), rays)
    theta = np.tile(np.linspace(-widest, widest, rays), rings)
    local = np.stack([r * np.cos(theta), r * np.sin(theta)], axis=1)
    u = np.asarray(displacement(np.asarray(tip, dtype=float) + local @ axes), dtype=float)
    if u.shape != local.shape:
        raise ValueError(f"displacement gives shape {u.shape} for points of shape {local.shape}")
    if not np.isfinite(u).all():
        first = int(np.argmin(np.isfinite(u).all(axis=1)))
        raise ValueError(
            f"displacement is not finite {r[first]:.4g} mm from the tip, at {theta[first]:.3g} rad"
        )
    u = u @ axes.T
    half = r >= 0.5 * (inner + outer) - 1e-9 * outer
    k_1, k_2, misfit = fit_series(r, theta, u, opening, E, nu, terms, decaying)
    others = [
        fit_series(r, theta, u, opening, E, nu, terms - 1, decaying)[:2],
        fit_series(r, theta, u, opening, E, nu, terms, max(decaying - 1, 0))[:2],
        fit_series(r[half], theta[half], u[half], opening, E, nu, terms, decaying)[:2],
    ]
    error_1, error_2 = np.abs(np.array(others) - [k_1, k_2]).max(axis=0)
    return GeneralisedIntensity(k_1, k_2, misfit, float(error_1), float(error_2))


def fit_series(
    r: np.ndarray,
    theta: np.ndarray,
    u: np.ndarray,
    opening: float,
    E: float,
    nu: float,
    terms: int,
    decaying: int,
) -> tuple[float, float, float]:
    """k_1, k_2 and relative misfit from displacements (n, 2) along and across the bisector at (r, theta)."""
    x, y = r * np.cos(theta), r * np.sin(theta)
    zero, one = np.zeros_like(r), np.ones_like(r)
    columns: list[np.ndarray] = [np.array([one, zero]), np.array([zero, one]), np.array([-y, x])]
    first = []
    for symmetric in (True, False):
        first.append(len(columns))
        for field in williams_fields(opening, symmetric, terms) + decaying_fields(
            opening, symmetric, decaying
        ):
            value = field.displacement(r, theta, E, nu)
            columns += [value.real, value.imag] if np.iscomplexobj(value) else [value]
    A = np.array([column.ravel() for column in columns]).T
    if A.shape[0] < A.shape[1]:
        raise ValueError(f"{len(r)} points cannot determine {A.shape[1]} amplitudes; take more rings or rays")
    size = np.linalg.norm(A, axis=0)
    b = u.T.ravel()
    amplitude = np.linalg.lstsq(A / size, b, rcond=None)[0] / size
    rigid = A[:, :3] @ np.linalg.lstsq(A[:, :3], b, rcond=None)[0]
    strained = np.linalg.norm(b - rigid)
    misfit = np.linalg.norm(b - A @ amplitude) / strained if strained > 0 else 0.0
    return float(amplitude[first[0]]), float(amplitude[first[1]]), float(misfit)


def sharp_curves(
    a: ArrayLike, k_1: float, k_2: float, opening: float, E: float
) -> tuple[np.ndarray, np.ndarray]:
    """Energy and stress on the bisector of a sharp notch (thesis Eq. 3.22, 3.23).

    Parameters
    ----------
    a : array_like (n,)
        Crack lengths and distances from the tip, > 0, mm.
    k_1, k_2 : float
        Generalised stress intensities, MPa mm^(1 - lambda). A negative k_1 keeps the crack closed and releases
        nothing.
    opening : float
        Opening angle, radians.
    E : float
        Plane stress equivalent of Young's modulus, MPa.

    Returns
    -------
    G_inc : ndarray (n,)
        Incremental energy release rate, N/mm.
    sigma_I : ndarray (n,)
        Maximum principal stress of the uncracked notch, MPa.

    Raises
    ------
    ValueError
        When a length is not positive: the stress is infinite at the tip.

    Examples
    --------
    A crack releases K^2/E at any length.

    >>> G_inc, sigma_I = sharp_curves([0.5, 2.0], 1.0 / np.sqrt(2 * np.pi), 0.0, 0.0, E=1.0)
    >>> bool(np.allclose(G_inc, 1.0)), bool(np.allclose(sigma_I, 1 / np.sqrt(2 * np.pi * np.array([0.5, 2.0]))))
    (True, True)
    """
    a = np.asarray(a, dtype=float)
    if not np.all(a > 0):
        raise ValueError(f"a = {np.min(a)!r}: must be positive, the stress is infinite at a sharp tip")
    G_inc = np.zeros_like(a)
    stress = np.zeros((3, *a.shape))
    for k, opens, symmetric in ((k_1, k_1 > 0, True), (k_2, True, False)):
        field = williams_fields(opening, symmetric, 1)[0]
        stress += k * field.stress(a, np.zeros_like(a))
        if opens:
            G_inc += k**2 * a ** (2 * field.exponent.real - 1) * release_coefficient(opening, symmetric) / E
    return G_inc, principal(*stress)


class CriticalIntensity(NamedTuple):
    """Leguillon's criterion for a sharp notch.

    Attributes
    ----------
    k_1 : float
        Generalised stress intensity at which a crack starts, MPa mm^(1 - lambda_1).
    crack_length : float
        Length with which it starts, mm.
    """

    k_1: float
    crack_length: float


def critical_intensity(opening: float, material: Material) -> CriticalIntensity:
    """Coupled criterion for a sharp notch under k_1 alone, in closed form.

    k_1c = (G_c/B)^(1 - lambda) sigma_c^(2 lambda - 1) and a_c = G_c/(B sigma_c^2) (D. Leguillon, Eur. J. Mech.
    A/Solids 21 (2002) 61-72). A crack (opening 0) gives Griffith's K_Ic/sqrt(2 pi), a straight edge (pi) sigma_c.

    Parameters
    ----------
    opening : float
        Opening angle, radians.
    material : Material
        Its state decides about plane stress or strain.

    Examples
    --------
    >>> PMMA = Material.from_name("PMMA")
    >>> round(critical_intensity(0.0, PMMA).k_1 * float(np.sqrt(2 * np.pi)) / PMMA.K_Ic, 9)
    1.0
    """
    lam = singular_exponent(opening)
    B = release_coefficient(opening) / material.plane_stress_equivalent[0]
    return CriticalIntensity(
        (material.G_c / B) ** (1 - lam) * material.sigma_c ** (2 * lam - 1),
        material.G_c / (B * material.sigma_c**2),
    )
