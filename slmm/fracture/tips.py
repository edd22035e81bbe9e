"""Where cracks end in a mesh of plane elements: the boundary turns back there and both faces run on side by side.

The faces may lie on each other, as those of a slit, or stand a little apart: a modelled gap that ends in a node or in a
narrow blunt end, or the sides of a narrow notch. Where they end at the outer boundary is the mouth. Nothing else of the
crack needs to be known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from slmm.results.boundary_chain import BoundaryChain, boundary_chain
from slmm.results.neighbourhood import interface_nodes

#: faces are straight while their nodes are not farther off one line than this share of their distance from the tip
#: (chosen), and the round-off of files with six digits, as a share of the largest coordinate
STRAIGHT_FACES, SIX_DIGITS = 1e-3, 2e-6
#: of a crack that is found by itself (chosen): the angle by which its faces open, rad, and how far they stand apart as
#: a share of their length
NARROW, GAP = np.radians(2.0), 0.01
#: of a notch whose tip is given (chosen): up to this angle its exponent is a crack's within 0.002, rad
WIDE, WIDE_GAP = np.radians(30.0), 0.1
#: a blunt end is at most this share of its faces' length long, and has this many edges at most; both chosen
END, END_EDGES = 0.5, 100
#: the boundary turns by this angle at least where a blunt end begins, rad; chosen
BEGIN = np.radians(1.0)


@dataclass(frozen=True)
class CrackTip:
    """The tip of a crack and the straight part of its faces.

    Parameters
    ----------
    position : ndarray (2,)
        mm; of a blunt end its foremost place.
    angle : float
        Of the direction in which the crack points, rad.
    nodes : ndarray (k,)
        Its nodes; several where elements are collapsed at the tip, or of a blunt end.
    upper, lower : ndarray (e, 2 or 3)
        Nodes of the edges on both faces, outwards from the tip: start, end and, if there is, middle. Upper is left of
        the direction.
    clear : float
        Radius around the tip in which nothing else is than the material and these straight faces, mm.
    """

    position: np.ndarray
    angle: float
    nodes: np.ndarray
    upper: np.ndarray
    lower: np.ndarray
    clear: float

    @property
    def axes(self) -> np.ndarray:
        """Unit vectors (2, 2), as rows: along the crack's direction, and left of it."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])


def find_crack_tips(
    points: np.ndarray,
    cells: Mapping[str, np.ndarray],
    region: Mapping[str, np.ndarray] | None = None,
    given: Sequence[Sequence[float]] = (),
) -> list[CrackTip]:
    """All tips of cracks in a plane mesh, in the order of their nodes' numbers, and then those that are given.

    Parameters
    ----------
    points : ndarray (n, 2)
        Undeformed nodes, mm.
    cells : mapping of str to ndarray (el, k)
        Nodes of the elements of each type.
    region : mapping of str to ndarray (el,) of int, optional
        Materials; the interface between two of them is an end of what is clear around a tip.
    given : sequence of (x, y) or (x, y, angle), optional
        Places of tips that are not found, mm, as of a notch that opens by up to 30 degrees, and if wanted the direction
        in which they point, degrees from the x axis; by default the middle between the faces.

    Raises
    ------
    ValueError
        For elements that are not plane, and for a place where no crack or narrow notch ends.

    Examples
    --------
    A square of four quadrilaterals, cut from the left to its middle: nodes 3 and 9 lie on each other.

    >>> points = np.array([[x, y] for y in (-1, 0, 1) for x in (-1, 0, 1)] + [[-1, 0]], dtype=float)
    >>> cells = {"CPE4": np.array([[0, 1, 4, 3], [1, 2, 5, 4], [9, 4, 7, 6], [4, 5, 8, 7]])}
    >>> (tip,) = find_crack_tips(points, cells)
    >>> tip.position.tolist(), tip.angle, tip.upper.tolist(), tip.lower.tolist(), tip.clear
    ([0.0, 0.0], 0.0, [[4, 9]], [[4, 3]], 1.0)
    """
    points = np.asarray(points, dtype=float)
    chain = boundary_chain(points, cells)
    others = np.empty((0, 2, 2))
    if region is not None and len(between := interface_nodes(cells, region)):
        others = np.repeat(points[between][:, None], 2, axis=1)
    leaving = np.bincount(chain.place[chain.edges[:, 0]], minlength=len(points))
    tips: list[CrackTip] = []
    for last, first in _turning_back(points, chain):
        # where another part of the boundary meets it is no end inside the material
        if leaving[chain.place[chain.edges[first, 0]]] != 1:
            continue
        tip = _tip(points, chain, others, last, first, NARROW, GAP)
        if tip is None:
            continue
        # an end may be a node, or blunt with the edges next to it: that of which more is clear
        same = [k for k, other in enumerate(tips) if np.isin(other.nodes, tip.nodes).any()]
        if all(tip.clear > tips[k].clear for k in same):
            tips = [other for k, other in enumerate(tips) if k not in same] + [tip]
    tips.sort(key=lambda tip: int(chain.place[tip.nodes].min()))
    for place in given:
        here = _given_tip(points, chain, others, place)
        same = [k for k, tip in enumerate(tips) if np.isin(here.nodes, tip.nodes).any()]
        tips = [tip for k, tip in enumerate(tips) if k not in same] + [here]
    return tips


