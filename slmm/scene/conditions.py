"""The general form of a load, `[[boundary]]`: what holds, moves or pulls stretches of a plate's outer edge."""

from __future__ import annotations

from itertools import combinations
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
import shapely
from pydantic import Field, model_validator

from slmm.mechanics.rigid import free_motions
from slmm.part.part import Part
from slmm.scene.load_checks import LEAST, UNBALANCED
from slmm.scene.loading import Affine, Condition, Loading, Point, plate_edges
from slmm.scene.values import Length, Number, PlanePoint, Table, exactly_one

EDGES = ("bottom", "right", "top", "left")
Component = Number | Literal["free"]


class Boundary(Table):
    """One condition: where, and exactly one of what.

    ``on`` names an edge, or all of them as "outer"; ``from`` and ``to`` are ends of a stretch, counter-clockwise;
    ``at`` and ``width`` a short stretch about a point. ``displacement`` (mm) holds or moves each direction that is not
    "free"; ``traction`` (MPa), ``pressure`` (MPa, onto the surface) and ``force`` (N, spread evenly over the material)
    load it.
    """

    on: Literal["bottom", "right", "top", "left", "outer"] | None = None
    start: Annotated[PlanePoint | None, Field(alias="from")] = None
    end: Annotated[PlanePoint | None, Field(alias="to")] = None
    at: PlanePoint | None = None
    width: Length | None = None
    displacement: tuple[Component, Component] | None = None
    traction: tuple[Number, Number] | None = None
    pressure: Number | None = None
    force: tuple[Number, Number] | None = None

    @model_validator(mode="after")
    def _one_place_and_one_quantity(self) -> Self:
        places = {"on": self.on, "from": self.start or self.end, "at": self.at or self.width}
        given = [name for name, value in places.items() if value is not None]
        if len(given) != 1:
            found = f"has {' and '.join(given)}" if given else "has none"
            raise ValueError(f"needs exactly one of on, from and to, at and width; it {found}")
        if (self.start is None) != (self.end is None):
            raise ValueError("from and to belong together; give both ends of the stretch")
        if (self.at is None) != (self.width is None):
            raise ValueError("at and width belong together; give both")
        exactly_one(self, ("displacement", "traction", "pressure", "force"))
        if self.displacement == ("free", "free"):
            raise ValueError('displacement = ["free", "free"]: holds nothing; leave the condition out')
        return self

    def stretches(self, width: float, height: float) -> list[tuple[Point, Point]]:
        """Its straight stretches on a plate's edge, counter-clockwise, mm.

        Raises
        ------
        ValueError
            When a point is not on the edge.
        """
        edges = plate_edges(width, height)
        if self.on is not None:
            return list(edges) if self.on == "outer" else [edges[EDGES.index(self.on)]]
        if self.at is not None:
            assert self.width is not None
            k, along = _place(self.at, width, height, "at")
            length = (width, height)[k % 2]
            low, high = along - self.width / 2, along + self.width / 2
            if low < -1e-9 * length or high > length * (1 + 1e-9):
                raise ValueError(f"width = {self.width:g}: the stretch goes beyond the {EDGES[k]} edge")
            return [(_point(k, max(low, 0.0), width, height), _point(k, min(high, length), width, height))]
        assert self.start is not None and self.end is not None
        (first, low), (last, high) = (
            _place(point, width, height, key) for point, key in ((self.start, "from"), (self.end, "to"))
        )
        if self.start == self.end:
            raise ValueError("from and to are the same point; a stretch has a length")
        lengths = (width, height, width, height)
        if first == last and high > low:
            return [(_point(first, low, width, height), _point(first, high, width, height))]
        found = [(first, low, lengths[first])]
        k = (first + 1) % 4
        while k != last:
            found.append((k, 0.0, lengths[k]))
            k = (k + 1) % 4
        found.append((last, 0.0, high))
        return [
            (_point(k, a, width, height), _point(k, b, width, height))
            for k, a, b in found
            if b - a > 1e-9 * lengths[k]
        ]


def _place(point: Point, width: float, height: float, key: str) -> tuple[int, float]:
    """The edge that a point lies on, and how far along it, counter-clockwise, mm."""
    x, y = point
    near = 1e-6 * max(width, height)
    along = (x, y, width - x, height - y)
    across = (y, width - x, height - y, x)
    lengths = (width, height, width, height)
    for k in range(4):
        if abs(across[k]) <= near and -near <= along[k] < lengths[k] - near:
            return k, max(along[k], 0.0)
    raise ValueError(
        f"{key} = [{x:g}, {y:g}]: must lie on the plate's edge (0 to {width:g}, 0 to {height:g})"
    )


