"""The closed curves around a part with notches, cut into smooth pieces, and boundary nodes along them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from slmm.fem.element_size import ElementSize
from slmm.mechanics.nearest import Nearest
from slmm.part.chords import chords
from slmm.part.outline import Outline

#: given steps of a line may be longer than the size wanted by this share, and than their neighbours by this factor: the
#: mesher cuts steps half as long again; both chosen
SLACK, STEPS_APART = 0.4, 1.45


@dataclass(frozen=True)
class Piece:
    """A smooth stretch of the boundary: part of an outline, or (outline = -1) of the outer edge.

    Attributes
    ----------
    outline : int
        The outline it is part of, or -1.
    s : ndarray (n,)
        Arc lengths at its ends and at prescribed points between them, mm; descending on an outline, which has
        the body on its right.
    start : ndarray (2,)
        The point at s[0], shared with the piece before, mm.
    direction : ndarray (2,), optional
        Of a straight piece.
    """

    outline: int
    s: np.ndarray
    start: np.ndarray
    direction: np.ndarray | None = None

    def points(self, s: np.ndarray, outlines: Sequence[Outline]) -> np.ndarray:
        """Points (n, 2) at arc lengths (n,), mm."""
        if self.direction is not None:
            return self.start + s[:, None] * self.direction
        return outlines[self.outline].points(s)


class _Line:
    """A straight line, with as much of an outline as finding a crossing needs."""

    def __init__(self, start: np.ndarray, end: np.ndarray):
        self.start = start
        self.direction = (end - start) / np.linalg.norm(end - start)

    def points(self, s: np.ndarray) -> np.ndarray:
        return self.start + s[:, None] * self.direction

    def project(self, points: np.ndarray) -> np.ndarray:
        return (points - self.start) @ self.direction


def boundary_pieces(
    body: shapely.Polygon, outlines: Sequence[Outline], mouths: np.ndarray
) -> list[list[Piece]]:
    """The curves around the body, which is on their left, cut where one curve gives way to another.

    Parameters
    ----------
    body : shapely.Polygon
        `slmm.part.part.Part.body`.
    outlines : sequence of Outline
        The true curves.
    mouths : ndarray (n, 2)
        Points of the boundary that have to be nodes, as the mouths of cracks, mm.
    """
    body = shapely.orient_polygons(body)
    samples = [chords(outline) for outline in outlines]
    label_of = _Labels(samples, 1e-9 * body.length)
    rings = []
    for ring in (body.exterior, *body.interiors):
        points = np.array(ring.coords)[:-1]
        label = label_of.of_ring(points)
        # straight stretches end at every corner of the outer edge, curves where the label changes
        starts = np.flatnonzero((label != np.roll(label, 1)) | (label < 0))
        if not len(starts):
            rings.append([_whole_outline(int(label[0]), outlines[label[0]], mouths)])
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
                pieces.append(_straight(corners[j], end, mouths))
            else:
                count = (starts[(j + 1) % len(starts)] - first) % len(points)
                last = points[(first + count) % len(points)]
                half_way = (
                    points[(first + count // 2) % len(points)] if count > 1 else (points[first] + last) / 2
                )
                k = int(label[first])
                pieces.append(_stretch(k, outlines[k], corners[j], half_way, end, mouths))
        rings.append(pieces)
    return rings


class _Labels:
    """Which outline a point of the body's polygon lies on, -1 for the outer edge."""

    def __init__(self, polygons: Sequence[np.ndarray], tolerance: float):
        self.polygons = polygons
        self.tolerance = tolerance

    @cached_property
    def _chords(self) -> tuple[np.ndarray, Nearest]:
        """To which outline chords belong, and their middles."""
        middle = [(polygon + np.roll(polygon, -1, axis=0)) / 2 for polygon in self.polygons]
        return np.repeat(np.arange(len(middle)), [len(m) for m in middle]), Nearest(np.concatenate(middle))

    def _in_reach(self, points: np.ndarray) -> np.ndarray:
        """Which points (n, 2) lie in the box around any of the polygons."""
        inside = np.zeros(len(points), dtype=bool)
        for polygon in self.polygons:
            low, high = polygon.min(axis=0) - self.tolerance, polygon.max(axis=0) + self.tolerance
            inside |= ((points >= low) & (points <= high)).all(axis=1)
        return inside

    def of_ring(self, points: np.ndarray) -> np.ndarray:
        """The outline of each chord (n,) of a ring that begins at points (n, 2)."""
        for k, polygon in enumerate(self.polygons):
            at = np.flatnonzero((polygon == points[0]).all(axis=1))
            if len(polygon) == len(points) and len(at):
                ahead, back = np.roll(polygon, -at[0], axis=0), np.roll(polygon[::-1], at[0] + 1, axis=0)
                if np.array_equal(points, ahead) or np.array_equal(points, back):
                    return np.full(len(points), k)
        return self((points + np.roll(points, -1, axis=0)) / 2)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        label = np.full(len(points), -1)
        rest = np.flatnonzero(self._in_reach(points))
        if not len(rest):
            return label
        # the middle of a whole chord is known; only chords that the outer edge cuts have to be searched
        owner, middles = self._chords
        nearest = middles.numbers(points[rest], 1)[:, 0]
        whole = np.linalg.norm(middles.points[nearest] - points[rest], axis=1) < self.tolerance
        label[rest[whole]] = owner[nearest[whole]]
        rest = rest[~whole]
        for k, polygon in enumerate(self.polygons):
            near = (
                shapely.distance(shapely.points(points[rest]), shapely.LinearRing(polygon)) < self.tolerance
            )
            label[rest[near]] = k
        return label


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
    # exactly on the outer edge, so that loads find it there
    return one.points(one.project(point[None]))[0]