def _turning_back(points: np.ndarray, chain: BoundaryChain) -> Iterator[tuple[int, int]]:
    """Pairs of edges, the last one before an end of a crack and the first one after it."""
    length = chain.length
    for last in np.flatnonzero((chain.turn < -BEGIN) & (chain.after >= 0)):
        turned, between = chain.turn[last], 0.0
        first, longest = int(chain.after[last]), None
        for _ in range(END_EDGES):
            if turned < -(np.pi + NARROW):
                break
            if turned <= -(np.pi - NARROW):
                yield int(last), first
            if longest is None:
                # where the boundary bends behind the last edge, too, as around a hole, that edge is all
                bends = abs(chain.turn[chain.before[last]]) > BEGIN
                run = [last] if bends else _face(points, chain, int(last), chain.before, 0.0)
                longest = END * length[run].sum()
            between += length[first]
            if between > longest or chain.after[first] < 0:
                break
            turned += chain.turn[first]
            first = int(chain.after[first])


def _given_tip(
    points: np.ndarray, chain: BoundaryChain, others: np.ndarray, place: Sequence[float]
) -> CrackTip:
    """The tip at a place, its end as short as it can be."""
    at, length = np.asarray(place[:2], dtype=float), chain.length
    distance = np.linalg.norm(points[chain.edges[:, 1]] - at, axis=1)
    nearest = np.flatnonzero(distance <= distance.min() * (1 + 1e-9) + SIX_DIGITS * np.abs(points).max())
    x, y = points[chain.edges[nearest[0], 1]]
    if distance.min() > length[nearest].max() / 2:
        raise ValueError(
            f"tip = ({at[0]:g}, {at[1]:g}) mm: no boundary is there; its nearest node is at ({x:g}, {y:g}) mm"
        )
    for last in nearest[np.argsort(chain.turn[nearest])]:
        first, back, ahead = int(chain.after[last]), 0.0, 0.0
        for _ in range(END_EDGES):
            if min(last, first) < 0:
                break
            tip = _tip(points, chain, others, int(last), first, WIDE, WIDE_GAP)
            if tip is not None:
                return replace(tip, angle=float(np.radians(place[2]))) if len(place) > 2 else tip
            if back < ahead:
                back, last = back + length[last], chain.before[last]
            else:
                ahead, first = ahead + length[first], int(chain.after[first])
    raise ValueError(
        f"tip = ({at[0]:g}, {at[1]:g}) mm: the boundary at ({x:g}, {y:g}) mm does not turn back between two straight "
        f"faces that open by {np.degrees(WIDE):g} degrees at most; the tip of a half model needs its line of symmetry"
    )


