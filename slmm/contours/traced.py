"""Outline from a contour that was traced in a picture: sharp at its corners, smooth between them.

Lengths are in pixels until the outline is made; x runs to the right and y up from the picture's lower left corner.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import hilbert

from slmm.contours.accuracy import Accuracy
from slmm.contours.outline import Outline
from slmm.contours.smoothing import HELD, curvatures, smoothed, wavelengths
from slmm.contours.vertices import (
    STEP,
    Flank,
    Noise,
    Vertex,
    evenly_spaced,
    find_vertices,
    flank_at_end,
    straight_flank,
)

Array = NDArray[np.float64]

#: within this distance of the picture's border the blur has bent the contour
BORDER = 2.0
#: how far flanks go on beyond the border, so that the corner which follows lies outside the plate, and how much of
#: them is extrapolated at most
BEYOND, FARTHEST_BEYOND = 1.0, 12.0
#: outside the plate a notch is a polygon through the points beyond this distance, simplified to this deviation
OUTSIDE, SIMPLIFIED = 4.0, 1.0
#: angle (rad) and distance between the points of a smooth stretch
TURN_PER_POINT, FARTHEST, NEAREST = 0.03, 4.0, 0.2
#: turn (rad) between neighbouring points at which even a smooth stretch is split
SPLIT = 0.3
#: second smoothing: so many times the wavelength; what it changes is taken for the error of the first
SECOND = 1.4
#: a wavelength shorter than this share of the longest is one that follows a bend
FOLLOWS_BEND = 0.8
#: a bend that is followed point by point with less than so many blurs as its radius is known to so many of them
TIGHT, KNOWN = 6.0, 2.0
#: longest waves that a straight stretch may hide
HIDDEN = 60.0
#: pixels over which the noise that is left in an outline hangs together
CORRELATION = 2.0
#: share of a stretch that the arcs at its ends may use up
CUT = 0.45
#: points of the arc at a tight bend
ARC_POINTS = 41


class Contour(NamedTuple):
    """What is known of a traced contour.

    Attributes
    ----------
    points : (n, 2) array
        Of the closed contour.
    noise : Noise
        By which they err.
    blur : float
        Standard deviation of the picture's blur.
    per_root : float
        Wavelength below which undulations are noise, over the root of the radius of curvature.
    offset : float
        By which the whole contour may lie too far inside or outside.
    """

    points: Array
    noise: Noise
    blur: float
    per_root: float
    offset: float

    @property
    def radius(self) -> float:
        """Of a circle as long as the contour."""
        steps = np.roll(self.points, -1, axis=0) - self.points
        return float(np.hypot(*steps.T).sum() / (2 * np.pi))


class Mark(NamedTuple):
    """Where stretches of a contour end.

    Attributes
    ----------
    index : int
        Along the contour, in points.
    gap : float
        Distance from there to where the contour tells the stretch and no longer the mark.
    point : (2,) array
        Where the stretch ends.
    before, behind : Flank, optional
        What leads there.
    vertex : Vertex, optional
        None where the contour leaves the plate.
    """

    index: int
    gap: float
    point: Array
    before: Flank | None
    behind: Flank | None
    vertex: Vertex | None = None


class Bend(NamedTuple):
    """A corner or tight bend as it is in an outline: its root, its turn, and its radius with the bounds of that."""

    root: Array
    turn: float
    spread: float
    radius: float
    least: float
    largest: float


class Stretch(NamedTuple):
    """A smooth stretch: its points, two when it is straight.

    Further samples of what waves may do to the stress there, and its tight bends.
    """

    points: Array
    samples: Array
    stress: Array
    wavelength: Array
    bends: tuple[Bend, ...] = ()


def traced_outline(contour: Contour, width: float, height: float, pixel_size: float) -> Outline:
    """Outline, in mm, of one dark area of a picture of some width and height, in pixels."""
    points = evenly_spaced(contour.points, closed=True)
    inside = _depth(points, width, height) > BORDER
    if inside.all():
        vertices = find_vertices(points, True, contour.noise, contour.blur)
        marks = [_mark(vertex) for vertex in vertices]
        stretches = [
            _between(points, True, one, other, contour)
            for one, other in zip(marks, [*marks[1:], *marks[:1]], strict=True)
        ]
        corners: list[Vertex | None] = list(vertices)
    else:
        stretches, corners = _leaving(points, inside, width, height, contour)
    if stretches:
        rounded, roots = _with_arcs(stretches, corners)
        ring = shapely.Polygon(np.concatenate([piece[:-1] for piece in rounded]))
        if ring.is_valid and ring.area > 0.5 * shapely.Polygon(points).area:
            outline = Outline.of_pieces([piece * pixel_size for piece in rounded])
            return outline.with_accuracy(_accuracy(stretches, corners, roots, contour, pixel_size))
    # no corner, or one too many for a shape of a few pixels
    return _smooth_all_round(points, contour, pixel_size)


def _mark(vertex: Vertex) -> Mark:
    return Mark(vertex.index, vertex.gap, vertex.point, *vertex.flanks, vertex)


def _depth(points: Array, width: float, height: float) -> Array:
    """Distances (n,) of points from the picture's border, negative outside."""
    x, y = points.T
    return np.minimum.reduce([x, width - x, y, height - y])


