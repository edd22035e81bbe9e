"""Holes, notches and parts as tables of a scene file, each of which knows its outlines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.part.points import point_problems, polygon_problems, read_points, without_repetition
from slmm.scene.values import (
    Angle,
    File,
    Length,
    Number,
    PlanePoint,
    PlanePoints,
    Radius,
    Table,
    as_lists,
    exactly_one,
)

Array = NDArray[np.float64]

#: radius over the length of the outline down to which a spline through points can follow a rounded corner; computed
SHARPEST_OF_SPLINE = 7e-4


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

    def outlines(self, box: Array) -> list[Outline]:
        """Its outline, as a list of one."""
        return [Outline.through(shapes.circle(self.center, self.radius))]


class EllipseHole(Table):
    """Elliptic hole; centre and semi-axes in mm, turned counter-clockwise by an angle in degrees."""

    shape: Literal["ellipse"]
    center: PlanePoint
    semi_axes: tuple[Length, Length]
    angle: Angle = 0.0

    def outlines(self, box: Array) -> list[Outline]:
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

    def outlines(self, box: Array) -> list[Outline]:
        """Its outline, as a list of one."""
        if self.corner_radius < SHARPEST_OF_SPLINE * 2 * sum(self.size):
            corners = shapes.rectangle_corners(self.center, self.size, self.angle)
            return [Outline.of_pieces(shapes.polygon(corners, self.corner_radius))]
        points = shapes.rectangle(self.center, self.size, self.corner_radius, self.angle)
        # The curvature jumps where side and corner meet, and an interpolating spline would overshoot by 29 %;
        # this trace of smoothing leaves 5 % and moves the outline by 1e-4 radii.
        return [Outline.through(points, smoothing=1.6e-5 * self.corner_radius)]


class PolygonHole(Table):
    """Hole with straight sides between its corners (mm), which are sharp or rounded by tangent arcs.

    All corners have one ``corner_radius``, or each its own of ``corner_radii``.
    """

    shape: Literal["polygon"]
    points: Annotated[PlanePoints, Field(min_length=3)]
    corner_radius: Radius = 0.0
    corner_radii: tuple[Radius, ...] | None = None

    @model_validator(mode="after")
    def _one_radius_or_one_each(self) -> Self:
        if self.corner_radii is None:
            return self
        if self.corner_radius:
            raise ValueError("corner_radius and corner_radii contradict each other; give one of them")
        if len(self.corner_radii) != len(self.points):
            raise ValueError(
                f"corner_radii has {len(self.corner_radii)} entries: must have one for each of the "
                f"{len(self.points)} points"
            )
        return self

    def outlines(self, box: Array) -> list[Outline]:
        """Its outline, as a list of one."""
        corners = np.array(self.points, dtype=float)
        problems = polygon_problems(corners)
        if problems:
            raise ValueError("; ".join(problems))
        distinct = without_repetition(corners)
        radius = self.corner_radius if self.corner_radii is None else self.corner_radii[: len(distinct)]
        return [Outline.of_pieces(shapes.polygon(distinct, radius))]


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

    def outlines(self, box: Array) -> list[Outline]:
        """Its outline, as a list of one."""
        depth = self._depth_beyond(box) if self.depth is None else self.depth
        return [Outline.of_pieces(shapes.v_notch(self.tip, self.direction, self.opening, self.radius, depth))]

    def _depth_beyond(self, box: Array) -> float:
        """Depth at which the whole back side lies outside a box (2, 2), mm."""
        angle = np.radians(self.direction)
        corners = np.array([(x, y) for x in box[:, 0] for y in box[:, 1]])
        farthest = float(np.max((np.array(self.tip) - corners) @ (np.cos(angle), np.sin(angle))))
        margin = 0.05 * float(np.ptp(box, axis=0).max())
        return max(farthest, shapes.root_depth(self.opening, self.radius)) + margin


class PointsHole(Table):
    """Hole with a smooth outline through points (mm) that are listed or come from a file."""

    shape: Literal["points"]
    points: PlanePoints | None = None
    file: File | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        exactly_one(self, ("points", "file"))
        return self

    def outlines(self, box: Array) -> list[Outline]:
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

    def outlines(self, box: Array) -> list[Outline]:
        """The outlines of all its dark areas."""
        from slmm.part.image import outlines_in_picture  # brings scikit-image

        width, height = (box[1] - box[0]).tolist()
        return outlines_in_picture(Path(self.file), self.pixel_size, width, height)


class PatternHole(Table):
    """Holes where a smooth function through support points on a square grid is large (Paper D, 2.3).

    ``values`` has the grid's rows, the first one at the top, 1 (or any number) for a hole and 0 for material. The grid
    fills the plate but for a ``frame``, mm, at its edges; ``length_scale`` is that of the Gaussian kernel over half the
    spacing, and there is a hole where the function exceeds the ``threshold``. The grid's middle is the plate's, or a
    ``center`` of its own.
    """

    shape: Literal["pattern"]
    values: Annotated[tuple[tuple[Number, ...], ...], BeforeValidator(as_lists), Field(min_length=1)]
    center: PlanePoint | None = None
    frame: Radius = 15.0
    length_scale: Annotated[Number, Field(gt=0, le=4)] = 2.5
    threshold: Annotated[Number, Field(gt=0, lt=1)] = 0.5

    @model_validator(mode="after")
    def _is_square(self) -> Self:
        n = len(self.values)
        if any(len(row) != n for row in self.values):
            raise ValueError(
                f"values has {n} rows of {[len(row) for row in self.values]}: must have as many as rows"
            )
        return self

    def outlines(self, box: Array) -> list[Outline]:
        """Outlines of all holes."""
        from slmm.part.level_set import LevelSet  # brings scikit-image

        width, height = (box[1] - box[0]).tolist()
        if abs(width - height) > 1e-9 * width:
            raise ValueError(f"a plate of {width:g} x {height:g} mm: a pattern needs a square one")
        if not 2 * self.frame < width:
            raise ValueError(f"frame = {self.frame:g}: must leave room in a plate of {width:g} mm")
        x, y = self.center or box.mean(axis=0).tolist()
        spacing = (width - 2 * self.frame) / len(self.values)
        level_set = LevelSet(np.array(self.values), (x, y), spacing, self.length_scale, self.threshold)
        return level_set.outlines()


Hole = Annotated[
    CircleHole
    | EllipseHole
    | RectangleHole
    | PolygonHole
    | VNotchHole
    | PointsHole
    | ImageHole
    | PatternHole,
    Field(discriminator="shape"),
]

#: shapes that a part's outer outline may have
OF_PART = ("circle", "ellipse", "rectangle", "polygon", "points")
PartOutline = Annotated[
    CircleHole | EllipseHole | RectangleHole | PolygonHole | PointsHole, Field(discriminator="shape")
]


class PartTable(Table):
    """Part of any outer outline; mm."""

    outline: PartOutline
    thickness: Length = 1.0


#: by their names in the file
HOLES: dict[str, type[Table]] = {
    "circle": CircleHole,
    "ellipse": EllipseHole,
    "rectangle": RectangleHole,
    "polygon": PolygonHole,
    "v-notch": VNotchHole,
    "points": PointsHole,
    "image": ImageHole,
    "pattern": PatternHole,
}
