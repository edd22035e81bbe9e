"""Holes that overlap are one hole: the union of outlines, on their exact curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.outline import Outline

Array = NDArray[np.float64]

#: outlines that cross at less than this angle (rad) touch: where, is better told by a corner of one of them
TOUCHING = 0.02


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
    return Outline.of_parts(
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