def _leaving(
    points: Array, inside: NDArray[np.bool_], width: float, height: float, contour: Contour
) -> tuple[list[Stretch], list[Vertex | None]]:
    """Stretches of a contour that leaves the plate, each with the vertex at which it begins: polygons outside."""
    first = int(np.argmin(inside))
    points, inside = np.roll(points, -first, axis=0), np.roll(inside, -first)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int))).reshape(-1, 2)
    runs = [(a, b) for a, b in edges if (b - a) * STEP > 2 * BORDER]
    along_runs = []
    for a, b in runs:
        run = points[a:b]
        found = [_mark(vertex) for vertex in find_vertices(run, False, contour.noise, contour.blur)]
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
        for one, other in zip(marks[:-1], marks[1:], strict=True):
            stretches.append(_between(points[a:b], False, one, other, contour))
            corners.append(one.vertex)
        following = runs[(k + 1) % len(runs)][0]
        outer = np.arange(b, following if following >= b else following + len(points)) % len(points)
        polygon = [
            marks[-1].point,
            *points[outer][depth[outer] < -OUTSIDE],
            along_runs[(k + 1) % len(runs)][0].point,
        ]
        bends = shapely.get_coordinates(shapely.LineString(polygon).simplify(SIMPLIFIED))
        stretches += [_straight(*ends, contour) for ends in zip(bends[:-1], bends[1:], strict=True)]
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


def _between(points: Array, closed: bool, one: Mark, other: Mark, contour: Contour) -> Stretch:
    """The stretch of a contour from one mark to another."""
    n = len(points)
    steps = other.index - one.index
    if closed and steps <= 0:
        steps += n
    start, end = round(one.gap / STEP), steps - round(other.gap / STEP)
    if end - start < 2:
        return _straight(one.point, other.point, contour)
    inner = points[(one.index + np.arange(start, end + 1)) % n]
    if one.vertex is not other.vertex and straight_flank(inner, contour.noise):
        return _straight(one.point, other.point, contour)
    assert one.behind is not None and other.before is not None
    head, tail = _lead(one.point, one.behind), _lead(other.point, other.before)
    even = evenly_spaced(np.concatenate([head, inner, tail[::-1]]), closed=False)
    weights = np.ones(len(even))
    weights[[0, -1]] = HELD
    along = STEP * np.arange(len(even))
    straight = np.zeros(len(even), dtype=bool)
    for flank, distance in ((one.behind, along), (other.before, along[::-1])):
        if flank.is_straight:
            straight |= distance < min(flank.length, 0.4 * along[-1])
    wanted = wavelengths(even, weights, straight, contour.per_root, contour.radius, STEP, False)
    smooth = smoothed(even, weights, straight, wanted, STEP, False)
    again = smoothed(even, weights, straight, SECOND * wanted, STEP, False)
    smooth[0], smooth[-1] = one.point, other.point  # exactly, so that the stretches meet
    stress = _stress_of_waves(smooth, again, wanted, contour.noise.deviation, False)
    bends = _tight_bends(smooth, contour.blur, False)
    return Stretch(_thinned(smooth, False), smooth[::2], stress[::2], wanted[::2], bends)


