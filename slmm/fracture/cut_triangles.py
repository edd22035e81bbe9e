"""Triangles over a part for pictures of its fields, cut open along its cracks: points there are doubled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from slmm.part.part import Part

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: chords of curved outlines are so far off them at most, over the size of triangles; chosen
OFF = 0.01
#: points between lines keep so far away from them, over the size of triangles; chosen
APART = 0.6
#: pieces of cracks over the size of triangles; chosen
ON_CRACK = 0.5
#: a face's fields are those so far beside it, over the way to the middle of the triangles there; round-off
BESIDE = 1e-4
#: fields at a tip, where stress has no bound, are those so far ahead of it, over the size of triangles; chosen
AHEAD_OF_TIP = 0.1
#: how often pieces of lines are halved that are not yet sides of triangles; chosen: two or three times is common
MOST_ROUNDS = 30
#: triangles of a smaller area, over that of the square of their size, are flat; round-off
FLAT = 1e-7


@dataclass(frozen=True, eq=False)
class CutTriangles:
    """Triangles whose points have fields.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        mm; places on a crack stand there once for each of its sides.
    triangles : ndarray, shape (m, 3) of int
        Counter-clockwise.
    places : ndarray, shape (n, 2)
        Where the fields of the points are taken: the same, but on cracks a hair's breadth beside them, and at tips a
        little ahead of them.
    """

    points: Array
    triangles: Integers
    places: Array


def cut_triangles(part: Part, size: float) -> CutTriangles:
    """Triangles over a part.

    Parameters
    ----------
    part : Part
    size : float
        Of their sides, about, mm.

    Raises
    ------
    ValueError
        When the size is not positive, or the lines of a part are so close that no triangles fit them.

    Examples
    --------
    >>> part = Part.plate(40.0, 40.0, cracks=[[(0, 20), (15, 20)]])
    >>> mesh = cut_triangles(part, 4.0)
    >>> on_crack = (abs(mesh.points[:, 1] - 20) < 1e-9) & (mesh.points[:, 0] < 14.9)
    >>> [int((abs(mesh.points[on_crack, 0] - x) < 1e-9).sum()) for x in (0.0, 7.5)]
    [2, 2]
    """
    if not size > 0:
        raise ValueError(f"size = {size!r}: must be a positive length in mm")
    points, edges, is_crack = _lines(part, size)
    inside = _between(part, size)
    for _ in range(MOST_ROUNDS):
        delaunay = Delaunay(np.concatenate([points, inside]))
        sides = np.sort(delaunay.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        present = np.isin(_keys(edges), _keys(sides))
        if present.all():
            break
        # halve what is no side yet
        halves = points[edges[~present]].mean(axis=1)
        new = len(points) + np.arange(len(halves))
        points = np.concatenate([points, halves])
        first, second = edges[~present].T
        edges = np.concatenate([edges[present], np.stack([first, new], 1), np.stack([new, second], 1)])
        is_crack = np.concatenate([is_crack[present], is_crack[~present], is_crack[~present]])
    else:
        raise ValueError(
            f"size = {size!r}: no triangles fit the lines of the part, which are too close to each other"
        )
    every = np.concatenate([points, inside])
    corners = every[delaunay.simplices]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    area = 0.5 * (ax * by - ay * bx)
    body = part.body
    shapely.prepare(body)
    kept = shapely.contains_xy(body, *corners.mean(axis=1).T) & (np.abs(area) > FLAT * size**2)
    triangles = np.where(area[kept, None] < 0, delaunay.simplices[kept][:, ::-1], delaunay.simplices[kept])
    mesh = _cut(every, triangles.astype(np.int64), edges[is_crack])
    for line in part.tips:
        along = (line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2])
        at_tip = np.linalg.norm(mesh.points - line[-1], axis=1) <= part.tolerance
        mesh.places[at_tip] = line[-1] + AHEAD_OF_TIP * size * along
    return mesh


def _lines(part: Part, size: float) -> tuple[Array, Integers, NDArray[np.bool_]]:
    """Points (n, 2) on outlines and cracks, pieces (k, 2) of both between them, and which of them are of cracks."""
    mouths = np.array([end for line in part.crack_lines for end in (line[0], line[-1])]).reshape(-1, 2)
    body = shapely.simplify(part.body, OFF * size)
    rings = [_ring(ring, mouths, size) for ring in (body.exterior, *body.interiors)]
    lines = [
        *(shapely.segmentize(shapely.LineString(ring), size) for ring in rings),
        *(shapely.segmentize(shapely.LineString(line), ON_CRACK * size) for line in part.crack_lines),
    ]
    points, of_line = shapely.get_coordinates(lines, return_index=True)
    first = np.flatnonzero(of_line[1:] == of_line[:-1])
    edges = np.stack([first, first + 1], axis=1)
    return _once(points, edges, of_line[first] >= len(rings), part.tolerance)


def _ring(ring: shapely.LinearRing, mouths: Array, size: float) -> Array:
    """Points (n, 2) of a closed outline, the first one again at its end, with those mouths (k, 2) that lie on it."""
    corners = shapely.get_coordinates(ring)[:-1]
    here = mouths[shapely.distance(ring, shapely.points(mouths)) < 2 * OFF * size]
    # a corner of the chords next to a mouth would make a side without length
    away = np.linalg.norm(corners[:, None] - here[None], axis=2).min(axis=1, initial=np.inf)
    points = np.concatenate([corners[away > OFF * size], here])
    order = np.argsort(shapely.line_locate_point(ring, shapely.points(points)), kind="stable")
    return points[[*order, order[0]]]


def _once(
    points: Array, edges: Integers, is_crack: NDArray[np.bool_], tolerance: float
) -> tuple[Array, Integers, NDArray[np.bool_]]:
    """The same with each point but once."""
    tree = shapely.STRtree(shapely.points(points))
    pairs = tree.query(shapely.points(points), predicate="dwithin", distance=tolerance)
    n = len(points)
    _, group = connected_components(coo_array((np.ones(pairs.shape[1]), tuple(pairs)), shape=(n, n)))
    first = np.unique(group, return_index=True)[1]
    edges = group[edges].astype(np.int64)
    real = edges[:, 0] != edges[:, 1]
    return points[first], edges[real], is_crack[real]


def _between(part: Part, size: float) -> Array:
    """Points (n, 2) of a grid of triangles inside the part, away from its lines."""
    (x0, y0), (x1, y1) = part.box
    rows = np.arange(y0, y1, size * np.sqrt(0.75))
    x = np.arange(x0, x1 + size, size)
    grid = np.concatenate(
        [np.column_stack([x + (k % 2) * size / 2, np.full(len(x), y)]) for k, y in enumerate(rows)]
    )
    at = shapely.points(grid)
    shapely.prepare(part.body)
    inside = shapely.contains_properly(part.body, at)
    inside &= shapely.distance(part.body.boundary, at) > APART * size
    for line in part.crack_lines:
        inside &= shapely.distance(shapely.LineString(line), at) > APART * ON_CRACK * size
    return np.asarray(grid[inside])


def _cut(points: Array, triangles: Integers, cracks: Integers) -> CutTriangles:
    """Triangles at a point of a crack have it in common only where one gets around it from one to the other."""
    m = len(triangles)
    # every corner of every triangle is a point of its own, and two are one across a side that is no crack
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    corner = np.stack([np.arange(3 * m), np.arange(3 * m).reshape(m, 3)[:, [1, 2, 0]].ravel()], axis=1)
    turned = sides[:, 0] > sides[:, 1]
    sides, corner = (np.where(turned[:, None], pair[:, ::-1], pair) for pair in (sides, corner))
    key = _keys(sides)
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    same &= ~np.isin(key[order][1:], _keys(cracks))
    one, other = corner[order[:-1][same]].ravel(), corner[order[1:][same]].ravel()
    number, group = connected_components(coo_array((np.ones(len(one)), (one, other)), shape=(3 * m, 3 * m)))
    own = np.empty(number, dtype=np.int64)
    own[group] = triangles.ravel()
    middles = points[triangles].mean(axis=1).repeat(3, axis=0)
    towards = (
        np.stack([np.bincount(group, middles[:, k]) for k in (0, 1)], axis=1) / np.bincount(group)[:, None]
    )
    on_crack = np.isin(own, cracks.ravel())
    places = points[own]
    places[on_crack] += BESIDE * (towards - places)[on_crack]
    return CutTriangles(points[own], group.reshape(m, 3).astype(np.int64), places)


def _keys(edges: Integers) -> Integers:
    """One number for each pair, whichever of both stands first."""
    return np.sort(edges, axis=1) @ np.array([2**32, 1])
