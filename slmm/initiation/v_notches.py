"""V-notches of a scene: corners of outlines, round roots between straight flanks, and crack tips.

The tip of a notch is surrounded by a region that holds nothing but its flanks. There Williams' series describes the
displacements, whatever the part looks like, and a crack that is short against it meets the notch alone.
"""

from __future__ import annotations

from itertools import chain
from typing import NamedTuple

import numpy as np
import shapely

from slmm.initiation.positions import Positions
from slmm.part.outline import AT_CORNER, Outline
from slmm.part.part import Part
from slmm.scene.scene import Scene

#: a flank is straight as long as its tangent turns by less, rad; chosen
STRAIGHT_TURN = 0.01
#: shortest straight flanks of a round root, in its radii, and how much its radius may vary; both chosen
SHORTEST_FLANK, ROUND = 1.0, 0.15
#: angle along the root between a position and the bisector up to which the position counts as the root, rad; chosen
ON_BISECTOR = 0.05


class VNotch(NamedTuple):
    """Two straight flanks that meet at a tip, or touch the arc of a root.

    Attributes
    ----------
    root : ndarray (2,)
        Where the notch's surface meets its bisector, mm; the tip of a sharp notch or a crack.
    direction : ndarray (2,)
        Unit vector of the bisector, into the material.
    opening : float
        Angle between the flanks, rad; 0 is a crack or a U-notch.
    radius : float
        Of the root, mm; 0 at a sharp notch and a crack.
    clear : float
        Distance from the root to the nearest thing that is not a flank, mm: the plate's edges, other outlines,
        cracks, and what the notch's own outline or crack does beyond the flanks.
    """

    root: np.ndarray
    direction: np.ndarray
    opening: float
    radius: float
    clear: float

    def on_root(self, parts: np.ndarray) -> np.ndarray:
        """Points (n, 2) on the arc of the root, mm; -1 is where the right flank begins, 1 where the left one does."""
        angle = 0.5 * (np.pi - self.opening) * parts[:, None]
        across = np.array([-self.direction[1], self.direction[0]])
        return self.root + self.radius * ((np.cos(angle) - 1) * self.direction + np.sin(angle) * across)


def notch_at(scene: Scene, where: Positions, i: int) -> VNotch:
    """The notch at one of the positions.

    Raises
    ------
    ValueError
        When there is none; the message says why.

    Examples
    --------
    >>> from slmm.scene.gallery import v_notch
    >>> from slmm.initiation.positions import find_positions
    >>> scene = v_notch(opening=60.0, radius=0.5, analysis={"points": [[10.0, 60.0]]})
    >>> notch = notch_at(scene, find_positions(scene), 0)
    >>> round(float(np.degrees(notch.opening)), 3), round(notch.radius, 3), round(notch.clear, 3)
    (60.0, 0.5, 10.0)
    """
    if where.tip[i] >= 0:
        return crack_notch(scene, scene.part.tips[where.tip[i]])
    if np.isnan(where.corner[i]):
        return rounded_notch(scene, int(where.hole[i]), float(where.s[i]))
    return sharp_notch(scene, int(where.hole[i]), float(where.s[i]))


def crack_notch(scene: Scene, line: np.ndarray) -> VNotch:
    """The tip of a crack, the last point of its line (n, 2): its last segment is both flanks."""
    last = line[-1] - line[-2]
    clear = _clear_distance(scene, line[-1], line[:-1], flanks=line[-2:])
    return VNotch(line[-1], last / np.linalg.norm(last), 0.0, 0.0, clear)


def sharp_notch(scene: Scene, hole: int, s: float) -> VNotch:
    """The notch whose tip is the corner at the arc length s, mm, of an outline."""
    outline = scene.outlines[hole]
    opening = float(outline.corner_angles[outline.corner_at(s)])
    if not opening < np.pi:
        raise ValueError(f"no notch: a corner of the material, {np.degrees(opening):.4g} degrees in the hole")
    ahead, behind = (_straight_until(*_turns(outline, s, side), 0) for side in (1, -1))
    root = outline.points(s)
    clear = _clear_distance(scene, root, _part(outline, s + ahead, s - behind), hole=hole)
    return VNotch(root, outline.normals(s), opening, 0.0, clear)