def _straight(start: Array, end: Array, contour: Contour) -> Stretch:
    """A straight stretch; waves of twice its length may have passed for straight."""
    length = float(np.hypot(*(end - start)))
    samples = start + np.linspace(0, 1, max(int(length), 1) + 1)[:, None] * (end - start)
    wavelength = np.full(len(samples), np.clip(2 * length, 4 * CORRELATION, HIDDEN))
    return Stretch(np.array([start, end]), samples, 2 * _slope(contour.noise.deviation, wavelength), wavelength)


def _lead(point: Array, flank: Flank) -> Array:
    """Points (n, 2) from where a stretch ends along its flank to where the contour takes over, that one excluded."""
    u = (point - flank.origin) @ flank.along
    inner = np.linspace(u, 0.0, max(int(-u / STEP), 1) + 1)[1:-1]
    return np.concatenate([point[None], flank.points(inner)])


def _smooth_all_round(points: Array, contour: Contour, pixel_size: float) -> Outline:
    """Outline without corners."""
    weights, straight = np.ones(len(points)), np.zeros(len(points), dtype=bool)
    wanted = wavelengths(points, weights, straight, contour.per_root, contour.radius, STEP, True)
    smooth = smoothed(points, weights, straight, wanted, STEP, True)
    again = smoothed(points, weights, straight, SECOND * wanted, STEP, True)
    stress = _stress_of_waves(smooth, again, wanted, contour.noise.deviation, True)
    bends = _tight_bends(smooth, contour.blur, True)
    stretch = Stretch(smooth, smooth[::2], stress[::2], wanted[::2], bends)
    accuracy = _accuracy([stretch], [None], [None], contour, pixel_size)
    if wanted.min() >= FOLLOWS_BEND * wanted.max():
        longest = contour.per_root * np.sqrt(contour.radius)
        outline = Outline.through(
            contour.points * pixel_size, contour.noise.deviation * pixel_size, longest * pixel_size
        )
    else:
        # the piece begins and ends where it bends least
        flattest = int(np.abs(curvatures(smooth, STEP, True)).argmin())
        ring = _thinned(np.roll(smooth, -flattest, axis=0), True)
        outline = Outline.of_pieces([piece * pixel_size for piece in _split_at_turns(ring)])
    return outline.with_accuracy(accuracy)


def _thinned(points: Array, closed: bool) -> Array:
    """Points (k, 2) of a smooth stretch, dense where it bends; the first one is repeated when it is closed."""
    bend = np.abs(curvatures(points, STEP, closed))
    if closed:
        points, bend = np.vstack([points, points[:1]]), np.append(bend, bend[0])
    distance = np.clip(TURN_PER_POINT / np.maximum(bend, 1e-12), NEAREST, FARTHEST)
    along = STEP * np.arange(len(points))
    number = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (1 / distance[1:] + 1 / distance[:-1]))])
    count = max(int(np.ceil(number[-1])), 4)
    at = np.interp(np.linspace(0, number[-1], count + 1), number, along)
    spline = CubicSpline(along, points, bc_type="periodic" if closed else "not-a-knot")
    thin: Array = spline(at)
    thin[0], thin[-1] = points[0], points[-1]
    return thin


def _split_at_turns(ring: Array) -> list[Array]:
    """The closed points (n, 2) in pieces that end where no spline could follow."""
    steps = np.diff(ring, axis=0)
    before, behind = steps[:-1], steps[1:]
    cross = before[:, 0] * behind[:, 1] - before[:, 1] * behind[:, 0]
    sharp = 1 + np.flatnonzero(np.abs(np.arctan2(cross, (before * behind).sum(axis=1))) > SPLIT)
    ends = np.concatenate([[0], sharp, [len(ring) - 1]])
    return [ring[start : end + 1] for start, end in zip(ends[:-1], ends[1:], strict=True)]


def _slope(deviation: float, wavelength: Array) -> Array:
    """Root mean square slope (n,) of the waves that noise leaves above a wavelength.

    Noise of one deviation and a length over which its points err together is white up to the wave number of that
    length.
    """
    return deviation * np.sqrt((2 * np.pi / wavelength) ** 3 * CORRELATION / (3 * np.pi))


