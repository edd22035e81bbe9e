"""The general form of a load, `[[boundary]]`: what holds, moves or pulls stretches of a part's surface."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
import shapely
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from slmm.mechanics.rigid import free_motions, motions_about, names_of, unheld
from slmm.part.part import Part
from slmm.part.span import Span
from slmm.scene.load_checks import LEAST, UNBALANCED
from slmm.scene.loading import Affine, Condition, Loading, Point, Stiff
from slmm.scene.places import EDGES, HOLE, located
from slmm.scene.values import Length, Number, PlanePoint, Table, exactly_one

Array = NDArray[np.float64]
Component = Number | Literal["free"]

#: forces below this share of all are round-off
ROUND_OFF = 1e-9
#: share of a pin's force that may point aside: its hole is then no circle, nor alike on both sides; chosen
ASIDE = 1e-3


class Boundary(Table):
    """One condition: where, and exactly one of what.

    ``on`` names an edge of a plate, all of an outer edge ("outer") or a hole ("hole 0"); ``from`` and ``to`` are ends
    of a stretch, counter-clockwise; ``at`` and ``width`` a short stretch about a point. ``displacement`` (mm) holds or
    moves each direction that is not "free"; ``traction`` (MPa), ``pressure`` (MPa, onto the surface), ``force`` (N,
    spread evenly over the material) and ``pin`` (N, as a pin in a hole pushes) load it. With ``stiff`` it moves as one
    body: by the ``force`` through the middle of its material and the ``moment`` about it (N mm, counter-clockwise), or
    with its middle displaced; it turns freely, unless its ``rotation`` (degrees) is given.
    """

    on: str | None = None
    start: Annotated[PlanePoint | None, Field(alias="from")] = None
    end: Annotated[PlanePoint | None, Field(alias="to")] = None
    at: PlanePoint | None = None
    width: Length | None = None
    displacement: tuple[Component, Component] | None = None
    traction: tuple[Number, Number] | None = None
    pressure: Number | None = None
    force: tuple[Number, Number] | None = None
    pin: tuple[Number, Number] | None = None
    stiff: Annotated[bool, Field(strict=True)] = False
    moment: Number | None = None
    rotation: Number | None = None

    @field_validator("on")
    @classmethod
    def _is_a_name(cls, on: str | None) -> str | None:
        if on is not None and on not in (*EDGES, "outer") and not HOLE.fullmatch(on):
            raise ValueError(f'must be one of {", ".join(EDGES)}, outer, or "hole" and its number')
        return on

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
        exactly_one(self, ("displacement", "traction", "pressure", "force", "pin"))
        if self.displacement == ("free", "free"):
            raise ValueError('displacement = ["free", "free"]: holds nothing; leave the condition out')
        if self.stiff and self.force is None and self.displacement is None:
            raise ValueError(
                "stiff = true: moves as one body, by a force or with a displacement of its middle; give one"
            )
        for name in ("moment", "rotation"):
            if getattr(self, name) is not None and not self.stiff:
                raise ValueError(f"{name} = {getattr(self, name):g}: belongs to stiff = true")
        if self.moment is not None and self.rotation is not None:
            raise ValueError("moment and rotation contradict each other; give one of them")
        return self


class _Placed(NamedTuple):
    """A condition, and what of its stretch is material: as a line if it is straight, and for integrals along it.

    Attributes
    ----------
    points, weights : ndarray (n, 2), (n,)
        mm.
    """

    key: str
    condition: Condition
    line: shapely.Geometry | None
    points: Array
    weights: Array

    @property
    def tractions(self) -> Array:
        """MPa, at the points (n, 2)."""
        return self.condition.tractions(self.points, self.condition.outward(self.points))

    @property
    def acts(self) -> tuple[bool, bool]:
        """In which directions."""
        x, y = self.condition.is_held
        t_x, t_y = np.abs(self.tractions).max(axis=0, initial=0.0) > 0
        return x or bool(t_x), y or bool(t_y)


def general_loading(tables: tuple[Boundary, ...], part: Part) -> tuple[Loading, list[str]]:
    """Conditions on a part, and what is wrong with them, each a sentence that starts with its key."""
    placed: list[_Placed] = []
    problems: list[str] = []
    for i, table in enumerate(tables):
        key = f"boundary[{i}]"
        try:
            stretches = located(table, part)
            within = [_material(stretch, part) for stretch in stretches]
            material = sum(float(weights.sum()) for *_, weights, _ in within)
            if material < LEAST * sum(length for *_, length in within):
                problems.append(f"{key}: no material there, between the notches; it holds and loads nothing")
                continue
            stiff = _stiff(table, within, part) if table.stiff else None
            placed += [
                _Placed(
                    key,
                    _condition(table, stretch, points, weights, material, part, stiff),
                    line,
                    points,
                    weights,
                )
                for stretch, (line, points, weights, _) in zip(stretches, within, strict=True)
                if weights.sum() > 0
            ]
        except ValueError as error:
            problems.append(f"{key}.{error}")
    if not problems:
        problems = [*_overlaps(placed, part.tolerance), *_balance(placed)]
    return Loading(tuple(p.condition for p in placed)), problems


class _Material(NamedTuple):
    """What of a stretch is material: as a line if it is straight, points (n, 2), weights (n,), and the whole length."""

    line: shapely.Geometry | None
    points: Array
    weights: Array
    whole: float


def _material(stretch: tuple[Point, Point] | Span, part: Part) -> _Material:
    """What of a stretch is material."""
    if isinstance(stretch, Span):
        points, _, weights = stretch.rule
        near = shapely.dwithin(part.body, shapely.points(points), 10 * part.tolerance)
        return _Material(None, points[near], weights[near], stretch.length)
    whole = shapely.LineString(stretch)
    line = whole.intersection(part.body.exterior)
    pieces = [
        piece for piece in shapely.get_parts(line) if piece.geom_type == "LineString" and piece.length > 0
    ]
    ends = np.array([piece.coords[k] for piece in pieces for k in (0, -1)]).reshape(-1, 2)
    return _Material(line, ends, np.repeat([0.5 * piece.length for piece in pieces], 2), whole.length)


def _condition(
    table: Boundary,
    stretch: tuple[Point, Point] | Span,
    points: Array,
    weights: Array,
    material: float,
    part: Part,
    stiff: Stiff | None,
) -> Condition:
    """A condition on one stretch of all that the table names, of which so many mm are material."""
    if isinstance(stretch, Span):
        x, y = stretch.points(np.array([0.0, 1.0])).tolist()
        empty = Condition((x[0], x[1]), (y[0], y[1]), span=stretch)
    else:
        empty = Condition(*stretch)
    start, end, span = empty.start, empty.end, empty.span
    if stiff is not None:
        return Condition(start, end, _given_motion(table, stiff.middle), span=span, stiff=stiff)
    if table.displacement is not None:
        u_x, u_y = (None if u == "free" else Affine(float(u)) for u in table.displacement)
        return Condition(start, end, (u_x, u_y), span=span)
    if table.traction is not None:
        return Condition(start, end, traction=table.traction, span=span)
    if table.force is not None:
        area = material * part.thickness
        return Condition(start, end, traction=(table.force[0] / area, table.force[1] / area), span=span)
    if table.pressure is not None:
        if span is not None:
            return Condition(start, end, pressure=table.pressure, span=span)
        # onto the surface: against the outward normal
        n_x, n_y = empty.outward(np.zeros((1, 2)))[0].tolist()
        return Condition(start, end, traction=(-table.pressure * n_x, -table.pressure * n_y))
    assert table.pin is not None
    if span is None:
        raise ValueError("pin: pushes in a hole; give the hole, or a force")
    return _pinned(Condition(start, end, span=span), table.pin, points, weights, part.thickness)


def _stiff(table: Boundary, within: Sequence[_Material], part: Part) -> Stiff:
    """The rigid body on what of some stretches is material."""
    points, weights = (
        np.concatenate([getattr(each, name) for each in within]) for name in ("points", "weights")
    )
    length = float(weights.sum())
    x, y = (weights @ points / length).tolist()
    free = [True, True] if table.displacement is None else [u == "free" for u in table.displacement]
    F_x, F_y = (0.0, 0.0) if table.force is None else table.force
    force = F_x / part.thickness, F_y / part.thickness, (table.moment or 0.0) / part.thickness
    return Stiff((x, y), 0.5 * length, (free[0], free[1], table.rotation is None), force)


def _given_motion(table: Boundary, middle: Point) -> tuple[Affine, Affine]:
    """What of a rigid body's motion is given, as displacements."""
    angle = np.radians(table.rotation or 0.0)
    given = table.displacement or ("free", "free")
    x, y = (0.0 if u == "free" else float(u) for u in given)
    return Affine(x + angle * middle[1], 0.0, -angle), Affine(y - angle * middle[0], angle, 0.0)


