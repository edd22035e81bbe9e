"""A part that was solved elsewhere, as a scene: its outlines from the mesh, its load from the displacements.

Stretches of free edges that carry forces are moved as the model moved them; all else is free. What the model's own
elements make of the stress at a notch does not matter then, and any method that serves a part serves this one.
"""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, SkipValidation, model_validator

from slmm.initiation.given_field import displacement_field
from slmm.mechanics.material import Material
from slmm.part.chords import chords
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.span import Span
from slmm.results.field import DisplacementField
from slmm.results.outlines import Ring, mesh_outlines
from slmm.results.surface_forces import SurfaceForces, surface_forces
from slmm.scene.errors import SceneError
from slmm.scene.loading import Condition, Loading
from slmm.scene.sampled import Sampled
from slmm.scene.scene import Scene

Array = NDArray[np.float64]

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
    model: Any, material: Material | str, field: str | None = None, step: int = -1
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
    solved, of = displacement_field(model, field, step)
    if isinstance(material, str):
        material = Material.from_name(material)
    try:
        rings = tuple(mesh_outlines(solved))
        surface = surface_forces(solved, material, np.concatenate([ring.nodes for ring in rings]))
        if surface.noise > TOO_NOISY:
            raise ValueError(
                f"forces of {surface.noise:.2g} of the largest act on nodes inside the part: it is not linear elastic "
                f"with nu = {material.nu:g} in {material.state}, or loaded inside (gravity, temperature), or its "
                "displacements have too few digits"
            )
        conditions = [condition for ring in rings for condition in _conditions(solved, ring, surface)]
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
            "conditions": Loading(tuple(conditions)),
            "surface": surface,
            "analysis": {"method": "boundary"},
        }
    )


def _conditions(field: DisplacementField, ring: Ring, surface: SurfaceForces) -> list[Condition]:
    """What moves a ring, run by run."""
    loaded = _loaded(ring, surface)
    n = len(loaded)
    if not loaded.any():
        return []
    begins = loaded & (~np.roll(loaded, 1) | ring.corners)
    if not begins.any():
        begins[0] = True
    found = []
    for first in np.flatnonzero(begins):
        run = [first]
        while loaded[after := (run[-1] + 1) % n] and not begins[after] and after != first:
            run.append(after)
        found.append(_moved(field, ring, np.array(run), surface))
    return found


def _loaded(ring: Ring, surface: SurfaceForces) -> NDArray[np.bool_]:
    """Which edges (n,) carry forces: those all of whose nodes do, and those beside a node that does alone."""
    there = ring.edges >= 0
    acts = np.asarray(surface.acts.any(axis=1))
    loaded = (acts[ring.edges] | ~there).all(axis=1)
    of_loaded = np.unique(ring.edges[loaded])
    alone = acts[ring.edges[:, 0]] & ~np.isin(ring.edges[:, 0], of_loaded)
    return loaded | alone | np.roll(alone, -1)


def _moved(field: DisplacementField, ring: Ring, run: NDArray[np.int64], surface: SurfaceForces) -> Condition:
    """The condition along a run of edges."""
    edges = ring.edges[run]
    nodes = np.concatenate([edges[:, [0, 2]].ravel(), edges[-1:, 1]])
    nodes = nodes[nodes >= 0]
    outline, at = ring.outline, field.points[nodes]
    s = outline.project(at)
    down = np.concatenate([[0.0], np.cumsum((s[:-1] - s[1:]) % outline.length)])
    span = Span(outline, float(s[0]), float(s[0] - down[-1]))
    share = down / down[-1]
    acts = surface.acts[nodes].any(axis=0)
    u_x, u_y = (Sampled(span, share, field.u[nodes, i]) if acts[i] else None for i in range(2))
    (x, y), (x_end, y_end) = at[0].tolist(), at[-1].tolist()
    return Condition((x, y), (x_end, y_end), (u_x, u_y), span=span)
