"""What is wrong with the geometry of a part, its holes and its cracks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from shapely import (
    Geometry,
    LineString,
    MultiPolygon,
    Point,
    Polygon,
    STRtree,
    box,
    get_parts,
    prepare,
    unary_union,
)
from shapely.validation import explain_validity

from slmm.part.edges import Edges, material_on_edges
from slmm.part.outline import Outline
from slmm.part.part import TOLERANCE, are_apart
from slmm.part.union import united

Array = NDArray[np.float64]

#: lines that are nearer than the tolerance for so many tolerances run along each other: at an angle below half a
#: degree; chosen
ALONG = 200
#: outlines whose polygons are kept, for all checks of a scene ask for them; chosen
LAST = 64


def overlaps_united(
    named: Sequence[tuple[str, Outline]], outer: Polygon
) -> tuple[list[tuple[str, Outline]], list[str]]:
    """Named outlines, those that overlap in the part as one, and what is wrong with their unions."""
    polygons = [_polygon(outline) for _, outline in named]
    if len(named) < 2 or not all(polygon.is_valid for polygon in polygons):
        return list(named), []  # `hole_problems` says so
    return united(named, polygons, outer, _tolerance(outer))


def hole_problems(outlines: Sequence[Outline], names: Sequence[str], outer: Polygon) -> list[str]:
    """Problems of the holes with the part and with each other, each one a sentence that starts with a name.

    Parameters
    ----------
    outlines : sequence of Outline
        Outlines of the holes and edge notches.
    names : sequence of str
        What to call them, eg. "holes[0]".
    outer : shapely.Polygon
        The part without its holes.
    """
    tolerance, what = _tolerance(outer), _what(outer)
    inside, around = outer.buffer(-tolerance), outer.buffer(2 * tolerance)
    holes = [_polygon(outline) for outline in outlines]
    problems = [
        f"{name}: the outline crosses or touches itself: {explain_validity(hole)}"
        for name, hole in zip(names, holes, strict=True)
        if not hole.is_valid
    ]
    if problems:
        return problems  # the operations below need valid polygons

    # what holes do beyond the part is of no importance
    prepare(around)
    nearby = [hole if around.contains_properly(hole) else hole.intersection(around) for hole in holes]
    for name, hole, near in zip(names, holes, nearby, strict=True):
        left, bottom, right, top = hole.bounds
        extent = f"it spans x = {left:.6g} to {right:.6g}, y = {bottom:.6g} to {top:.6g}"
        mean_width = 2 * hole.area / hole.length
        if max(right - left, top - bottom) <= tolerance or mean_width <= tolerance:
            problems.append(f"{name}: is too small for the {what}; {extent}")
        elif hole.covers(outer):
            problems.append(f"{name}: covers the whole {what}; {extent}")
        elif not hole.intersects(inside):
            problems.append(f"{name}: lies outside the {what} {_shown(outer)}; {extent}")
        elif _touches_an_edge(near, outer, tolerance):
            problems.append(
                f"{name}: just touches the {what}'s edge, so no material is left there; {extent}."
                " Move it away from the edge, or let a notch go on beyond it"
            )
    reaching = [(name, near) for name, near in zip(names, nearby, strict=True) if not near.is_empty]
    boxes = box(*np.array([near.bounds for _, near in reaching]).reshape(-1, 4).T)
    tree = STRtree(boxes)
    for i, (name, first) in enumerate(reaching):
        left, bottom, right, top = first.bounds
        beside = box(left - tolerance, bottom - tolerance, right + tolerance, top + tolerance)
        prepare(first)
        for k in sorted(tree.query(beside)):
            if k <= i:
                continue
            other, second = reaching[k]
            pair = f"{name} and {other}"
            if first.contains(second) or second.contains(first):
                problems.append(f"{pair}: one lies within the other")
            elif first.dwithin(second, tolerance):
                x, y = first.intersection(second.buffer(tolerance)).centroid.coords[0]
                problems.append(
                    f"{pair}: touch each other near ({x:.6g}, {y:.6g}); move them apart, or let them overlap by"
                    f" more than {tolerance:.3g} mm, then they are one hole"
                )
    if problems:
        return problems

    rest = _material(holes, outer)
    if isinstance(rest, MultiPolygon):
        places = " and ".join(
            "({:.4g}, {:.4g})".format(*piece.representative_point().coords[0]) for piece in rest.geoms
        )
        problems.append(f"holes: cut the {what} into {len(rest.geoms)} pieces, one at each of {places}")
    return problems


def crack_problems(cracks: Sequence[Array], outlines: Sequence[Outline], outer: Polygon) -> list[str]:
    """Problems of the cracks, each (n, 2) points in mm, in a part whose holes are fine.

    Each end may lie in the material, then it is a tip, on a surface or in a hole, or on another crack.
    """
    tolerance = _tolerance(outer)
    material = _material([_polygon(outline) for outline in outlines], outer)
    problems: list[str] = []
    lines: list[tuple[int, LineString]] = []
    for i, points in enumerate(cracks):
        name = f"cracks[{i}]"
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if (steps <= tolerance).any():
            k = int(np.argmax(steps <= tolerance))
            problems.append(f"{name}: points {k} and {k + 1} coincide; remove one of them")
            continue
        line = LineString(points)
        if not line.is_simple or line.is_ring:
            problems.append(f"{name}: crosses or touches itself")
        elif not outer.buffer(tolerance).covers(line):
            problems.append(f"{name}: leaves the {_what(outer)} {_shown(outer)}")
        elif not any(part.length > tolerance for part in get_parts(line.intersection(material))):
            problems.append(f"{name}: does not run through the material")
        elif _runs_along_an_edge_or_through_a_hole(line, material, tolerance):
            problems.append(
                f"{name}: runs through a hole or along an edge; give what lies beyond it as another crack"
            )
        else:
            lines.append((i, line))
    tree = STRtree([line for _, line in lines])
    for a, (i, first) in enumerate(lines):
        for b in sorted(tree.query(first, predicate="dwithin", distance=tolerance)):
            j, second = lines[b]
            if b > a and first.intersection(second.buffer(tolerance)).length > ALONG * tolerance:
                problems.append(f"cracks[{i}] and cracks[{j}]: run along each other")
    return problems


def _material(holes: Sequence[Polygon], outer: Polygon) -> Polygon | MultiPolygon:
    """What holes leave of a part."""
    if are_apart(holes, outer):
        return Polygon(outer.exterior, [hole.exterior for hole in holes])
    return outer.difference(unary_union(holes))


def _tolerance(outer: Polygon) -> float:
    left, bottom, right, top = outer.bounds
    return TOLERANCE * max(right - left, top - bottom)


def _is_plate(outer: Polygon) -> bool:
    return len(outer.exterior.coords) == 5 and outer.bounds[:2] == (0.0, 0.0)


def _what(outer: Polygon) -> str:
    return "plate" if _is_plate(outer) else "part"


def _shown(outer: Polygon) -> str:
    left, bottom, right, top = outer.bounds
    return f"({left:g} to {right:g}, {bottom:g} to {top:g})"


def _touches_an_edge(near: Geometry, outer: Polygon, tolerance: float) -> bool:
    """Whether what lies of a hole in and just around the part ends at its edge, not inside or beyond."""
    if not _is_plate(outer):
        beyond = near.difference(outer.buffer(tolerance))
        return bool(near.distance(outer.exterior) <= tolerance and beyond.is_empty)
    left, bottom, right, top = near.bounds
    _, _, width, height = outer.bounds
    return bool(min(abs(left), abs(bottom), abs(right - width), abs(top - height)) <= tolerance)


def _runs_along_an_edge_or_through_a_hole(line: LineString, material: Polygon, tolerance: float) -> bool:
    # what a crack's first point misses the edge by, for rounding, is no part of its own
    parts = get_parts(line.intersection(material))
    if sum(part.length > tolerance for part in parts) != 1:
        return True
    # at its ends the crack leaves the edge at some angle, of more than half a degree
    beside = material.boundary.intersection(line.buffer(tolerance, cap_style="flat"))
    ends = sum(material.boundary.distance(Point(line.coords[k])) <= 2 * tolerance for k in (0, -1))
    return bool(beside.length > ALONG * max(ends, 1) * tolerance)


def position_problems(points: Array, outer: Polygon) -> list[str]:
    """Which of the positions (n, 2), mm, lie too far from the part to be meant as points of a notch."""
    left, bottom, right, top = outer.bounds
    beyond = np.maximum(np.maximum((left, bottom) - points, points - (right, top)), 0.0)
    far = np.flatnonzero(np.hypot(*beyond.T) > 0.05 * max(right - left, top - bottom))
    return [
        f"analysis.points[{k}] = [{points[k, 0]:g}, {points[k, 1]:g}]: must lie in or near the {_what(outer)}"
        f" {_shown(outer)}"
        for k in far
    ]


def edges_of(outlines: Sequence[Outline], width: float, height: float) -> Edges:
    """Where the edges of a plate with notches have material."""
    return material_on_edges([_polygon(outline) for outline in outlines], width, height)


@lru_cache(maxsize=LAST)
def _polygon(outline: Outline) -> Polygon:
    # four points per piece: a chord then stays within 3e-6 radii of the outline, below the tolerance
    parts = outline.breaks[:-1, None] + np.diff(outline.breaks)[:, None] * np.arange(4) / 4
    return Polygon(outline.points(parts.ravel()))
