"""A part that was solved elsewhere, as a scene: its outlines from the mesh, its load from the displacements.

Stretches of free edges that carry forces are moved or loaded as in the model, see `slmm.initiation.solved_loads`; all
else is free. What the model's own elements make of the stress at a notch does not matter then, and any method that
serves a part serves this one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, SkipValidation, model_validator

from slmm.initiation.given_field import displacement_field
from slmm.initiation.half_models import half_model_doubts
from slmm.initiation.solved_loads import solved_loads
from slmm.mechanics.material import Material, State
from slmm.part.chords import chords
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.results.field import DisplacementField
from slmm.results.mirrored import mirrored
from slmm.results.outlines import Ring, mesh_outlines
from slmm.results.surface_forces import SurfaceForces, surface_forces
from slmm.scene.errors import SceneError
from slmm.scene.loading import Loading
from slmm.scene.scene import Scene

Array = NDArray[np.float64]

#: noise from which it tells the state, and its share that the other state's must not reach; chosen
OTHER_STATE = (1e-3, 0.2)
#: noise from which forces on surfaces are not told from it, see `SurfaceForces`; chosen
TOO_NOISY = 0.1


class SolvedScene(Scene):
    """A scene of somebody's finite element results; made by `solved_scene`.

    Attributes
    ----------
    solved : DisplacementField
    rings : tuple of Ring
        Its outlines.
    conditions : Loading
    surface : SurfaceForces
    """

    model_config = ConfigDict(arbitrary_types_allowed=True)

    solved: Annotated[SkipValidation[DisplacementField], Field(exclude=True)]
    rings: Annotated[SkipValidation[tuple[Ring, ...]], Field(exclude=True)]
    conditions: Annotated[SkipValidation[Loading], Field(exclude=True)]
    surface: Annotated[SkipValidation[SurfaceForces], Field(exclude=True)]

    @property
    def loading(self) -> Loading:
        """Where the part was held, moved or loaded, moved as it was."""
        return self.conditions

    @property
    def doubts(self) -> list[str]:
        """What may be meant otherwise: sides that move as planes of symmetry do, where a notch ends."""
        return half_model_doubts(self.solved, self.conditions)

    @property
    def _rim(self) -> Outline:
        return self.rings[-1].outline

    @property
    def _named_outlines(self) -> tuple[tuple[str, Outline], ...]:
        return tuple((f"hole {k}", ring.outline) for k, ring in enumerate(self.rings[:-1]))

    @property
    def _uncracked(self) -> Part:
        corners = chords(self._rim)[::-1]
        return Part(corners, tuple(outline for _, outline in self._named_outlines), (), 1.0, self._rim)

    def with_(self, **changes: Any) -> Self:
        """The same part with another title, material or analysis, see `slmm.scene.scene.Scene.with_`."""
        if theirs := sorted(set(changes) - {"title", "material", "analysis"}):
            raise SceneError(
                [f"{theirs[0]}: is what {self.title} has; only title, material and analysis may change"]
            )
        own = {name: getattr(self, name) for name in ("solved", "rings", "conditions", "surface")}
        return type(self)._validated({**self._changed(changes), **own}, {})

    @model_validator(mode="after")
    def _has_one_part_and_load(self) -> Self:
        return self

    @model_validator(mode="after")
    def _geometry_is_possible(self) -> Self:
        return self


def solved_scene(
    model: Any,
    material: Material | str,
    field: str | None = None,
    step: int = -1,
    symmetry: Sequence[str] = (),
) -> SolvedScene:
    """The part that a finite element model stands for.

    Parameters
    ----------
    model : path, DisplacementField or (points, cells, u)
        Displacements, mm, of a linear elastic part without cracks.
    material : Material or str
        Its stiffness, and strength and toughness to judge by.
    field : str, optional
        Which nodal data of a file the displacements are, see `slmm.results.results.read_displacements`.
    step : int
        Which step of a file; from the end if negative.
    symmetry : sequence of str
        At which sides of its box the model is the half of a part ("left", "right", "bottom", "top").

    Raises
    ------
    OSError
        When there is no such file.
    ValueError
        When it cannot be used, the mesh is none of one part without cracks, its displacements are in balance nowhere
        with this material, or nothing acts on its free edges.

    Examples
    --------
    >>> scene = solved_scene("tests/data/plate_2d.frd", "PMMA")  # a hole of 2 mm in a plate whose edges are moved
    >>> len(scene.outlines), [condition.is_held for condition in scene.loading]
    (2, [(True, True), (True, True), (True, True), (True, True)])
    """
    if isinstance(symmetry, str):
        symmetry = (symmetry,)
    solved, of = displacement_field(model, field, step)
    if isinstance(material, str):
        material = Material.from_name(material)
    try:
        solved = mirrored(solved, symmetry)
        rings = tuple(mesh_outlines(solved))
        on_surface = np.concatenate([ring.nodes for ring in rings])
        surface = surface_forces(solved, material, on_surface)
        _check_state(surface_forces(solved, in_other_state(material), on_surface), surface, material)
        if surface.noise > TOO_NOISY:
            raise ValueError(
                f"forces of {surface.noise:.2g} of the largest act on nodes inside the part: it is not linear elastic "
                f"with nu = {material.nu:g} in {material.state}, or loaded inside (gravity, temperature), or its "
                "displacements have too few digits, or are of quadratic elements and given on linear ones"
            )
        conditions = solved_loads(solved, rings, surface)
        if not conditions:
            raise ValueError("nothing acts on its free edges: there is no load")
    except ValueError as error:
        raise ValueError(f"{of}: {error}") from None
    table = {name: getattr(material, name) for name in ("E", "nu", "sigma_c", "G_c", "state")}
    return SolvedScene.model_validate(
        {
            "title": of,
            "material": table,
            "solved": solved,
            "rings": rings,
            "conditions": Loading(conditions),
            "surface": surface,
            "analysis": {"method": "boundary"},
        }
    )


def in_other_state(material: Material) -> Material:
    """The same material in plane strain in place of plane stress, or the other way round."""
    state: State = "plane stress" if material.state == "plane strain" else "plane strain"
    return Material(material.E, material.nu, material.sigma_c, material.G_c, state)


def _check_state(other: SurfaceForces, surface: SurfaceForces, material: Material) -> None:
    if surface.noise > OTHER_STATE[0] and other.noise < OTHER_STATE[1] * surface.noise:
        right = in_other_state(material).state
        raise ValueError(
            f"its displacements are in balance in {right} (forces of {other.noise:.2g} are left inside), "
            f"not in {material.state} ({surface.noise:.2g}): give the material in {right}"
        )
