"""Which way a crack runs on from its stress intensities K_I and K_II: the criteria of thesis 3.2.3.

Angles are in radians, measured anticlockwise from the crack's own direction; K_II > 0 (shear stress sigma_xy > 0 ahead
of the tip) turns the crack clockwise. The stress intensities may have any unit: only their ratio matters.

How the loading of the tip changes when the crack kinks is known: the stress intensities at the tip of a kink that has
only just started are k = F(angle) K, whatever the body, and F is a series in angle/pi (Amestoy and Leblond 1992). Up to
60 degrees its error is below 1e-8, at 80 degrees 1e-6 and at 90 degrees 1e-5 (against the singular integral equation of
the kink).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import pi

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from slmm.mechanics.elasticity import Elasticity

#: kinks beyond it are refused: there the series loses its digits; chosen
LARGEST_KINK = pi / 2
#: of |K_II|: by so much a computed K_I may be negative; a crack that is closed more firmly needs contact of its
#: faces; chosen
OVERLAP = 0.25

#: coefficients by their power of angle/pi; published (Amestoy and Leblond 1992)
_F_11 = {
    0: 1.0,
    2: -3 * pi**2 / 8,
    4: pi**2 - 5 * pi**4 / 128,
    6: pi**2 / 9 - 11 * pi**4 / 72 + 119 * pi**6 / 15360,
    8: 5.07790,
    10: -2.88312,
    12: -0.0925,
    14: 2.996,
    16: -4.059,
    18: 1.63,
    20: 4.1,
}
_F_12 = {
    1: -3 * pi / 2,
    3: 10 * pi / 3 + pi**3 / 16,
    5: -2 * pi - 133 * pi**3 / 180 + 59 * pi**5 / 1280,
    7: 12.313906,
    9: -7.32433,
    11: 1.5793,
    13: 4.0216,
    15: -6.915,
    17: 4.21,
    19: 4.56,
}
_F_21 = {
    1: pi / 2,
    3: -4 * pi / 3 - pi**3 / 48,
    5: -2 * pi / 3 + 13 * pi**3 / 30 - 59 * pi**5 / 3840,
    7: -6.176023,
    9: 4.44112,
    11: -1.5340,
    13: -2.0700,
    15: 4.684,
    17: -3.95,
    19: -1.32,
}
_F_22 = {
    0: 1.0,
    2: -4 - 3 * pi**2 / 8,
    4: 8 / 3 + 29 * pi**2 / 18 - 5 * pi**4 / 128,
    6: -32 / 15 - 4 * pi**2 / 9 - 1159 * pi**4 / 7200 + 119 * pi**6 / 15360,
    8: 10.58254,
    10: -4.78511,
    12: -1.8804,
    14: 7.280,
    16: -7.591,
    18: 0.25,
    20: 12.5,
}
_POWERS = np.arange(21)
#: coefficients (2, 2, 21) of F over the powers of angle/pi, and those of its derivative (2, 2, 20)
_SERIES = np.array(
    [
        [[row.get(power, 0.0) for power in range(21)] for row in rows]
        for rows in ((_F_11, _F_12), (_F_21, _F_22))
    ]
)
_SERIES_DERIVATIVE = _SERIES[..., 1:] * _POWERS[1:]


def maximum_tangential_stress(K_I: float, K_II: float) -> float:
    """Direction across the largest tension around the tip (MTS; Erdogan and Sih 1963, thesis Eq. 3.7).

    Parameters
    ----------
    K_I, K_II : float
        Stress intensities at the tip, in the same unit.

    Returns
    -------
    float
        Angle of the kink, radians; in pure mode II 70.53 degrees.

    Raises
    ------
    ValueError
        When a stress intensity is not finite, both are zero, or the crack is closed: K_I < -|K_II|/4, or K_I < 0
        without K_II.

    Examples
    --------
    >>> round(math.degrees(maximum_tangential_stress(1.0, 0.5)), 2)
    -40.21
    """
    I, II = open_crack(K_I, K_II)
    return 2 * math.atan2(-2 * II, I + math.sqrt(I**2 + 8 * II**2))


def minimum_strain_energy_density(K_I: float, K_II: float, elasticity: Elasticity) -> float:
    """Direction of the least strain energy density around the tip (MSED; Sih 1974).

    The density has several minima, and the least of all may lie at the faces of the crack (thesis 3.2.3): only those
    count where the tangential stress is a tension.

    Parameters
    ----------
    K_I, K_II
        See `maximum_tangential_stress`.
    elasticity : Elasticity
        Of the material, with its plane state.

    Returns
    -------
    float
        Angle of the kink, radians.

    Raises
    ------
    ValueError
        See `maximum_tangential_stress`; and when no minimum lies under tension, as in mode I for nu <= 0, where the
        density has a maximum straight ahead.

    Examples
    --------
    >>> round(math.degrees(minimum_strain_energy_density(0.0, 1.0, Elasticity(210e3, 0.3))), 2)
    -82.34
    """
    I, II = open_crack(K_I, K_II)
    kappa = elasticity.kappa
    # but for a factor and a constant the density is a cos + b cos^2 + sin (c + d cos)
    a, b = (kappa - 1) * (I**2 - II**2), 3 * II**2 - I**2
    c, d = -2 * (kappa - 1) * I * II, 4 * I * II
    # its derivative, over tan(angle/2)
    quartic = np.array([d - c, 4 * b - 2 * a, -6 * d, -2 * a - 4 * b, c + d])
    # what is left of a vanishing K_II would only spoil the roots
    quartic[np.abs(quartic) < 1e-14 * np.abs(quartic).max()] = 0.0
    roots = np.roots(quartic)
    angle = 2 * np.arctan(roots[np.isreal(roots)].real)
    cos, sin = np.cos(angle), np.sin(angle)
    curvature = -a * cos - 2 * b * np.cos(2 * angle) - c * sin - 2 * d * np.sin(2 * angle)
    tension = I * np.cos(angle / 2) - 3 * II * np.sin(angle / 2)
    density = np.where((curvature > 0) & (tension > 0), a * cos + b * cos**2 + sin * (c + d * cos), np.inf)
    if not np.isfinite(density).any():
        raise ValueError(
            f"K_I = {K_I:g}, K_II = {K_II:g}, nu = {elasticity.nu:g}: the strain energy density has no minimum where "
            "there is tension; take another criterion"
        )
    at = density.argmin()
    # small roots of the quartic carry errors of 1e-12: a step of Newton takes them away
    slope = -a * sin[at] - b * math.sin(2 * angle[at]) + c * cos[at] + d * math.cos(2 * angle[at])
    return float(angle[at] - slope / curvature[at])


def maximum_energy_release_rate(K_I: float, K_II: float) -> float:
    """Direction in which the crack releases the most energy, with the kink taken into account (MERR).

    Maximises G(angle) = (k_I^2 + k_II^2)/E' with the stress intensities at the tip of a short kink, see
    `kinked_stress_intensities`.

    Parameters
    ----------
    K_I, K_II
        See `maximum_tangential_stress`.

    Returns
    -------
    float
        Angle of the kink, radians; in pure mode II 75.76 degrees.

    Raises
    ------
    ValueError
        See `maximum_tangential_stress`.

    Examples
    --------
    >>> angle = maximum_energy_release_rate(1.0, 0.5)
    >>> k_I, k_II = kinked_stress_intensities(1.0, 0.5, angle)
    >>> round(math.degrees(angle), 2), round((k_I**2 + k_II**2) / (1.0**2 + 0.5**2), 4)
    (-42.03, 1.3343)
    """
    K = np.array(open_crack(K_I, K_II))

    def slope(angle: float) -> float:
        m = angle / pi
        k, derivative = (_SERIES @ m**_POWERS) @ K, (_SERIES_DERIVATIVE @ m ** _POWERS[:-1]) @ K
        return float(k @ derivative)

    return _beyond_tangential_stress(slope, K_I, K_II)


def local_symmetry(K_I: float, K_II: float) -> float:
    """Direction in which a short kink has no mode II (principle of local symmetry, Goldstein and Salganik 1974).

    Parameters
    ----------
    K_I, K_II
        See `maximum_tangential_stress`.

    Returns
    -------
    float
        Angle of the kink, radians; in pure mode II 77.33 degrees.

    Raises
    ------
    ValueError
        See `maximum_tangential_stress`.

    Examples
    --------
    >>> round(math.degrees(local_symmetry(1.0, 0.5)), 2)
    -42.13
    """
    K = np.array(open_crack(K_I, K_II))
    return _beyond_tangential_stress(
        lambda angle: float((_SERIES[1] @ (angle / pi) ** _POWERS) @ K), K_I, K_II
    )


def kinked_stress_intensities(K_I: float, K_II: float, angle: float) -> tuple[float, float]:
    """Stress intensities k_I, k_II at the tip of a kink that has only just started (Amestoy and Leblond 1992).

    Parameters
    ----------
    K_I, K_II
        See `maximum_tangential_stress`; the crack may be closed as well, then as if its faces could overlap.
    angle : float
        Of the kink, radians.

    Raises
    ------
    ValueError
        When a stress intensity is not finite, or the angle beyond 90 degrees.

    Examples
    --------
    Mode II of the crack pulls the kink open.

    >>> k_I, k_II = kinked_stress_intensities(0.0, 1.0, math.radians(-60.0))
    >>> round(k_I, 4), round(k_II, 4)
    (1.168, 0.3079)
    """
    _check_finite(K_I, K_II)
    if not abs(angle) <= LARGEST_KINK:
        raise ValueError(f"angle = {angle!r}: must lie within {LARGEST_KINK:.4f} radians (90 degrees)")
    k_I, k_II = (_SERIES @ (angle / pi) ** _POWERS) @ (K_I, K_II)
    return float(k_I), float(k_II)


def energy_release_direction(J: ArrayLike) -> float:
    """Direction of the vector J, which thesis 3.2.4.2 takes for that of the maximum energy release rate.

    It knows nothing of the kink, since J says what shifting the whole tip would release. Its angle is smaller than that
    of `maximum_energy_release_rate`: by 0.05 degrees for K_II/K_I = 0.1, beyond which Judt and Ricoeur do not trust it,
    by 3.4 for 0.5 and by 12 for 1.

    Parameters
    ----------
    J : array_like (2,)
        Along the crack and across it, N/mm.

    Returns
    -------
    float
        Angle of the kink, radians.

    Raises
    ------
    ValueError
        For another shape, values that are not finite, and a J that does not point ahead.

    Examples
    --------
    >>> round(math.degrees(energy_release_direction([2.16667, -1.73333])), 2)
    -38.66
    """
    J = np.asarray(J, dtype=float)
    if J.shape != (2,) or not np.isfinite(J).all():
        raise ValueError(f"J = {J.tolist()}: must be two finite numbers")
    if not J[0] > 0:
        raise ValueError(
            f"J = {J.tolist()}: must point ahead, J[0] > 0; shifting this tip ahead releases nothing"
        )
    return math.atan2(J[1], J[0])


def _check_finite(K_I: float, K_II: float) -> None:
    if not (math.isfinite(K_I) and math.isfinite(K_II)):
        raise ValueError(f"K_I = {K_I!r}, K_II = {K_II!r}: must be finite")


def open_crack(K_I: float, K_II: float) -> tuple[float, float]:
    """K_I and K_II over their magnitude, when they open the crack.

    Raises
    ------
    ValueError
        See `maximum_tangential_stress`.
    """
    _check_finite(K_I, K_II)
    size = max(abs(K_I), abs(K_II))
    if size == 0.0:
        raise ValueError("K_I = K_II = 0: the crack has no load")
    if -OVERLAP * abs(K_II) > K_I:
        raise ValueError(
            f"K_I = {K_I:g}, K_II = {K_II:g}: the crack is closed, its faces would overlap; K_I must be at least "
            f"-{OVERLAP:g} |K_II|"
        )
    return K_I / size, K_II / size


def _beyond_tangential_stress(function: Callable[[float], float], K_I: float, K_II: float) -> float:
    """Root of a function of the angle between the direction of the largest tension and the largest kink."""
    start = maximum_tangential_stress(K_I, K_II)
    # they turn farther than MTS by a share of the angle's square, which a small angle does not show
    if abs(start) < 1e-8:
        return start
    return brentq(function, 0.9 * start, math.copysign(LARGEST_KINK, start), xtol=1e-14)