def _on_outline(outline: Outline, mouths: np.ndarray) -> np.ndarray:
    """Arc lengths that have to be nodes: corners, and the mouths that lie on the outline, mm."""
    near, (low, high) = 1e-6 * outline.length, outline.box
    mouths = mouths[((mouths > low - near) & (mouths < high + near)).all(axis=1)]
    if not len(mouths):
        return outline.corners
    s = outline.project(mouths)
    on = np.linalg.norm(outline.points(s) - mouths, axis=1) < near
    return np.concatenate([outline.corners, s[on]])


def _whole_outline(k: int, outline: Outline, mouths: np.ndarray) -> Piece:
    """A hole inside the plate; its arc length runs backwards when the material is on the left."""
    wanted = _on_outline(outline, mouths)
    first = float(wanted[-1]) if len(wanted) else 0.0
    back = _distinct((first - wanted) % outline.length, outline.length)
    s = first - np.concatenate([[0.0], back, [outline.length]])
    return Piece(k, s, outline.points(first))


def _stretch(
    k: int, outline: Outline, start: np.ndarray, half_way: np.ndarray, end: np.ndarray, mouths: np.ndarray
) -> Piece:
    """The part of an outline from start over half_way to end."""
    s_start, s_half, s_end = outline.project(np.stack([start, half_way, end]))
    # around the hole the outline runs counter-clockwise, the ring around the body the other way
    span = float((s_start - s_end) % outline.length)
    if (s_start - s_half) % outline.length > span:
        raise ValueError(f"outline {k} runs clockwise around its hole: reverse its points")
    back = _distinct((s_start - _on_outline(outline, mouths)) % outline.length, span)
    return Piece(k, float(s_start) - np.concatenate([[0.0], back, [span]]), start)


def _straight(start: np.ndarray, end: np.ndarray, mouths: np.ndarray) -> Piece:
    """A stretch of the outer edge."""
    line = _Line(start, end)
    length = float(np.linalg.norm(end - start))
    along = line.project(mouths)
    on = np.linalg.norm(line.points(along) - mouths, axis=1) < 1e-9 * length
    s = np.concatenate([[0.0], _distinct(along[on], length), [length]])
    return Piece(-1, s, start, line.direction)


