"""Trial crack paths: where they start, where they go, and how far they may."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from slmm.initiation.positions import Positions
from slmm.part.rays import Lines, distances_along
from slmm.scene.scene import Scene

#: longest trial crack in Irwin's lengths: at a straight edge a_c is 0.51 of them, in falling stress less; chosen
IN_IRWIN_LENGTHS = 0.7
#: where that is too short, as for the averaged stress or under bending: so much longer; chosen
LONGER = 4.0
#: and as a share of the ligament; chosen
IN_LIGAMENT = 0.8
#: a ligament's computed end is this near to the true outline, as a share of the part's longer side; chosen
CLOSE = 1e-5
#: steps from a surface into the body, as shares of the plate's width and height together; chosen
OFFSETS = (1e-4, 1e-5, 1e-6)


class Paths(NamedTuple):
    """Straight trial paths at some positions.

    Attributes
    ----------
    start, direction : ndarray (n, 2)
        The mouth, mm, and the unit vector into the material.
    ligament : ndarray (n,)
        Distance along the path to the next surface, mm.
    longest : ndarray (n,)
        Longest trial crack, mm.
    """

    start: np.ndarray
    direction: np.ndarray
    ligament: np.ndarray
    longest: np.ndarray

    def lengthened(self) -> Paths:
        """The same paths with longer trial cracks, where the ligament allows it."""
        return self._replace(longest=np.minimum(LONGER * self.longest, IN_LIGAMENT * self.ligament))


def trial_paths(scene: Scene, where: Positions) -> Paths:
    """Paths normal to the outlines, along the bisector at corners, straight on at crack tips."""
    n = len(where.s)
    direction = np.empty((n, 2))
    for k, outline in enumerate(scene.outlines):
        on_k = where.hole == k
        direction[on_k] = outline.normals(where.s[on_k])
    for k, line in enumerate(scene.part.tips):
        last = line[-1] - line[-2]
        direction[where.tip == k] = last / np.linalg.norm(last)
    ligament = ligaments(scene, where.points, direction)
    longest = np.minimum(IN_IRWIN_LENGTHS * scene.material.irwin_length, IN_LIGAMENT * ligament)
    return Paths(where.points, direction, ligament, longest)


def ligament_end(scene: Scene, paths: Paths, i: int) -> np.ndarray:
    """Point (2,) of a surface or crack where the path of a position leaves the material, mm."""
    end = paths.start[i] + paths.ligament[i] * paths.direction[i]
    near = CLOSE * scene.size
    for outline in scene.outlines:
        on_outline = outline.points(outline.project(end[None]))[0]
        if np.linalg.norm(on_outline - end) < near:
            return on_outline
    if scene.plate is None:
        return end
    # exactly on the plate's edge, unless it is a crack
    sides = scene.box[1]
    return np.where(np.abs(end) < near, 0.0, np.where(np.abs(end - sides) < near, sides, end))


def ligaments(scene: Scene, points: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Distances (n,) from surface points (n, 2) along directions (n, 2) to the next surface or crack, mm."""
    rings = [outline.polygon(2000) for outline in scene.part.holes]
    closed = [np.array(scene.outer.exterior.coords), *(np.vstack([ring, ring[:1]]) for ring in rings)]
    lines = Lines.of([*closed, *(crack.points for crack in scene.part.cracks)])
    reach = float(np.ptp(scene.box, axis=0).sum())
    result = np.full(len(points), OFFSETS[-1] * reach)
    todo = np.arange(len(points))
    # the outlines' polygons are a little off the points; a ligament may be thinner than the first step into the body
    for offset in OFFSETS:
        start = points[todo] + offset * reach * direction[todo]
        inside = _in_the_body(start, scene.outer, rings)
        found = todo[inside]
        # a ray through the plate's very corner may slip out between its edges
        way = np.minimum(distances_along(start[inside], direction[found], lines), reach)
        result[found] = offset * reach + way
        todo = todo[~inside]
    return result


def _in_the_body(points: np.ndarray, outer: shapely.Polygon, rings: Sequence[np.ndarray]) -> np.ndarray:
    """Whether points (n, 2) lie in the part and in none of its holes."""
    inside = shapely.contains_xy(outer, points)
    if rings:
        _, in_hole = shapely.STRtree(shapely.points(points)).query(
            [shapely.Polygon(ring) for ring in rings], predicate="intersects"
        )
        inside[in_hole] = False
    return inside
