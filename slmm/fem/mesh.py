"""Body-fitted triangles of a part with notches and cracks, fine along a trial crack path, coarse far away.

The outlines of the notches may lie inside the part or cut its outer edge. Every boundary edge remembers the
outline it lies on and the arc lengths of its ends, so that quadratic triangles get their midside nodes on the
true curve, and a refined mesh its new vertices. Cracks and the trial crack path are inner edges; slmm.fem.slit
opens them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from slmm.fem.boundary import (
    boundary_pieces,
    boundary_segments,
    crack_nodes,
    path_nodes,
    spaced,
)
from slmm.fem.element_size import SizePolicy, all_sizes
from slmm.fem.triangulation import MesherError, triangulated
from slmm.part.crack import TIP, Crack, with_point
from slmm.part.outline import Outline
from slmm.part.part import Part

#: meshes that are tried, and by how much more the body is turned (rad) for each: whether the mesher finds one is a
#: matter of chance (chosen)
ATTEMPTS, TURNED = 8, 0.8


@dataclass(frozen=True)
class PlateMesh:
    """Triangles of a part, with the true curve behind every notch edge.

    Parameters
    ----------
    vertices : ndarray, shape (n, 2)
        Corner nodes, mm.
    triangles : ndarray, shape (m, 3)
        Vertex numbers, counter-clockwise.
    path : ndarray, shape (k,)
        Vertices along the trial crack path, from its mouth inwards; empty without a path.
    cracks : tuple of ndarray, shape (k,)
        Vertices along each crack, from its start to its end.
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
    cracks: tuple[np.ndarray, ...]
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
        """Every triangle cut in four, new notch vertices on the true curve; paths have twice the edges."""
        n = len(self.vertices)
        corner_pairs = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        key, of_triangle = np.unique(corner_pairs @ [n, 1], return_inverse=True)
        pairs = np.column_stack(np.divmod(key, n))
        position = self.vertices[pairs].mean(axis=1)

        def between(first: np.ndarray, second: np.ndarray) -> np.ndarray:
            low, high = np.minimum(first, second), np.maximum(first, second)
            return n + np.searchsorted(key, low * n + high)

        def doubled(line: np.ndarray) -> np.ndarray:
            if not len(line):
                return line
            twice = np.empty(2 * len(line) - 1, dtype=line.dtype)
            twice[::2] = line
            twice[1::2] = between(line[:-1], line[1:])
            return twice

        edge_middle = between(*self.edges.T)
        position[edge_middle - n] = self.edge_midpoints()
        a, b, c = self.triangles.T
        ab, bc, ca = (n + of_triangle.reshape(-1, 3)).T
        s_middle = self.edge_s.mean(axis=1)
        return PlateMesh(
            np.concatenate([self.vertices, position]),
            np.concatenate(
                [np.column_stack(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
            ),
            doubled(self.path),
            tuple(doubled(crack) for crack in self.cracks),
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


def plate_mesh(
    part: Part,
    path: np.ndarray | None = None,
    policy: SizePolicy | None = None,
    fine_at: tuple[np.ndarray, np.ndarray] | None = None,
    nodes_at: np.ndarray | None = None,
) -> PlateMesh:
    """Mesh a part.

    Parameters
    ----------
    part : Part
        With its notches, inside or across its outer edge, and its cracks, which may end at each other.
    path : ndarray, shape (k, 2), optional
        Nodes of a straight trial crack path, from its mouth (on a surface, or a crack's tip) inwards, mm. The elements
        along it are as large as the distance between its nodes; where the surroundings are finer, there are more nodes
        between them. It may end on a surface or a crack, and then goes through the ligament.
    policy : SizePolicy, optional
        How fine.
    fine_at : (ndarray (k, 2), ndarray (k,)), optional
        Points of the boundary and of cracks where edges must not be longer than the sizes given, mm.
    nodes_at : ndarray, shape (k, 2), optional
        Points that have to be nodes if they lie on the boundary, as the ends of conditions, mm. Between two of them
        that are neighbours there are four elements at least.

    Returns
    -------
    PlateMesh

    Raises
    ------
    ImportError
        Without netgen.
    ValueError
        When the notches cut the part in pieces or leave nothing of it, or the path leaves the material.
    MesherError
        When the mesher finds no triangles, or does not keep the prescribed nodes.

    Examples
    --------
    >>> mesh = plate_mesh(Part.plate(2.0, 1.0), policy=SizePolicy(0.5))
    >>> corner = mesh.vertices[mesh.triangles]
    >>> a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    >>> round(float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2), 12)
    2.0
    """
    outlines, body = part.outlines, part.body
    extent = np.ptp(part.outer, axis=0)
    cracks = list(part.crack_lines)
    mouths = [point for crack in part.cracks for point in _mouths(crack)]
    goes_through = False
    if path is not None:
        path = np.asarray(path, dtype=float)
        last = part.end_at(path[-1])
        goes_through = last != TIP
        _check_path(path[:-1] if goes_through else path, body)
        mouths.append(path[0])
        if last.kind == "crack":
            cracks[last.number] = with_point(cracks[last.number], path[-1], part.tolerance)
        elif goes_through:
            mouths.append(path[-1])
    size = all_sizes(policy or SizePolicy(), part, cracks, path)
    if fine_at is not None:
        size.prescribe(*fine_at)
    if nodes_at is not None and len(nodes_at) > 1:
        away = cKDTree(nodes_at).query(nodes_at, k=2)[0][:, 1]
        apart = away > part.tolerance
        size.prescribe(nodes_at[apart], away[apart] / 4)
        mouths += list(nodes_at)
    rings = boundary_pieces(body, outlines, np.array(mouths).reshape(-1, 2))
    pieces = [piece for ring in rings for piece in ring]

    for attempt in range(ATTEMPTS):
        parameters = [spaced(piece, outlines, size) for piece in pieces]
        points, segments, origin = boundary_segments(rings, parameters, outlines)
        n_boundary = len(segments)
        lines = [crack_nodes(crack, size) for crack in cracks]
        joints: dict[bytes, int] = {}
        inner = []
        for line, crack in zip(lines, part.cracks, strict=True):
            ends = [end.kind == "surface" for end in (crack.start, crack.end)]
            points, numbers = _numbered(points, line, ends, joints, size.largest)
            segments = np.concatenate([segments, np.column_stack([numbers[:-1], numbers[1:]])])
            inner.append(numbers)
        if path is not None:
            points, numbers = _numbered(
                points, path_nodes(path, size), [True, goes_through], {}, size.largest
            )
            segments = np.concatenate([segments, np.column_stack([numbers[:-1], numbers[1:]])])
            inner.append(numbers)
        try:
            vertices, triangles = triangulated(points, segments, n_boundary, size, attempt * TURNED)
        except MesherError as error:
            why = str(error)
            continue
        distance, of_point = cKDTree(vertices).query(points)
        kept = _are_edges(of_point[segments], triangles, len(vertices))
        if np.all(kept) and np.max(distance) <= 1e-9 * extent.max():
            vertices[of_point] = points  # exactly, also in a body that was turned
            break
        why = "the mesher cuts edges of the boundary, of cracks or of their path"
        # it wants shorter edges here than we gave
        ends = points[segments[~kept]]
        size.prescribe(ends.mean(axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / 2)
    else:
        raise MesherError(f"{why}, also of the body turned in {ATTEMPTS - 1} ways")

    on_outline = np.array([pieces[k].outline >= 0 for k, _ in origin])
    edge_s = np.array([parameters[k][i : i + 2] for k, i in origin])
    found = [of_point[numbers] for numbers in inner]
    return PlateMesh(
        vertices,
        triangles,
        found.pop() if path is not None else np.empty(0, dtype=int),
        tuple(found),
        of_point[segments[:n_boundary][on_outline]],
        np.array([pieces[k].outline for k, _ in origin])[on_outline],
        edge_s[on_outline],
        outlines,
    )


def _mouths(crack: Crack) -> list[np.ndarray]:
    """Ends (2,) of a crack that lie on surfaces, mm."""
    ends = ((crack.start, crack.points[0]), (crack.end, crack.points[-1]))
    return [point for end, point in ends if end.kind == "surface"]


def _numbered(
    points: np.ndarray, line: np.ndarray, on_others: Sequence[bool], joints: dict[bytes, int], largest: float
) -> tuple[np.ndarray, np.ndarray]:
    """All nodes (n, 2), those of a line (k, 2) added, and the numbers (k,) of its own.

    Its first and its last one may be nodes that are there already, and any that an earlier line has left in ``joints``.
    """
    numbers = np.array([joints.get(point.tobytes(), -1) for point in line])
    for k, exists in zip((0, -1), on_others, strict=True):
        if exists:
            numbers[k] = _existing_node(points, line[k], largest)
    new = numbers < 0
    numbers[new] = len(points) + np.arange(np.count_nonzero(new))
    joints.update((point.tobytes(), int(number)) for point, number in zip(line, numbers, strict=True))
    return np.concatenate([points, line[new]]), numbers


def _check_path(path: np.ndarray, body: shapely.Polygon) -> None:
    """Refuse a path that leaves the material (it may touch the boundary at its mouth alone)."""
    inside = shapely.contains_xy(body, path[1:, 0], path[1:, 1])
    if not np.all(inside):
        first = path[1:][~inside][0]
        raise ValueError(f"crack path node {first.tolist()} lies outside the material: shorten the path")


def _existing_node(points: np.ndarray, mouth: np.ndarray, largest: float) -> int:
    distance, nearest = cKDTree(points).query(mouth)
    if distance > 1e-6 * largest:
        raise ValueError(f"path[0] = {mouth.tolist()}: must lie on the boundary, not {distance:g} mm away")
    return int(nearest)


def _are_edges(pairs: np.ndarray, triangles: np.ndarray, n: int) -> np.ndarray:
    """Whether vertex pairs (k, 2) are edges of the triangles."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.isin(np.sort(pairs, axis=1) @ [n, 1], edges @ [n, 1])
