"""Where a crack is looked for: on the outlines, at their corners and at the tips of the cracks that are there."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from slmm.part.checks import TOLERANCE
from slmm.part.outline import Outline
from slmm.scene.scene import Scene

#: samples of an outline that decide which part of it lies within the plate; chosen
SAMPLES = 4000
#: an outline that turns by more than this between two positions (rad) has its sharpest bend missed by both; chosen
MISSED_TURN = 0.8
#: so few positions cannot be meant to find it; chosen
FEW = 8


class Positions(NamedTuple):
    """Positions on the notches and at crack tips.

    Attributes
    ----------
    hole : ndarray (n,) of int
        Index into ``scene.outlines``; -1 at a crack tip.
    s : ndarray (n,)
        Arc length on that outline, mm; NaN at a crack tip.
    points : ndarray (n, 2)
        Coordinates, mm.
    tip : ndarray (n,) of int
        Index into ``scene.part.tips`` at a crack tip; -1 on the notches.
    corner : ndarray (n,)
        Opening angle at a sharp corner, rad; 0 at a crack tip, NaN where the outline is smooth.
    """

    hole: np.ndarray
    s: np.ndarray
    points: np.ndarray
    tip: np.ndarray
    corner: np.ndarray


def find_positions(scene: Scene, positions: int | None = None) -> Positions:
    """Positions along every outline, at its corners, and at the crack tips; or the scene's explicit points.

    On every outline they are equally spaced. Each corner inside the plate whose opening angle is less than pi is one
    more, in order of arc length, and from eight positions on the middle of each bend of the hole that is so sharp that
    it lies between two of them, as the root of a blunted V-notch. Where the surface is held, and where its corners jut
    out, there are none. The tips of the cracks follow after all outlines.

    The scene's explicit points keep their order. Each one goes to the crack tip or corner that it is (within
    1e-5 of the part's longer side), and else to the nearest point of an outline.

    Parameters
    ----------
    scene : Scene
    positions : int, optional
        Number on each hole; in place of what the scene asks for.

    Raises
    ------
    ValueError
        When the scene has neither hole nor crack, or an explicit point is no tip in a scene without holes.

    Examples
    --------
    >>> from slmm.scene.gallery import square_hole
    >>> where = find_positions(square_hole(), 2)
    >>> where.s.round(6).tolist(), np.degrees(where.corner).round(6).tolist()
    ([0.0, 30.0, 60.0, 90.0], [90.0, 90.0, 90.0, 90.0])
    """
    if not scene.outlines and not scene.part.tips and not scene.part.is_severed:
        raise ValueError(
            "holes: the scene has none, and no crack tips; a crack is looked for at a hole, notch or crack tip"
        )
    tolerance = TOLERANCE * scene.size
    if positions is None and scene.analysis.points is not None:
        return _explicit(scene, np.asarray(scene.analysis.points, dtype=float), tolerance)
    count = scene.analysis.positions if positions is None else positions
    if count < 1:
        raise ValueError(f"positions = {count}: must be at least 1")
    s_of = []
    for outline in scene.outlines:
        s = _with_corners(scene, outline, _spread(scene, outline, count), tolerance)
        s = s if count < FEW else _with_bends(scene, outline, s)
        s_of.append(s[_is_free(scene, outline, s)])
    tips = _tips(scene)
    hole = np.repeat(np.arange(len(s_of)), [len(s) for s in s_of])
    return positions_on(
        scene,
        np.concatenate([hole, np.full(len(tips), -1)]),
        np.concatenate([*s_of, np.full(len(tips), np.nan)]),
        np.concatenate([np.full(len(hole), -1), np.arange(len(tips))]),
    )


def _explicit(scene: Scene, wanted: np.ndarray, tolerance: float) -> Positions:
    """The explicit points (n, 2), each at the crack tip or on the outline where it belongs."""
    n = len(wanted)
    hole, s, at_tip = np.full(n, -1), np.full(n, np.nan), np.full(n, -1)
    nearest = np.full(n, np.inf)
    for k, outline in enumerate(scene.outlines):
        on_k = outline.project(wanted)
        distance = np.linalg.norm(outline.points(on_k) - wanted, axis=1)
        nearer = distance < nearest
        on_k = _to_corners(outline, on_k, tolerance)
        hole[nearer], s[nearer], nearest[nearer] = k, on_k[nearer], distance[nearer]
    for i, tip in enumerate(_tips(scene)):
        at = np.linalg.norm(wanted - tip, axis=1) <= tolerance
        hole[at], s[at], at_tip[at] = -1, np.nan, i
    lost = np.flatnonzero((hole < 0) & (at_tip < 0))
    if len(lost):
        x, y = wanted[lost[0]]
        raise ValueError(
            f"analysis.points[{lost[0]}] = [{x:g}, {y:g}]: the scene has no hole, so it must be a crack tip"
        )
    return positions_on(scene, hole, s, at_tip)


def positions_on(scene: Scene, hole: np.ndarray, s: np.ndarray, tip: np.ndarray) -> Positions:
    """Positions with their coordinates and opening angles."""
    points, corner = np.empty((len(s), 2)), np.full(len(s), np.nan)
    for k, outline in enumerate(scene.outlines):
        on_k = hole == k
        points[on_k] = outline.points(s[on_k])
        index = outline.corner_at(s[on_k])
        corner[on_k] = np.append(outline.corner_angles, np.nan)[index]  # -1, no corner, is the last one
    at_tip = tip >= 0
    points[at_tip], corner[at_tip] = _tips(scene)[tip[at_tip]], 0.0
    return Positions(hole, s, points, tip, corner)


def _tips(scene: Scene) -> np.ndarray:
    """Tips (n, 2) of the cracks, mm."""
    return np.array([line[-1] for line in scene.part.tips], dtype=float).reshape(-1, 2)


def _spread(scene: Scene, outline: Outline, count: int) -> np.ndarray:
    """Arc lengths equally spaced over the part of the outline that lies within the plate."""
    s = (np.arange(SAMPLES) + 0.5) * outline.length / SAMPLES
    inside = is_within(scene, outline.points(s))
    if inside.all():
        return np.arange(count) * outline.length / count
    within = s[inside]
    return within[((np.arange(count) + 0.5) * len(within) / count).astype(int)]


def _with_corners(scene: Scene, outline: Outline, s: np.ndarray, tolerance: float) -> np.ndarray:
    """The arc lengths with those of the corners inside the plate that open towards the hole, ascending."""
    wanted = (outline.corner_angles < np.pi) & is_within(scene, outline.points(outline.corners), tolerance)
    s = _to_corners(outline, s, tolerance)
    return np.sort(np.concatenate([s, np.setdiff1d(outline.corners[wanted], s)]))


def _is_free(scene: Scene, outline: Outline, s: np.ndarray) -> np.ndarray:
    """Whether cracks may start at arc lengths (n,): where nothing holds the surface, and no corner juts out."""
    juts = np.append(outline.corner_angles, 0.0)[outline.corner_at(s)] >= np.pi
    points = outline.points(s)
    held = np.zeros(len(s), dtype=bool)
    for condition in scene.loading:
        if any(condition.is_held):
            held |= condition.on(points)
    return ~juts & ~held


def _with_bends(scene: Scene, outline: Outline, s: np.ndarray) -> np.ndarray:
    """The arc lengths with the middles of bends that lie between two of them."""
    ends = np.append(s, s[0] + outline.length)
    bends = []
    for start, end in pairwise(ends):
        corners = np.concatenate([outline.corners, outline.corners + outline.length])
        at, turned = turn_along(outline, start, end)
        if np.any((corners >= start) & (corners <= end)) or not is_within(scene, outline.points(at)).all():
            continue
        if turned[-1] > MISSED_TURN:
            bends.append(float(np.interp(0.5 * turned[-1], turned, at)) % outline.length)
    return np.sort(np.concatenate([s, bends]))


def turn_along(outline: Outline, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths (k,) from one to another, mm, and the angle (k,) by which the outline has turned on the way, rad.

    Around a hole that bulges the outline turns to the left, which counts as positive.
    """
    at = np.linspace(start, end, 65)
    x, y = outline.tangents(at % outline.length).T
    steps = np.arctan2(x[:-1] * y[1:] - y[:-1] * x[1:], x[:-1] * x[1:] + y[:-1] * y[1:])
    return at, np.concatenate([[0.0], np.cumsum(steps)])


def _to_corners(outline: Outline, s: np.ndarray, tolerance: float) -> np.ndarray:
    """The arc lengths, those next to a corner (mm) replaced by the corner's."""
    index = outline.corner_at(s, tolerance)
    return np.where(index >= 0, np.append(outline.corners, np.nan)[index], s)


def is_within(scene: Scene, points: np.ndarray, margin: float = 0.0) -> np.ndarray:
    """Whether points (n, 2) of outlines lie within the plate, farther than a margin (mm) from its edges.

    In a part of another outline: whether they lie on its surface.
    """
    if scene.plate is None:
        return np.asarray(shapely.dwithin(scene.part.body, shapely.points(points), 2 * scene.part.tolerance))
    (x, y), width, height = points.T, scene.plate.width, scene.plate.height
    return (x > margin) & (x < width - margin) & (y > margin) & (y < height - margin)
