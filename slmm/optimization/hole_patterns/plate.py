"""The square plate with a crack in which hole patterns are tried, by default that of Paper D."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.material import Material
from slmm.optimization.hole_patterns.patterns import Design
from slmm.part.level_set import LevelSet
from slmm.scene.holes import PatternHole
from slmm.scene.scene import Scene

#: of support points: True for a hole, or any numbers
Values = Design | NDArray[np.float64]
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

    @classmethod
    def of_scene(cls, scene: Scene) -> CrackedPlate:
        """The plate of a scene: its sides, its crack, its material, and what a hole pattern in it says.

        Parameters
        ----------
        scene : Scene
            A square plate, a straight crack from the middle of its left edge, and ``displacement`` as its load. Of a
            hole of the shape pattern ``frame``, ``length_scale`` and ``threshold`` are taken, its values are not; there
            may be no other hole.

        Raises
        ------
        ValueError
            For any other scene, with what would be right.

        Examples
        --------
        >>> CrackedPlate.of_scene(CrackedPlate(crack=12.0).scene(np.eye(3))).crack
        12.0
        """
        plate, load = scene.plate, scene.load
        if plate is None or plate.width != plate.height or plate.thickness != 1.0:
            raise ValueError(
                "plate: must be there, as wide as high, and 1 mm thick: U_T goes with the thickness"
            )
        if load is None or load.displacement is None:
            raise ValueError("load: must be a displacement; how large it is does not matter")
        middle = plate.height / 2
        points = np.array(scene.cracks[0].points) if len(scene.cracks) == 1 else np.empty((0, 2))
        if points.shape != (2, 2) or (points[:, 1] != middle).any() or points[:, 0].min() != 0.0:
            raise ValueError(f"cracks: must be one, straight from (0, {middle:g}) to the right")
        others = [hole.shape for hole in scene.holes if not isinstance(hole, PatternHole)]
        if others or len(scene.holes) > 1:
            raise ValueError("holes: must be none but one of the shape pattern, whose values are not taken")
        said = {
            name: getattr(hole, name)
            for hole in scene.holes
            for name in ("frame", "length_scale", "threshold")
        }
        return cls(plate.width, float(points[:, 0].max()), material=scene.material, **said)

    def level_set(self, whole: Values) -> LevelSet:
        """The function whose level is the outline of the holes of a whole grid."""
        middle, spacing = self.side / 2, (self.side - 2 * self.frame) / len(whole)
        return LevelSet(whole.astype(float), (middle, middle), spacing, self.length_scale, self.threshold)

    def weight(self, whole: Values) -> float:
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

    def scene(self, whole: Values, shift: tuple[float, float] = (0.0, 0.0)) -> Scene:
        """The plate with the holes of a whole grid of support values, all of them shifted, mm.

        Raises
        ------
        SceneError
            When there is material within a hole.
        """
        holes = {
            "shape": "pattern",
            "values": whole.astype(float).tolist(),
            "center": [self.side / 2 + by for by in shift],
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
