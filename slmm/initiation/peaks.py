"""Where the largest index may lie between two positions, and which further positions would find it.

The index along an outline has a peak where the stress has one. Between two positions it is as high as a parabola
through three of them says, or a cubic through the next one on either side, too, once they lie closely enough to see
each bend of the outline. What is still hidden must be covered by the estimate of the index's error; where it is not,
positions are added.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slmm.initiation.positions import Positions, is_within, turn_along
from slmm.part.outline import Outline
from slmm.scene.scene import POLYGON_POINTS, Scene

#: an interval along which the outline turns by less, rad, has no peak of its own; chosen: 50 positions on a circle
#: turn by 0.13 from one to the next
PEAKLESS_TURN = 0.25
#: nor has one shorter than this share of the critical crack, over whose length the criterion looks in any case; chosen
SHORT = 0.25
#: share of an index from which on a bend beside it may hide the largest one; chosen: at a fillet the index may fall by
#: a third within a third of the bend
HIDDEN = 0.6
#: share of the estimate that the rise between positions may take, and of the index, whatever the estimate; chosen
RISE_COVERED, LEAST_RISE = 0.5, 5e-4
#: a parabola does not see a peak beside which one interval is so many times as long as the other, or along which the
#: index falls by so large a share; nor how much of that fall may be a rise before it; all chosen
LOPSIDED, STEEP, BEFORE_FALL = 2.5, 0.15, 0.25
#: beside a corner stress changes within less: no peak is nearer to it than the first of these shares of the critical
#: crack, and farther from it than the second there may be one that does not show; the next position is nearer by the
#: factor; positions that an outline has for this at least; all chosen
SHORT_BESIDE_CORNER, FAR_FROM_CORNER, NEARER, FEWEST_AROUND = 0.02, 0.15, 0.25, 6
#: a corner is under shear where the index of one flank is so many times that of the other, and beside it the index may
#: then be so many times the corner's; both chosen: under pure shear it was 1.2 times (a notch of 40 degrees)
ASYMMETRIC, OVER_CORNER = 1.25, 1.2
#: positions that are added at a time, at most; and to one interval; both chosen
MOST, MOST_IN_INTERVAL = 32, 6


class Peak(NamedTuple):
    """A position whose index is that of no smaller one than its neighbours'.

    Attributes
    ----------
    row : int
        The position.
    rise : float
        By how much the index may rise between it and its neighbours, by a parabola, or by their fall where that sees
        too little.
    wanted : ndarray (k,)
        Arc lengths of positions that would tell, mm; none where the estimate covers the rise.
    """

    row: int
    rise: float
    wanted: np.ndarray


def find_peaks(
    scene: Scene, where: Positions, index: np.ndarray, error: np.ndarray, crack_length: np.ndarray
) -> list[Peak]:
    """Peaks along all outlines that matter beside the largest index and are not resolved yet, the highest first.

    Parameters
    ----------
    scene : Scene
    where : Positions
        n positions, those of each outline in the order of their arc lengths.
    index, error : ndarray (n,)
        Failure index, and its estimated error, alike; NaN where there is none.
    crack_length : ndarray (n,)
        Critical crack length, mm; NaN where there is none.
    """
    index = np.nan_to_num(index, nan=0.0)
    if not index.max(initial=0.0) > 0:
        return []
    allowed = np.maximum(RISE_COVERED * np.nan_to_num(error, nan=0.0), LEAST_RISE * index)
    top = int(index.argmax())
    least = index[top] + allowed[top]
    found = []
    for k, outline in enumerate(scene.outlines):
        rows = np.flatnonzero(where.hole == k)
        for row, before, after in _maxima(rows, index):
            s = _unrolled(where.s[[before, row, after]], outline.length)
            bends = [
                _missing(scene, outline, start, end, where.corner[[one, other]], SHORT * crack_length[row])
                for start, end, one, other in ((s[0], s[1], before, row), (s[1], s[2], row, after))
            ]
            rise, at = _parabola(s, index[[before, row, after]])
            for other in _second_neighbours(rows, row):
                if np.isnan(where.corner[other]):
                    far = (float(where.s[other]) - s[1] + outline.length / 2) % outline.length
                    higher, there = _cubic(
                        s, s[1] + far - outline.length / 2, index[[before, row, after]], float(index[other])
                    )
                    between = s[1] - s[0] if there < s[1] else s[2] - s[1]
                    if higher > rise and not between <= SHORT * crack_length[row]:
                        rise, at = higher, there
            wanted = np.concatenate(bends) if index[row] >= HIDDEN * index[top] else np.empty(0)
            smooth = np.isnan(where.corner[[before, row, after]]).all()
            if not len(wanted) and smooth:
                closer, hidden = _unseen(s, index[[before, row, after]], SHORT * crack_length[row])
                if hidden > allowed[row] and index[row] + hidden > least:
                    wanted, rise = closer, hidden
                elif rise > allowed[row] and index[row] + rise > least:
                    wanted = _beside(s, at)
                wanted = wanted[is_within(scene, outline.points(wanted % outline.length))]
            if len(wanted):
                found.append(Peak(row, rise, np.sort(wanted % outline.length)))
        found += [
            Peak(row, rise, np.array([at % outline.length]))
            for row, rise, at in _towards_ends(_ends(scene, outline, where, rows), index, crack_length)
            if rise > allowed[row] and index[row] + rise > least
        ]
    return sorted(found, key=lambda peak: -index[peak.row])


def tops(where: Positions, index: np.ndarray) -> np.ndarray:
    """Positions (k,) on smooth stretches with an index no smaller than their neighbours'.

    Between them and these the index may still rise by `LEAST_RISE` of itself, which is what its error is at least.
    """
    index = np.nan_to_num(index, nan=0.0)
    found = [
        row
        for hole in np.unique(where.hole[where.hole >= 0])
        for row, _, _ in _maxima(np.flatnonzero(where.hole == hole), index)
    ]
    rows = np.array(found, dtype=int)
    return rows[np.isnan(where.corner[rows])]


class _End(NamedTuple):
    """A corner, or where the outline leaves the plate, as seen from one side.

    Attributes
    ----------
    s : float
        Its arc length, mm.
    near, far : int
        The positions next to it.
    side : int
        1 where these have the larger arc lengths, else -1.
    away : float
        Distance of the nearer one along the outline, mm.
    corner, beyond : int
        The position at the corner and the next one on its other side; -1 where the outline leaves the plate.
    """

    s: float
    near: int
    far: int
    side: int
    away: float
    corner: int
    beyond: int


def _ends(scene: Scene, outline: Outline, where: Positions, rows: np.ndarray) -> list[_End]:
    """Ends of the smooth stretches of an outline on which there are at least two positions."""
    found: list[_End] = []
    if len(rows) < FEWEST_AROUND:
        return found
    leaves = not is_within(scene, outline.polygon(POLYGON_POINTS)).all()
    for i, row in enumerate(rows):
        for side in (-1, 1):
            near, far = (int(rows[(i + k * side) % len(rows)]) for k in (1, 2))
            if np.isfinite(where.corner[row]):
                end = float(where.s[row])
                corner, beyond = int(row), int(rows[(i - side) % len(rows)])
            elif leaves:
                # the same two positions as seen from where the outline leaves the plate before them
                near, far, corner, beyond = int(row), near, -1, -1
                start = float(where.s[rows[(i - side) % len(rows)]])
                crossing = _leaves(scene, outline, float(where.s[row]), start, -side)
                if crossing is None:
                    continue
                end = crossing
            else:
                continue
            if np.isfinite(where.corner[[near, far]]).any():
                continue
            away = (side * (where.s[near] - end)) % outline.length
            found.append(_End(end, near, far, side, float(away), corner, beyond))
    return found


def _leaves(scene: Scene, outline: Outline, s: float, other: float, side: int) -> float | None:
    """Arc length, mm, at which the outline leaves the plate on the way from a position to the next; None if not."""
    distance = (side * (other - s)) % outline.length
    at = s + side * distance * np.linspace(0, 1, 65)
    inside = is_within(scene, outline.points(at % outline.length))
    if inside.all():
        return None
    last = int(np.argmin(inside))
    within, outside = at[max(last - 1, 0)], at[last]
    for _ in range(40):
        middle = 0.5 * (within + outside)
        if is_within(scene, outline.points(np.array([middle % outline.length])))[0]:
            within = middle
        else:
            outside = middle
    return float(within)


def _towards_ends(
    ends: list[_End], index: np.ndarray, crack_length: np.ndarray
) -> list[tuple[int, float, float]]:
    """Positions towards whose end the index rises, by how much it may, and an arc length nearer to that.

    A crack beside a corner runs in another direction than one from it, and under shear that may be the worse one;
    where a notch leaves a plate whose edge is held, the stress may be singular.
    """
    found = []
    for end in ends:
        crack = np.nan_to_num(crack_length[end.near], nan=0.0)
        rise = float(index[end.near] - index[end.far])
        if rise > 0 and end.corner < 0 and end.away > SHORT * crack > 0:
            # a held edge may make it rise as the root of the distance falls, to where the criterion does not look
            rise = max(rise, (np.sqrt(end.away / (SHORT * crack)) - 1) * float(index[end.near]))
        if end.away > FAR_FROM_CORNER * crack:
            rise = max(rise, BEFORE_FALL * float(index[end.near]))
            if end.corner >= 0 and index[end.near] > ASYMMETRIC * index[end.beyond]:
                rise = max(rise, OVER_CORNER * float(index[end.corner]) - float(index[end.near]))
        if rise > 0 and end.away > SHORT_BESIDE_CORNER * crack:
            found.append((end.near, rise, end.s + end.side * NEARER * end.away))
    return found


def _maxima(rows: np.ndarray, index: np.ndarray) -> list[tuple[int, int, int]]:
    """Positions on a closed outline with an index no smaller than both neighbours', and these."""
    if len(rows) < 3:
        return []
    before, after = np.roll(rows, 1), np.roll(rows, -1)
    highest = (index[rows] > 0) & (index[rows] >= index[before]) & (index[rows] >= index[after])
    return [(int(rows[i]), int(before[i]), int(after[i])) for i in np.flatnonzero(highest)]