def _pinned(at: Condition, force: Point, points: Array, weights: Array, thickness: float) -> Condition:
    """A condition with the pressure of a pin, whose resultant is a force, N."""
    size = float(np.hypot(*force))
    if not size > 0:
        raise ValueError("pin = [0, 0]: pushes with nothing")
    along = np.array(force) / size
    outward = at.outward(points)
    share = np.maximum(-outward @ along, 0.0)
    resultant = -(weights * share) @ outward
    if abs(resultant[0] * along[1] - resultant[1] * along[0]) > ASIDE * np.hypot(*resultant):
        raise ValueError(
            f"pin = [{force[0]:g}, {force[1]:g}]: the hole is not alike on both sides of that direction, a pin would "
            "push aside; give a traction"
        )
    x, y = (size * along / (thickness * float(resultant @ along))).tolist()
    return Condition(at.start, at.end, bearing=(x, y), span=at.span)


def _overlaps(placed: list[_Placed], near: float) -> list[str]:
    """Pairs of conditions that act in the same direction on the same stretch."""
    found = []
    for one, other in combinations(placed, 2):
        both = any(a and b for a, b in zip(one.acts, other.acts, strict=True))
        if both and _meet(one, other, near):
            found.append(f"{one.key} and {other.key}: overlap, and act in the same direction there")
    return list(dict.fromkeys(found))