def _point(k: int, along: float, width: float, height: float) -> Point:
    """A point of an edge."""
    return ((along, 0.0), (width, along), (width - along, height), (0.0, height - along))[k]


class _Placed(NamedTuple):
    """A condition with what of its stretch is material."""

    key: str
    condition: Condition
    material: shapely.Geometry

    @property
    def acts(self) -> tuple[bool, bool]:
        """In which directions."""
        (x, y), (t_x, t_y) = self.condition.is_held, self.condition.traction
        return x or bool(t_x), y or bool(t_y)


def general_loading(tables: tuple[Boundary, ...], part: Part) -> tuple[Loading, list[str]]:
    """Conditions on a plate, and what is wrong with them, each a sentence that starts with its key."""
    (_, _), (width, height) = part.box
    placed: list[_Placed] = []
    problems: list[str] = []
    for i, table in enumerate(tables):
        key = f"boundary[{i}]"
        try:
            stretches = table.stretches(float(width), float(height))
        except ValueError as error:
            problems.append(f"{key}.{error}")
            continue
        edge = part.body.exterior
        material = [shapely.LineString(stretch).intersection(edge) for stretch in stretches]
        total = sum(piece.length for piece in material)
        if total < LEAST * sum(shapely.LineString(stretch).length for stretch in stretches):
            problems.append(f"{key}: no material there, between the notches; it holds and loads nothing")
            continue
        placed += [
            _Placed(key, _condition(table, stretch, total * part.thickness), piece)
            for stretch, piece in zip(stretches, material, strict=True)
            if piece.length > 0
        ]
    if not problems:
        problems = [*_overlaps(placed, part.tolerance), *_balance(placed)]
    return Loading(tuple(p.condition for p in placed)), problems


def _condition(table: Boundary, stretch: tuple[Point, Point], area: float) -> Condition:
    """A condition on one stretch of all that the table names, whose material has an area, mm^2."""
    (x0, y0), (x1, y1) = stretch
    if table.displacement is not None:
        u_x, u_y = (None if u == "free" else Affine(float(u)) for u in table.displacement)
        return Condition(*stretch, (u_x, u_y))
    if table.traction is not None:
        return Condition(*stretch, traction=table.traction)
    if table.pressure is not None:
        length = float(np.hypot(x1 - x0, y1 - y0))
        # onto the surface: against the outward normal
        return Condition(
            *stretch, traction=(-table.pressure * (y1 - y0) / length, table.pressure * (x1 - x0) / length)
        )
    assert table.force is not None
    return Condition(*stretch, traction=(table.force[0] / area, table.force[1] / area))


def _overlaps(placed: list[_Placed], near: float) -> list[str]:
    """Pairs of conditions that act in the same direction on the same stretch."""
    found = []
    for one, other in combinations(placed, 2):
        both = any(a and b for a, b in zip(one.acts, other.acts, strict=True))
        if both and one.material.intersection(other.material).length > near:
            found.append(f"{one.key} and {other.key}: overlap, and act in the same direction there")
    return list(dict.fromkeys(found))


def _balance(placed: list[_Placed]) -> list[str]:
    """Nothing that loads, or motions that are free and loads that do not balance."""
    moved = [c for p in placed for c in p.condition.displacement if c is not None and any(c)]
    if not moved and not any(any(p.condition.traction) for p in placed):
        return ["boundary: moves and loads nothing; without a load there is no failure to predict"]
    pieces = [
        (piece, p.condition)
        for p in placed
        for piece in shapely.get_parts(p.material)
        if piece.geom_type == "LineString"
    ]
    ends = np.array([piece.coords[k] for piece, _ in pieces for k in (0, -1)])
    held = np.array([condition.is_held for _, condition in pieces for _ in (0, 1)])
    motions = free_motions(ends, held)
    free = motions.reshape(len(pieces), 2, 2, motions.shape[1])
    # a uniform traction works on the mean motion of its stretch, which is that of its ends
    force = np.array([np.array(condition.traction) * piece.length for piece, condition in pieces])
    work = np.einsum("pi,peik->k", force, free) / 2
    if np.abs(work).max(initial=0.0) <= UNBALANCED * np.abs(force).sum():
        return []
    x, y = force.sum(axis=0)
    return [
        "boundary: the part is free to move, and what acts on it does not balance: forces of "
        f"({x:.4g}, {y:.4g}) N for each mm of thickness are left, or a moment; hold it, or balance the loads"
    ]
