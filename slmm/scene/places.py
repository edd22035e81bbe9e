"""Where a condition acts: stretches of a plate's straight edges, and spans of curved outlines."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.span import Span
from slmm.scene.loading import Point, plate_edges

EDGES = ("bottom", "right", "top", "left")
HOLE = re.compile(r"hole (\d{1,6})")
#: a point as near to a surface lies on it, as a share of the part's larger side; chosen
ON_SURFACE = 1e-5


class Place(Protocol):
    """Exactly one of: a name, two ends, or a point with a width."""

    @property
    def on(self) -> str | None:
        """An edge, "outer" or "hole" with its number."""

    @property
    def start(self) -> Point | None:
        """With ``end``, a stretch counter-clockwise."""

    @property
    def end(self) -> Point | None:
        """The other end of that."""

    @property
    def at(self) -> Point | None:
        """With ``width``, a short stretch about a point, mm."""

    @property
    def width(self) -> float | None:
        """Of the stretch, mm."""


def located(place: Place, part: Part) -> Sequence[tuple[Point, Point] | Span]:
    """The stretches of a part that a place names: straight ones of a plate, or a span of an outline.

    Raises
    ------
    ValueError
        When the part has no such place.
    """
    if place.on is not None:
        return _by_name(place.on, part)
    given, key = (place.at, "at") if place.at is not None else (place.start, "from")
    assert given is not None
    near = ON_SURFACE * float(np.ptp(part.outer, axis=0).max())
    points = np.array([given])
    for outline in part.outlines:
        if np.linalg.norm(outline.points(outline.project(points)) - points) <= near:
            return [_span(place, outline, near)]
    if part.rim is None:
        _, (width, height) = part.box
        return on_plate(place, float(width), float(height))
    (left, bottom), (right, top) = part.box
    raise ValueError(
        f"{key} = [{given[0]:g}, {given[1]:g}]: must lie on a surface of the part ({left:g} to {right:g}, "
        f"{bottom:g} to {top:g})"
    )


def _by_name(name: str, part: Part) -> Sequence[tuple[Point, Point] | Span]:
    if match := HOLE.fullmatch(name):
        number = int(match[1])
        if number >= len(part.holes):
            raise ValueError(f'on = "{name}": the part has {len(part.holes)} holes, which count from 0')
        return [_whole(part.holes[number])]
    if part.rim is not None:
        if name != "outer":
            raise ValueError(
                f'on = "{name}": is an edge of a plate; give "outer", "hole" and its number, from and to, or at'
            )
        return [_whole(part.rim)]
    _, (width, height) = part.box
    edges = plate_edges(float(width), float(height))
    return list(edges) if name == "outer" else [edges[EDGES.index(name)]]


def _whole(outline: Outline) -> Span:
    return Span(outline, outline.length, 0.0)


def _span(place: Place, outline: Outline, near: float) -> Span:
    """Of an outline on which the place's first point lies."""
    if place.at is not None:
        assert place.width is not None
        if place.width > outline.length:
            raise ValueError(f"width = {place.width:g}: the whole outline is {outline.length:.6g} mm long")
        middle = float(outline.project(np.array([place.at]))[0])
        return Span(outline, middle + place.width / 2, middle - place.width / 2)
    assert place.start is not None and place.end is not None
    ends = np.array([place.start, place.end])
    start, end = s = outline.project(ends)
    x, y = place.end
    if np.linalg.norm(outline.points(s)[1] - ends[1]) > near:
        raise ValueError(f"to = [{x:g}, {y:g}]: must lie on the same outline as from")
    if abs(start - end) <= near:
        raise ValueError("from and to are the same point; a stretch has a length")
    # counter-clockwise, that is up around a hole and down around a part
    around_hole = _area(outline) > 0
    first, last = (end, start) if around_hole else (start, end)
    return Span(outline, float(first), float(first - (first - last) % outline.length))


def _area(outline: Outline) -> float:
    x, y = outline.polygon(400).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def on_plate(place: Place, width: float, height: float) -> list[tuple[Point, Point]]:
    """Straight stretches on a plate's edge, counter-clockwise, mm.

    Raises
    ------
    ValueError
        When a point is not on the edge.
    """
    if place.at is not None:
        assert place.width is not None
        k, along = _on_edge(place.at, width, height, "at")
        length = (width, height)[k % 2]
        low, high = along - place.width / 2, along + place.width / 2
        if low < -1e-9 * length or high > length * (1 + 1e-9):
            raise ValueError(f"width = {place.width:g}: the stretch goes beyond the {EDGES[k]} edge")
        return [(_point(k, max(low, 0.0), width, height), _point(k, min(high, length), width, height))]
    assert place.start is not None and place.end is not None
    (first, low), (last, high) = (
        _on_edge(point, width, height, key) for point, key in ((place.start, "from"), (place.end, "to"))
    )
    if place.start == place.end:
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


def _on_edge(point: Point, width: float, height: float, key: str) -> tuple[int, float]:
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
