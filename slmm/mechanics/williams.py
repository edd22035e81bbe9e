"""Williams' series at the tip of a sharp V-notch, and what a short crack on its bisector releases.

The tip is the origin of polar coordinates (r, theta); theta = 0 is the bisector, pointing into the material, which
fills |theta| < gamma = pi - opening/2. Each term is Airy's function r^(lambda + 1) f(theta) with

    f = A cos(lambda + 1) theta + B cos(lambda - 1) theta     symmetric about the bisector,
    f = A sin(lambda + 1) theta + B sin(lambda - 1) theta     antisymmetric,

and faces without traction (M. L. Williams, J. Appl. Mech. 19 (1952) 526-528). The first term of each kind is scaled
as in thesis Eq. 3.23: sigma_theta_theta(r, 0) = k_1 r^(lambda_1 - 1) and sigma_r_theta(r, 0) = k_2 r^(lambda_2 - 1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from slmm.mechanics.stress import kolosov

#: where lambda_2 passes 1 (102.6 degrees) its field turns into a rotation; it is kept this far away
ROTATION_GAP = 1e-6

#: Gauss points of the factorisation integral in `release_coefficient`: more change nothing
FACTOR_POINTS = 96


def half_angle(opening: float) -> float:
    """Half the angle of the material, gamma = pi - opening/2.

    Raises
    ------
    ValueError
        When the opening is not an angle from 0 (crack) to pi (straight edge).

    Examples
    --------
    >>> round(math.degrees(half_angle(math.pi / 2)), 6)
    135.0
    """
    if not 0.0 <= opening <= math.pi:
        raise ValueError(f"opening = {opening!r}: must be an angle from 0 (crack) to pi (straight edge)")
    return math.pi - 0.5 * opening


def exponents(opening: float, symmetric: bool, n: int) -> np.ndarray:
    """First exponents lambda of the traction-free notch, rigid motions left out.

    They solve sin(2 lambda gamma) + lambda sin(2 gamma) = 0 (symmetric) or the same with a minus (antisymmetric).
    With z = 2 lambda gamma these are |sin z| = c z, which has two roots in every second interval (m pi, m pi + pi):
    real ones where the line c z passes below the arch, a conjugate pair where it passes above.

    Parameters
    ----------
    opening : float
        Opening angle of the notch, radians.
    symmetric : bool
        About the bisector.
    n : int
        How many; of a conjugate pair the one with positive imaginary part counts.

    Returns
    -------
    ndarray of complex, shape (n,)
        Ascending real part. The first is real.

    Examples
    --------
    A crack has all half integers; lambda = 1 is its T-stress.

    >>> np.round(exponents(0.0, True, 4).real, 12)
    array([0.5, 1. , 1.5, 2. ])
    """
    angle = 2 * half_angle(opening)
    c = max(-math.sin(angle), 0.0) / angle
    roots: list[complex] = []
    m = 0 if symmetric else 1
    while len(roots) < n:
        found = arch_roots(m, c)
        if m == 0:
            found = found[1:]  # z = 0
        elif m == 1:
            found = [max(found, key=lambda z: abs(z - angle))]  # the other one, lambda = 1, is a rotation
        roots += [complex(z / angle) for z in found]
        m += 2
    return np.array(roots[:n])


def arch_roots(m: int, c: float) -> list[complex]:
    """Roots of sin y = c (y + m pi) in the arch 0 <= y <= pi, as z = y + m pi; one complex root for a pair."""
    start = m * math.pi

    def above(y: float) -> float:
        return math.sin(y) - c * (y + start)

    top = math.acos(c)
    if above(top) >= 0:
        from scipy.optimize import brentq  # smooth surfaces need none, and it takes long to load

        first = brentq(above, 0.0, top, xtol=1e-15, rtol=1e-15) if m > 0 and c > 0 else 0.0
        last = brentq(above, top, math.pi, xtol=1e-15, rtol=1e-15) if c > 0 else math.pi
        return [complex(first + start), complex(last + start)]
    # sin(p + iq): c (p + m pi) = sin p cosh q and c q = cos p sinh q, solved for q and p in turn, then by Newton
    p, q = top, 0.0
    for _ in range(50):
        q = math.acosh(max(c * (p + start) / math.sin(p), 1.0 + 1e-12))
        p = math.acos(c * q / math.sinh(q))
    y = complex(p, q)
    for _ in range(20):
        y -= (np.sin(y) - c * (y + start)) / (np.cos(y) - c)
    return [complex(y + start)]


def singular_exponent(opening: float, symmetric: bool = True) -> float:
    """Exponent lambda_1 (symmetric) or lambda_2 (antisymmetric) of the strongest term.

    Parameters
    ----------
    opening : float
        Opening angle of the notch, radians, from 0 (crack) to pi (straight edge).
    symmetric : bool
        About the bisector.

    Returns
    -------
    float
        lambda_1 grows from 1/2 to 1. lambda_2 grows from 1/2 to 2 and is singular, below 1, up to an opening of
        102.6 degrees only.

    Raises
    ------
    ValueError
        When the opening is not such an angle.

    Examples
    --------
    >>> [round(singular_exponent(np.radians(angle)), 4) for angle in (0, 60, 90, 120)]
    [0.5, 0.5122, 0.5445, 0.6157]
    """
    return float(exponents(opening, symmetric, 1)[0].real)


@dataclass(frozen=True)
class WilliamsField:
    """One term of Williams' series, of unit amplitude.

    With a complex exponent displacements and stresses are complex: their real and their imaginary part are two
    solutions.

    Attributes
    ----------
    exponent : complex
        lambda.
    A, B : complex
        Coefficients of Airy's function, in the unit that makes r^(lambda - 1) a stress in MPa.
    symmetric : bool
        About the bisector.
    """

    exponent: complex
    A: complex
    B: complex
    symmetric: bool

    def stress(self, r: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Stresses sigma_rr, sigma_theta_theta, sigma_r_theta at (r, theta), shape (3, ...), MPa.

        Examples
        --------
        >>> crack = williams_fields(0.0, True, 1)[0]
        >>> np.round(crack.stress(np.array(4.0), np.array(0.0)), 6)
        array([0.5, 0.5, 0. ])
        """
        lam, A, B = _real_if_real(self.exponent, self.A, self.B)
        even, odd = (np.cos, np.sin) if self.symmetric else (np.sin, np.cos)
        sign = 1 if self.symmetric else -1
        up, down = A * even((lam + 1) * theta), B * even((lam - 1) * theta)
        slope = -sign * ((lam + 1) * A * odd((lam + 1) * theta) + (lam - 1) * B * odd((lam - 1) * theta))
        f, curvature = up + down, -((lam + 1) ** 2) * up - (lam - 1) ** 2 * down
        return r ** (lam - 1) * np.array([curvature + (lam + 1) * f, lam * (lam + 1) * f, -lam * slope])

    def displacement(self, r: np.ndarray, theta: np.ndarray, E: float, nu: float) -> np.ndarray:
        """Displacements along the bisector and across it at (r, theta), shape (2, ...), mm.

        Parameters
        ----------
        r, theta : ndarray
            Polar coordinates, r > 0, mm and radians.
        E, nu : float
            Of plane stress, or its equivalents in plane strain (`Material.plane_stress_equivalent`).
        """
        lam, A, B = _real_if_real(self.exponent, self.A, self.B)
        kappa = kolosov(nu)
        even, odd = (np.cos, np.sin) if self.symmetric else (np.sin, np.cos)
        sign = 1 if self.symmetric else -1
        # Kolosov: 2 mu (u_r + i u_theta) = e^(-i theta) (kappa phi - z conj(phi') - conj(psi))
        radial = (kappa - lam) * B * even((lam - 1) * theta) - (lam + 1) * A * even((lam + 1) * theta)
        hoop = sign * ((kappa + lam) * B * odd((lam - 1) * theta) + (lam + 1) * A * odd((lam + 1) * theta))
        scale = r**lam * (1 + nu) / E
        return scale * np.array(
            [
                radial * np.cos(theta) - hoop * np.sin(theta),
                radial * np.sin(theta) + hoop * np.cos(theta),
            ]
        )


