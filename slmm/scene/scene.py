"""The scene: plate, holes, cracks, material, load and analysis, read from a TOML file and checked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from slmm.mechanics.material import LEAST, MATERIALS, MOST, Material, State
from slmm.part import shapes
from slmm.part.checks import crack_problems, edges_of, hole_problems, overlaps_united, position_problems
from slmm.part.outline import Outline
from slmm.part.points import point_problems, polygon_problems, read_points, without_repetition
from slmm.running.encoding import without_control
from slmm.running.input_file import input_problem, shown
from slmm.scene.errors import SceneError, problems_of
from slmm.scene.load_checks import load_problems
from slmm.scene.toml_file import read_toml

if TYPE_CHECKING:
    from slmm.part.rays import Lines

Array = NDArray[np.float64]
Method = Literal[
    "rankine",
    "mises",
    "point",
    "line",
    "slmm",
    "slmm+ac",
    "asymptotics",
    "griffith",
    "dislocations",
    "full-fea",
    "auto",
]


def _at_least(least: float) -> AfterValidator:
    """Of a positive number, so that what is negative or zero is told that first."""

    def check(value: float) -> float:
        if value < least:
            raise ValueError(f"must be at least {least:g}")
        return value

    return AfterValidator(check)


# Strict: a number in quotes, or true for 1, is a mistake and not a number. Coordinates have a bound so that
# squares and products of them stay finite, and lengths one below which these would vanish.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Coordinate = Annotated[Number, Field(ge=-1e9, le=1e9)]
Length = Annotated[Number, Field(gt=0, le=1e9), _at_least(1e-9)]
Radius = Annotated[Number, Field(ge=0, le=1e9)]
Angle = Annotated[Number, Field(ge=-1e6, le=1e6)]
Constant = Annotated[Number, Field(gt=0, le=MOST), _at_least(LEAST)]
Count = Annotated[int, Field(strict=True)]
PlanePoint = tuple[Coordinate, Coordinate]


#: of an outline as a polygon, where it keeps lines from passing
POLYGON_POINTS = 400
#: characters
LONGEST_TITLE = 1000
#: radius over the length of the outline down to which a spline through points can follow a rounded corner
SHARPEST_OF_SPLINE = 7e-4


def _as_lists(value: object) -> object:
    return value.tolist() if isinstance(value, np.ndarray) else value


PlanePoints = Annotated[tuple[PlanePoint, ...], BeforeValidator(_as_lists)]


def _printable(title: str) -> str:
    if without_control(title) != title:
        raise ValueError("must not have control characters")
    if len(title) > LONGEST_TITLE:
        raise ValueError(f"has {len(title)} characters; must have at most {LONGEST_TITLE}")
    return title


def _in_folder(file: str, info: ValidationInfo) -> str:
    folder = Path((info.context or {}).get("folder", "."))
    if problem := input_problem(folder / file):
        raise ValueError(f"{problem}, in {folder.resolve()}")
    return str((folder / file).resolve())


File = Annotated[str, Field(strict=True, min_length=1), AfterValidator(_in_folder)]


class Table(BaseModel):
    """A table of the scene file: immutable, and no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Plate(Table):
    """Rectangular plate with its lower left corner at (0, 0); mm."""

    width: Length
    height: Length
    thickness: Length = 1.0


class CircleHole(Table):
    """Circular hole; centre and radius in mm."""

    shape: Literal["circle"]
    center: PlanePoint
    radius: Length

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        return [Outline.through(shapes.circle(self.center, self.radius))]


class EllipseHole(Table):
    """Elliptic hole; centre and semi-axes in mm, turned counter-clockwise by an angle in degrees."""

    shape: Literal["ellipse"]
    center: PlanePoint
    semi_axes: tuple[Length, Length]
    angle: Angle = 0.0

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        return [Outline.through(shapes.ellipse(self.center, self.semi_axes, self.angle))]


