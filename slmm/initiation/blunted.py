"""Rounded V-notches whose root radius is small in the part: energy and stress from a table (thesis section 3.3.4.3)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from slmm.initiation.v_notch_table import VNotchTable, load_v_notches
from slmm.mechanics.williams import half_angle, singular_exponent


def root_half_width(radius: float, opening: float) -> float:
    """Distance of the points where arc and flanks touch from the bisector, radius cos(opening/2), mm.

    Raises
    ------
    ValueError
        When the radius is not positive.
    """
    if not (math.isfinite(radius) and radius > 0):
        raise ValueError(f"radius = {radius!r}: must be positive; a sharp notch has `sharp_curves`")
    half_angle(opening)  # refuses what is not an opening
    return radius * math.cos(0.5 * opening)


def blunted_curves(
    a: ArrayLike, k_1: float, radius: float, opening: float, E: float, table: VNotchTable | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Energy and stress on the bisector of a rounded notch that is small in its part.

    The arc of the root touches both flanks; flanks, arc and k_1 tell everything. With an opening of 0 the flanks are
    parallel (U-notch) and k_1 = K/sqrt(2 pi).

    Parameters
    ----------
    a : array_like (n,)
        Crack lengths and distances from the root, >= 0, mm.
    k_1 : float
        Generalised stress intensity of the sharp notch with the same flanks, MPa mm^(1 - lambda_1). A negative one
        keeps the crack closed and releases nothing.
    radius : float
        Of the root, mm.
    opening : float
        Opening angle, radians.
    E : float
        Plane stress equivalent of Young's modulus, MPa.
    table : VNotchTable, optional
        Without it the shipped one.

    Returns
    -------
    G_inc : ndarray (n,)
        Incremental energy release rate, N/mm.
    sigma_I : ndarray (n,)
        Maximum principal stress of the uncracked notch, MPa.

    Raises
    ------
    ValueError
        When a length is negative or the radius not positive.

    Examples
    --------
    The straight edge in tension: G_inc = 1.1215^2 pi/2 sigma^2 a/E.

    >>> G_inc, sigma_I = blunted_curves([0.0, 0.1], 10.0, 1.0, np.pi, E=1000.0)
    >>> np.round(G_inc, 5), np.round(sigma_I, 5)
    (array([0.     , 0.01976]), array([10., 10.]))
    """
    a = np.asarray(a, dtype=float)
    if not np.all(a >= 0):
        raise ValueError(f"a = {np.min(a)!r}: must not be negative")
    table = load_v_notches() if table is None else table
    unit, exponent = root_half_width(radius, opening), singular_exponent(opening)
    G_inc = max(k_1, 0.0) ** 2 * unit ** (2 * exponent - 1) * table.release(opening, a / unit) / E
    sigma_I = (k_1 * unit ** (exponent - 1) * table.bisector_stress(opening, a / unit)).max(axis=0)
    return G_inc, sigma_I


def intensity_from_root_stress(
    sigma_max: float, radius: float, opening: float, table: VNotchTable | None = None
) -> float:
    """k_1 with which the root of a rounded notch carries the stress ``sigma_max``, MPa mm^(1 - lambda_1).

    Parameters
    ----------
    sigma_max : float
        Stress along the surface of the root, at the bisector, MPa.
    radius : float
        Of the root, mm.
    opening : float
        Opening angle, radians.
    table : VNotchTable, optional
        Without it the shipped one.

    Examples
    --------
    >>> round(intensity_from_root_stress(10.0, 1.0, np.pi), 6)
    10.0
    """
    table = load_v_notches() if table is None else table
    unit = root_half_width(radius, opening)
    root = table.bisector_stress(opening, np.zeros(1))[0, 0]
    return float(sigma_max / (root * unit ** (singular_exponent(opening) - 1)))
