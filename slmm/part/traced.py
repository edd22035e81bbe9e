"""Outline from a contour that was traced in a picture: sharp at its corners, smooth between them.

Lengths are in pixels until the outline is made; x runs to the right and y up from the picture's lower left corner.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.accuracy import Accuracy
from slmm.part.arcs import with_arcs
from slmm.part.flanks import STEP, Flank, Noise, evenly_spaced, flank_at_end
from slmm.part.outline import Outline
from slmm.part.outline_splines import MAX_PIECES
from slmm.part.smoothing import curvatures, smoothed, wavelengths
from slmm.part.stretches import (
    SECOND,
    Bend,
    Contour,
    Mark,
    Stretch,
    straight_stretch,
    stress_of_waves,
    stretch_between,
    thinned,
    tight_bends,
)
from slmm.part.vertices import Vertex, find_vertices

Array = NDArray[np.float64]

#: within this distance of the picture's border the blur has bent the contour; chosen
BORDER = 2.0
#: how far flanks go on beyond the border, so that the corner which follows lies outside the plate, and how much of
#: them is extrapolated at most; both chosen
BEYOND, FARTHEST_BEYOND = 1.0, 12.0
#: outside the plate a notch is a polygon through the points beyond this distance, simplified to this
#: deviation; both chosen
OUTSIDE, SIMPLIFIED = 4.0, 1.0
#: farthest that an outline may lie from its contour: blur takes 0.8 of its standard deviation off a right
#: angle; chosen
DEPARTS = 2.0
#: turn (rad) per piece up to which an outline of even pieces follows a bend; chosen
FINEST = 0.2
#: turn (rad) between neighbouring points at which even a smooth stretch is split; chosen
SPLIT = 0.3
#: a wavelength shorter than this share of the longest is one that follows a bend; chosen
FOLLOWS_BEND = 0.8


def traced_outline(contour: Contour, width: float, height: float, pixel_size: float) -> Outline:
    """Outline, in mm, of one dark area of a picture of some width and height, in pixels."""
    points = evenly_spaced(contour.points, closed=True)
    inside = _depth(points, width, height) > BORDER
    left_out: list[Array] = []
    while True:
        stretches, corners = (
            _closed(points, contour, left_out)
            if inside.all()
            else _leaving(points, inside, width, height, contour, left_out)
        )
        if not stretches:
            break
        rounded, roots = with_arcs([stretch.points for stretch in stretches], corners)
        rounded = [part for piece in rounded for part in _split_at_turns(piece)]
        ring = shapely.Polygon(np.concatenate([piece[:-1] for piece in rounded]))
        away = shapely.distance(ring.exterior, shapely.points(points[inside]))
        if ring.is_valid and away.max() <= DEPARTS:
            outline = Outline.of_pieces([piece * pixel_size for piece in rounded])
            return outline.with_accuracy(_accuracy(stretches, corners, roots, contour, pixel_size))
        # a corner is none, or lies elsewhere: flanks a few pixels long may mislead
        vertices = [vertex for vertex in corners if vertex is not None]
        if not vertices:
            break
        worst = points[inside][int(away.argmax())]
        left_out.append(min((vertex.point for vertex in vertices), key=lambda p: np.hypot(*(p - worst))))
    return _smooth_all_round(points, contour, pixel_size)


def _closed(
    points: Array, contour: Contour, left_out: list[Array]
) -> tuple[list[Stretch], list[Vertex | None]]:
    """Stretches of a contour within the plate, each with the vertex at which it begins."""
    vertices = _vertices(points, True, contour, left_out)
    marks = [_mark(vertex) for vertex in vertices]
    following = [*marks[1:], *marks[:1]]
    stretches = [
        stretch_between(points, True, one, other, contour)
        for one, other in zip(marks, following, strict=True)
    ]
    return stretches, list(vertices)


def _vertices(points: Array, closed: bool, contour: Contour, left_out: list[Array]) -> list[Vertex]:
    return [
        vertex
        for vertex in find_vertices(points, closed, contour.noise, contour.blur)
        if all(np.hypot(*(vertex.point - other)) > 0.5 for other in left_out)
    ]


def _mark(vertex: Vertex) -> Mark:
    return Mark(vertex.index, vertex.gap, vertex.point, *vertex.flanks, vertex)


def _depth(points: Array, width: float, height: float) -> Array:
    """Distances (n,) of points from the picture's border, negative outside."""
    x, y = points.T
    return np.minimum.reduce([x, width - x, y, height - y])