class RectangleHole(Table):
    """Rectangular hole, its corners round or (radius 0) sharp; mm, turned counter-clockwise by degrees."""

    shape: Literal["rectangle"]
    center: PlanePoint
    size: tuple[Length, Length]
    corner_radius: Number
    angle: Angle = 0.0

    @model_validator(mode="after")
    def _corners_fit(self) -> Self:
        half = min(self.size) / 2
        if not 0 <= self.corner_radius <= half:
            raise ValueError(
                f"corner_radius = {self.corner_radius:g}: must be at least 0, for sharp corners, and at most half"
                f" the smaller side, {half:g}"
            )
        return self

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        if self.corner_radius < SHARPEST_OF_SPLINE * 2 * sum(self.size):
            corners = shapes.rectangle_corners(self.center, self.size, self.angle)
            return [Outline.of_pieces(shapes.polygon(corners, self.corner_radius))]
        points = shapes.rectangle(self.center, self.size, self.corner_radius, self.angle)
        # The curvature jumps where side and corner meet, and an interpolating spline would overshoot by 29 %;
        # this trace of smoothing leaves 5 % and moves the outline by 1e-4 radii.
        return [Outline.through(points, smoothing=1.6e-5 * self.corner_radius)]


class PolygonHole(Table):
    """Hole with straight sides between its corners (mm), which are sharp or rounded by tangent arcs."""

    shape: Literal["polygon"]
    points: Annotated[PlanePoints, Field(min_length=3)]
    corner_radius: Radius = 0.0

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        corners = np.array(self.points, dtype=float)
        problems = polygon_problems(corners)
        if problems:
            raise ValueError("; ".join(problems))
        return [Outline.of_pieces(shapes.polygon(without_repetition(corners), self.corner_radius))]


class VNotchHole(Table):
    """V-notch with straight flanks and a sharp or round root; mm and degrees.

    ``tip`` is where the notch's surface meets its bisector, ``direction`` where the notch points to from its mouth
    (0 is along x), ``opening`` the angle between the flanks; 0 is a U-notch and needs a ``radius``. Without a
    ``depth`` it runs out of the plate; with one it has a straight back side, at that distance from the tip.
    """

    shape: Literal["v-notch"]
    tip: PlanePoint
    direction: Angle
    opening: Annotated[Number, Field(ge=0, lt=180)]
    radius: Radius = 0.0
    depth: Length | None = None

    @model_validator(mode="after")
    def _has_a_width_and_flanks(self) -> Self:
        if self.opening == 0 and self.radius == 0:
            raise ValueError("opening = 0: a notch with parallel flanks needs a radius, half its width")
        root = shapes.root_depth(self.opening, self.radius)
        if self.depth is not None and self.depth <= root:
            raise ValueError(
                f"depth = {self.depth:g}: must be greater than {root:.6g}, where the flanks begin behind the root"
            )
        return self

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        depth = self._depth_beyond(plate) if self.depth is None else self.depth
        return [Outline.of_pieces(shapes.v_notch(self.tip, self.direction, self.opening, self.radius, depth))]

    def _depth_beyond(self, plate: Plate) -> float:
        """Depth at which the whole back side lies outside the plate."""
        angle = np.radians(self.direction)
        corners = np.array([(x, y) for x in (0.0, plate.width) for y in (0.0, plate.height)])
        farthest = float(np.max((np.array(self.tip) - corners) @ (np.cos(angle), np.sin(angle))))
        margin = 0.05 * max(plate.width, plate.height)
        return max(farthest, shapes.root_depth(self.opening, self.radius)) + margin


class PointsHole(Table):
    """Hole with a smooth outline through points (mm) that are listed or come from a file."""

    shape: Literal["points"]
    points: PlanePoints | None = None
    file: File | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        _exactly_one(self, ("points", "file"))
        return self

    def outlines(self, plate: Plate) -> list[Outline]:
        """Its outline, as a list of one."""
        points = np.array(self.points, dtype=float) if self.file is None else read_points(Path(self.file))
        problems = point_problems(points.reshape(-1, 2))
        if problems:
            raise ValueError("; ".join(problems))
        return [Outline.through(without_repetition(points))]


class ImageHole(Table):
    """All dark areas of a picture that covers the plate; pixel size in mm."""

    shape: Literal["image"]
    file: File
    pixel_size: Length

    def outlines(self, plate: Plate) -> list[Outline]:
        """The outlines of all its dark areas."""
        from slmm.part.image import outlines_in_picture  # brings scikit-image

        return outlines_in_picture(Path(self.file), self.pixel_size, plate.width, plate.height)


Hole = Annotated[
    CircleHole | EllipseHole | RectangleHole | PolygonHole | VNotchHole | PointsHole | ImageHole,
    Field(discriminator="shape"),
]


class Crack(Table):
    """Initial crack along points (mm), from the plate's edge or a hole to its tip, the last one."""

    points: Annotated[PlanePoints, Field(min_length=2)]


