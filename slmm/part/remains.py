"""What is left of a part when pieces of it fall out: faces of cracks become edges of holes, and of notches."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import ops

from slmm.part.chords import OFF, chords
from slmm.part.outline import SMALLEST_TURN, Outline, read_only
from slmm.part.part import Part
from slmm.part.union import of_stretches

Array = NDArray[np.float64]

#: edges of pieces as near to a curve are its own, over the part's tolerance; round-off
ON_CURVE = 1e-4
#: notches are closed so far outside of the part, over its tolerance, clear of the chords of its rim; chosen
BEYOND = 50.0
#: cracks end so near to where polygons cross them, over the part's tolerance, and chords besides; round-off
AT_MOUTH = 5.0
#: what the edge of a piece may be, beside the number of a hole
EDGE, FACE = -1, -2


class Remains(NamedTuple):
    """A part without the pieces that fell out.

    Attributes
    ----------
    part : Part
        Faces of cracks that are surfaces belong to a hole of it, or to a notch in its outer edge.
    cracks : tuple of int
        For each of its cracks, of which crack of the part before it is a stretch.
    holes : tuple of int
        For each of its holes which one it was, the first of those that it unites, or -1 of a new notch.
    """

    part: Part
    cracks: tuple[int, ...]
    holes: tuple[int, ...]


class _Run(NamedTuple):
    """Points (n, 2) around a piece, which is on their right, on one curve: a hole's number, `EDGE` or `FACE`."""

    on: int
    points: Array


def remains(part: Part, kept: shapely.Polygon) -> Remains:
    """A part of which one piece is left, its surfaces on the exact curves.

    Parameters
    ----------
    part : Part
    kept : Polygon
        One of its pieces.

    Raises
    ------
    ValueError
        When the piece has nothing of the outer edge, or what comes out is not the piece.

    Examples
    --------
    Two cracks between two holes cut out what lies between them.

    >>> from slmm.part.shapes import circle
    >>> holes = [Outline.through(circle((x, 20.0), 5.0)) for x in (12.0, 28.0)]
    >>> part = Part.plate(40.0, 40.0, holes, [[(12.0, y), (28.0, y)] for y in (18.0, 22.0)])
    >>> kept, loose = sorted(part.pieces, key=lambda piece: -piece.area)
    >>> left = remains(part, kept)
    >>> left.part.cracks, left.holes, round(left.part.body.area / kept.area, 6)
    ((), (0,), 1.0)
    """
    kept = shapely.orient_polygons(kept)
    exterior, *interiors = (_runs(part, ring) for ring in (kept.exterior, *kept.interiors))
    first = next((k for k, run in enumerate(exterior) if run.on == EDGE), None)
    if first is None:
        raise ValueError("a piece came loose with the whole outer edge of the part")
    around = [*exterior[first:], *exterior[:first]]
    notches = [list(runs) for is_edge, runs in groupby(around, lambda run: run.on == EDGE) if not is_edge]
    found = {_outline(part, runs, True): _holes_of(runs) for runs in notches}
    found |= {_outline(part, runs, False): _holes_of(runs) for runs in interiors}
    found = dict(sorted(found.items(), key=lambda item: min(item[1], default=len(part.holes))))
    lines, cracks = _within(part, kept)
    left = Part(part.outer, tuple(found), (), part.thickness, part.rim)
    if abs(left.body.area - kept.area) > part.tolerance * kept.length:
        raise ValueError(
            f"what a piece came loose from has {left.body.area:.6g} mm2, and not {kept.area:.6g}"
        )
    holes = tuple(min(numbers, default=-1) for numbers in found.values())
    return Remains(left.with_cracks(lines) if lines else left, cracks, holes)


def _holes_of(runs: Sequence[_Run]) -> list[int]:
    return sorted({run.on for run in runs if run.on >= 0})


def _runs(part: Part, ring: shapely.LinearRing) -> list[_Run]:
    """A ring around a piece, cut where one curve gives way to another."""
    points = np.array(ring.coords)[::-1]
    middle = shapely.points(0.5 * (points[1:] + points[:-1]))
    near = ON_CURVE * part.tolerance
    on = np.full(len(middle), FACE)
    for number, line in [(EDGE, part.outer), *enumerate(map(chords, part.holes))]:
        curve = shapely.LinearRing(line)
        shapely.prepare(curve)
        on[shapely.dwithin(curve, middle, near)] = number
    changes = np.flatnonzero(on != np.roll(on, 1))
    if not len(changes):
        return [_Run(int(on[0]), points)]
    n = len(on)
    ends = [*changes[1:], changes[0] + n]
    return [_Run(int(on[a]), points[np.arange(a, b + 1) % n]) for a, b in zip(changes, ends, strict=True)]


