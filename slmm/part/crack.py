"""A crack as a line with two ends, each of them a tip, on a surface of the part or on another crack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.chords import OFF
from slmm.part.outline import Outline

Array = NDArray[np.float64]

#: points as near to an outline lie on it, as a share of its length; round-off
SAME = 1e-12


class End(NamedTuple):
    """Where a crack ends.

    Attributes
    ----------
    kind : str
        "tip" in the material, "surface", or "crack": on another one.
    number : int
        The outline whose surface it is, -1 for a straight outer edge; or the other crack.
    """

    kind: Literal["tip", "surface", "crack"]
    number: int = -1


TIP = End("tip")


@dataclass(frozen=True, eq=False)
class Crack:
    """A crack: free faces along a line through the material.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        From one end to the other, mm; the ends lie exactly on what they end at.
    start, end : End
    """

    points: Array
    start: End = TIP
    end: End = TIP

    @cached_property
    def shape(self) -> shapely.LineString:
        """Its line."""
        return shapely.LineString(self.points)

    @property
    def tips(self) -> list[Array]:
        """For each of its tips the line (n, 2) that leads there, the tip last."""
        from_start = [self.points[::-1]] if self.start == TIP else []
        return from_start + ([self.points] if self.end == TIP else [])


def in_material(points: Array, body: shapely.Polygon, tolerance: float) -> Array:
    """The stretch (n, 2) of a line that lies in the body, from its first point towards its last one.

    Raises
    ------
    ValueError
        When it is not one stretch.
    """
    if _is_inside(points, body, tolerance):
        return points
    line = shapely.LineString(points)
    parts = [part for part in shapely.get_parts(line.intersection(body)) if part.length > tolerance]
    if len(parts) != 1 or parts[0].geom_type != "LineString":
        raise ValueError(f"crack {np.asarray(points).tolist()}: must run through the material in one piece")
    inside = shapely.get_coordinates(parts[0])
    along = [line.project(shapely.Point(point)) for point in (inside[0], inside[-1])]
    return inside if along[0] < along[1] else inside[::-1]


def _is_inside(points: Array, body: shapely.Polygon, tolerance: float) -> bool:
    """Whether a line (n, 2) lies in the body but for a tolerance at its ends, which decides nothing."""
    steps = np.diff(points[[0, 1, -1, -2]], axis=0)[::2]
    lengths = np.linalg.norm(steps, axis=1)
    if lengths.min() <= 2 * tolerance:
        return False
    inner = points.copy()
    inner[[0, -1]] += tolerance * steps / lengths[:, None]
    return bool(shapely.contains_properly(body, shapely.LineString(inner)))


def located(
    lines: Sequence[Array],
    body: shapely.Polygon,
    outer: shapely.LinearRing,
    holes: Sequence[Outline],
    tolerance: float,
    known: Sequence[Crack] = (),
) -> tuple[Crack, ...]:
    """Cracks along lines (n, 2), their ends on what they end at.

    Parameters
    ----------
    lines : sequence of ndarray, shape (n, 2)
        What lies in a hole or beyond the outer edge is left out.
    body : shapely.Polygon
        The part without its holes, as a polygon.
    outer : shapely.LinearRing
        Its outer edge.
    holes : sequence of Outline
    tolerance : float
        An end as near to a surface or to another crack lies on it, mm.
    known : sequence of Crack
        Those of the same body that have been located: the first lines may be theirs, or go on from these.

    Raises
    ------
    ValueError
        When a line is not one stretch in the body.
    """
    cracks = []
    shapely.prepare(body)
    for number, line in enumerate(lines):
        if number < len(known) and line is known[number].points:
            cracks.append(known[number])
            continue
        line = np.asarray(line, dtype=float)
        points = in_material(line, body, tolerance).copy()
        old = known[number] if number < len(known) else None
        ends = []
        for k in (0, -1):
            if old is not None and (line[k] == old.points[k]).all():
                points[k] = line[k]
                ends.append(old.end if k else old.start)
                continue
            # the body's chords may have cut off what lies on the surface
            if np.linalg.norm(points[k] - line[k]) <= tolerance:
                points[k] = line[k]
            end, points[k] = surface_at(points[k], outer, holes, tolerance)
            ends.append(end)
        cracks.append(Crack(points, *ends))
    tree = shapely.STRtree([crack.shape for crack in cracks])
    return tuple(_on_others(number, cracks, tree, tolerance) for number in range(len(cracks)))


def surface_at(
    point: Array, outer: shapely.LinearRing, holes: Sequence[Outline], tolerance: float
) -> tuple[End, Array]:
    """What surface a point (2,) lies on (a tip: on none), and where exactly, mm."""
    for k, hole in enumerate(holes):
        near = tolerance + OFF * hole.length
        low, high = hole.box
        if ((point < low - near) | (point > high + near)).any():
            continue
        nearest = hole.points(hole.project(point[None]))[0]
        away = np.linalg.norm(nearest - point)
        if away <= near:
            # what lies on it stays as it is
            return End("surface", k), point if away <= SAME * hole.length else nearest
    at = shapely.Point(point)
    if at.distance(outer) <= tolerance:
        return End("surface"), _nearest_on(shapely.get_coordinates(outer), point, tolerance)
    return TIP, point


def _on_others(number: int, cracks: Sequence[Crack], tree: shapely.STRtree, tolerance: float) -> Crack:
    """A crack with its free ends on the others that they touch; their lines are in the tree."""
    crack = cracks[number]
    if TIP not in (crack.start, crack.end):
        return crack
    points, ends = crack.points.copy(), {"start": crack.start, "end": crack.end}
    for name, k in (("start", 0), ("end", -1)):
        if ends[name] != TIP:
            continue
        others = touched(points[k], tree, tolerance)
        if others := [other for other in others if other != number]:
            ends[name] = End("crack", others[0])
            points[k] = _nearest_on(cracks[others[0]].points, points[k], tolerance)
    return replace(crack, points=points, **ends)


def touched(point: Array, tree: shapely.STRtree, tolerance: float) -> list[int]:
    """Which lines of a tree a point (2,) lies on, ascending."""
    found: list[int] = tree.query(shapely.Point(point), predicate="dwithin", distance=tolerance).tolist()
    return sorted(found)


def _nearest_on(line: Array, point: Array, tolerance: float) -> Array:
    """The point (2,) of a polyline (n, 2) that lies nearest, one of its own where that is as near."""
    away = np.linalg.norm(line - point, axis=1)
    if away.min() <= tolerance:
        return line[away.argmin()]
    a, along = line[:-1], np.diff(line, axis=0)
    t = np.clip(((point - a) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    foot = a + t[:, None] * along
    # what lies on it stays as it is
    distance = np.linalg.norm(foot - point, axis=1)
    return point if distance.min() <= 1e-12 * np.abs(line).max() else foot[distance.argmin()]


def joined(cracks: Sequence[Crack], tolerance: float) -> list[Array]:
    """The lines (n, 2) of cracks, with points of their own wherever two of them touch or cross."""
    lines = [crack.points.copy() for crack in cracks]
    if len(lines) < 2:
        return lines
    shapes = [crack.shape for crack in cracks]
    near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=tolerance).T
    pairs = [(i, k) for i, k in near.tolist() if i < k]
    if not pairs:
        return lines
    for i, k in pairs:
        ends = [
            crack.points[place]
            for crack, other in ((cracks[i], cracks[k]), (cracks[k], cracks[i]))
            for place in (0, -1)
            if shapely.Point(crack.points[place]).distance(shapely.LineString(other.points)) <= tolerance
        ]
        meeting = shapely.get_coordinates(shapes[i].intersection(shapes[k]))
        for at in [*ends, *meeting]:
            for number in (i, k):
                lines[number] = with_point(lines[number], at, tolerance)
    # the same place is the same numbers on each of them
    known = np.empty((0, 2))
    for line in lines:
        for n, at in enumerate(line):
            same = np.flatnonzero(np.abs(known - at).max(axis=1) <= tolerance)
            if len(same):
                line[n] = known[same[0]]
            else:
                known = np.vstack([known, at])
    return lines


def with_point(line: Array, at: Array, tolerance: float) -> Array:
    """A line (n, 2) with one more point of it, unless it has that; a copy."""
    if np.linalg.norm(line - at, axis=1).min() <= tolerance:
        return line.copy()
    shape = shapely.LineString(line)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return np.insert(line, int(np.searchsorted(along, shape.project(shapely.Point(at)))), at, axis=0)
