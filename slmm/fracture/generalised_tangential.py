"""Which way a crack runs on from K_I, K_II and the stress T along it (GMTS; Smith, Ayatollahi and Pavier 2001).

At a distance r_c from the tip the tension across a direction is, times sqrt(2 pi r_c),

    cos(angle/2) (K_I cos^2(angle/2) - 3/2 K_II sin(angle)) + T sqrt(2 pi r_c) sin^2(angle),

and the crack runs where it is largest. T counts with the distance: at none of it the criterion is that of
`slmm.fracture.kinking.maximum_tangential_stress`. Tension along the crack turns it farther aside, compression less.

In mode I the crack runs straight on while T sqrt(2 pi r_c) is at most 3/8 K_I. Beyond that tension is least straight
ahead, and largest in two directions, as far to the left as to the right: the path forks, and what decides is a K_II
however small; where there is none, for all digits, the crack is taken to the left.
"""

from __future__ import annotations

import math

import numpy as np

from slmm.fracture.kinking import open_crack

#: T sqrt(2 pi r_c) over K_I from which on a crack in mode I leaves its direction
BIFURCATION = 3 / 8
#: tensions that differ by less than this share are one; round-off of the roots
ALIKE = 1e-12
#: loadings below this share of the largest one are none; round-off
VANISHES = 1e-14
#: roots whose imaginary part is below it are real; round-off where three of them meet
REAL = 1e-4
#: maxima nearer than that are one, radians; round-off where they meet
APART = 1e-4
#: a step of Newton is taken where the tension's curvature is at least that share of all that it is made of; chosen
CURVED = 1e-6


def generalised_tangential_stress(K_I: float, K_II: float, T_root: float) -> float:
    """Direction across the largest tension at a distance r_c from the tip.

    Parameters
    ----------
    K_I, K_II : float
        Stress intensities at the tip, in the same unit.
    T_root : float
        T sqrt(2 pi r_c) in that unit, T the stress along the crack that does not grow towards the tip.

    Returns
    -------
    float
        Angle of the kink, radians, within +-pi.

    Raises
    ------
    ValueError
        When a value is not finite, both stress intensities are zero, or the crack is closed: K_I < -|K_II|/4, or
        K_I < 0 without K_II.

    Examples
    --------
    >>> [round(math.degrees(generalised_tangential_stress(1.0, 0.5, T)), 2) for T in (-0.2, 0.0, 0.2)]
    [-31.79, -40.21, -49.62]
    >>> [round(math.degrees(generalised_tangential_stress(1.0, 0.0, T)), 1) for T in (0.37, 0.38)]
    [0.0, 10.7]
    """
    peaks = _peaks(K_I, K_II, T_root)
    tension = _tension(peaks, K_I, K_II, T_root)
    highest = tension >= tension.max() - ALIKE * max(abs(K_I), abs(K_II), abs(T_root))
    return float(peaks[highest].max())


def lower_fork(K_I: float, K_II: float, T_root: float) -> float:
    """Tension across the second best direction over that across the best one; 0 where there is only one.

    Next to 1 the path forks. Parameters and errors are those of `generalised_tangential_stress`.

    Examples
    --------
    >>> [round(lower_fork(1.0, K_II, T), 3) for K_II, T in ((0.0, 0.3), (0.0, 0.5), (0.01, 0.5))]
    [0.0, 1.0, 0.981]
    """
    tension = np.sort(_tension(_peaks(K_I, K_II, T_root), K_I, K_II, T_root))
    return float(max(tension[-2] / tension[-1], 0.0)) if len(tension) > 1 else 0.0


def _tension(angle: np.ndarray, K_I: float, K_II: float, T_root: float) -> np.ndarray:
    """Across directions, times sqrt(2 pi r_c)."""
    c = np.cos(angle / 2)
    return np.asarray(c * (K_I * c**2 - 1.5 * K_II * np.sin(angle)) + T_root * np.sin(angle) ** 2)


def _peaks(K_I: float, K_II: float, T_root: float) -> np.ndarray:
    """Angles (k,) of the tension's maxima, the faces of the crack not among them."""
    open_crack(K_I, K_II)
    if not math.isfinite(T_root):
        raise ValueError(f"T_root = {T_root!r}: must be finite")
    size = max(abs(K_I), abs(K_II), abs(T_root))
    I, II, T = K_I / size, K_II / size, T_root / size
    # its derivative vanishes; over 3/2 cos(angle/2), times (1 + t^2)^3 with t = tan(angle/4), that is of sixth degree
    polynomial = (
        I * np.array([0, 2, 0, 0, 0, -2, 0])
        - II * np.array([1, 0, -9, 0, -9, 0, 1])
        + T / 3 * np.array([0, 16, 0, -96, 0, 16, 0])
    )
    # what is left of a vanishing K_II would only spoil the roots
    polynomial[np.abs(polynomial) < VANISHES] = 0.0
    roots = np.roots(polynomial)
    t = roots[np.abs(roots.imag) < REAL].real
    angle = 4 * np.arctan(t[np.abs(t) < 1])
    for _ in range(2):
        slope, curvature = _slope_and_curvature(angle, I, II, T)
        good = np.abs(curvature) > CURVED
        angle = angle - np.where(good, slope / np.where(good, curvature, 1.0), 0.0)
    angle = np.sort(angle[_slope_and_curvature(angle, I, II, T)[1] <= CURVED])
    return np.asarray(angle[np.diff(angle, prepend=-np.inf) > APART])


def _slope_and_curvature(angle: np.ndarray, I: float, II: float, T: float) -> tuple[np.ndarray, np.ndarray]:
    half, three = angle / 2, 1.5 * angle
    # cos^3 x = (3 cos x + cos 3x)/4, and sin 2x cos x = (sin x + sin 3x)/2
    slope = (
        -0.375 * I * (np.sin(half) + np.sin(three))
        - 0.375 * II * (np.cos(half) + 3 * np.cos(three))
        + T * np.sin(2 * angle)
    )
    curvature = (
        -0.1875 * I * (np.cos(half) + 3 * np.cos(three))
        + 0.1875 * II * (np.sin(half) + 9 * np.sin(three))
        + 2 * T * np.cos(2 * angle)
    )
    return slope, curvature
