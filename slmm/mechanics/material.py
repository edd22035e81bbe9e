"""Linear elastic, brittle materials: stiffness, strength and toughness (N, mm, MPa)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

State = Literal["plane stress", "plane strain"]

#: E, sigma_c, K_Ic and G_c lie between these in any unit that anybody uses, and Irwin's length then is a finite number
LEAST, MOST = 1e-30, 1e30


@dataclass(frozen=True)
class Material:
    """Isotropic, linear elastic material that fails brittle.

    Parameters
    ----------
    E : float
        Young's modulus, MPa.
    nu : float
        Poisson's ratio, between -1 and 0.5.
    sigma_c : float
        Tensile strength, MPa.
    G_c : float
        Critical energy release rate, N/mm (1 J/m2 = 1e-3 N/mm).
    state : {"plane stress", "plane strain"}
        The two-dimensional state.
    name : str
        For tables and pictures only.

    Raises
    ------
    ValueError
        When a value is not finite or out of its range; the message names it.

    Examples
    --------
    >>> Material.from_name("PMMA").irwin_length      # Paper A, Table 2: 0.773 mm
    0.77...
    """

    E: float
    nu: float
    sigma_c: float
    G_c: float
    state: State = "plane stress"
    name: str = "user material"

    def __post_init__(self) -> None:
        for symbol in ("E", "sigma_c", "G_c"):
            value = getattr(self, symbol)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"material.{symbol} = {value!r}: must be a positive number")
            if not LEAST <= value <= MOST:
                raise ValueError(f"material.{symbol} = {value!r}: must lie between {LEAST:g} and {MOST:g}")
        if not (math.isfinite(self.nu) and -1 < self.nu < 0.5):
            raise ValueError(f"material.nu = {self.nu!r}: must lie between -1 and 0.5")
        if self.state not in ("plane stress", "plane strain"):
            raise ValueError(f"material.state = {self.state!r}: must be 'plane stress' or 'plane strain'")

    @classmethod
    def from_toughness(
        cls,
        E: float,
        nu: float,
        sigma_c: float,
        K_Ic: float,
        state: State = "plane stress",
        name: str = "user material",
    ) -> Material:
        """Material from its fracture toughness ``K_Ic`` in MPa sqrt(m)."""
        if not (math.isfinite(K_Ic) and K_Ic > 0):
            raise ValueError(f"material.K_Ic = {K_Ic!r} MPa sqrt(m): must be a positive number")
        if not LEAST <= K_Ic <= MOST:
            raise ValueError(f"material.K_Ic = {K_Ic!r} MPa sqrt(m): must lie between {LEAST:g} and {MOST:g}")
        once = cls(E, nu, sigma_c, 1.0, state, name)  # refuses the other constants by their own names
        G_c = K_Ic**2 * 1000.0 / once.plane_stress_equivalent[0]
        if not LEAST <= G_c <= MOST:
            raise ValueError(
                f"material.K_Ic = {K_Ic!r} MPa sqrt(m): makes G_c = {G_c:g} N/mm with E = {E!r} MPa, which must lie "
                f"between {LEAST:g} and {MOST:g}"
            )
        return replace(once, G_c=G_c)

    @classmethod
    def from_name(cls, name: str, state: State = "plane stress") -> Material:
        """One of the materials of the thesis (Paper A, Table 2): PMMA, PS, Al2O3.

        The published G_c was converted from K_Ic under plane stress; K_Ic is what a material keeps, so in
        plane strain G_c = K_Ic^2 (1 - nu^2)/E (Paper A, section 3.1.1).
        """
        if name not in MATERIALS:
            raise ValueError(f"material.name = {name!r}: known are {', '.join(MATERIALS)}")
        E, nu, sigma_c, G_c = MATERIALS[name]
        if state == "plane strain":
            G_c *= 1 - nu**2
        return cls(E, nu, sigma_c, G_c, state, name)

    @property
    def plane_stress_equivalent(self) -> tuple[float, float]:
        """E and nu that make the plane stress equations describe this state."""
        if self.state == "plane strain":
            return self.E / (1 - self.nu**2), self.nu / (1 - self.nu)
        return self.E, self.nu

    @property
    def K_Ic(self) -> float:
        """Fracture toughness, MPa sqrt(mm)."""
        return math.sqrt(self.G_c * self.plane_stress_equivalent[0])

    @property
    def irwin_length(self) -> float:
        """Irwin's length l_ch = (K_Ic/sigma_c)^2, mm (Paper A)."""
        return (self.K_Ic / self.sigma_c) ** 2


#: E (MPa), nu, sigma_c (MPa), G_c (N/mm) of Paper A, Table 2; nu = 0.35 as in section 3
MATERIALS: dict[str, tuple[float, float, float, float]] = {
    "PMMA": (2960.0, 0.35, 70.5, 1.298),
    "PS": (3100.0, 0.35, 30.0, 0.6323),
    "Al2O3": (300000.0, 0.35, 400.0, 0.040),
}
