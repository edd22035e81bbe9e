"""Body-fitted meshes of parts whose cracks grow: fine at tips and at corners, coarse along cracks that are arrested.

A mesh is made anew for every increment, as in Paper D (section 2.1). Around tips it is fine enough for an interaction
integral over all that is clear there, down to a twelfth of that.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.fem.element_size import ACROSS_GAP, ElementSize, SizePolicy, follow_outline
from slmm.fem.mesh import PlateMesh, plate_mesh
from slmm.fem.triangulation import MesherError
from slmm.part.crack import TIP
from slmm.part.part import Part
from slmm.scene.loading import Condition, Loading

Array = NDArray[np.float64]

#: of the coarsest meshes that are used: turn of an outline along an edge, rad; elements in what is clear around a tip,
#: and in the part's shorter side if they were all as small as at a tip; in the depth of the point method at a corner or
#: where a support ends; all chosen on validation/fracture_engines.py
TURN, AT_TIP, SMALL, AT_CORNER = 0.12, 12, 2000, 24
#: elements in a stretch that is held or loaded if all were as small as at its ends; chosen
AT_END = 12
#: sizes that are tried where the mesher fails, over those that are wanted; chosen
OTHERS = (1.0, 0.8, 1.25, 0.6)
#: faces go straight on while their points lie off the tip's direction by less than this share of their distance; chosen
STRAIGHT = 1e-3
#: a crack runs along what is nearer than this share of its way to where it ends at a surface or crack; chosen
ALONGSIDE = 0.4
#: edges of cracks are so many times as long as their neighbours at most; chosen below the 1.5 at which the mesher cuts
APART = 1.4
#: places on each straight piece of a crack at which its distance to the others is taken; chosen
PLACES = 8


def crack_mesh(
    part: Part,
    loading: Loading,
    depth: float,
    fineness: float = 1.0,
    fine_at: tuple[Array, Array] | None = None,
) -> PlateMesh:
    """A mesh of a part with growing cracks.

    Parameters
    ----------
    part : Part
    loading : Loading
        Its ends become nodes.
    depth : float
        At which stress below corners is wanted, mm.
    fineness : float
        Sizes of elements, over those of the coarsest mesh.
    fine_at : (ndarray (k, 2), ndarray (k,)), optional
        Places and how large elements may be there, mm.

    Raises
    ------
    ImportError
        Without netgen.
    MesherError
        When the mesher fails with other sizes, too.
    """
    for other in OTHERS:
        scale = fineness * other
        policy = SizePolicy(_largest(part) * scale, TURN * scale, at_tips=np.inf, at_kinks=np.inf)
        try:
            fine = _fine_at(part, loading, depth, policy, scale, fine_at)
            return plate_mesh(part, None, policy, fine, loading.ends)
        except MesherError as error:
            why = error
    raise MesherError(f"{why}, nor with elements {', '.join(f'{x:g}' for x in OTHERS[1:])} times as large")


def clear_radii(part: Part) -> Array:
    """Radius (k,) around each tip of a part within which there is only material and its crack's straight faces, mm.

    Examples
    --------
    >>> part = Part.plate(80.0, 80.0, cracks=[[(0, 40), (10, 40), (12, 41)], [(60, 50), (60, 45)]])
    >>> clear_radii(part).round(3).tolist()
    [2.236, 5.0, 5.0]
    """
    radii = []
    for number, crack in enumerate(part.cracks):
        others = [other.points for k, other in enumerate(part.cracks) if k != number]
        obstacles = [part.body.boundary, *map(shapely.LineString, others)]
        for line in crack.tips:
            obstacles_here = [*obstacles, _behind(line)]
            tip = shapely.Point(line[-1])
            radii.append(min(shapely.distance(obstacle, tip) for obstacle in obstacles_here))
    return np.array(radii)


def _behind(line: Array) -> shapely.Geometry:
    """What is left of the line (n, 2) to a tip behind its last straight stretch: at least where it begins."""
    back = line[::-1] - line[-1]
    way = np.linalg.norm(back, axis=1)
    along = back[1] / way[1]
    aside = np.abs(back[:, 0] * along[1] - back[:, 1] * along[0])
    bent = np.flatnonzero((aside > STRAIGHT * way) | (back @ along < 0))
    last = len(line) - int(bent[0]) if len(bent) else 0
    return shapely.LineString(line[: last + 1]) if last > 0 else shapely.Point(line[0])


def _largest(part: Part) -> float:
    return float(np.ptp(part.outer, axis=0).min()) / 12


def _fine_at(
    part: Part,
    loading: Loading,
    depth: float,
    policy: SizePolicy,
    scale: float,
    more: tuple[Array, Array] | None,
) -> tuple[Array, Array]:
    """Points (n, 2) and the sizes (n,) wanted there, mm."""
    side, at_corner = float(np.ptp(part.outer, axis=0).min()), scale * depth / AT_CORNER
    tips = np.array([line[-1] for line in part.tips]).reshape(-1, 2)
    at = [tips]
    sizes = [scale * np.minimum(clear_radii(part) / AT_TIP, side / SMALL)]
    for outline in part.outlines:
        corners = outline.points(outline.corners[outline.corner_angles < np.pi])
        # a notch that cuts the outer edge has corners outside
        corners = corners[shapely.dwithin(shapely.points(corners), part.body.boundary, part.tolerance)]
        at.append(corners)
        sizes.append(np.full(len(corners), at_corner))
    for condition in loading:
        at.append(condition.ends)
        at_end = np.full(len(condition.ends), scale * condition.length / AT_END)
        sizes.append(np.where(_singular(part, condition), np.minimum(at_end, at_corner), at_end))
    for points, wanted in (_alongside(part), *([more] if more else [])):
        at.append(points)
        sizes.append(wanted)
    points, wanted = np.concatenate(at), np.concatenate(sizes)
    size = ElementSize(scale * _largest(part))
    size.prescribe(points, wanted)
    for outline in part.outlines:
        follow_outline(size, outline, policy, part.body)
    edges = [_even_edges(line, size) for line in part.crack_lines]
    return (
        np.concatenate([points, *(middles for middles, _ in edges)]),
        np.concatenate([wanted, *(lengths for _, lengths in edges)]),
    )


def _singular(part: Part, condition: Condition) -> NDArray[np.bool_]:
    """Which ends (k,) of a stretch leave stresses singular: where it is held, but for rollers up to a corner."""
    ends = condition.ends
    if not any(condition.is_held):
        return np.zeros(len(ends), dtype=bool)
    if all(condition.is_held) or part.rim is not None:
        return np.ones(len(ends), dtype=bool)
    return np.linalg.norm(ends[:, None] - part.outer, axis=-1).min(axis=1) > part.tolerance


def _even_edges(line: Array, size: ElementSize) -> tuple[Array, Array]:
    """Middles (n, 2) and lengths (n,) of edges along a crack (k, 2), all its points among their ends, mm.

    The mesher cuts edges that are half as long again as their neighbours.
    """
    a, step = line[:-1], np.diff(line, axis=0)
    length = np.linalg.norm(step, axis=1)
    share = (np.arange(PLACES) + 0.5) / PLACES
    places = a[:, None] + share[:, None] * step[:, None]
    wanted = size(places.reshape(-1, 2)).reshape(places.shape[:2])
    count = np.ceil(length * (1 / wanted).mean(axis=1)).astype(int)
    while True:
        edge = length / count
        neighbour = np.minimum(np.append(edge[1:], np.inf), np.insert(edge[:-1], 0, np.inf))
        sudden = edge > APART * neighbour
        if not sudden.any():
            break
        count[sudden] += 1
    middles = [
        start + (np.arange(n)[:, None] + 0.5) / n * way for start, n, way in zip(a, count, step, strict=True)
    ]
    return np.concatenate(middles), np.repeat(edge, count)


def _alongside(part: Part) -> tuple[Array, Array]:
    """Points (n, 2) of cracks that run along a surface or another crack, and the sizes (n,) wanted there, mm."""
    at, sizes = [np.empty((0, 2))], [np.empty(0)]
    share = (np.arange(PLACES) + 0.5) / PLACES
    for number, crack in enumerate(part.cracks):
        others = [other.points for k, other in enumerate(part.cracks) if k != number]
        obstacle = shapely.union_all([part.body.boundary, *map(shapely.LineString, others)])
        a, step = crack.points[:-1], np.diff(crack.points, axis=0)
        points = (a[:, None] + share[:, None] * step[:, None]).reshape(-1, 2)
        length = np.linalg.norm(step, axis=1)
        way = (np.concatenate([[0.0], np.cumsum(length)[:-1]])[:, None] + share * length[:, None]).ravel()
        to_end = np.full(len(points), np.inf)
        if crack.start != TIP:
            to_end = way
        if crack.end != TIP:
            to_end = np.minimum(to_end, length.sum() - way)
        distance = shapely.distance(shapely.points(points), obstacle)
        near = distance < np.minimum(ALONGSIDE * to_end, ACROSS_GAP * _largest(part))
        near &= distance > part.tolerance  # where cracks cross there is no gap
        at.append(points[near])
        sizes.append(distance[near] / ACROSS_GAP)
    return np.concatenate(at), np.concatenate(sizes)
