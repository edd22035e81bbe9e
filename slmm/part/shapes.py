"""The simple hole shapes: points dense enough for the smallest radius of curvature, or pieces between corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slmm.part.outline import SMALLEST_TURN

Array = NDArray[np.float64]

#: points per full turn of the tangent; chosen
POINTS_PER_TURN = 360
MAX_POINTS = 8000  # chosen
#: angle (rad) between the points of an arc that is a piece of its own; its curvature is then good to 3e-5; chosen
ARC_STEP = 0.005


def circle(center: ArrayLike, radius: float) -> Array:
    """Points (n, 2) on a circle, from its rightmost point counter-clockwise; centre and radius in mm."""
    return ellipse(center, (radius, radius))


def ellipse(center: ArrayLike, semi_axes: tuple[float, float], angle: float = 0.0) -> Array:
    """Points (n, 2) on an ellipse, counter-clockwise from the end of its first semi-axis.

    Parameters
    ----------
    center : (2,) array_like
        Centre, mm.
    semi_axes : (float, float)
        Semi-axes along x and y before turning, mm.
    angle : float
        Angle by which it is turned counter-clockwise, degrees.
    """
    a, b = semi_axes
    # Even steps of the eccentric angle are shortest where the ellipse bends most; the tangent turns there
    # by a/b of the step.
    n = int(min(POINTS_PER_TURN * max(a / b, b / a), MAX_POINTS))
    t = np.linspace(0.0, 2 * np.pi, n, endpoint=False)
    return _placed(np.column_stack([a * np.cos(t), b * np.sin(t)]), center, angle)


def rectangle(
    center: ArrayLike, size: tuple[float, float], corner_radius: float, angle: float = 0.0
) -> Array:
    """Points (n, 2) on a rectangle with circular corners, counter-clockwise from its right side.

    Parameters
    ----------
    center : (2,) array_like
        Centre, mm.
    size : (float, float)
        Sides along x and y before turning, mm.
    corner_radius : float
        Radius of the corners, more than 0 and at most half the smaller side, mm.
    angle : float
        Angle by which it is turned counter-clockwise, degrees.
    """
    half = np.asarray(size, dtype=float) / 2 - corner_radius
    turn = np.linspace(0.0, np.pi / 2, POINTS_PER_TURN // 4 + 1)
    parts = []
    for quarter, (sx, sy) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        t = turn + quarter * np.pi / 2
        arc = half * (sx, sy) + corner_radius * np.column_stack([np.cos(t), np.sin(t)])
        # the straight side behind the corner has steps no longer than ten of the arc's
        side = 2 * half[quarter % 2]
        n = int(np.ceil(side / (10 * corner_radius * turn[1])))
        along = np.arange(1, n)[:, None] / max(n, 1) * side * np.array([-np.sin(t[-1]), np.cos(t[-1])])
        parts += [arc if side > 1e-9 * corner_radius else arc[:-1], arc[-1] + along]
    return _placed(np.vstack(parts), center, angle)


def rectangle_corners(center: ArrayLike, size: tuple[float, float], angle: float = 0.0) -> Array:
    """Corners (4, 2) of a rectangle, counter-clockwise from the end of its right side; as `rectangle`."""
    half = np.asarray(size, dtype=float) / 2
    return _placed(half * [(1, 1), (-1, 1), (-1, -1), (1, -1)], center, angle)


def polygon(points: ArrayLike, corner_radius: ArrayLike = 0.0) -> list[Array]:
    """Pieces of a polygon for `Outline.of_pieces`: its sides and, when it is rounded, tangent arcs between them.

    Parameters
    ----------
    points : (k, 2) array_like
        Corners of a simple polygon, mm, in either sense.
    corner_radius : float or (k,) array_like
        Radius of the corners, or of each of them, mm; 0 leaves them sharp.

    Returns
    -------
    list of (n, 2) arrays
        In the sense of the corners. The first one starts at the first corner or where its arc begins.

    Raises
    ------
    ValueError
        When the radius does not fit between a corner and its neighbours.

    Examples
    --------
    >>> [len(piece) for piece in polygon([(0, 0), (4, 0), (0, 3)])]
    [2, 2, 2]
    """
    corners = np.asarray(points, dtype=float)
    sides = np.roll(corners, -1, axis=0) - corners
    radius = np.broadcast_to(np.asarray(corner_radius, dtype=float), len(corners))
    if not radius.any():
        return [np.array(ends) for ends in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    lengths = np.linalg.norm(sides, axis=1)
    along = sides / lengths[:, None]
    before = np.roll(along, 1, axis=0)
    turns = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    turns[np.abs(turns) < SMALLEST_TURN] = 0.0  # smooth already
    per_radius = np.tan(np.abs(turns) / 2)  # length of the tangents from a corner to its arc
    cut = radius * per_radius
    left = lengths - cut - np.roll(cut, -1)
    if (left < -1e-9 * lengths).any():
        k = int((left / lengths).argmin())
        following = (k + 1) % len(corners)
        # both radii alike, or as they are to each other
        share = lengths[k] / (cut[k] + cut[following])
        allowed = " and ".join(f"{share * r:.6g}" for r in dict.fromkeys((radius[k], radius[following])))
        given = " and ".join(f"{r:g}" for r in dict.fromkeys((radius[k], radius[following])))
        raise ValueError(
            f"corner_radius = {given}: does not fit between points {k} and {following};"
            f" must be at most {allowed} there"
        )
    pieces = []
    for k, corner in enumerate(corners):
        start, end = corner - cut[k] * before[k], corner + cut[k] * along[k]
        if turns[k] and radius[k]:
            centre = start + np.sign(turns[k]) * radius[k] * _left_of(before[k])
            pieces.append(np.vstack([start, _arc(start, centre, turns[k])[1:-1], end]))
        if left[k] > 1e-9 * lengths[k]:
            following = (k + 1) % len(corners)
            pieces.append(np.array([end, corners[following] - cut[following] * along[k]]))
    return pieces


def v_notch(tip: ArrayLike, direction: float, opening: float, radius: float, depth: float) -> list[Array]:
    """Pieces of a V-notch for `Outline.of_pieces`: a flank, the arc at its root, the other flank, the back side.

    Parameters
    ----------
    tip : (2,) array_like
        Where the notch's surface meets its bisector, mm.
    direction : float
        Where the notch points to, from its mouth along its bisector into the material, degrees; 0 is along x.
    opening : float
        Angle between the flanks, degrees; 0 is a U-notch of the width 2 radius.
    radius : float
        Radius of the root, to which the flanks are tangents, mm; 0 is a sharp tip.
    depth : float
        Distance along the bisector from the tip to the straight back side, more than `root_depth`, mm.

    Returns
    -------
    list of (n, 2) arrays
        Counter-clockwise, from the corner on the right (as seen in the direction) between back side and flank.
    """
    half = np.radians(opening) / 2
    ahead = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    aside = _left_of(ahead)
    root = root_depth(opening, radius)
    width = radius * np.cos(half) + (depth - root) * np.tan(half)
    tip = np.asarray(tip, dtype=float)
    right, left = tip - depth * ahead - width * aside, tip - depth * ahead + width * aside
    back = np.array([left, right])
    if radius == 0:
        return [np.array([right, tip]), np.array([tip, left]), back]
    centre = tip - radius * ahead
    start, end = (
        centre + radius * (np.sin(half) * ahead + side * np.cos(half) * aside) for side in (-1.0, 1.0)
    )
    arc = np.vstack([start, _arc(start, centre, np.pi - 2 * half)[1:-1], end])
    return [np.array([right, start]), arc, np.array([end, left]), back]


def root_depth(opening: float, radius: float) -> float:
    """Distance (mm) along the bisector from the tip of a rounded V-notch to where its flanks begin.

    Examples
    --------
    >>> root_depth(0.0, 2.0), root_depth(60.0, 0.0)
    (2.0, 0.0)
    """
    return float(radius * (1 - np.sin(np.radians(opening) / 2)))


def _arc(start: Array, centre: Array, angle: float) -> Array:
    """Points (n, 2) from start round a centre by an angle (rad), counter-clockwise when it is positive."""
    turn = np.linspace(0.0, angle, max(int(np.ceil(np.abs(angle) / ARC_STEP)), 4) + 1)
    x, y = start - centre
    c, s = np.cos(turn), np.sin(turn)
    return centre + np.column_stack([c * x - s * y, s * x + c * y])


def _left_of(direction: Array) -> Array:
    return np.array([-direction[1], direction[0]])


def _placed(points: Array, center: ArrayLike, angle: float) -> Array:
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return points @ np.array([[c, s], [-s, c]]) + np.asarray(center, dtype=float)