def _second_neighbours(rows: np.ndarray, row: int) -> list[int]:
    """Those of a position, but for its neighbours."""
    if len(rows) < 5:
        return []
    i = int(np.flatnonzero(rows == row)[0])
    return [int(rows[i - 2]), int(rows[(i + 2) % len(rows)])]


def _unrolled(s: np.ndarray, length: float) -> np.ndarray:
    """Three arc lengths (3,) in ascending order, where the outline's start may lie between them."""
    before, at, after = s
    return np.array([before - length if before > at else before, at, after + length if after < at else after])


def _missing(
    scene: Scene, outline: Outline, start: float, end: float, corner: np.ndarray, short: float
) -> np.ndarray:
    """Arc lengths that part an interval so that the outline turns by little in each part; none beside a corner."""
    if np.isfinite(corner).any():
        return np.empty(0)
    at, signed = turn_along(outline, start, end)
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(signed)))])  # waves add up
    if not is_within(scene, outline.points(at % outline.length)).all() or turned[-1] <= PEAKLESS_TURN:
        return np.empty(0)
    bend = np.interp([0.05 * turned[-1], 0.95 * turned[-1]], turned, at)
    if bend[1] - bend[0] <= (short if np.isfinite(short) else 0.0):
        return np.empty(0)
    parts = min(int(np.ceil(turned[-1] / PEAKLESS_TURN)), MOST_IN_INTERVAL + 1)
    # the straight rest of the interval takes a part of its own
    measure = turned + (turned[-1] / parts) * (at - start) / (end - start)
    return np.interp(np.arange(1, parts) / parts * measure[-1], measure, at)