class MaterialTable(Table):
    """Material by its name, or by its constants with exactly one of K_Ic (MPa sqrt(m)) and G_c (N/mm)."""

    name: str | None = None
    E: Constant | None = None
    nu: Annotated[Number, Field(gt=-1, lt=0.5)] | None = None
    sigma_c: Constant | None = None
    K_Ic: Constant | None = None
    G_c: Constant | None = None
    state: State = "plane stress"

    CONSTANTS: ClassVar[tuple[str, ...]] = ("E", "nu", "sigma_c", "K_Ic", "G_c")

    @field_validator("name")
    @classmethod
    def _is_known(cls, name: str | None) -> str | None:
        if name is not None and name not in MATERIALS:
            raise ValueError(f"must be one of {', '.join(MATERIALS)}, or give E, nu, sigma_c and K_Ic or G_c")
        return name

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        given = [key for key in self.CONSTANTS if getattr(self, key) is not None]
        if self.name is not None:
            if given:
                raise ValueError(
                    f'name = "{self.name}" has its own constants and contradicts {", ".join(given)};'
                    " give the name or the constants"
                )
            return self
        missing = [key for key in ("E", "nu", "sigma_c") if key not in given]
        if missing:
            known = ", ".join(f'"{name}"' for name in MATERIALS)
            raise ValueError(
                f"{', '.join(missing)} missing; needs a name ({known}), or E, nu, sigma_c and K_Ic or G_c"
            )
        _exactly_one(self, ("K_Ic", "G_c"))
        return self

    def material(self) -> Material:
        """The material with its constants in N, mm, MPa."""
        if self.name is not None:
            return Material.from_name(self.name, self.state)
        assert self.E is not None and self.nu is not None and self.sigma_c is not None
        if self.K_Ic is not None:
            return Material.from_toughness(self.E, self.nu, self.sigma_c, self.K_Ic, self.state)
        assert self.G_c is not None
        return Material(self.E, self.nu, self.sigma_c, self.G_c, self.state)


class Load(Table):
    """Exactly one kind of load; the others are None.

    ``strain`` (e_xx, e_yy, gamma_xy) prescribes the displacement of all four edges, ``displacement`` (mm)
    moves the top edge up as one, ``stress`` (MPa) pulls uniformly on top and bottom.
    """

    strain: tuple[Number, Number, Number] | None = None
    displacement: Number | None = None
    stress: Number | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        _exactly_one(self, ("strain", "displacement", "stress"))
        value = self.strain or (self.displacement or self.stress,)
        if not any(value):
            raise ValueError("is zero; without a load there is no failure to predict")
        size = max(abs(x) for x in value if x is not None)
        if not LEAST <= size <= MOST:
            raise ValueError(f"is {size:g}; the largest number must lie between {LEAST:g} and {MOST:g}")
        return self


class Analysis(Table):
    """How to compute: the method, where, and with how fine a model.

    ``points`` (mm), when given, take the place of ``positions`` equally spaced ones on every hole.
    ``void_stiffness`` is the stiffness of a hole's voxels as a share of the material's. ``settings`` are the
    package's own or those that Paper A published. ``average`` compares the mean stress over the crack with the
    strength (thesis Eq. 3.21). ``tolerance`` is the relative error of the failure index that the method "auto"
    aims at; of indices below a quarter of the largest it is that of the quarter. ``local_model`` is what crack
    cells and strength criteria take the uncracked part's field from.
    """

    method: Method = "auto"
    positions: Annotated[Count, Field(ge=1, le=100_000)] = 50
    points: Annotated[PlanePoints, Field(min_length=1)] | None = None
    voxels: Literal["auto"] | Count = "auto"
    void_stiffness: Annotated[Number, Field(ge=1e-9, le=0.1)] = 1e-6
    settings: Literal["default", "published"] = "default"
    local_model: Literal["voxels", "body-fitted"] = "voxels"
    average: Annotated[bool, Field(strict=True)] = False
    tolerance: Annotated[Number, Field(ge=0.0005, le=0.5)] = 0.02

    @field_validator("voxels", mode="before")
    @classmethod
    def _number_of_voxels(cls, voxels: object) -> object:
        whole = isinstance(voxels, int) and not isinstance(voxels, bool)
        if voxels != "auto" and not (whole and 100 <= voxels <= 100_000_000):  # type: ignore[operator]
            raise ValueError('must be "auto" or a whole number between 100 and 100000000')
        return voxels

    @model_validator(mode="after")
    def _one_choice_of_positions(self) -> Self:
        if self.points is not None and "positions" in self.model_fields_set:
            raise ValueError("positions and points contradict each other; give one of them")
        return self