def rounded_notch(scene: Scene, hole: int, s: float) -> VNotch:
    """The notch at whose root a smooth position lies, the arc length s, mm, of an outline.

    The outline bends there with one radius and goes straight on both sides, over a radius at least.
    """
    outline = scene.outlines[hole]
    curvature = float(outline.curvatures(s))
    if not curvature < -1 / outline.length:
        raise ValueError("smooth surface without flanks: it does not bulge into the material")
    radius = -1 / curvature
    (ahead, ahead_end, after), (behind, behind_end, before) = (
        _flank(outline, s, side, radius) for side in (1, -1)
    )
    arc = np.linspace(s - 0.9 * behind, s + 0.9 * ahead, 41)
    deviation = float(np.abs(outline.curvatures(arc) * radius + 1).max())
    if deviation > ROUND:
        raise ValueError(
            f"smooth surface without flanks: its curvature varies by {deviation:.0%} between them"
        )
    opening = float(np.pi - after - before)
    if opening < -2 * STRAIGHT_TURN:
        raise ValueError("smooth surface without flanks: its straight parts converge towards the mouth")
    off = 0.5 * (after - before)
    if abs(off) > ON_BISECTOR:
        raise ValueError(f"root of a V-notch, but {np.degrees(abs(off)):.3g} degrees off its bisector")
    at_root = s + off * radius
    root = outline.points(at_root)
    clear = _clear_distance(scene, root, _part(outline, s + ahead_end, s - behind_end), hole=hole)
    return VNotch(root, outline.normals(at_root), max(opening, 0.0), radius, clear)


def _clear_distance(
    scene: Scene, root: np.ndarray, beyond: np.ndarray, hole: int = -1, flanks: np.ndarray | None = None
) -> float:
    """Distance from a root to anything but its flanks, mm.

    ``beyond`` (n, 2) is the rest of its hole or crack, ``flanks`` (2, 2) the last straight of a crack.
    """
    rest = shapely.LineString(beyond) if len(beyond) > 1 else shapely.Point(beyond[0])
    edges = () if scene.part.rim is not None else (shapely.LinearRing(scene.part.outer),)
    obstacles = chain(
        edges,
        (rest,),
        (shapely.LinearRing(other.polygon(2000)) for k, other in enumerate(scene.outlines) if k != hole),
        (shapely.LineString(line) for line in _other_cracks(scene.part, flanks)),
    )
    return min(shapely.Point(root).distance(obstacle) for obstacle in obstacles)


def _other_cracks(part: Part, flanks: np.ndarray | None) -> list[np.ndarray]:
    """Lines (n, 2) of the cracks but the one whose last straight ends at a tip."""
    if flanks is None:
        return [crack.points for crack in part.cracks]
    return [
        crack.points
        for crack in part.cracks
        if not any(np.array_equal(line[-2:], flanks) for line in crack.tips)
    ]


def _turns(outline: Outline, s: float, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Distances (n,) along an outline from s to one side, mm, and the angles (n,) it has turned by until there, rad.

    At the ends and middles of its pieces, once round; the angles are positive where the hole bulges.
    """
    breaks = outline.breaks[:-1]
    samples = np.concatenate([breaks, 0.5 * (breaks + outline.breaks[1:])])
    distance = np.unique([0.0, *np.mod(side * (samples - s), outline.length), outline.length])
    # a corner has two tangents: that before it, but at the start the one behind it
    inset = 2 * AT_CORNER * outline.length
    start = inset if outline.corner_at(s) >= 0 else 0.0
    tangent = outline.tangents(s + side * np.maximum(distance - inset, start))
    first, (x, y) = tangent[0], tangent.T
    return distance, side * np.arctan2(first[0] * y - first[1] * x, first[0] * x + first[1] * y)


def _straight_until(distance: np.ndarray, turn: np.ndarray, start: int) -> float:
    """Distance up to which the outline stays straight from one of the distances on, mm."""
    bends = np.flatnonzero(np.abs(turn[start:] - turn[start]) > STRAIGHT_TURN)
    return float(distance[start + bends[0] - 1] if len(bends) else distance[-1])


def _flank(outline: Outline, s: float, side: int, radius: float) -> tuple[float, float, float]:
    """Distances from s at which a flank begins and ends, mm, and the angle the outline turns by until its end, rad."""
    distance, turn = _turns(outline, s, side)
    shortest = SHORTEST_FLANK * radius
    on_arc = np.flatnonzero(distance <= 0.5 * np.pi * radius * (1 + ROUND))
    after = np.searchsorted(distance, distance[on_arc] + shortest, side="right") - 1
    for start in on_arc[np.abs(turn[after] - turn[on_arc]) <= STRAIGHT_TURN]:
        end = _straight_until(distance, turn, start)
        if end - distance[start] >= shortest:
            return float(distance[start]), end, float(turn[distance <= end][-1])
    raise ValueError(
        f"smooth surface without flanks: nothing as long as its radius of curvature, {radius:.3g} mm,"
        " is straight beside it"
    )


def _part(outline: Outline, start: float, end: float) -> np.ndarray:
    """Points (n, 2) of an outline from one arc length onwards to another, mm."""
    extent = np.mod(end - start, outline.length)
    inner = np.sort(np.mod(outline.breaks[:-1] - start, outline.length))
    along = np.concatenate([[0.0], inner[(inner > 0) & (inner < extent)], [extent]])
    return outline.points(start + along)
