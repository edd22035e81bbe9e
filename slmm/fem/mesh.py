"""Body-fitted triangles of a plate with notches, fine along a trial crack path, coarse far away.

The outlines of the notches may lie inside the plate or cut its edges. Every boundary edge remembers the
outline it lies on and the arc lengths of its ends, so that quadratic triangles get their midside nodes on the
true curve, and a refined mesh its new vertices. The trial crack path is an inner edge with prescribed nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from slmm.contours.outline import Outline

#: the growth of the element size with the distance from where it is prescribed, mm per mm
SIZE_GROWTH = 0.3
#: straight pieces that stand for an outline in the plane geometry (crossings, gaps), at least
OUTLINE_SAMPLES = 2000


@dataclass(frozen=True)
class PlateMesh:
    """Triangles of a plate with notches, with the true curve behind every notch edge.

    Parameters
    ----------
    vertices : ndarray, shape (n, 2)
        Corner nodes, mm.
    triangles : ndarray, shape (m, 3)
        Vertex numbers, counter-clockwise.
    path : ndarray, shape (k,)
        Vertices along the trial crack path, from its mouth inwards; empty without a path.
    edges : ndarray, shape (e, 2)
        Edges that lie on an outline, as vertex pairs.
    edge_outline : ndarray, shape (e,)
        The outline each of them lies on.
    edge_s : ndarray, shape (e, 2)
        Arc length at both ends, mm, unwrapped: the edge spans the values between.
    outlines : tuple of Outline
        The true curves.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    path: np.ndarray
    edges: np.ndarray
    edge_outline: np.ndarray
    edge_s: np.ndarray
    outlines: tuple[Outline, ...]

    def edge_midpoints(self) -> np.ndarray:
        """Points of the true curves half way along each notch edge, shape (e, 2), mm."""
        middle = np.empty((len(self.edges), 2))
        for k, outline in enumerate(self.outlines):
            on_k = self.edge_outline == k
            middle[on_k] = outline.points(self.edge_s[on_k].mean(axis=1))
        return middle

    def refined(self) -> PlateMesh:
        """Every triangle cut in four, new notch vertices on the true curve; the path has twice the edges."""
        corner_pairs = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        pairs, of_triangle = np.unique(corner_pairs, axis=0, return_inverse=True)
        n = len(self.vertices)
        middle = n + of_triangle.reshape(-1, 3)
        position = self.vertices[pairs].mean(axis=1)
        number = {(int(i), int(j)): n + k for k, (i, j) in enumerate(pairs)}

        def between(edges: np.ndarray) -> np.ndarray:
            return np.array([number[i, j] for i, j in np.sort(edges, axis=1).tolist()], dtype=int)

        edge_middle = between(self.edges)
        position[edge_middle - n] = self.edge_midpoints()
        a, b, c = self.triangles.T
        ab, bc, ca = middle.T
        triangles = np.concatenate(
            [np.column_stack(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
        path = self.path
        if len(path):
            path = np.empty(2 * len(self.path) - 1, dtype=int)
            path[::2] = self.path
            path[1::2] = between(np.column_stack([self.path[:-1], self.path[1:]]))
        s_middle = self.edge_s.mean(axis=1)
        return PlateMesh(
            np.concatenate([self.vertices, position]),
            triangles,
            path,
            np.concatenate(
                [
                    np.column_stack([self.edges[:, 0], edge_middle]),
                    np.column_stack([edge_middle, self.edges[:, 1]]),
                ]
            ),
            np.tile(self.edge_outline, 2),
            np.concatenate(
                [
                    np.column_stack([self.edge_s[:, 0], s_middle]),
                    np.column_stack([s_middle, self.edge_s[:, 1]]),
                ]
            ),
            self.outlines,
        )


@dataclass(frozen=True)
class _Piece:
    """A smooth stretch of the boundary: part of an outline, or (outline = -1) of an edge of the plate."""

    outline: int
    s: np.ndarray  # arc length at its ends and at prescribed points between them
    start: np.ndarray  # the point at s[0], shared with the piece before
    direction: np.ndarray | None = None  # of a straight piece

    def points(self, s: np.ndarray, outlines: Sequence[Outline]) -> np.ndarray:
        if self.direction is not None:
            return self.start + s[:, None] * self.direction
        outline = outlines[self.outline]
        return outline.points(s)


class _Size:
    """Element size wanted at a point: prescribed at sources, growing with the distance from them."""

    def __init__(self, size_max: float):
        self.size_max = size_max
        self.points = np.empty((0, 2))
        self.sizes = np.empty(0)

    def add(self, points: np.ndarray, sizes: np.ndarray) -> None:
        self.points = np.concatenate([self.points, points])
        self.sizes = np.concatenate([self.sizes, np.minimum(sizes, self.size_max)])

    def __call__(self, points: np.ndarray) -> np.ndarray:
        size = np.full(len(points), self.size_max)
        for chunk in np.array_split(np.arange(len(points)), 1 + len(points) // 256):
            distance = np.linalg.norm(points[chunk, None, :] - self.points[None], axis=-1)
            wanted = np.min(self.sizes + SIZE_GROWTH * distance, axis=1, initial=self.size_max)
            size[chunk] = np.minimum(size[chunk], wanted)
        return size


def plate_mesh(
    width: float,
    height: float,
    outlines: Sequence[Outline] = (),
    path: np.ndarray | None = None,
    size_max: float | None = None,
    angle_max: float = 0.12,
) -> PlateMesh:
    """Mesh the plate (0, 0)-(width, height) without its notches.

    Parameters
    ----------
    width, height : float
        The plate, mm.
    outlines : sequence of Outline
        The notches, inside the plate or across its edges.
    path : ndarray, shape (k, 2), optional
        Nodes of a straight trial crack path, from its mouth (on an outline or an edge of the plate)
        inwards, mm. The elements along it are as large as the distance between its nodes.
    size_max : float, optional
        Largest element, mm; by default a twelfth of the plate's shorter side.
    angle_max : float
        How far an outline may turn along one element edge, rad.

    Returns
    -------
    PlateMesh

    Raises
    ------
    ImportError
        Without netgen.
    ValueError
        When the notches cut the plate in pieces or leave nothing of it, or the path leaves the material.

    Examples
    --------
    >>> mesh = plate_mesh(2.0, 1.0, size_max=0.5)
    >>> corner = mesh.vertices[mesh.triangles]
    >>> a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    >>> round(float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2), 12)
    2.0
    """
    outlines = tuple(outlines)
    size = _Size(min(width, height) / 12 if size_max is None else size_max)
    plate = shapely.box(0.0, 0.0, width, height)
    samples = [_sample(outline) for outline in outlines]
    body = plate.difference(shapely.union_all([shapely.Polygon(points) for points in samples]))
    if body.geom_type != "Polygon" or body.is_empty:
        raise ValueError(
            f"plate {width!r} x {height!r} mm with {len(outlines)} notches leaves "
            f"{len(getattr(body, 'geoms', []))} pieces: it must leave exactly one"
        )
    mouth = None
    if path is not None:
        path = np.asarray(path, dtype=float)
        mouth = path[0]
        _check_path(path, body)
        step = np.linalg.norm(np.diff(path, axis=0), axis=1)
        size.add(path, np.minimum(np.append(step, step[-1]), np.append(step[0], step)))
    for points in samples:
        size.add(*_curvature_sizes(points, angle_max))
    for points in _ring_points(body):
        size.add(*_gap_sizes(points, body))
    rings = _rings(body, outlines, samples, mouth)
    pieces = [piece for ring in rings for piece in ring]

    parameters = [_spaced(piece, outlines, size) for piece in pieces]
    for _ in range(8):
        points, segments, origin = _segments(rings, parameters, outlines)
        n_boundary = len(segments)
        if path is not None:
            distance, nearest = cKDTree(points).query(mouth)
            if distance > 1e-6 * size.size_max:
                raise ValueError(
                    f"path[0] = {path[0].tolist()}: must lie on the boundary, not {distance:g} mm away"
                )
            inner = np.concatenate([[nearest], len(points) + np.arange(len(path) - 1)])
            points = np.concatenate([points, path[1:]])
            segments = np.concatenate([segments, np.column_stack([inner[:-1], inner[1:]])])
        vertices, triangles = _netgen(points, segments, n_boundary, size.size_max)
        distance, of_point = cKDTree(vertices).query(points)
        corner_pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        present = {(int(i), int(j)) for i, j in corner_pairs}
        kept = np.array([(i, j) in present for i, j in np.sort(of_point[segments], axis=1).tolist()])
        if np.all(kept) and np.max(distance) <= 1e-9 * max(width, height):
            break
        if not np.all(kept[n_boundary:]):
            raise RuntimeError(
                "the mesher cut an edge of the crack path: its node distances may change by a third at most"
            )
        # the mesher wanted shorter boundary edges here than we gave: halve them on the true curve, mesh again
        parameters = _halved(parameters, origin, ~kept[:n_boundary])
    else:
        raise RuntimeError(f"no mesh with the prescribed boundary nodes (size_max = {size.size_max:g} mm)")

    on_outline = np.array([pieces[k].outline >= 0 for k, _ in origin])
    edge_s = np.array([parameters[k][i : i + 2] for k, i in origin])
    return PlateMesh(
        vertices,
        triangles,
        of_point[inner] if path is not None else np.empty(0, dtype=int),
        of_point[segments[:n_boundary][on_outline]],
        np.array([pieces[k].outline for k, _ in origin])[on_outline],
        edge_s[on_outline],
        outlines,
    )


def _sample(outline: Outline) -> np.ndarray:
    """Corners (OUTLINE_SAMPLES, 2) of a fine closed polygon on the outline."""
    return outline.polygon(OUTLINE_SAMPLES)


def _curvature_sizes(points: np.ndarray, angle_max: float) -> tuple[np.ndarray, np.ndarray]:
    """Sizes at points of a closed polygon so that one element edge turns by angle_max at most."""
    chord = np.roll(points, -1, axis=0) - points
    before = np.roll(chord, 1, axis=0)
    turn = np.abs(np.arctan2(_cross(before, chord), np.sum(before * chord, axis=1)))
    # over eight chords: digitised outlines are not smooth on the scale of one
    turn = turn.reshape(-1, 8).sum(axis=1)
    arc = np.linalg.norm(chord, axis=1).reshape(-1, 8).sum(axis=1)
    return points[::8], angle_max * arc / np.maximum(turn, 1e-12)


def _ring_points(body: shapely.Polygon) -> list[np.ndarray]:
    """Points along each closed curve around the body."""
    rings = [body.exterior, *body.interiors]
    return [
        shapely.get_coordinates(ring.interpolate(np.linspace(0, 1, 257)[:-1], normalized=True))
        for ring in rings
    ]


def _gap_sizes(points: np.ndarray, body: shapely.Polygon) -> tuple[np.ndarray, np.ndarray]:
    """Sizes that put two elements at least between the ring of these points and the other rings."""
    rings = [body.exterior, *body.interiors]
    distance = np.array([shapely.distance(shapely.points(points), ring) for ring in rings])
    own = np.argmin(distance.max(axis=1))
    others = np.delete(distance, own, axis=0)
    return points, np.min(others, axis=0, initial=np.inf) / 2


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _check_path(path: np.ndarray, body: shapely.Polygon) -> None:
    """Refuse a path that leaves the material (it may touch the boundary at its mouth alone)."""
    inside = shapely.contains_xy(body, path[1:, 0], path[1:, 1])
    if not np.all(inside):
        first = path[1:][~inside][0]
        raise ValueError(f"crack path node {first.tolist()} lies outside the material: shorten the path")


def _rings(
    body: shapely.Polygon, outlines: Sequence[Outline], samples: list[np.ndarray], mouth: np.ndarray | None
) -> list[list[_Piece]]:
    """The curves around the body, which is on their left, cut where one curve gives way to another."""
    body = shapely.orient_polygons(body)
    tolerance = 1e-9 * body.length
    rings = []
    for ring in (body.exterior, *body.interiors):
        points = np.array(ring.coords)[:-1]
        middle = shapely.points((points + np.roll(points, -1, axis=0)) / 2)
        label = np.full(len(points), -1)
        for k, polygon in enumerate(samples):
            label[shapely.distance(middle, shapely.LinearRing(polygon)) < tolerance] = k
        # straight stretches end at every corner of the plate, curves where the label changes
        starts = np.flatnonzero((label != np.roll(label, 1)) | (label < 0))
        if not len(starts):
            rings.append([_whole_outline(int(label[0]), outlines[label[0]], mouth)])
            continue
        curves = [
            _Line(points[i], points[(i + 1) % len(points)]) if label[i] < 0 else outlines[label[i]]
            for i in starts
        ]
        corners = np.array([_crossing(points[i], curves[j - 1], curves[j]) for j, i in enumerate(starts)])
        pieces = []
        for j, first in enumerate(starts):
            end = corners[(j + 1) % len(corners)]
            if label[first] < 0:
                pieces.append(_straight(corners[j], end, mouth))
            else:
                count = (starts[(j + 1) % len(starts)] - first) % len(points)
                last = points[(first + count) % len(points)]
                half_way = (
                    points[(first + count // 2) % len(points)] if count > 1 else (points[first] + last) / 2
                )
                k = int(label[first])
                pieces.append(_stretch(k, outlines[k], corners[j], half_way, end, mouth))
        rings.append(pieces)
    return rings


class _Line:
    """A straight line, with as much of an outline as finding a crossing needs."""

    def __init__(self, start: np.ndarray, end: np.ndarray):
        self.start = start
        self.direction = (end - start) / np.linalg.norm(end - start)

    def points(self, s: np.ndarray) -> np.ndarray:
        return self.start + s[:, None] * self.direction

    def project(self, points: np.ndarray) -> np.ndarray:
        return (points - self.start) @ self.direction


def _crossing(point: np.ndarray, one: Outline | _Line, other: Outline | _Line) -> np.ndarray:
    """The crossing of two curves near a point: projected onto both in turn; the last one wins a tie."""
    if isinstance(one, _Line) and isinstance(other, _Line):
        return point
    if isinstance(other, _Line):
        one, other = other, one
    for _ in range(50):
        on_one = other.points(other.project(one.points(one.project(point[None]))))[0]
        if np.linalg.norm(on_one - point) < 1e-13 * (1 + np.abs(point).max()):
            break
        point = on_one
    # exactly on the edge of the plate, so that loads find it there
    return one.points(one.project(point[None]))[0]


def _whole_outline(k: int, outline: Outline, mouth: np.ndarray | None) -> _Piece:
    """A hole inside the plate; its arc length runs backwards when the material is on the left."""
    s = 0.0 if mouth is None else float(outline.project(mouth[None])[0])
    return _Piece(k, np.array([s, s - outline.length]), outline.points(s))


def _stretch(
    k: int,
    outline: Outline,
    start: np.ndarray,
    half_way: np.ndarray,
    end: np.ndarray,
    mouth: np.ndarray | None,
) -> _Piece:
    """The part of an outline from start over half_way to end, with a break at the crack's mouth."""
    s_start, s_half, s_end = outline.project(np.stack([start, half_way, end]))
    # around the hole the outline runs counter-clockwise, the ring around the body the other way
    span = float((s_start - s_end) % outline.length)
    if (s_start - s_half) % outline.length > span:
        raise ValueError(f"outline {k} runs clockwise around its hole: reverse its points")
    s = [float(s_start), float(s_start) - span]
    if mouth is not None:
        s_mouth = outline.project(mouth[None])
        back = float((s_start - s_mouth[0]) % outline.length)
        close = np.linalg.norm(outline.points(s_mouth)[0] - mouth) < 1e-6 * outline.length
        if close and 0 < back < span:
            s.insert(1, s[0] - back)
    return _Piece(k, np.array(s), start)


def _straight(start: np.ndarray, end: np.ndarray, mouth: np.ndarray | None) -> _Piece:
    """A stretch of the plate's edge, with a break at the crack's mouth."""
    line = _Line(start, end)
    length = float(np.linalg.norm(end - start))
    s = [0.0, length]
    if mouth is not None:
        along = line.project(mouth[None])
        if np.linalg.norm(line.points(along)[0] - mouth) < 1e-9 * length and 0 < along[0] < length:
            s.insert(1, float(along[0]))
    return _Piece(-1, np.array(s), start, line.direction)


def _spaced(piece: _Piece, outlines: Sequence[Outline], size: _Size) -> np.ndarray:
    """Arc lengths of boundary nodes along a piece, as far apart as the size wanted there."""
    nodes = [piece.s[:1]]
    # small sizes are prescribed at ends (the crack's mouth): sample densely towards both
    half = np.concatenate([[0.0], np.geomspace(1e-6, 0.02, 60), np.linspace(0.02, 0.5, 200)[1:]])
    fraction = np.concatenate([half, 1 - half[-2::-1]])
    for s0, s1 in zip(piece.s[:-1], piece.s[1:], strict=True):
        s = s0 + fraction * (s1 - s0)
        density = 1 / size(piece.points(s, outlines))
        count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.abs(np.diff(s)))])
        least = 8 if s1 < s0 else 1  # an outline is never one chord
        n = max(least, int(np.ceil(count[-1])))
        # the first and last value exactly, so that pieces meet
        inner = np.interp(np.arange(1, n) * count[-1] / n, count, s)
        nodes.append(np.append(inner, s1))
    return np.concatenate(nodes)


def _segments(
    rings: Sequence[Sequence[_Piece]], parameters: Sequence[np.ndarray], outlines: Sequence[Outline]
) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]:
    """Boundary nodes (n, 2), the segments between them (n, 2), and for each its piece and place in it."""
    points: list[np.ndarray] = []
    segments: list[np.ndarray] = []
    origin: list[tuple[int, int]] = []
    n, k = 0, 0
    for ring in rings:
        first = n
        for piece in ring:
            s = parameters[k]
            points += [piece.start[None], piece.points(s[1:-1], outlines)]
            origin += [(k, i) for i in range(len(s) - 1)]
            n += len(s) - 1
            k += 1
        number = np.arange(first, n)
        segments.append(np.column_stack([number, np.append(number[1:], first)]))
    return np.concatenate(points), np.concatenate(segments), origin


def _halved(
    parameters: Sequence[np.ndarray], origin: Sequence[tuple[int, int]], split: np.ndarray
) -> list[np.ndarray]:
    """Put a node into the middle of every segment marked."""
    marked: dict[int, list[int]] = {}
    for (k, i), wanted in zip(origin, split, strict=True):
        if wanted:
            marked.setdefault(k, []).append(i)
    result = list(parameters)
    for k, places in marked.items():
        s = parameters[k]
        at = np.array(places)
        result[k] = np.insert(s, at + 1, (s[at] + s[at + 1]) / 2)
    return result


def _netgen(
    points: np.ndarray, segments: np.ndarray, n_boundary: int, size_max: float
) -> tuple[np.ndarray, np.ndarray]:
    """Triangulate: the first n_boundary segments have the body on their left, the others on both sides."""
    try:
        from netgen.geom2d import SplineGeometry
    except ImportError as error:
        raise ImportError("body-fitted meshes need netgen: pip install slmm[fea]") from error
    geometry = SplineGeometry()
    number = [geometry.AppendPoint(float(x), float(y)) for x, y in points]
    for k, (i, j) in enumerate(segments):
        right = 0 if k < n_boundary else 1
        geometry.Append(["line", number[i], number[j]], leftdomain=1, rightdomain=right, bc=1)
    mesh = geometry.GenerateMesh(maxh=size_max, grading=SIZE_GROWTH)
    # copies: the mesher's arrays die with its mesh
    vertices = np.array(mesh.Coordinates(), dtype=float)[:, :2]
    triangles = np.array(mesh.Elements2D().NumPy()["nodes"], dtype=np.int64)[:, :3] - 1
    used, number_used = np.unique(triangles, return_inverse=True)
    triangles = number_used.reshape(-1, 3)
    vertices = vertices[used]
    corner = vertices[triangles]
    turned = _cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) < 0
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    return vertices, triangles