def _distinct(s: np.ndarray, length: float) -> np.ndarray:
    """Ascending values strictly between 0 and length, neighbours that coincide taken once."""
    s = np.sort(s[(s > 1e-9 * length) & (s < (1 - 1e-9) * length)])
    return s[np.diff(s, prepend=-length) > 1e-9 * length]


def spaced(piece: Piece, outlines: Sequence[Outline], size: ElementSize, slack: float = 0.0) -> np.ndarray:
    """Arc lengths of boundary nodes along a piece, as far apart as the size wanted there or by ``slack`` farther."""
    nodes = [piece.s[:1]]
    # small sizes are prescribed at ends (a crack's mouth, a corner): sample densely towards both
    half = np.concatenate([[0.0], np.geomspace(1e-6, 0.02, 60), np.linspace(0.02, 0.5, 200)[1:]])
    fraction = np.concatenate([half, 1 - half[-2::-1]])
    # a smooth hole is never one chord
    least = 8 if piece.direction is None and len(piece.s) <= 3 else 1
    for s0, s1 in pairwise(piece.s):
        s = s0 + fraction * (s1 - s0)
        wanted = size(piece.points(s, outlines))
        # sizes grow by less than the distance: samples no farther apart than the size miss no small one
        while (far := np.abs(np.diff(s)) > np.minimum(wanted[:-1], wanted[1:])).any():
            middle = (s[:-1] + s[1:])[far] / 2
            at = np.flatnonzero(far) + 1
            wanted = np.insert(wanted, at, size(piece.points(middle, outlines)))
            s = np.insert(s, at, middle)
        density = 1 / wanted
        count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.abs(np.diff(s)))])
        n = max(least, int(np.ceil(count[-1] - slack)))
        # the first and last value exactly, so that pieces meet
        inner = np.interp(np.arange(1, n) * count[-1] / n, count, s)
        nodes.append(np.append(inner, s1))
    return np.concatenate(nodes)


def crack_nodes(crack: np.ndarray, size: ElementSize) -> np.ndarray:
    """Nodes (k, 2) along a crack (n, 2), all its points among them."""
    nodes = [crack[:1]]
    for a, b in pairwise(crack):
        length = float(np.linalg.norm(b - a))
        piece = Piece(-1, np.array([0.0, length]), a, (b - a) / length)
        nodes += [piece.points(spaced(piece, (), size)[1:-1], ()), b[None]]
    return np.concatenate(nodes)


def path_nodes(path: np.ndarray, size: ElementSize) -> np.ndarray:
    """Nodes (k, 2) of a trial path: those given (n, 2), and more between them where the surroundings are finer."""
    step = np.linalg.norm(np.diff(path, axis=0), axis=1)
    sizes = size(path)
    least = np.minimum.reduce([sizes[:-1], sizes[1:], size((path[1:] + path[:-1]) / 2)])
    nodes = [path[:1]]
    for a, b, length, fine in zip(path, path[1:], step, least, strict=False):
        if length > (1 + SLACK / 2) * fine:
            piece = Piece(-1, np.array([0.0, length]), a, (b - a) / length)
            nodes.append(piece.points(spaced(piece, (), size, SLACK)[1:-1], ()))
        nodes.append(b[None])
    line = np.concatenate(nodes)
    while True:
        step = np.linalg.norm(np.diff(line, axis=0), axis=1)
        neighbour = np.minimum(np.append(step[1:], np.inf), np.insert(step[:-1], 0, np.inf))
        sudden = np.flatnonzero(step > STEPS_APART * neighbour)
        if not len(sudden):
            return line
        line = np.insert(line, sudden + 1, (line[1:] + line[:-1])[sudden] / 2, axis=0)


def boundary_segments(
    rings: Sequence[Sequence[Piece]], parameters: Sequence[np.ndarray], outlines: Sequence[Outline]
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
