"""Variants of a scene that have one elastic field, but for its size: all of them as materials under one load.

Displacements that are given make stresses E times as large, tractions do not; the stress follows the vector of both,
and energy its square over E. A load s times as large on a material (sigma_c, G_c, E) is therefore a reference load on
a material (sigma_c/s, G_c E/(E_r s^2), E_r): load factors and crack lengths are the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slmm.mechanics.material import Material
from slmm.scene.scene import Scene
from slmm.scene.tables import MaterialTable
from slmm.scene.variants import Variants, load_numbers

#: decimals of a load's direction and of Poisson's ratio that tell fields apart; round-off
DECIMALS = 12


@dataclass(frozen=True)
class ElasticClass:
    """Variants with one elastic field.

    Attributes
    ----------
    scene : Scene
        The first of them.
    members : ndarray (m,) of int
        Numbers of the variants.
    materials : tuple of Material
        As which they act under the scene's load.
    """

    scene: Scene
    members: np.ndarray
    materials: tuple[Material, ...]

    def of(self, material: Material) -> Scene:
        """The scene with one of the materials."""
        return _with_material(self.scene, material)


def elastic_classes(variants: Variants) -> list[ElasticClass]:
    """The variants by their elastic field.

    Examples
    --------
    >>> from slmm.scene.gallery import circular_hole
    >>> from slmm.scene.variants import variants_of
    >>> vary = {"load.strain": [0.1, 0.2], "material.nu": [0.2, 0.3]}
    >>> one, other = elastic_classes(variants_of(circular_hole(), vary))
    >>> one.members.tolist(), [round(material.sigma_c, 2) for material in one.materials]
    ([0, 2], [70.5, 35.25])
    """
    loads = [load_numbers(scene) for scene in variants.loaded]
    materials = [scene.material for scene in variants.made_of]
    groups: dict[object, list[tuple[int, float]]] = {}
    for k, (i, j) in enumerate(zip(variants.load.tolist(), variants.material.tolist(), strict=True)):
        given, acting = loads[i]
        material = materials[j]
        vector = np.concatenate([material.E * given, acting])
        size = float(np.abs(vector).max())
        direction = tuple(np.round(vector / size, DECIMALS).tolist())
        key = (direction, round(material.nu, DECIMALS), material.state)
        groups.setdefault(key, []).append((k, size))
    found = []
    for members in groups.values():
        first, reference = members[0]
        scene = variants.loaded[variants.load[first]]
        one = materials[variants.material[first]]
        acting_as = []
        for k, size in members:
            material, s = materials[variants.material[k]], size / reference
            acting_as.append(
                Material(
                    one.E,
                    one.nu,
                    material.sigma_c / s,
                    material.G_c * (material.E / one.E) / s**2,
                    one.state,
                )
            )
        numbers = np.array([k for k, _ in members])
        found.append(ElasticClass(_with_material(scene, one), numbers, tuple(acting_as)))
    return found


def _with_material(scene: Scene, material: Material) -> Scene:
    """A scene with other constants, which have been checked."""
    table = MaterialTable(
        E=material.E, nu=material.nu, sigma_c=material.sigma_c, G_c=material.G_c, state=material.state
    )
    return scene.model_copy(update={"material_table": table})
