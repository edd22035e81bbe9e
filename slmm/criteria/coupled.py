"""Leguillon's coupled criterion: stress and energy at the same time (Paper A, section 2.1; thesis Eq. 3.20, 3.21)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from slmm.mechanics.material import Material

#: what decides the critical load, by code
GOVERNED_BY = ("stress and energy", "energy", "stress", "none")
BOTH, ENERGY, STRESS, NONE = range(4)

#: points at which curves given by a user are sampled; chosen
SAMPLES = 801


class CriticalLoad(NamedTuple):
    """Result of the coupled criterion.

    Attributes
    ----------
    load_factor : float
        Factor on the load at which a crack starts; infinite where no load of this kind starts one, NaN where the
        curves end before both conditions meet.
    failure_index : float
        1/load_factor.
    crack_length : float
        Length with which the crack starts, mm.
    governed_by : str
        "stress and energy" where both limits are met at once; "energy" where the energy needed is least at a length
        that the stress allows anyway; "stress" where the energy suffices wherever the stress does; "none".
    """

    load_factor: float
    failure_index: float
    crack_length: float
    governed_by: str


@njit(cache=True)
def critical_load(a, G_inc, strength, G_c, sigma_c, complete=False):
    """Load factor, crack length and code of what governs, for curves sampled densely enough.

    Parameters
    ----------
    a : ndarray (n,)
        Crack lengths, ascending from 0, mm.
    G_inc : ndarray (n,)
        Incremental energy release rate, N/mm.
    strength : ndarray (n,)
        What the stress criterion compares with sigma_c for a crack of each length, MPa.
    G_c, sigma_c : float
        Material.
    complete : bool
        No crack can be longer than the last length.
    """
    n = len(a)
    best, at, code = np.inf, np.nan, NONE
    by_energy = np.empty(n)
    by_stress = np.empty(n)
    for i in range(n):
        by_energy[i] = np.sqrt(G_c / G_inc[i]) if G_inc[i] > 0.0 else np.inf
        by_stress[i] = sigma_c / strength[i] if strength[i] > 0.0 else np.inf
    for i in range(n):
        if i > 0:
            # the two limits may cross within the interval
            d0, d1 = by_energy[i - 1] - by_stress[i - 1], by_energy[i] - by_stress[i]
            if d0 * d1 < 0.0 and np.isfinite(d0) and np.isfinite(d1):
                t = d0 / (d0 - d1)
                lf = by_stress[i - 1] + t * (by_stress[i] - by_stress[i - 1])
                if lf < best:
                    best, at, code = lf, a[i - 1] + t * (a[i] - a[i - 1]), BOTH
        lf = max(by_energy[i], by_stress[i])
        if lf < best:
            best, at = lf, a[i]
            code = ENERGY if by_energy[i] >= by_stress[i] else STRESS
    if not np.isfinite(best):
        return np.inf, np.nan, NONE
    if code == ENERGY and at == a[n - 1] and not complete:
        return np.nan, np.nan, NONE  # a longer crack would need less: the curves end too early
    return best, at, code


def coupled_criterion(
    a: ArrayLike, G_inc: ArrayLike, sigma_I: ArrayLike, material: Material, average: bool = False
) -> CriticalLoad:
    """Critical load and crack length from curves along one crack path.

    Both conditions are tested for every length: the released energy G_inc(a) >= G_c, and the stress over the whole
    new crack, which is its smallest value up to a (for a stress that falls along the path, its value at a, thesis
    Eq. 3.20) or its mean (``average``, Eq. 3.21).

    Parameters
    ----------
    a : array_like (n,)
        Crack lengths, mm, ascending; 0 is added where it is missing.
    G_inc : array_like (n,)
        Incremental energy release rate for the load that is applied, N/mm.
    sigma_I : array_like (n,)
        Maximum principal stress in the uncracked part at the distance a from the notch, MPa.
    material : Material
        sigma_c and G_c are used.
    average : bool
        Average the stress over the crack.

    Returns
    -------
    CriticalLoad

    Raises
    ------
    ValueError
        When the curves differ in length, are not finite, or a does not ascend.

    Examples
    --------
    Under a constant stress the energy decides how long the crack is.

    >>> import numpy as np
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> a = np.linspace(0.0, 4.0, 50)
    >>> r = coupled_criterion(a, 0.2 * a, np.full(50, 20.0), material)
    >>> round(r.load_factor, 3), round(r.crack_length, 3), r.governed_by
    (0.5, 2.0, 'stress and energy')
    """
    a, G_inc, sigma_I = (np.asarray(v, dtype=float) for v in (a, G_inc, sigma_I))
    if not (a.ndim == 1 and a.shape == G_inc.shape == sigma_I.shape and len(a) >= 2):
        raise ValueError(
            f"a, G_inc and sigma_I have shapes {a.shape}, {G_inc.shape}, {sigma_I.shape}: "
            "give three curves of one length"
        )
    for name, values in (("a", a), ("G_inc", G_inc), ("sigma_I", sigma_I)):
        if not np.isfinite(values).all():
            raise ValueError(
                f"{name} has values that are not finite, the first at index {np.argmin(np.isfinite(values))}"
            )
    if a[0] < 0 or np.any(np.diff(a) <= 0):
        raise ValueError("a must ascend from 0 or above without repeating a length")
    from scipy.interpolate import PchipInterpolator  # our own curves need none, and it takes long to load

    crack = a > 0
    fine = np.linspace(0.0, 1.0, SAMPLES) ** 2 * a[-1]
    # G_inc rises linearly from zero at a smooth notch: G_inc/a is what interpolates well
    per_length = PchipInterpolator(a[crack], G_inc[crack] / a[crack])(np.maximum(fine, a[crack][0]))
    stress = PchipInterpolator(a, sigma_I)(np.maximum(fine, a[0]))
    lf, length, code = critical_load(
        fine, per_length * fine, stress_over_crack(fine, stress, average), material.G_c, material.sigma_c
    )
    return CriticalLoad(lf, 1 / lf, length, GOVERNED_BY[code])


def stress_over_crack(a: np.ndarray, sigma_I: np.ndarray, average: bool) -> np.ndarray:
    """Smallest or mean stress between the notch and each length, along the last axis, MPa."""
    if average:
        steps = 0.5 * (sigma_I[..., 1:] + sigma_I[..., :-1]) * np.diff(a)
        singular = np.isinf(sigma_I[..., 0])
        steps[singular] = _power_law_steps(a[singular], sigma_I[singular])
        with np.errstate(invalid="ignore"):
            mean = np.cumsum(steps, axis=-1) / a[..., 1:]
        return np.concatenate([sigma_I[..., :1], mean], axis=-1)
    return np.minimum.accumulate(sigma_I, axis=-1)


def _power_law_steps(a: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Integrals (n, m - 1) of stresses (n, m) that are infinite at a = 0, over the steps between lengths (n, m).

    A power law from point to point; the one after the last infinite value holds from the mouth on.
    """
    left, right = slice(None, -1), slice(1, None)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.log(sigma[..., right] / sigma[..., left]) / np.log(a[..., right] / a[..., left])
        steps = np.diff(a * sigma, axis=-1) / (1 + slope)
    smooth = 0.5 * (sigma[..., right] + sigma[..., left]) * np.diff(a)
    steps = np.where(np.isfinite(steps), steps, smooth)
    for row, stress in enumerate(sigma):
        first = int(np.isfinite(stress).argmax())
        steps[row, :first] = 0.0
        steps[row, first - 1] = a[row, first] * stress[first] / (1 + slope[row, first])
    return steps
