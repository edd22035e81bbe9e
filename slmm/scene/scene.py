"""The scene: part, material, loading and analysis, read from a TOML file and checked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
import shapely
from pydantic import Field, ValidationError, ValidationInfo, model_validator
from shapely.validation import explain_validity

from slmm.mechanics.material import Material
from slmm.part.checks import crack_problems, edges_of, hole_problems, overlaps_united, position_problems
from slmm.part.chords import chords
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.running.input_file import shown
from slmm.scene.conditions import Boundary, general_loading
from slmm.scene.errors import SceneError, problems_of
from slmm.scene.holes import HOLES, OF_PART, Hole, PartTable, Plate
from slmm.scene.load_checks import load_problems
from slmm.scene.loading import Loading, plate_loading
from slmm.scene.tables import Analysis, Crack, Load, MaterialTable
from slmm.scene.toml_file import read_toml
from slmm.scene.values import Table, Title

if TYPE_CHECKING:
    from slmm.part.rays import Lines

#: of an outline as a polygon, where it keeps lines from passing; chosen
POLYGON_POINTS = 400


class Scene(Table):
    """A plate or part with notches under load: everything a prediction needs.

    Made by `read_scene` or `Scene.from_dict`; a scene that exists has been checked.

    Examples
    --------
    >>> scene = Scene.from_dict({
    ...     "plate": {"width": 100.0, "height": 100.0},
    ...     "holes": [{"shape": "circle", "center": [50.0, 50.0], "radius": 20.0}],
    ...     "material": {"name": "PMMA"},
    ...     "load": {"strain": [0.0, 0.1, 0.0]},
    ... })
    >>> scene.material.E, len(scene.outlines)
    (2960.0, 1)
    >>> scene.with_(load={"stress": 10.0}).load.stress
    10.0
    """

    title: Title = ""
    plate: Plate | None = None
    part_table: Annotated[PartTable | None, Field(alias="part")] = None
    holes: tuple[Hole, ...] = ()
    cracks: tuple[Crack, ...] = ()
    material_table: MaterialTable = Field(alias="material")
    load: Load | None = None
    boundary: tuple[Boundary, ...] = ()
    analysis: Analysis = Analysis()

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any], folder: str | Path = ".") -> Scene:
        """Scene from tables as in the scene file.

        Parameters
        ----------
        tables : mapping
            What a scene file holds.
        folder : path
            Where the files lie that it names.

        Raises
        ------
        SceneError
            When anything is unknown, missing, out of range, contradictory or geometrically impossible.
        """
        return cls._validated(tables, {"folder": Path(folder)})

    @classmethod
    def _validated(cls, tables: Mapping[str, Any], context: dict[str, Any]) -> Self:
        try:
            return cls.model_validate(dict(tables), context=context)
        except ValidationError as error:
            raise SceneError(problems_of(error, _KNOWN_KEYS)) from None

    @property
    def material(self) -> Material:
        """The material; G_c in N/mm."""
        return self.material_table.material()

    @cached_property
    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of all holes, in the order of the file; a picture may give several, holes that overlap one.

        Of a part the last one is its outer outline.
        """
        holes = tuple(outline for _, outline in self._named_outlines)
        return holes if self._rim is None else (*holes, self._rim)

    @cached_property
    def part(self) -> Part:
        """The geometry alone: outer edge, holes, and cracks with their ends where they belong."""
        return self._uncracked.with_cracks([np.array(crack.points) for crack in self.cracks])

    @cached_property
    def _uncracked(self) -> Part:
        holes = tuple(outline for _, outline in self._named_outlines)
        if self.plate is not None:
            return Part.plate(self.plate.width, self.plate.height, holes, (), self.plate.thickness)
        assert self.part_table is not None and self._rim is not None
        corners = chords(self._rim)[::-1]
        return Part(corners, holes, (), self.part_table.thickness, self._rim)

    @cached_property
    def _rim(self) -> Outline | None:
        """Outer outline of a part, clockwise."""
        if self.part_table is None:
            return None
        try:
            (outline,) = self.part_table.outline.outlines(np.zeros((2, 2)))
        except ValueError as error:
            raise SceneError([f"part.outline: {error}"]) from None
        return outline.reversed()

    @cached_property
    def outer(self) -> shapely.Polygon:
        """The part without its holes."""
        if self.plate is not None:
            return shapely.box(0.0, 0.0, self.plate.width, self.plate.height)
        assert self._rim is not None
        return shapely.Polygon(chords(self._rim)[::-1])

    @property
    def box(self) -> np.ndarray:
        """Lower left and upper right corner (2, 2) of the rectangle around it, mm."""
        return np.array(self.outer.bounds).reshape(2, 2)

    @property
    def doubts(self) -> list[str]:
        """What may be meant otherwise than it is read, each a sentence with its key."""
        return []

    @property
    def size(self) -> float:
        """Longer side of the rectangle around it, mm."""
        return float(np.ptp(self.box, axis=0).max())

    @cached_property
    def loading(self) -> Loading:
        """The load as conditions on the part's surface."""
        load = self.load
        if load is None:
            return self._general_loading[0]
        assert self.plate is not None
        return plate_loading(self.plate.width, self.plate.height, load.strain, load.displacement, load.stress)

    @cached_property
    def _general_loading(self) -> tuple[Loading, list[str]]:
        return general_loading(self.boundary, self._uncracked)

    @cached_property
    def notches(self) -> Lines:
        """The holes as polygons, for rays to meet."""
        from slmm.part.rays import Lines  # imports numba, which scenes do without

        return Lines.of([hole.polygon(POLYGON_POINTS) for hole in self._uncracked.holes], closed=True)

    @cached_property
    def _named_outlines(self) -> tuple[tuple[str, Outline], ...]:
        named, problems = [], []
        for i, hole in enumerate(self.holes):
            try:
                outlines = hole.outlines(self.box)
            except ValueError as error:
                file = getattr(hole, "file", None)
                key = f"holes[{i}]" if file is None else f'holes[{i}].file = "{Path(file).name}"'
                problems.append(f"{key}: {error}")
                continue
            for k, outline in enumerate(outlines):
                named.append((f"holes[{i}]" + (f" (outline {k})" if len(outlines) > 1 else ""), outline))
        if not problems:
            named, problems = overlaps_united(named, self.outer)
        if problems:
            raise SceneError(problems)
        return tuple(named)

    @model_validator(mode="after")
    def _has_one_part_and_load(self) -> Self:
        if (self.plate is None) == (self.part_table is None):
            contradicts = "part: contradicts plate; give [plate] or [part]"
            raise SceneError(["plate: is missing" if self.plate is None else contradicts])
        if self.load is not None and self.plate is None:
            raise SceneError(["load: is the short form for plates; give [[boundary]] for a part"])
        if (self.load is None) == (not self.boundary):
            contradicts = "load: contradicts boundary; give [load] or [[boundary]]"
            raise SceneError(["load: is missing" if self.load is None else contradicts])
        return self

    @model_validator(mode="after")
    def _geometry_is_possible(self, info: ValidationInfo) -> Self:
        images = sum(hole.shape == "image" for hole in self.holes)
        if images > 1:
            raise SceneError(["holes: only one image is allowed, because it covers the whole plate"])
        if images and self.plate is None:
            raise SceneError(["holes: an image covers a whole plate; give [plate] in place of [part]"])
        unchanged: Scene | None = (info.context or {}).get("geometry_of")
        if unchanged is not None:
            self.__dict__["_named_outlines"] = unchanged._named_outlines
            self.__dict__["_rim"] = unchanged._rim
        if not self.outer.is_valid:
            raise SceneError(
                [f"part.outline: the outline crosses or touches itself: {explain_validity(self.outer)}"]
            )
        problems = []
        if unchanged is None:
            names = [name for name, _ in self._named_outlines]
            problems = hole_problems([outline for _, outline in self._named_outlines], names, self.outer)
        if not problems and self.cracks:
            cracks = [np.array(crack.points) for crack in self.cracks]
            holes = [outline for _, outline in self._named_outlines]
            problems += crack_problems(cracks, holes, self.outer)
        if not problems and self.load is not None:
            assert self.plate is not None
            width, height = self.plate.width, self.plate.height
            problems += load_problems(self.load, edges_of(self.outlines, width, height), width, height)
        elif not problems:
            problems += self._general_loading[1]
        if self.analysis.points is not None:
            problems += position_problems(np.array(self.analysis.points), self.outer)
        if problems:
            raise SceneError(problems)
        return self

    def with_(self, **changes: Any) -> Scene:
        """The same scene with changes, checked again.

        Tables are changed key by key: ``scene.with_(analysis={"positions": 20})``. What excludes the new
        value gives way: another kind of load, positions against points, a material's name against its
        constants. The lists ``holes`` and ``cracks`` are replaced.

        Raises
        ------
        SceneError
            As `from_dict`.
        """
        tables = self._changed(changes)
        for new, old_load in (("load", "boundary"), ("boundary", "load")):
            if new in changes and old_load not in changes:
                tables.pop(old_load, None)
        context: dict[str, Any] = {"folder": Path()}
        for new, old_body in (("plate", "part"), ("part", "plate")):
            if new in changes and old_body not in changes:
                tables.pop(old_body, None)
        if not {"plate", "part", "holes"} & set(changes):
            context["geometry_of"] = self
        return self._validated(tables, context)

    def _changed(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Its tables with changes key by key."""
        tables = self.model_dump(by_alias=True, exclude_unset=True)
        for key, change in changes.items():
            old = tables.get(key)
            if not (isinstance(old, dict) and isinstance(change, Mapping)):
                tables[key] = change
                continue
            given_way = {other for new in change for other in _EXCLUDES.get((key, new), ())} - set(change)
            tables[key] = {**{k: v for k, v in old.items() if k not in given_way}, **change}
        return tables


_LOADS = ("strain", "displacement", "stress")
_EXCLUDES: dict[tuple[str, str], tuple[str, ...]] = {
    **{("load", new): tuple(old for old in _LOADS if old != new) for new in _LOADS},
    **{("material", new): ("name",) for new in MaterialTable.CONSTANTS},
    ("material", "name"): MaterialTable.CONSTANTS,
    ("material", "K_Ic"): ("name", "G_c"),
    ("material", "G_c"): ("name", "K_Ic"),
    ("analysis", "positions"): ("points",),
    ("analysis", "points"): ("positions",),
}

_KNOWN_KEYS: dict[tuple[str, ...], list[str]] = {
    (): ["title", "plate", "part", "holes", "cracks", "material", "load", "boundary", "analysis"],
    ("plate",): list(Plate.model_fields),
    ("part",): list(PartTable.model_fields),
    **{("part", "outline", shape): list(HOLES[shape].model_fields) for shape in OF_PART},
    ("cracks",): list(Crack.model_fields),
    ("material",): list(MaterialTable.model_fields),
    ("load",): list(Load.model_fields),
    ("boundary",): [field.alias or name for name, field in Boundary.model_fields.items()],
    ("analysis",): list(Analysis.model_fields),
    **{("holes", shape): list(hole.model_fields) for shape, hole in HOLES.items()},
}


def read_scene(path: str | Path) -> Scene:
    """Scene from a TOML file; files that it names lie relative to it.

    Raises
    ------
    SceneError
        When the file cannot be read, is not TOML, or describes no scene that can be computed.
    """
    path = Path(path)
    try:
        return Scene.from_dict(read_toml(path), path.parent)
    except SceneError as error:
        raise SceneError(error.problems, shown(path)) from None
    except ValueError as error:
        raise SceneError([str(error)], shown(path)) from error