def _outline(part: Part, runs: Sequence[_Run], is_open: bool) -> Outline:
    """The outline of a hole, or of a notch, that has these edges in the part; that of the part where it is one."""
    if len(runs) == 1 and runs[0].on >= 0:
        return part.holes[runs[0].on]
    if len(runs) == 1 and not is_open:
        return _polyline(runs[0].points[:-1])
    runs = [_Run(run.on, _from_mouths(part, run.points)) if run.on == FACE else run for run in runs]
    beyond = BEYOND * part.tolerance
    stretches = []
    for k, (on, points) in enumerate(runs):
        # where a curve leaves the part it goes on outside
        leads_in, leads_out = is_open and k == 0, is_open and k == len(runs) - 1
        if on == FACE:
            into = [_further(points[1], points[0], beyond)] if leads_in else []
            out = [_further(points[-2], points[-1], beyond)] if leads_out else []
            stretches.append(_line(np.array([*into, *points, *out])))
        else:
            ends = (
                points[0] if leads_in else runs[k - 1].points[-1],
                points[-1] if leads_out else runs[(k + 1) % len(runs)].points[0],
            )
            start, end = part.holes[on].project(np.array(ends))
            stretches.append((part.holes[on], start - beyond * leads_in, end + beyond * leads_out))
    if is_open:
        (curve, _, end), (other, start, _) = stretches[-1], stretches[0]
        path = _outside(part, runs[-1].points[-1], runs[0].points[0], beyond)
        ends = curve.points(end), other.points(start)
        apart = np.array([np.linalg.norm(path - point, axis=1) for point in ends]).min(axis=0)
        stretches.append(_line(np.array([ends[0], *path[apart > 0.1 * beyond], ends[1]])))
    return of_stretches(stretches)


def _from_mouths(part: Part, points: Array) -> Array:
    """Points (n, 2) along faces of cracks, of which the first and last are where cracks end, and not beside it."""
    mouths = np.array([crack.points[k] for crack in part.cracks for k in (0, -1)])
    near = AT_MOUTH * part.tolerance + OFF * max((hole.length for hole in part.outlines), default=0.0)
    first, last = (mouths[np.linalg.norm(mouths - point, axis=1).argmin()] for point in points[[0, -1]])
    away = np.array([np.linalg.norm(points - end, axis=1) for end in (first, last)])
    return np.array([first, *points[(away > near).all(axis=0)], last])


def _further(start: Array, end: Array, way: float) -> Array:
    """The point (2,) so far behind the end of a line."""
    return np.asarray(end + way * (end - start) / np.linalg.norm(end - start))


def _outside(part: Part, start: Array, end: Array, beyond: float) -> Array:
    """Points (n, 2) beside the outer edge, outside of it, counter-clockwise from one of its points to another."""
    corners = np.vstack([part.outer, part.outer, part.outer[:1]])
    twice = shapely.LineString(corners)
    once = 0.5 * twice.length
    first, last = (shapely.line_locate_point(twice, shapely.Point(point)) % once for point in (start, end))
    edge = ops.substring(twice, first, last if last > first else last + once)
    path = shapely.get_coordinates(shapely.offset_curve(edge, -beyond, join_style="mitre"))
    backwards = np.linalg.norm(path[0] - start) > np.linalg.norm(path[-1] - start)
    return path[::-1] if backwards else path


def _line(points: Array) -> tuple[Outline, float, float]:
    """Straight lines from point to point (n, 2) as a stretch of an outline, which leads back."""
    outline = _polyline(points)
    return outline, 0.0, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _polyline(points: Array) -> Outline:
    """Straight lines from point to point (n, 2) and back to the first; not in whichever sense, and it may be thin."""
    along = np.diff(points, axis=0, append=points[:1])
    length = np.linalg.norm(along, axis=1)
    direction = along / length[:, None]
    breaks = np.concatenate([[0.0], np.cumsum(length)])
    before = np.roll(direction, 1, axis=0)
    cross, dot = (
        before[:, 0] * direction[:, 1] - before[:, 1] * direction[:, 0],
        (before * direction).sum(axis=1),
    )
    corners = breaks[:-1][np.abs(np.arctan2(cross, dot)) >= SMALLEST_TURN]
    zero = np.zeros_like(points)
    coefficients = np.array([zero, zero, direction, points])
    return Outline(read_only(breaks), read_only(coefficients), read_only(corners))


def _within(part: Part, kept: shapely.Polygon) -> tuple[list[Array], tuple[int, ...]]:
    """Stretches (n, 2) of cracks within a piece, and of which crack each one is."""
    shapely.prepare(kept)
    near = ON_CURVE * part.tolerance
    found, numbers = [], []
    for number, line in enumerate(part.crack_lines):
        middle = shapely.points(0.5 * (line[1:] + line[:-1]))
        inside = shapely.contains(kept, middle) & ~shapely.dwithin(kept.boundary, middle, near)
        changes = np.diff(np.concatenate([[False], inside, [False]]).astype(int))
        for first, last in zip(np.flatnonzero(changes > 0), np.flatnonzero(changes < 0), strict=True):
            found.append(line[first : last + 1])
            numbers.append(number)
    return found, tuple(numbers)
