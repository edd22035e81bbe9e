"""Which way a tip runs on from its stress intensities, by the name of the criterion (Paper D, section 2.2.1)."""

from __future__ import annotations

from collections.abc import Callable

from slmm.fracture.kinking import (
    energy_release_direction,
    local_symmetry,
    maximum_energy_release_rate,
    maximum_tangential_stress,
)

#: the angle of the kink, radians, from K_I and K_II
Direction = Callable[[float, float], float]


def along_J(K_I: float, K_II: float) -> float:
    """Angle of the vector J = (K_I^2 + K_II^2, -2 K_I K_II)/E', the paper's explicit scheme.

    Examples
    --------
    >>> round(along_J(1.0, -0.5), 3), round(maximum_tangential_stress(1.0, -0.5), 3)
    (0.675, 0.702)
    """
    return energy_release_direction([K_I**2 + K_II**2, -2 * K_I * K_II])


DIRECTIONS: dict[str, Direction] = {
    "MTS": maximum_tangential_stress,
    "MERR": maximum_energy_release_rate,
    "local symmetry": local_symmetry,
    "J": along_J,
}
