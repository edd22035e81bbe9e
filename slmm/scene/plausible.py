"""Values that no solid has: nearly always a unit that was mistaken for another one.

The ranges are chosen, not fitted, and wide: soft gels to diamond for Young's modulus, elastomers to perfect crystals
for the strength over it. A value outside is no proof of a mistake, and one inside no proof of none: the tests list the
materials and the mistakes that were thought of.
"""

from __future__ import annotations

import math

from slmm.mechanics.material import Material
from slmm.scene.scene import Scene

#: MPa
MODULUS = (0.1, 1.3e6)
#: MPa
STRENGTH = (1e-4, 2e5)
#: MPa sqrt(m)
TOUGHNESS = (1e-3, 1e3)
#: sigma_c/E, but for elastomers: MPa up to which E is one's, and sigma_c is
STRONGEST, SOFT, SOFT_STRENGTH = 0.2, 20.0, 60.0
#: K_Ic/E of rigid and of soft solids, sqrt(m)
TOUGHEST, TOUGHEST_SOFT = 0.015, 0.3
#: mm; Irwin's length of the toughest steels is some metres, that of perfect crystals some nanometres
IRWIN = (1e-7, 2e4)
#: mm, of the longer side
PLATE = (1e-3, 5e4)
#: parts shorter than this (mm) are etched from what breaks within far less than a tenth of them
ETCHED, IRWIN_OF_ETCHED = 1.0, 0.1


class UnusualValueWarning(UserWarning):
    """A value that no solid or no part has, in the unit in which it is read."""


def unusual_values(scene: Scene) -> list[str]:
    """What of a scene lies outside all that is known, each a sentence with the key, its unit and what is usual.

    Examples
    --------
    >>> from slmm.scene.gallery import circular_hole
    >>> unusual_values(circular_hole())
    []
    >>> glass = {"E": 70.0, "nu": 0.2, "sigma_c": 50.0, "K_Ic": 0.7}  # GPa
    >>> print(*unusual_values(circular_hole(material=glass)))
    material.E = 70 MPa: is less than 5 times sigma_c = 50 MPa, as in no solid but elastomers; E is read in MPa
    """
    material = scene.material
    what = "plate" if scene.plate is not None else "part"
    return [*_of_material(material), *_of_size(scene.size, what, material.irwin_length), *scene.doubts]


def _of_material(material: Material) -> list[str]:
    E, sigma_c, K_Ic = material.E, material.sigma_c, material.K_Ic / math.sqrt(1000.0)
    problems = [
        f"material.{key} = {value:.4g} {unit}: solids have {low:g} to {high:g} {unit}"
        for key, value, unit, (low, high) in (
            ("E", E, "MPa", MODULUS),
            ("sigma_c", sigma_c, "MPa", STRENGTH),
            ("K_Ic", K_Ic, "MPa sqrt(m)", TOUGHNESS),
        )
        if not low <= value <= high
    ]
    if problems:
        return problems
    elastomer = E <= SOFT and sigma_c <= SOFT_STRENGTH
    if sigma_c > STRONGEST * E and not elastomer:
        problems.append(
            f"material.E = {E:.4g} MPa: is less than {1 / STRONGEST:g} times sigma_c = {sigma_c:.4g} MPa, as in no "
            "solid but elastomers; E is read in MPa"
        )
    limit = TOUGHEST_SOFT if E <= SOFT else TOUGHEST
    if K_Ic > limit * E:
        problems.append(
            f"material.K_Ic = {K_Ic:.4g} MPa sqrt(m) (G_c = {material.G_c:.4g} N/mm): solids with E = {E:.4g} MPa have "
            f"at most {limit * E:.3g} MPa sqrt(m); K_Ic is read in MPa sqrt(m), G_c in N/mm, E in MPa"
        )
    low, high = IRWIN
    if not problems and not low <= material.irwin_length <= high:
        problems.append(
            f"material.sigma_c = {sigma_c:.4g} MPa: with K_Ic = {K_Ic:.4g} MPa sqrt(m) Irwin's length is "
            f"{material.irwin_length:.3g} mm, in solids it is {low:g} to {high:g} mm; sigma_c is read in MPa"
        )
    return problems


def _of_size(size: float, what: str, irwin_length: float) -> list[str]:
    low, high = PLATE
    if not low <= size <= high:
        return [f"{what}: is {size:.4g} mm long, parts are {low:g} to {high:g} mm; lengths are read in mm"]
    if size < ETCHED and irwin_length > IRWIN_OF_ETCHED * size:
        return [
            f"{what}: is {size:.4g} mm long, with an Irwin's length of {irwin_length:.3g} mm; lengths are read in mm"
        ]
    return []
