"""Vertices of a traced contour: sharp corners and bends so tight that a picture hardly tells them from corners.

Away from a vertex the contour follows two flanks, each straight or gently curved. They are fitted there and
extrapolated: on a smooth contour both go over into each other, at a vertex they meet at an angle. The area that
the contour cuts off between them and the vertex is that of a tangent arc, less what the picture's blur has cut off.
All lengths are in pixels.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.part.flanks import STEP, Flank, Noise, at_index, crossing, flank_beside

Array = NDArray[np.float64]

#: smallest turn at a vertex, rad: a flatter corner (opening 163 degrees) hardly raises the stress; chosen
SMALLEST_TURN = 0.3
#: and in standard deviations of the angle between the flanks; chosen
CERTAIN = 4.0
#: distances from a vertex at which its flanks may begin: beyond the blur, and beyond arcs of some radius; chosen
GAPS = (2.0, 3.5, 6.0)
#: and where a notch is so narrow that the picture does not show its last pixels: there its flanks turn by at least
#: this much, rad (an opening of 25 degrees), and by no more than lines that a picture tells from parallel
#: ones; all chosen
NARROW_GAPS, NARROW, PARALLEL = (10.0, 16.0), 2.7, 3.08
#: vertices nearer to each other than this are one; and how far one may lie from the contour, beside its
#: gap; both chosen
APART, AWAY = 3.0, 2.0
#: a vertex bends with at most this share of its flanks' radius, and this radius: others are followed point by
#: point; both chosen
TIGHT, LARGEST_RADIUS = 0.4, 6.0
#: a bend that may have a larger radius than this may be a wave of the contour; chosen
UNSURE = 24.0
#: up to this turn (rad) a vertex must be told from a smooth bend: a polynomial of degree 4 leaves more than the flanks
#: do by this factor; both chosen
GENTLE, WORSE = 1.2, 1.4
#: area that the chords of a traced contour cut off at a corner beside the blur, and its standard deviation; fitted to
#: sharp corners of drawn polygons (validation/fit_outline_errors.py)
CHORDS, CHORDS_SPREAD = 0.2, 0.1
#: turn (degrees) of a sharp corner, and the radius of the arc that cuts off as much of it as a Gaussian blur of
#: standard deviation 1 does, times tan(turn/2); computed, but too small by 2 and 4 % in the last two, which should be
#: 3.75 and 5.19 (validation/fit_outline_errors.py)
BLURRED_TURN = (20.0, 45.0, 75.0, 90.0, 110.0, 130.0, 150.0, 160.0)
BLURRED_RADIUS = (1.73, 1.78, 1.90, 2.01, 2.23, 2.65, 3.66, 5.0)


@dataclass(frozen=True)
class Vertex:
    """Where two flanks of a contour meet.

    Attributes
    ----------
    index : int
        Where on the contour, in points.
    point : ndarray (2,)
        Where the flanks meet.
    turn, spread : float
        Angle by which the contour turns there, rad, positive where it bulges out as a circle does; and its standard
        deviation.
    radius, least, largest : float
        Radius of the arc between the flanks, 0 for a corner that may be sharp, and its bounds (two standard
        deviations).
    gap : float
        Distance along the contour within which its points tell the arc and not the flanks.
    flanks : (Flank, Flank)
        That before the vertex and that behind it.
    """

    index: int
    point: Array
    turn: float
    spread: float
    radius: float
    least: float
    largest: float
    gap: float
    flanks: tuple[Flank, Flank]


def find_vertices(points: Array, closed: bool, noise: Noise, blur: float) -> list[Vertex]:
    """Vertices of a contour, in their order.

    Parameters
    ----------
    points : (n, 2) array
        Of the contour, `STEP` apart.
    closed : bool
        Whether the first point follows the last one.
    noise : Noise
        By which they err across the contour.
    blur : float
        Standard deviation of the Gaussian blur of the picture.
    """
    possible = []
    for i in _candidates(points, closed):
        vertex = _vertex_at(points, closed, int(i), noise, blur)
        if vertex is not None:
            # once more from where the flanks meet: the turn is spread over some points
            nearest = int(np.hypot(*(points - vertex.point).T).argmin())
            vertex = _vertex_at(points, closed, nearest, noise, blur)
        if vertex is not None and np.hypot(*(points[vertex.index] - vertex.point)) < vertex.gap + AWAY:
            possible.append(vertex)
    found: list[Vertex] = []
    for vertex in sorted(possible, key=lambda vertex: vertex.spread):
        if all(
            _apart(vertex.index, other.index, len(points), closed) >= max(other.gap, vertex.gap)
            and np.hypot(*(vertex.point - other.point)) > APART
            for other in found
        ):
            found.append(vertex)
    return sorted(found, key=lambda vertex: vertex.index)


def _apart(one: float, other: float, n: int, closed: bool) -> float:
    gap = abs(one - other)
    return STEP * (min(gap, n - gap) if closed else gap)


def _candidates(points: Array, closed: bool) -> NDArray[np.intp]:
    """Where the contour turns most within a few pixels: the strongest first."""
    n = len(points)
    near, far = round(1.0 / STEP), round(5.0 / STEP)
    steps = np.arange(n)
    if closed:
        ends = [np.roll(points, -k, axis=0) for k in (near, far, -near, -far)]
        inner = np.ones(n, dtype=bool)
    else:
        ends = [points[np.clip(steps + k, 0, n - 1)] for k in (near, far, -near, -far)]
        inner = (steps >= round(3.0 / STEP)) & (steps < n - round(3.0 / STEP))
    ahead, behind = ends[1] - ends[0], ends[2] - ends[3]
    turn = np.abs(
        np.arctan2(behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0], (behind * ahead).sum(axis=1))
    )
    turn[~inner] = 0.0
    reach = round(1.5 / STEP)
    windows = np.stack([np.roll(turn, k) for k in range(-reach, reach + 1)])
    peak = (turn >= windows.max(axis=0)) & (turn > 0.7 * SMALLEST_TURN)
    index = np.flatnonzero(peak)
    return index[np.argsort(-turn[index], kind="stable")]


def _vertex_at(points: Array, closed: bool, i: int, noise: Noise, blur: float) -> Vertex | None:
    """The vertex next to a point of the contour, None where it is smooth there."""
    for gap in GAPS + NARROW_GAPS:
        ahead, after = (flank_beside(points, closed, i, side, gap, noise) for side in (-1, 1))
        if ahead is None or after is None:
            continue
        flanks = (ahead, after)
        met = crossing(flanks[0], flanks[1], gap)
        if met is None:
            continue
        (u_0, u_1), meeting = met
        before, behind = -flanks[0].direction(u_0), flanks[1].direction(u_1)
        turn = float(np.arctan2(before[0] * behind[1] - before[1] * behind[0], before @ behind))
        (place_0, slope_0), (place_1, slope_1) = flanks[0].spread(u_0), flanks[1].spread(u_1)
        of_turn = float(np.hypot(slope_0, slope_1))
        least_turn = NARROW if gap in NARROW_GAPS else SMALLEST_TURN
        if abs(turn) < max(least_turn, CERTAIN * of_turn) or abs(turn) > PARALLEL:
            continue
        per_square = np.tan(abs(turn) / 2) - abs(turn) / 2
        cut_off = area_cut_off(points, closed, i, gap, flanks, (u_0, u_1), turn) - CHORDS
        spread = np.linalg.norm(
            [
                place_0 * gap / 2,
                place_1 * gap / 2,
                noise.deviation * np.sqrt(2 * gap * noise.correlation),
                CHORDS_SPREAD,
            ]
        )
        blurred = (
            blur * np.interp(np.degrees(abs(turn)), BLURRED_TURN, BLURRED_RADIUS) / np.tan(abs(turn) / 2)
        )
        square = cut_off / per_square - blurred**2
        least, largest = (np.sqrt(max(square + side * 2 * spread / per_square, 0.0)) for side in (-1.0, 1.0))
        # within its own blur no picture tells a radius from a corner
        least = float(least) if least > blur else 0.0
        largest = max(float(largest), blur)
        radius = float(np.sqrt(max(square, 0.0))) if least > 0 else 0.0
        bend = max(abs(2 * flank.coefficients[0]) for flank in flanks)
        if max(largest, blurred) * bend > TIGHT or radius > LARGEST_RADIUS or largest > UNSURE:
            continue
        if largest * np.tan(abs(turn) / 2) > gap + 1.0:
            continue  # an arc might reach into what was taken for flanks
        if abs(turn) < GENTLE and _is_smooth(points, closed, i, gap, flanks, before + behind):
            continue
        bounds = (radius, least, largest)
        return Vertex(int(i), meeting, turn, of_turn, *bounds, gap, flanks)
    return None


def area_cut_off(
    points: Array,
    closed: bool,
    i: int,
    gap: float,
    flanks: tuple[Flank, Flank],
    ends: tuple[float, float],
    turn: float,
) -> float:
    """Area between a contour, within a gap of a point, and its two flanks, which go on up to where they meet.

    ``ends`` are the places along the flanks where they do, ``turn`` is the angle by which the contour turns, rad.
    """
    number = round(gap / STEP)
    around = points[at_index(i + np.arange(-number, number + 1), len(points), closed)]
    sides = [flanks[1].points(np.linspace(0, ends[1], 9)), flanks[0].points(np.linspace(ends[0], 0, 9))]
    return -float(np.sign(turn)) * _area(np.concatenate([around, *sides]))


def _is_smooth(
    points: Array, closed: bool, i: int, gap: float, flanks: tuple[Flank, Flank], along: Array
) -> bool:
    """Whether a polynomial across the bend follows flanks and contour between them about as well as the flanks do."""
    first, last = (round((gap + flank.length) / STEP) for flank in flanks)
    around = points[at_index(i + np.arange(-first, last + 1), len(points), closed)] - points[i]
    along = along / np.hypot(*along)
    u, v = around @ along, around @ np.array([-along[1], along[0]])
    u = u / np.abs(u).max()
    powers = np.vander(u, 5)
    rest = v - powers @ np.linalg.lstsq(powers, v, rcond=None)[0]
    of_flanks = np.sqrt(np.mean([flank.rest**2 for flank in flanks]))
    return bool(np.sqrt((rest**2).mean()) < WORSE * of_flanks)


def _area(points: Array) -> float:
    x, y = points.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
