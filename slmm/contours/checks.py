"""What is wrong with the geometry of a plate, its holes and its cracks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from shapely import LineString, MultiPolygon, Point, Polygon, box, unary_union
from shapely.validation import explain_validity

from slmm.contours.outline import Outline

Array = NDArray[np.float64]

#: lengths below this share of the plate count as zero
TOLERANCE = 1e-5


def hole_problems(
    outlines: Sequence[Outline], names: Sequence[str], width: float, height: float
) -> list[str]:
    """Problems of the holes with the plate and with each other, each one a sentence that starts with a name.

    Parameters
    ----------
    outlines : sequence of Outline
        Outlines of the holes and edge notches.
    names : sequence of str
        What to call them, eg. "holes[0]".
    width, height : float
        Size of the plate, mm; its lower left corner is (0, 0).
    """
    plate = box(0.0, 0.0, width, height)
    tolerance = TOLERANCE * max(width, height)
    inside = plate.buffer(-tolerance)
    holes = [_polygon(outline) for outline in outlines]
    problems = [
        f"{name}: the outline crosses or touches itself: {explain_validity(hole)}"
        for name, hole in zip(names, holes, strict=True)
        if not hole.is_valid
    ]
    if problems:
        return problems  # the operations below need valid polygons

    for name, hole in zip(names, holes, strict=True):
        left, bottom, right, top = hole.bounds
        extent = f"it spans x = {left:.6g} to {right:.6g}, y = {bottom:.6g} to {top:.6g}"
        if max(right - left, top - bottom) <= tolerance:
            problems.append(f"{name}: is too small for the plate; {extent}")
        elif hole.covers(plate):
            problems.append(f"{name}: covers the whole plate; {extent}")
        elif not hole.intersects(inside):
            problems.append(f"{name}: lies outside the plate (0 to {width:g}, 0 to {height:g}); {extent}")
        elif min(abs(left), abs(bottom), abs(right - width), abs(top - height)) <= tolerance:
            problems.append(
                f"{name}: just touches the plate's edge, so no material is left there; {extent}."
                " Move it away from the edge, or let a notch go on beyond it"
            )
    for i, first in enumerate(holes):
        around = box(*first.bounds).buffer(tolerance)
        for j in range(i + 1, len(holes)):
            second, pair = holes[j], f"{names[i]} and {names[j]}"
            if not around.intersects(box(*second.bounds)):
                continue
            if first.contains(second) or second.contains(first):
                problems.append(f"{pair}: one lies within the other")
            elif first.distance(second) <= tolerance:
                x, y = first.intersection(second.buffer(tolerance)).centroid.coords[0]
                problems.append(f"{pair}: touch or cross each other near ({x:.6g}, {y:.6g})")
    if problems:
        return problems

    rest = plate.difference(unary_union(holes))
    if isinstance(rest, MultiPolygon):
        places = " and ".join(
            "({:.4g}, {:.4g})".format(*piece.representative_point().coords[0]) for piece in rest.geoms
        )
        problems.append(f"holes: cut the plate into {len(rest.geoms)} pieces, one at each of {places}")
    return problems


def crack_problems(
    cracks: Sequence[Array], outlines: Sequence[Outline], width: float, height: float
) -> list[str]:
    """Problems of the cracks, each (n, 2) points in mm with the tip last, in a plate whose holes are fine."""
    plate = box(0.0, 0.0, width, height)
    tolerance = TOLERANCE * max(width, height)
    holes = unary_union([_polygon(outline) for outline in outlines])
    material = plate.difference(holes)
    problems: list[str] = []
    lines: list[tuple[int, LineString]] = []
    for i, points in enumerate(cracks):
        name = f"cracks[{i}]"
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if (steps <= tolerance).any():
            k = int(np.argmax(steps <= tolerance))
            problems.append(f"{name}: points {k} and {k + 1} coincide; remove one of them")
            continue
        line, start, tip = LineString(points), Point(points[0]), Point(points[-1])
        if not line.is_simple:
            problems.append(f"{name}: crosses itself")
        elif not plate.buffer(tolerance).covers(line):
            problems.append(f"{name}: leaves the plate (0 to {width:g}, 0 to {height:g})")
        elif not material.contains(tip) or material.boundary.distance(tip) <= tolerance:
            problems.append(f"{name}: its tip ({tip.x:.6g}, {tip.y:.6g}) must lie inside the material")
        elif material.contains(start) and material.boundary.distance(start) > tolerance:
            problems.append(
                f"{name}: its first point ({start.x:.6g}, {start.y:.6g}) lies inside the material;"
                " a crack starts at the plate's edge or in a hole, only its last point is a tip"
            )
        elif line.intersection(material).geom_type != "LineString":
            problems.append(f"{name}: runs through a hole or along an edge")
        else:
            lines.append((i, line))
    for a, (i, first) in enumerate(lines):
        for j, second in lines[a + 1 :]:
            if first.distance(second) <= tolerance:
                problems.append(f"cracks[{i}] and cracks[{j}]: touch or cross each other")
    return problems


def position_problems(points: Array, width: float, height: float) -> list[str]:
    """Which of the positions (n, 2), mm, lie too far from the plate to be meant as points of a notch."""
    beyond = np.maximum(np.maximum(-points, points - (width, height)), 0.0)
    far = np.flatnonzero(np.hypot(*beyond.T) > 0.05 * max(width, height))
    return [
        f"analysis.points[{k}] = [{points[k, 0]:g}, {points[k, 1]:g}]: must lie in or near the plate"
        f" (0 to {width:g}, 0 to {height:g})"
        for k in far
    ]


def _polygon(outline: Outline) -> Polygon:
    # four points per piece: a chord then stays within 3e-6 radii of the outline, below the tolerance
    return Polygon(outline.polygon(4 * (len(outline.breaks) - 1)))