def _exactly_one(table: Table, keys: tuple[str, ...]) -> None:
    given = [key for key in keys if getattr(table, key) is not None]
    if len(given) != 1:
        found = f"has {' and '.join(given)}" if given else "has none"
        raise ValueError(f"needs exactly one of {', '.join(keys)}; it {found}")


class Scene(Table):
    """A plate with notches under load: everything a prediction needs.

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

    title: Annotated[str, Field(strict=True), AfterValidator(_printable)] = ""
    plate: Plate
    holes: tuple[Hole, ...] = ()
    cracks: tuple[Crack, ...] = ()
    material_table: MaterialTable = Field(alias="material")
    load: Load
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
    def _validated(cls, tables: Mapping[str, Any], context: dict[str, Any]) -> Scene:
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
        """Outlines of all holes, in the order of the file; a picture may give several, holes that overlap one."""
        return tuple(outline for _, outline in self._named_outlines)

    @cached_property
    def notches(self) -> Lines:
        """The outlines as polygons, for rays to meet."""
        from slmm.part.rays import Lines  # imports numba, which scenes do without

        return Lines.of([outline.polygon(POLYGON_POINTS) for outline in self.outlines], closed=True)

    @cached_property
    def _named_outlines(self) -> tuple[tuple[str, Outline], ...]:
        named, problems = [], []
        for i, hole in enumerate(self.holes):
            try:
                outlines = hole.outlines(self.plate)
            except ValueError as error:
                file = getattr(hole, "file", None)
                key = f"holes[{i}]" if file is None else f'holes[{i}].file = "{Path(file).name}"'
                problems.append(f"{key}: {error}")
                continue
            for k, outline in enumerate(outlines):
                named.append((f"holes[{i}]" + (f" (outline {k})" if len(outlines) > 1 else ""), outline))
        if not problems:
            named, problems = overlaps_united(named, self.plate.width, self.plate.height)
        if problems:
            raise SceneError(problems)
        return tuple(named)

    @model_validator(mode="after")
    def _geometry_is_possible(self, info: ValidationInfo) -> Self:
        width, height = self.plate.width, self.plate.height
        if sum(hole.shape == "image" for hole in self.holes) > 1:
            raise SceneError(["holes: only one image is allowed, because it covers the whole plate"])
        unchanged: Scene | None = (info.context or {}).get("geometry_of")
        if unchanged is not None:
            self.__dict__["_named_outlines"] = unchanged._named_outlines
        problems = []
        if unchanged is None:
            names = [name for name, _ in self._named_outlines]
            problems = hole_problems(self.outlines, names, width, height)
        if not problems and self.cracks:
            cracks = [np.array(crack.points) for crack in self.cracks]
            problems += crack_problems(cracks, self.outlines, width, height)
        if not problems:
            problems += load_problems(self.load, edges_of(self.outlines, width, height), width, height)
        if self.analysis.points is not None:
            problems += position_problems(np.array(self.analysis.points), width, height)
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
        tables = self.model_dump(by_alias=True, exclude_unset=True)
        for key, change in changes.items():
            old = tables.get(key)
            if not (isinstance(old, dict) and isinstance(change, Mapping)):
                tables[key] = change
                continue
            given_way = {other for new in change for other in _EXCLUDES.get((key, new), ())} - set(change)
            tables[key] = {**{k: v for k, v in old.items() if k not in given_way}, **change}
        context: dict[str, Any] = {"folder": Path()}
        if not {"plate", "holes"} & set(changes):
            context["geometry_of"] = self
        return self._validated(tables, context)


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

_HOLES: dict[str, type[Table]] = {
    "circle": CircleHole,
    "ellipse": EllipseHole,
    "rectangle": RectangleHole,
    "polygon": PolygonHole,
    "v-notch": VNotchHole,
    "points": PointsHole,
    "image": ImageHole,
}
_KNOWN_KEYS: dict[tuple[str, ...], list[str]] = {
    (): ["title", "plate", "holes", "cracks", "material", "load", "analysis"],
    ("plate",): list(Plate.model_fields),
    ("cracks",): list(Crack.model_fields),
    ("material",): list(MaterialTable.model_fields),
    ("load",): list(Load.model_fields),
    ("analysis",): list(Analysis.model_fields),
    **{("holes", shape): list(hole.model_fields) for shape, hole in _HOLES.items()},
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
