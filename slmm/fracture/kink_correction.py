"""The direction of a kink from finite element models of the kinked crack (Frankl et al.; thesis 3.2.4.2).

J of a crack that has not kinked yet points off the direction that it takes, the more so the larger K_II is. Here the
crack gets a short straight increment, J is evaluated at the new tip, and the increment is turned until J points along
it: then the release rate is largest straight on. J is taken from the stress intensities at the new tip,
(K_I^2 + K_II^2, -2 K_I K_II)/E', which scatter less from mesh to mesh than J across the crack.

How long the increment is matters where a stress T parallel to the crack acts: it turns the angle by a share of
T sqrt(increment) / K_I. Two increments tell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slmm.fracture.loading import crack_tip_loading
from slmm.mechanics.element_results import ElementResults


@dataclass(frozen=True)
class CorrectedKink:
    """Outcome of the iteration.

    Parameters
    ----------
    angle : float
        From the crack's direction to the increment's, rad.
    energy_release_rate : float
        At the tip of the increment, N/mm.
    angles, off : ndarray (k,)
        Of each model solved: the increment's angle, and the angle from it to J, rad.
    converged : bool
        Whether J points along the increment, to the tolerance.
    """

    angle: float
    energy_release_rate: float
    angles: np.ndarray
    off: np.ndarray
    converged: bool


def corrected_kink(
    solve: Callable[[np.ndarray], ElementResults],
    crack: np.ndarray,
    increment: float,
    start: float = 0.0,
    tolerance: float = np.radians(0.1),
    most: int = 12,
) -> CorrectedKink:
    """Turn a short increment of a crack until J at its tip points along it.

    Parameters
    ----------
    solve : callable
        Makes the results of the model with a crack given by its points (n, 2), mm, the last one the tip.
    crack : array_like (n, 2)
        mm.
    increment : float
        Length of the straight piece that the crack gets, mm: short against the crack.
    start : float
        First angle, rad, as from one of the criteria in `slmm.fracture.kinking`.
    tolerance : float
        Of the angle between the increment and J, rad.
    most : int
        Models at most.

    Raises
    ------
    ValueError
        When the stress intensities at the tip of an increment are not known, or it is closed; the message has its
        status.

    Examples
    --------
    See ``validation/crack_tips.py``: a crack in a plate, inclined to the load.
    """
    crack = np.asarray(crack, dtype=float)
    along = crack[-1] - crack[-2]
    direction = np.arctan2(along[1], along[0])
    angles: list[float] = []
    off: list[float] = []
    angle, rate = start, np.nan
    while len(angles) < most:
        heading = direction + angle
        tip = crack[-1] + increment * np.array([np.cos(heading), np.sin(heading)])
        loading = crack_tip_loading(solve(np.concatenate([crack, tip[None]])))
        distance = np.hypot(loading.x.values - tip[0], loading.y.values - tip[1])
        here = loading.isel(tip=int(np.argmin(distance)))
        K_I, K_II = float(here.K_I), float(here.K_II)
        if not K_I > 0:
            raise ValueError(f"increment of {np.degrees(angle):.4g} degrees: {here.status.item()}")
        rate = float(here.G)
        angles.append(angle)
        off.append(float(np.arctan2(-2 * K_I * K_II, K_I**2 + K_II**2)))
        if abs(off[-1]) <= tolerance:
            break
        # J's direction itself first, then the secant through the last two
        slope = (off[-1] - off[-2]) / (angles[-1] - angles[-2]) if len(angles) > 1 else -1.0
        angle -= off[-1] / slope
    return CorrectedKink(angles[-1], rate, np.array(angles), np.array(off), abs(off[-1]) <= tolerance)
