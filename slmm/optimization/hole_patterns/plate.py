"""The square plate with a crack in which hole patterns are tried, by default that of Paper D."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from slmm.mechanics.material import Material
from slmm.optimization.hole_patterns.patterns import Design
from slmm.part.level_set import LevelSet
from slmm.scene.scene import Scene

#: PMMA of Sapora et al.; published (Paper D, section 2.1)
PMMA = Material.from_toughness(2960.0, 0.38, 70.5, 1.96, "plane strain", "PMMA")


@dataclass(frozen=True)
class CrackedPlate:
    """A square plate under a displacement of its upper edge, with a crack from the middle of its left one.

    Parameters
    ----------
    side, crack, frame : float
        Of the plate; length of the crack; breadth at the edges without support points, mm; published: 80, 10, 15.
    length_scale, threshold : float
        Of the function through the support points, see `slmm.part.level_set.LevelSet`; published.
    material : Material

    Raises
    ------
    ValueError
        For lengths that do not fit into each other.
    """

    side: float = 80.0
    crack: float = 10.0
    frame: float = 15.0
    length_scale: float = 2.5
    threshold: float = 0.5
    material: Material = PMMA

    def __post_init__(self) -> None:
        if not (math.isfinite(self.side) and self.side > 0):
            raise ValueError(f"side = {self.side!r}: must be a length, mm")
        for name, most in (("crack", self.side), ("frame", self.side / 2)):
            if not 0 < getattr(self, name) < most:
                raise ValueError(f"{name} = {getattr(self, name)!r}: must lie between 0 and {most:g} mm")

    def level_set(self, whole: Design) -> LevelSet:
        """The function whose level is the outline of the holes of a whole grid."""
        middle, spacing = self.side / 2, (self.side - 2 * self.frame) / len(whole)
        return LevelSet(whole.astype(float), (middle, middle), spacing, self.length_scale, self.threshold)

    def weight(self, whole: Design) -> float:
        """What the plate weighs, over a plate without holes.

        Examples
        --------
        >>> CrackedPlate().weight(np.zeros((3, 3), bool))
        1.0
        """
        level_set, area = self.level_set(whole), 0.0
        for places in level_set.contours():
            x, y = places.T
            area += abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
        return 1.0 - area * (level_set.spacing / self.side) ** 2

    def scene(self, whole: Design) -> Scene:
        """The plate with the holes of a whole grid.

        Raises
        ------
        SceneError
            When there is material within a hole.
        """
        holes = {
            "shape": "pattern",
            "values": whole.astype(float).tolist(),
            "frame": self.frame,
            "length_scale": self.length_scale,
            "threshold": self.threshold,
        }
        material = self.material
        return Scene.from_dict(
            {
                "title": f"Hole pattern of {len(whole)} x {len(whole)} points",
                "plate": {"width": self.side, "height": self.side},
                "holes": [holes] if whole.any() else [],
                "cracks": [{"points": [[0.0, self.side / 2], [self.crack, self.side / 2]]}],
                "material": {
                    name: getattr(material, name) for name in ("E", "nu", "sigma_c", "G_c", "state")
                },
                "load": {"displacement": 1.0},
            }
        )