def _parabola(s: np.ndarray, index: np.ndarray) -> tuple[float, float]:
    """By how much the parabola through three points rises above the middle one, the highest, and where."""
    (left, right), (below, beyond) = s[[0, 2]] - s[1], index[[0, 2]] - index[1]
    curvature = (beyond / right - below / left) / (right - left)
    slope = below / left - curvature * left
    if not curvature < 0:
        return 0.0, float(s[1])
    return float(-(slope**2) / (4 * curvature)), float(s[1] - slope / (2 * curvature))


def _cubic(s: np.ndarray, far: float, index: np.ndarray, beyond: float) -> tuple[float, float]:
    """The same through a fourth point beside the three, as high as the cubic gets between these."""
    fitted = np.polynomial.Polynomial.fit(np.append(s, far) - s[1], np.append(index, beyond), 3)
    at = np.linspace(s[0], s[2], 65)
    values = fitted(at - s[1])
    top = int(values.argmax())
    return float(values[top] - index[1]), float(at[top])


def _unseen(s: np.ndarray, index: np.ndarray, short: float) -> tuple[np.ndarray, float]:
    """Where a parabola through three points is no measure of the peak, points closer to it, and what may be hidden."""
    lengths, falls = np.diff(s), index[1] - index[[0, 2]]
    closer, hidden = [], 0.0
    for side in (0, 1):
        length, other = lengths[side], lengths[1 - side]
        if length <= (short if np.isfinite(short) else 0.0):
            continue
        if length > LOPSIDED * other or falls[side] > STEEP * index[1]:
            closer.append(s[1] + (2 * side - 1) * min(other, 0.5 * length))
            hidden = max(hidden, BEFORE_FALL * float(falls[side]))
    return np.array(closer), hidden


def _beside(s: np.ndarray, at: float) -> np.ndarray:
    """The top of the parabola, and the middle of the wider interval, which keeps the next one from being lopsided."""
    start, end = (s[0], s[1]) if s[1] - s[0] > s[2] - s[1] else (s[1], s[2])
    middle = 0.5 * (start + end)
    near = 0.05 * (s[2] - s[0])
    return np.array([middle]) if min(abs(at - middle), abs(at - s[1])) < near else np.array([at, middle])


def positions_at(peaks: list[Peak], where: Positions) -> tuple[np.ndarray, np.ndarray]:
    """Outline (m,) and arc length (m,), mm, of what the highest peaks want, at most `MOST` of them."""
    hole: list[int] = []
    s: list[float] = []
    for peak in peaks:
        if s and len(s) + len(peak.wanted) > MOST:
            break
        hole += [int(where.hole[peak.row])] * len(peak.wanted)
        s += peak.wanted.tolist()
    taken = sorted(set(zip(hole, s, strict=True)))
    return np.array([k for k, _ in taken], dtype=int), np.array([at for _, at in taken])
