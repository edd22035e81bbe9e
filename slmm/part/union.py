"""Holes that overlap are one hole: the union of outlines, on their exact curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.accuracy import Accuracy
from slmm.part.outline import AT_CORNER, Outline, read_only
from slmm.part.outline_splines import turns_at

Array = NDArray[np.float64]

#: outlines that cross at less than this angle (rad) touch: where, is better told by a corner of one of them; chosen
TOUCHING = 0.02
#: where stretches of other outlines touch, the point is known to about a millionth of them, and the angle to its
#: root; chosen
TOUCHING_TURN = 0.01


def united(
    named: Sequence[tuple[str, Outline]],
    polygons: Sequence[shapely.Polygon],
    plate: shapely.Polygon,
    tolerance: float,
) -> tuple[list[tuple[str, Outline]], list[str]]:
    """Outlines with their names, those that overlap in the plate as one; and what is wrong with their unions.

    Parameters
    ----------
    named : sequence of (str, Outline)
    polygons : sequence of shapely.Polygon
        Close to the outlines, and valid.
    plate : shapely.Polygon
    tolerance : float
        Overlaps less wide than this are touches, which are left alone, mm.
    """
    result, problems = [], []
    for group in _groups(polygons, plate.buffer(2 * tolerance), tolerance):
        if len(group) == 1:
            result.append(named[group[0]])
            continue
        name = " and ".join(dict.fromkeys(named[k][0] for k in group))
        union = shapely.union_all([polygons[k] for k in group])
        islands = [
            shapely.Polygon(ring)
            for ring in union.interiors
            if _mean_width(shapely.Polygon(ring).intersection(plate)) > tolerance
        ]
        for island in islands:
            x, y = island.representative_point().coords[0]
            problems.append(
                f"{name}: enclose a loose piece of material at ({x:.6g}, {y:.6g}); cover it by a hole, or move"
                " the holes apart"
            )
        if not islands:
            result.append((name, _union([named[k][1] for k in group], polygons, group, union, tolerance)))
    return result, problems


def _mean_width(shape: shapely.Geometry) -> float:
    return 2 * shape.area / shape.length if shape.length > 0 else 0.0


def _groups(
    polygons: Sequence[shapely.Polygon], around_plate: shapely.Polygon, tolerance: float
) -> list[list[int]]:
    """Numbers of the polygons that hang together, in order of the first one of each group."""
    group = list(range(len(polygons)))
    if not group:
        return []
    tree = shapely.STRtree(polygons)
    for i, k in sorted(zip(*tree.query(polygons, predicate="intersects"), strict=True)):
        if i >= k:
            continue
        one, other = polygons[i], polygons[k]
        overlap = one.intersection(other).intersection(around_plate)
        # one within another is no keyhole, and said elsewhere
        if _mean_width(overlap) > tolerance and not (one.contains(other) or other.contains(one)):
            old, new = max(group[i], group[k]), min(group[i], group[k])
            group = [new if member == old else member for member in group]
    return [[i for i, member in enumerate(group) if member == first] for first in sorted(set(group))]


def _union(
    outlines: Sequence[Outline],
    polygons: Sequence[shapely.Polygon],
    group: Sequence[int],
    union: shapely.Polygon,
    tolerance: float,
) -> Outline:
    """The outer outline of some outlines."""
    ring = shapely.get_coordinates(shapely.orient_polygons(union).exterior)
    middles = shapely.points(0.5 * (ring[1:] + ring[:-1]))
    distance = np.array([shapely.distance(polygons[k].exterior, middles) for k in group])
    runs = _runs(distance <= 1e-3 * tolerance, ring, tolerance)
    if len(runs) == 1:
        return outlines[runs[0][0]]
    joints = [
        _joint(outlines[one], outlines[other], ring[start], tolerance)
        for (one, _), (other, start) in zip([runs[-1], *runs[:-1]], runs, strict=True)
    ]
    return of_stretches(
        [
            (outlines[number], joint[1], following[0])
            for (number, _), joint, following in zip(runs, joints, [*joints[1:], joints[0]], strict=True)
        ]
    )


def _runs(on: NDArray[np.bool_], ring: Array, tolerance: float) -> list[tuple[int, int]]:
    """Which outline each run of edges of a ring lies on, and the point where it begins.

    ``on`` (outlines, edges) says which outlines an edge lies on. A run is followed as far as it goes; those shorter
    than the tolerance are the traces of chords that miss a tangent point.
    """
    current, runs = int(on[:, 0].argmax()), []
    runs.append((current, 0))
    for edge in range(1, on.shape[1]):
        if not on[current, edge]:
            current = int(on[:, edge].argmax())
            runs.append((current, edge))
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    ends = [start for _, start in runs[1:]] + [len(ring) - 1]
    runs = [run for run, end in zip(runs, ends, strict=True) if along[end] - along[run[1]] > 5 * tolerance]
    merged = [run for k, run in enumerate(runs) if k == 0 or run[0] != runs[k - 1][0]]
    if len(merged) > 1 and merged[0][0] == merged[-1][0]:
        merged[0] = merged.pop()
    return merged


def _joint(one: Outline, other: Outline, near: Array, tolerance: float) -> tuple[float, float]:
    """Arc lengths on two outlines where the first goes over into the other, near a point (2,)."""
    s = [float(outline.project(near[None])[0]) for outline in (one, other)]
    for k, outline in enumerate((one, other)):
        corner = int(outline.corner_at(s[k], within=5 * tolerance))
        if corner >= 0:  # it touches the other outline there
            s[k] = float(outline.corners[corner])
            s[1 - k] = float((one, other)[1 - k].project(outline.points(s[k])[None])[0])
            gap = outline.points(s[k]) - (one, other)[1 - k].points(s[1 - k])
            if np.hypot(*gap) <= tolerance:
                return s[0], s[1]
    best = s
    for _ in range(20):
        slopes = one.tangents(s[0]), other.tangents(s[1])
        matrix = np.column_stack([slopes[0], -slopes[1]])
        if abs(np.linalg.det(matrix)) < TOUCHING:
            break
        gap = one.points(s[0]) - other.points(s[1])
        if np.hypot(*gap) <= np.hypot(*(one.points(best[0]) - other.points(best[1]))):
            best = s
        step = np.linalg.solve(matrix, -gap)
        if np.abs(step).max() < 1e-14 * (one.length + other.length):
            break
        if np.abs(step).max() > 100 * tolerance:
            break
        s = [s[0] + float(step[0]), s[1] + float(step[1])]
    return best[0] % one.length, best[1] % other.length


def of_stretches(parts: Sequence[tuple[Outline, float, float]]) -> Outline:
    """Outline of stretches of others, counter-clockwise, on their exact curves.

    Parameters
    ----------
    parts : sequence of (Outline, float, float)
        An outline and the arc lengths from which and up to which it is followed, mm. Each stretch ends where the
        next one begins; what rounding leaves between them is made up for along the stretch. Two that meet at
        less than 0.01 rad touch there, without a corner.
    """
    steps, coefficients, corners, first = [], [], [], []
    reached, number = 0.0, 0
    for k, (outline, start, end) in enumerate(parts):
        following, beginning, _ = parts[(k + 1) % len(parts)]
        missing = following.points(beginning) - outline.points(end)
        own_steps, own = _cut(outline, start, end)
        along = np.concatenate([[0.0], np.cumsum(own_steps)])
        own[3] += missing * (along[:-1] / along[-1])[:, None]
        own[2] += missing / along[-1]
        inner = (outline.corners - start) % outline.length
        nearest = AT_CORNER * outline.length
        inner = np.sort(inner[(inner > nearest) & (inner < along[-1] - nearest)])
        corners.append(along[np.abs(along[:, None] - inner).argmin(axis=0)] + reached)
        first.append(number)
        steps.append(own_steps)
        coefficients.append(own)
        reached, number = reached + along[-1], number + len(own_steps)
    breaks = np.concatenate([[0.0], np.cumsum(np.concatenate(steps))])
    joined = np.concatenate(coefficients, axis=1)
    turns = np.abs(turns_at(breaks, joined, np.array(first))[1])
    at = np.concatenate([*corners, breaks[np.array(first)[turns >= TOUCHING_TURN]]])
    # sums in another order differ by rounding: each corner is one of the breaks
    at = breaks[np.unique(np.abs(breaks[:-1, None] - at).argmin(axis=0))] if len(at) else at
    known = [outline.accuracy for outline in dict.fromkeys(part[0] for part in parts)]
    traced = [accuracy for accuracy in known if accuracy is not None]
    return Outline(
        read_only(breaks),
        read_only(joined),
        read_only(at),
        Accuracy.of_all(traced) if traced else None,
    )


def _cut(outline: Outline, start: float, end: float) -> tuple[Array, Array]:
    """Steps (m,) and coefficients (4, m, 2) of an outline from one arc length on to another."""
    length = outline.length
    extent = (end - start) % length or length
    inner = np.sort((outline.breaks[:-1] - start) % length)
    inner = inner[(inner > AT_CORNER * length) & (inner < extent - AT_CORNER * length)]
    offsets = np.concatenate([[0.0], inner])
    # the middle of a stretch tells its piece, whatever rounding does at its ends
    steps = np.diff(np.append(offsets, extent))
    middle = (start + offsets + 0.5 * steps) % length
    piece = np.clip(np.searchsorted(outline.breaks, middle, side="right") - 1, 0, len(outline.breaks) - 2)
    t = (middle - 0.5 * steps - outline.breaks[piece])[:, None]
    a, b, c, d = outline.coefficients[:, piece]
    return steps, np.array([a, 3 * a * t + b, (3 * a * t + 2 * b) * t + c, ((a * t + b) * t + c) * t + d])