def _stress_of_waves(smooth: Array, again: Array, wavelength: Array, deviation: float, closed: bool) -> Array:
    """Relative error (n,) of the stress along a surface, from the noise left and from what smoothing takes out.

    To first order, waves of a free surface change the stress along it by twice the Hilbert transform of their slope.
    """
    tangent = np.gradient(smooth, axis=0)
    tangent /= np.maximum(np.hypot(*tangent.T), 1e-12)[:, None]
    gap = again - smooth
    across = gap[:, 0] * tangent[:, 1] - gap[:, 1] * tangent[:, 0]
    slope = np.gradient(across, STEP)
    if not closed:
        slope = np.concatenate([slope, np.zeros(len(slope))])
    envelope = np.abs(hilbert(slope))[: len(across)]
    result: Array = 2 * np.hypot(_slope(deviation, wavelength), envelope)
    return result


def _tight_bends(smooth: Array, blur: float, closed: bool) -> tuple[Bend, ...]:
    """Bends of a smooth stretch into the material that the picture tells little about."""
    bend = curvatures(smooth, STEP, closed)
    tight = bend > 1 / (TIGHT * blur)
    if tight.all():
        return ()
    first = int(np.argmin(tight))  # an open stretch begins with a flank
    order = np.roll(np.arange(len(smooth)), -first if closed else 0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], tight[order], [False]]).astype(int)))
    found = []
    for start, end in edges.reshape(-1, 2):
        inside = order[start:end]
        root = inside[bend[inside].argmax()]
        radius = float(1 / bend[root])
        turn = min(float(bend[inside].sum() * STEP), np.pi)
        bounds = max(radius - KNOWN * blur, 0.0), radius + KNOWN * blur
        found.append(Bend(smooth[root], turn, 0.0, radius, *bounds))
    return tuple(found)


def _with_arcs(
    stretches: list[Stretch], corners: list[Vertex | None]
) -> tuple[list[Array], list[Array | None]]:
    """The pieces of an outline, arcs at its tight bends among them, and the middle of the arc at each corner.

    ``corners[k]`` lies where ``stretches[k]`` begins.
    """
    pieces = [stretch.points for stretch in stretches]
    lengths = [float(np.hypot(*np.diff(piece, axis=0).T).sum()) for piece in pieces]
    arcs: list[Array | None] = [None] * len(pieces)
    for k, vertex in enumerate(corners):
        if vertex is None or vertex.radius == 0.0:
            continue
        before = k - 1
        cut = vertex.radius * np.tan(abs(vertex.turn) / 2)
        cut = min(cut, CUT * lengths[before], CUT * lengths[k])
        pieces[before], end, arriving = _shortened(pieces[before][::-1], cut)
        pieces[before] = pieces[before][::-1]
        pieces[k], start, leaving = _shortened(pieces[k], cut)
        arcs[k] = _arc(end, -arriving, start, leaving)
    result: list[Array] = []
    for piece, arc in zip(pieces, arcs, strict=True):
        result += [piece] if arc is None else [arc, piece]
    return result, [None if arc is None else arc[len(arc) // 2] for arc in arcs]


def _shortened(piece: Array, cut: float) -> tuple[Array, Array, Array]:
    """A piece without its beginning, its new first point, and the tangent (2,) there."""
    if len(piece) == 2:
        tangent = (piece[1] - piece[0]) / np.hypot(*(piece[1] - piece[0]))
        start = piece[0] + cut * tangent
        return np.array([start, piece[1]]), start, tangent
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(piece, axis=0).T))])
    spline = CubicSpline(along, piece)
    rest = piece[along > cut + 0.5 * (along[1] - along[0])]
    tangent = spline(cut, 1)
    return np.vstack([spline(cut), rest]), spline(cut), tangent / np.hypot(*tangent)


def _arc(start: Array, leaving: Array, end: Array, arriving: Array) -> Array:
    """Points (n, 2) of the curve between two points with given tangents, an arc when it is symmetric (Bezier)."""
    turn = np.arccos(np.clip(leaving @ arriving, -1, 1))
    handle = np.hypot(*(end - start)) / (3 * np.cos(turn / 4) ** 2)
    controls = np.array([start, start + handle * leaving, end - handle * arriving, end])
    t = np.linspace(0, 1, ARC_POINTS)[:, None]
    powers = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    points: Array = powers @ controls
    points[0], points[-1] = start, end
    return points


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