def _tip(
    points: np.ndarray,
    chain: BoundaryChain,
    others: np.ndarray,
    last: int,
    first: int,
    widest: float,
    farthest: float,
) -> CrackTip | None:
    """The tip between two edges, or None when the faces that begin there are too short, or open too much."""
    a, b = chain.along[last], chain.along[first]
    open_here = abs(np.arctan2(a[0] * -b[1] + a[1] * b[0], -(a @ b)))
    if open_here > widest:
        return None
    # a gap may be closed by a wedge of the first edges: how far these stand off a face's line
    off = min(open_here, NARROW) * min(chain.length[last], chain.length[first])
    upper = _face(points, chain, last, chain.before, off)
    lower = _face(points, chain, first, chain.after, off)
    ends = points[chain.edges[last, 1]], points[chain.edges[first, 0]]
    outer = points[chain.edges[upper[-1], 0]], points[chain.edges[lower[-1], 1]]
    faces = np.array([outer[0] - ends[0], outer[1] - ends[1]])
    lengths = np.linalg.norm(faces, axis=1)
    unit = np.array(
        [
            -_direction(points[chain.edges[upper, :2]], off),
            _direction(points[chain.edges[lower, :2]], off),
        ]
    )
    blunt = []
    k = int(chain.after[last])
    while k != first and k >= 0:
        blunt.append(k)
        k = int(chain.after[k])
    opening = np.arctan2(unit[1, 0] * -unit[0, 1] + unit[1, 1] * unit[0, 0], unit[0] @ unit[1])
    apart = np.linalg.norm(ends[1] - ends[0])
    if (
        abs(opening) > widest
        or apart > farthest * lengths.min()
        or chain.length[blunt].sum() > END * lengths.min()
    ):
        return None
    direction = -unit.sum(axis=0) / np.linalg.norm(unit.sum(axis=0))
    nodes = np.unique(
        np.concatenate([chain.edges[[last], 1], chain.edges[[first], 0], chain.edges[blunt, 0]])
    )
    middle = (ends[0] + ends[1]) / 2
    position = points[nodes[0]] if not blunt else middle
    position = position + direction * (((points[nodes] - middle) @ direction).max() if blunt else 0.0)
    # what ends the faces is an obstacle as everything else: the mouth, a kink, another tip
    rest = np.ones(len(chain.edges), dtype=bool)
    rest[[*upper, *lower, *blunt]] = False
    obstacles = [others, points[chain.edges[rest, :2]], np.repeat(np.array(outer)[:, None], 2, axis=1)]
    clear = shapely.distance(shapely.linestrings(np.concatenate(obstacles)), shapely.points(position)).min()
    keep = slice(None) if np.all(chain.edges[[*upper, *lower], 2] >= 0) else slice(2)
    return CrackTip(
        position,
        float(np.arctan2(direction[1], direction[0]) + 0.0),
        nodes,
        chain.edges[upper][:, [1, 0, 2]][:, keep],
        chain.edges[lower][:, keep],
        float(clear),
    )


def _direction(edges: np.ndarray, off: float) -> np.ndarray:
    """Unit vector along edges (k, 2, 2) of a face, most of which lie on a line.

    Its last ones may lie behind a kink: a line to its end would be off by as much as faces may bend.
    """
    steps = edges[:, 1] - edges[:, 0]
    length = np.linalg.norm(steps, axis=1)
    z = steps @ [1, 1j]
    turn = np.angle(z / z.sum())
    order = np.argsort(turn)
    most = turn[order][np.searchsorted(np.cumsum(length[order]), 0.5 * length.sum())]
    allowed = STRAIGHT_FACES + (off + SIX_DIGITS * np.abs(edges).max()) / length
    along = steps[np.abs(turn - most) <= allowed].sum(axis=0)
    return np.asarray(along / np.linalg.norm(along))


def _face(
    points: np.ndarray, chain: BoundaryChain, edge: int, following: np.ndarray, off: float
) -> list[int]:
    """Edges from a tip outwards while they are straight, but for a distance off their line."""
    inner, outer = (1, 0) if following is chain.before else (0, 1)
    start = points[chain.edges[edge, inner]]
    allowed = off + SIX_DIGITS * np.abs(points).max()
    found = [edge]
    back = (points[chain.edges[edge, outer]] - start)[None]
    while (following_one := int(following[found[-1]])) >= 0 and following_one != edge:
        longer = np.vstack([back, points[chain.edges[following_one, outer]] - start])
        distance = np.linalg.norm(longer, axis=1)
        step = longer[-1] - longer[-2]
        # within 60 degrees of the line, and so never back
        if step @ longer[-1] < np.linalg.norm(step) * distance[-1] / 2 or distance[-1] <= distance[-2]:
            break
        aside = np.abs(longer[:, 0] * longer[-1, 1] - longer[:, 1] * longer[-1, 0]) / distance[-1]
        if np.any(aside > STRAIGHT_FACES * distance + allowed):
            break
        found.append(following_one)
        back = longer
    return found