def _real_if_real(*values: complex) -> tuple:
    return values if any(abs(v.imag) > 0 for v in values) else tuple(v.real for v in values)


def williams_fields(opening: float, symmetric: bool, n: int) -> list[WilliamsField]:
    """First terms of Williams' series.

    The first one carries sigma_theta_theta = r^(lambda - 1) (symmetric) or sigma_r_theta = r^(lambda - 1)
    (antisymmetric) on the bisector, the others stresses of the order of r^(lambda - 1).

    Parameters
    ----------
    opening : float
        Opening angle of the notch, radians.
    symmetric : bool
        About the bisector.
    n : int
        How many exponents.

    Examples
    --------
    >>> first, T_stress = williams_fields(0.0, True, 2)
    >>> T_stress.exponent.real, bool(abs(T_stress.A + T_stress.B) < 1e-12)
    (1.0, True)
    """
    gamma = half_angle(opening)
    fields = []
    for order, lam in enumerate(exponents(opening, symmetric, n)):
        if not symmetric and abs(lam - 1) < ROTATION_GAP:
            lam = complex(1 + math.copysign(ROTATION_GAP, lam.real - 1))
        A, B = free_faces(lam, gamma, symmetric)
        if order > 0:
            scale = 1 / abs(lam * (lam + 1))
        elif symmetric:
            scale = 1 / (lam * (lam + 1) * (A + B))
        else:
            scale = -1 / (lam * ((lam + 1) * A + (lam - 1) * B))
        fields.append(WilliamsField(complex(lam), complex(A * scale), complex(B * scale), symmetric))
    return fields


