"""A smooth curve through the nodes of a chain of free edges: straight lines and arcs are what they were.

Between two nodes the curvature is nearly linear, and it is the same on either side of a node (an Euler spiral through
the nodes, to second order in the turn between two of them). Where a line goes over into an arc the curvature jumps;
there the curve is cut, and each part ends as an arc.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]

#: a curve turns by at most this between two of its points, rad: a spline through them is then as good as the nodes
#: (see `slmm.part.outline.Outline.of_pieces`); chosen
FINEST = 0.01
#: points between two nodes, at least and at most; chosen
FEWEST, MOST = 4, 40
#: an arc ends where the curvature jumps by this share of it, and so many times as far as on the other side; chosen
JUMP, CLEAR = 0.3, 5.0
#: nodes beyond the ends of a closed chain by which it is lengthened; 2^-40 is round-off
FELT = 40


def curve_through(at: Array, closed: bool) -> Array:
    """Points (m, 2) of the curve through nodes (n, 2), in order, the last of a closed chain not repeated.

    Parameters
    ----------
    at : ndarray (n, 2)
        At least two of them, three of a closed chain.
    closed : bool
        Whether the first node follows the last one.

    Examples
    --------
    >>> angle = np.linspace(0, np.pi, 7)
    >>> half = curve_through(np.column_stack([np.cos(angle), np.sin(angle)]), closed=False)
    >>> float(np.abs(np.hypot(*half.T) - 1).max()) < 1e-12
    True
    """
    if not closed:
        return np.concatenate([_points(at, _directions(at)), at[-1:]])
    # followed so far beyond its ends that nothing of these is felt: each node halves what is felt, at least
    n, turns = len(at), -(-FELT // len(at))
    around = np.concatenate([*[at] * (2 * turns + 1), at[:1]])
    start = turns * n
    direction = _directions(around)[start : start + n + 1]
    return _points(around[start : start + n + 1], direction)


def _directions(at: Array) -> Array:
    """Angles (n,) of the tangents at nodes (n, 2) of an open chain, rad, without jumps between them."""
    if len(at) == 2:
        return np.repeat(_chords(at)[0], 2)
    angle, length = _chords(at)
    # of the arc that has half of what the chords turn at either end
    turn = np.abs(np.diff(angle))
    half = 0.25 * (np.append(turn[0], turn) + np.append(turn, turn[-1]))
    length = length / np.sinc(np.minimum(half, 1.0) / np.pi)
    cuts = np.concatenate([[0], np.flatnonzero(_is_cut(at)), [len(at) - 1]])
    direction = np.full(len(at), np.nan)
    for first, last in pairwise(cuts):
        if last - first > 1:
            direction[first : last + 1] = _of_spiral(angle[first:last], length[first:last])
    # an edge alone goes on as its neighbours do, or is straight
    for first, last in pairwise(cuts):
        if last - first == 1:
            known = np.isfinite(direction[[first, last]])
            if not known.any():
                direction[[first, last]] = angle[first]
            elif not known.all():
                here = first if known[0] else last
                direction[first + last - here] = 2 * angle[first] - direction[here]
    return direction


def _chords(at: Array) -> tuple[Array, Array]:
    """Angles (n - 1,), without jumps, and lengths (n - 1,) of the chords between nodes (n, 2)."""
    step = np.diff(at, axis=0)
    return np.unwrap(np.arctan2(step[:, 1], step[:, 0])), np.hypot(*step.T)


def _of_spiral(angle: Array, length: Array) -> Array:
    """Tangents (n,) of the curve over chords (n - 1,), whose first and last pieces are arcs."""
    n = len(angle) + 1
    band, right = np.zeros((3, n)), np.zeros(n)
    band[1, 0] = band[0, 1] = band[1, -1] = band[2, -2] = 1.0
    right[0], right[-1] = 2 * angle[0], 2 * angle[-1]
    before, behind = 1 / length[:-1], 1 / length[1:]
    band[2, :-2], band[0, 2:] = before, behind
    band[1, 1:-1] = 2 * (before + behind)
    right[1:-1] = 3 * (before * angle[:-1] + behind * angle[1:])
    return np.asarray(solve_banded((1, 1), band, right))


def _is_cut(at: Array) -> NDArray[np.bool_]:
    """At which of the nodes (n, 2) the curvature jumps: beside the end of an arc, the circle through a node and those
    beside it, which reaches over the end, is neither the arc nor the line."""
    bend = np.full(len(at), np.nan)
    a, b, c = at[:-2], at[1:-1], at[2:]
    (ux, uy), (vx, vy), (wx, wy) = (b - a).T, (c - b).T, (c - a).T
    bend[1:-1] = 2 * (ux * vy - uy * vx) / (np.hypot(ux, uy) * np.hypot(vx, vy) * np.hypot(wx, wy))
    cut = np.zeros(len(at), dtype=bool)
    before, first, last, behind = bend[:-3], bend[1:-2], bend[2:-1], bend[3:]
    jumps = np.abs(first - before), np.abs(last - behind)
    least = JUMP * np.maximum(np.abs(first), np.abs(last))
    cut[1:-2] |= (jumps[0] > least) & (jumps[0] > CLEAR * jumps[1])
    cut[2:-1] |= (jumps[1] > least) & (jumps[1] > CLEAR * jumps[0])
    return cut


def _points(at: Array, direction: Array) -> Array:
    """Points (m, 2) of the curve through nodes (n, 2) with these tangents (n,), all but the last node."""
    angle, _ = _chords(at)
    # without jumps each for itself: how far the tangents lie from the chord
    start = (direction[:-1] - angle + np.pi) % (2 * np.pi) - np.pi
    end = (direction[1:] - angle + np.pi) % (2 * np.pi) - np.pi
    half, skew = 0.5 * (end - start), 0.5 * (start + end)
    turn = np.abs(end - start) + 4 * np.abs(skew)
    pieces = np.clip(np.ceil(turn / FINEST), FEWEST, MOST).astype(int)
    edge = np.repeat(np.arange(len(pieces)), pieces)
    t = (np.arange(len(edge)) - (np.cumsum(pieces) - pieces)[edge]) / pieces[edge]
    half, skew = half[edge], skew[edge]
    # over the chord, with the chord along x from 0 to 1: an arc, and what its curvature changes by
    u = half * (2 * t - 1)
    flat = np.abs(half) < 1e-9
    sine = np.where(flat, 1.0, np.sin(half))
    x = np.where(flat, t, 0.5 + 0.5 * np.sin(u) / sine)
    y = np.where(flat, 0.0, -0.5 * (np.cos(u) - np.cos(half)) / sine)
    y = y + skew * t * (1 - t) * (1 - 2 * t)
    along = np.diff(at, axis=0)[edge]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    return np.asarray(at[edge] + x[:, None] * along + y[:, None] * across)
