"""Which way a tip runs on from its loading, by the name of the criterion (Paper D, section 2.2.1)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from slmm.criteria.distances import point_distance
from slmm.fracture.generalised_tangential import generalised_tangential_stress, lower_fork
from slmm.fracture.kinking import (
    energy_release_direction,
    local_symmetry,
    maximum_energy_release_rate,
    maximum_tangential_stress,
)
from slmm.mechanics.material import Material

#: the angle of the kink, radians, from K_I and K_II
ByIntensities = Callable[[float, float], float]


def along_J(K_I: float, K_II: float) -> float:
    """Angle of the vector J = (K_I^2 + K_II^2, -2 K_I K_II)/E', the paper's explicit scheme.

    Examples
    --------
    >>> round(along_J(1.0, -0.5), 3), round(maximum_tangential_stress(1.0, -0.5), 3)
    (0.675, 0.702)
    """
    return energy_release_direction([K_I**2 + K_II**2, -2 * K_I * K_II])


#: what asks for nothing but the stress intensities
BY_INTENSITIES: dict[str, ByIntensities] = {
    "MTS": maximum_tangential_stress,
    "MERR": maximum_energy_release_rate,
    "local symmetry": local_symmetry,
    "J": along_J,
}
#: the generalised criterion, which asks for T as well
GENERALISED = "GMTS"
#: share of the tension by which two directions are alike; chosen, as loads are that compete
FORKING = 0.005
DIRECTIONS = (*BY_INTENSITIES, GENERALISED)


@dataclass(frozen=True)
class Direction:
    """A criterion for the direction of growth.

    Parameters
    ----------
    name : str
        One of `DIRECTIONS`.
    distance : float
        r_c at which the stress T counts, mm; 0 of criteria that do not ask for it.
    """

    name: str
    distance: float = 0.0

    @property
    def asks_for_T(self) -> bool:
        """Whether T is needed."""
        return self.name == GENERALISED

    def angle(self, K_I: float, K_II: float, T: float) -> float:
        """Angle by which a tip turns, radians, from K_I and K_II, MPa sqrt(mm), and T, MPa.

        Examples
        --------
        >>> [round(math.degrees(Direction("GMTS", 0.1).angle(60.0, 20.0, T)), 1) for T in (-10.0, 0.0, 10.0)]
        [-25.4, -31.4, -38.9]
        >>> round(math.degrees(Direction("MTS").angle(60.0, 20.0, 10.0)), 1)
        -31.4
        """
        if self.asks_for_T:
            return generalised_tangential_stress(K_I, K_II, T * math.sqrt(2 * math.pi * self.distance))
        return BY_INTENSITIES[self.name](K_I, K_II)

    def forks(self, K_I: float, K_II: float, T: float) -> bool:
        """Whether another direction is as good to `FORKING`, so that the path may go either way.

        Examples
        --------
        >>> [Direction("GMTS", 0.1).forks(60.0, K_II, T) for K_II, T in ((0.0, 20.0), (0.0, 40.0), (1.0, 40.0))]
        [False, True, False]
        """
        if not self.asks_for_T or K_I == K_II == 0 or not math.isfinite(K_I + T):
            return False
        T_root = T * math.sqrt(2 * math.pi * self.distance)
        return lower_fork(K_I, K_II, T_root) > 1 - FORKING


def direction_of(name: str, material: Material, critical_distance: float | None = None) -> Direction:
    """The criterion of a name.

    Parameters
    ----------
    name : str
        One of `DIRECTIONS`.
    material : Material
        Its r_c is the depth of the point method, (K_Ic/sigma_c)^2/(2 pi).
    critical_distance : float, optional
        r_c in place of the material's, mm.

    Raises
    ------
    ValueError
        For another name, a distance that is not positive, or one that the criterion does not ask for.

    Examples
    --------
    >>> round(direction_of("GMTS", Material.from_name("PMMA")).distance, 4)
    0.123
    """
    if name not in DIRECTIONS:
        raise ValueError(f"direction = {name!r}: must be one of {', '.join(DIRECTIONS)}")
    if name != GENERALISED:
        if critical_distance is not None:
            raise ValueError(
                f"critical_distance = {critical_distance!r}: belongs to direction = {GENERALISED!r}, "
                f"and not to {name!r}"
            )
        return Direction(name)
    distance = point_distance(material) if critical_distance is None else critical_distance
    if not (math.isfinite(distance) and distance > 0):
        raise ValueError(f"critical_distance = {critical_distance!r}: must be a positive length, mm")
    return Direction(name, distance)