def _meet(one: _Placed, other: _Placed, near: float) -> bool:
    """Whether two conditions act along the same stretch."""
    a, b = one.condition.span, other.condition.span
    if a is not None and b is not None:
        return a.outline is b.outline and a.overlap(b) > near
    if one.line is None or other.line is None:
        return False
    return bool(one.line.intersection(other.line).length > near)


def _balance(placed: list[_Placed]) -> list[str]:
    """Nothing that loads, or motions that are free and loads that do not balance."""
    moved = [c for p in placed for c in p.condition.displacement if c not in (None, Affine())]
    bodies = Loading(tuple(p.condition for p in placed)).stiff
    acts = any(p.condition.is_loaded for p in placed) or any(any(body.force) for body in bodies)
    if not moved and not acts:
        return ["boundary: moves and loads nothing; without a load there is no failure to predict"]
    if bodies:
        return _not_held(placed, bodies)
    points = np.concatenate([p.points for p in placed])
    held = np.concatenate([np.tile(p.condition.is_held, (len(p.points), 1)) for p in placed])
    force = np.concatenate([p.weights[:, None] * p.tractions for p in placed])
    free = free_motions(points, held)
    work = free.T @ force.ravel()
    if np.abs(work).max(initial=0.0) <= UNBALANCED * np.abs(force).sum():
        return []
    total = force.sum(axis=0)
    x, y = np.where(np.abs(total) < ROUND_OFF * np.abs(force).sum(), 0.0, total)
    return [
        f"boundary: the part is free to move {names_of(points, free)}, and what acts on it does not balance: forces of "
        f"({x:.4g}, {y:.4g}) N for each mm of thickness are left, or a moment; hold it, or balance the loads"
    ]


def _not_held(placed: list[_Placed], bodies: Sequence[Stiff]) -> list[str]:
    """Motions that are free of a part with stiff stretches, whose forces then hang in the air."""
    points = np.concatenate([p.points for p in placed])
    middle, reach = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    rows = [
        motions_about(p.points, middle, reach)[:, np.array(p.condition.is_held)].reshape(-1, 3)
        for p in placed
        if p.condition.stiff is None
    ]
    for body in bodies:
        at = motions_about(np.array([body.middle]), middle, reach)[0]
        given = np.vstack([at, [0.0, 0.0, 1.0]])
        rows.append(given[~np.array(body.free)])
    free = unheld(np.concatenate(rows))
    if not len(free):
        return []
    motions = motions_about(points, middle, reach).reshape(-1, 3) @ free.T
    return [
        f"boundary: the part is free to move {names_of(points, motions)}, with what is stiff on it; hold it elsewhere, "
        "or give a displacement or a rotation"
    ]