def _leaving(
    points: Array,
    inside: NDArray[np.bool_],
    width: float,
    height: float,
    contour: Contour,
    left_out: list[Array],
) -> tuple[list[Stretch], list[Vertex | None]]:
    """Stretches of a contour that leaves the plate, each with the vertex at which it begins: polygons outside."""
    first = int(np.argmin(inside))
    points, inside = np.roll(points, -first, axis=0), np.roll(inside, -first)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int))).reshape(-1, 2)
    runs = [(a, b) for a, b in edges if (b - a) * STEP > 2 * BORDER]
    along_runs = []
    for a, b in runs:
        run = points[a:b]
        found = [_mark(vertex) for vertex in _vertices(run, False, contour, left_out)]
        ends = [_exit(part, width, height, contour.noise) for part in (run, run[::-1])]
        along_runs.append(
            [
                Mark(0, 0.0, ends[0][0], None, ends[0][1]),
                *found,
                Mark(len(run) - 1, 0.0, ends[1][0], ends[1][1], None),
            ]
        )
    depth = _depth(points, width, height)
    stretches: list[Stretch] = []
    corners: list[Vertex | None] = []
    for k, ((a, b), marks) in enumerate(zip(runs, along_runs, strict=True)):
        for one, other in pairwise(marks):
            stretches.append(stretch_between(points[a:b], False, one, other, contour))
            corners.append(one.vertex)
        following = runs[(k + 1) % len(runs)][0]
        outer = np.arange(b, following if following >= b else following + len(points)) % len(points)
        polygon = [
            marks[-1].point,
            *points[outer][depth[outer] < -OUTSIDE],
            along_runs[(k + 1) % len(runs)][0].point,
        ]
        bends = shapely.get_coordinates(shapely.LineString(polygon).simplify(SIMPLIFIED))
        stretches += [straight_stretch(*ends, contour) for ends in pairwise(bends)]
        corners += [None] * (len(bends) - 1)
    return stretches, corners


def _exit(run: Array, width: float, height: float, noise: Noise) -> tuple[Array, Flank]:
    """Where a contour that begins near the border comes in from outside, and the flank that leads there."""
    flank = flank_at_end(run, noise)
    for u in np.arange(-STEP, -FARTHEST_BEYOND - STEP, -STEP):
        point = flank.points(np.array([u]))
        if _depth(point, width, height)[0] < -BEYOND:
            break
    return point[0], flank


def _smooth_all_round(points: Array, contour: Contour, pixel_size: float) -> Outline:
    """Outline without corners."""
    weights, straight = np.ones(len(points)), np.zeros(len(points), dtype=bool)
    wanted = wavelengths(points, weights, straight, contour.per_root, contour.radius, STEP, True)
    smooth = smoothed(points, weights, straight, wanted, STEP, True)
    again = smoothed(points, weights, straight, SECOND * wanted, STEP, True)
    stress = stress_of_waves(smooth, again, wanted, contour.noise.deviation, True)
    bends = tight_bends(smooth, contour.blur, True)
    stretch = Stretch(smooth, smooth[::2], stress[::2], wanted[::2], bends)
    accuracy = _accuracy([stretch], [None], [None], contour, pixel_size)
    bends_by = np.abs(curvatures(smooth, STEP, True))
    # the first piece begins, and the last one ends, where it bends least
    pieces = _split_at_turns(thinned(np.roll(smooth, -int(bends_by.argmin()), axis=0), True))
    if len(pieces) > 1 or bends_by.max() >= FINEST * MAX_PIECES / (STEP * len(smooth)):
        outline = Outline.of_pieces([piece * pixel_size for piece in pieces])
    elif wanted.min() >= FOLLOWS_BEND * wanted.max():
        longest = contour.per_root * np.sqrt(contour.radius)
        outline = Outline.through(
            contour.points * pixel_size, contour.noise.deviation * pixel_size, longest * pixel_size
        )
    else:
        outline = Outline.through(smooth * pixel_size)
    return outline.with_accuracy(accuracy)


def _split_at_turns(points: Array) -> list[Array]:
    """The points (n, 2) in pieces that end where no spline could follow."""
    steps = np.diff(points, axis=0)
    before, behind = steps[:-1], steps[1:]
    cross = before[:, 0] * behind[:, 1] - before[:, 1] * behind[:, 0]
    sharp = 1 + np.flatnonzero(np.abs(np.arctan2(cross, (before * behind).sum(axis=1))) > SPLIT)
    ends = np.concatenate([[0], sharp, [len(points) - 1]])
    return [points[start : end + 1] for start, end in pairwise(ends.tolist())]


def _accuracy(
    stretches: list[Stretch],
    corners: list[Vertex | None],
    roots: list[Array | None],
    contour: Contour,
    pixel_size: float,
) -> Accuracy:
    """What is open about an outline, in mm."""
    bends = [bend for stretch in stretches for bend in stretch.bends]
    bends += [
        Bend(
            vertex.point if root is None else root,
            *(vertex.turn, vertex.spread, vertex.radius, vertex.least, vertex.largest),
        )
        for vertex, root in zip(corners, roots, strict=True)
        if vertex is not None
    ]
    radii = [(bend.radius, bend.least, bend.largest) for bend in bends]
    return Accuracy(
        offset=contour.offset * pixel_size,
        points=np.concatenate([stretch.samples for stretch in stretches]) * pixel_size,
        stress=np.concatenate([stretch.stress for stretch in stretches]),
        wavelength=np.concatenate([stretch.wavelength for stretch in stretches]) * pixel_size,
        tips=np.array([bend.root for bend in bends]).reshape(-1, 2) * pixel_size,
        turns=np.array([bend.turn for bend in bends]),
        spreads=np.array([bend.spread for bend in bends]),
        radii=np.array(radii).reshape(-1, 3) * pixel_size,
    )