def decaying_fields(opening: float, symmetric: bool, n: int) -> list[WilliamsField]:
    """First terms that decay away from the tip, with the negative of the exponents of Williams' series.

    Free faces allow them too. What happens close to the tip, a rounding, a defect or the error of a mesh, acts further
    away through them.

    Examples
    --------
    >>> [field.exponent.real for field in decaying_fields(0.0, False, 2)]
    [-0.5, -1.5]
    """
    gamma = half_angle(opening)
    powers = -exponents(opening, symmetric, n)
    faces = [free_faces(lam, gamma, symmetric) for lam in powers]
    return [
        WilliamsField(complex(lam), complex(A), complex(B), symmetric)
        for lam, (A, B) in zip(powers, faces, strict=True)
    ]


def free_faces(lam: complex, gamma: float, symmetric: bool) -> tuple[complex, complex]:
    """Coefficients A, B of unit length whose tractions vanish at theta = gamma: f = f' = 0."""
    up, down = (lam + 1) * gamma, (lam - 1) * gamma
    even, odd = (np.cos, np.sin) if symmetric else (np.sin, np.cos)
    traction = np.array([[even(up), even(down)], [(lam + 1) * odd(up), (lam - 1) * odd(down)]])
    A, B = np.linalg.svd(traction)[2][-1].conj()
    turn = max(A, B, key=abs)
    return A * abs(turn) / turn, B * abs(turn) / turn


def release_coefficient(opening: float, symmetric: bool = True) -> float:
    """Coefficient E' B of thesis Eq. 3.22 for a crack on the bisector: G_inc = k^2 a^(2 lambda - 1) B.

    The crack parts the notch into two wedges of angle gamma. Mellin's transform of either relates the traction on
    the bisector to the slope of the crack's opening by the ratio

        (sin 2 mu gamma +- mu sin 2 gamma) / (2 (sin^2 mu gamma - mu^2 sin^2 gamma)) = cot(pi mu) H(mu)

    and Wiener and Hopf's method gives, with p = k r^(lambda - 1) on the faces,

        K = sqrt(2) k a^(lambda - 1/2) Gamma(lambda)/Gamma(lambda + 1/2)
            exp(1/pi int_0^inf lambda ln H(it) / (lambda^2 + t^2) dt).

    This is Koiter's way to the edge crack (gamma = pi/2, K = 1.12152 sigma sqrt(pi a)). Then
    E' B = K^2/(2 lambda) at k = a = 1, from G = K^2/E' and a G_inc = int G da.

    Parameters
    ----------
    opening : float
        Opening angle of the notch, radians, from 0 (crack) to pi (straight edge).
    symmetric : bool
        Crack opened by k_1, or sheared by k_2.

    Returns
    -------
    float
        E' B for k as defined above; 2 pi for a crack. It does not depend on Poisson's ratio.

    Examples
    --------
    >>> round(release_coefficient(np.pi), 4), round(release_coefficient(0.0) / np.pi, 4)
    (1.9758, 2.0)
    """
    gamma, lam = half_angle(opening), singular_exponent(opening, symmetric)
    x, w = np.polynomial.legendre.leggauss(FACTOR_POINTS)
    t = np.minimum(lam * np.tan(0.25 * math.pi * (x + 1)), 40.0)  # H = 1 beyond
    sign = 1 if symmetric else -1
    H = (
        np.tanh(math.pi * t)
        * (np.sinh(2 * gamma * t) + sign * t * math.sin(2 * gamma))
        / (2 * (np.sinh(gamma * t) ** 2 - (t * math.sin(gamma)) ** 2))
    )
    factor = math.exp(0.25 * float(w @ np.log(H)))
    K = math.sqrt(2.0) * math.gamma(lam) / math.gamma(lam + 0.5) * factor
    return float(K**2 / (2 * lam))
