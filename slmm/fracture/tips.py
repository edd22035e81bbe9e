"""Where cracks end in a mesh of plane elements: tips of slits whose two faces lie on each other.

A crack's face is a boundary edge that another one covers, run through the other way round. A tip is where such a pair
ends inside the material; where it ends on the boundary is the mouth. Nothing else of the crack needs to be known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from slmm.fem.boundary_edges import boundary_edges
from slmm.fem.neighbourhood import interface_nodes

#: nodes closer than this share of the shortest boundary edge lie on each other
COINCIDENT = 1e-4
#: faces are straight while their nodes are not farther off one line than this share of their distance from the tip, and
#: the round-off of files with six digits, as a share of the largest coordinate
STRAIGHT, ROUND_OFF = 1e-3, 2e-6


@dataclass(frozen=True)
class CrackTip:
    """The tip of a crack and the straight part of its faces.

    Parameters
    ----------
    position : ndarray (2,)
        mm.
    angle : float
        Of the direction in which the crack points, rad.
    nodes : ndarray (k,)
        Its nodes; several where elements are collapsed at the tip.
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
    points: np.ndarray, cells: Mapping[str, np.ndarray], region: Mapping[str, np.ndarray] | None = None
) -> list[CrackTip]:
    """All tips of slits in a plane mesh, in the order of their nodes' numbers.

    Parameters
    ----------
    points : ndarray (n, 2)
        Undeformed nodes, mm.
    cells : mapping of str to ndarray (el, k)
        Nodes of the elements of each type.
    region : mapping of str to ndarray (el,) of int, optional
        Materials; the interface between two of them is an end of what is clear around a tip.

    Raises
    ------
    ValueError
        For elements that are not plane.

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
    edges = boundary_edges(points, cells)
    place = _places(points, edges)
    pair = np.sort(place[edges[:, :2]], axis=1)
    _, of_pair, count = np.unique(pair, axis=0, return_inverse=True, return_counts=True)
    doubled = count[of_pair.ravel()] == 2
    faces, rest = edges[doubled], edges[~doubled]
    # each doubled place is met once from either side
    degree = np.bincount(place[faces[:, :2]].ravel(), minlength=len(points)) // 2
    ends = np.flatnonzero(degree == 1)
    tips = np.setdiff1d(ends, place[rest[:, :2]])
    obstacles = [points[rest[:, :2]]]
    if region is not None and len(between := interface_nodes(cells, region)):
        obstacles.append(np.repeat(points[between][:, None], 2, axis=1))
    return [_tip(points, place, faces, np.concatenate(obstacles), at) for at in tips]


def _places(points: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """For each node (n,) the first node that lies where it does; only boundary nodes are looked at."""
    nodes = np.unique(edges[:, :2])
    shortest = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1).min()
    close = cKDTree(points[nodes]).query_pairs(COINCIDENT * shortest, output_type="ndarray")
    graph = sp.coo_array((np.ones(len(close)), close.T), shape=(len(nodes), len(nodes)))
    _, group = connected_components(graph, directed=False)
    place = np.arange(len(points))
    place[nodes] = nodes[np.unique(group, return_index=True)[1][group]]
    return place


def _tip(
    points: np.ndarray, place: np.ndarray, faces: np.ndarray, obstacles: np.ndarray, at: int
) -> CrackTip:
    """Walk from a tip along its faces while they are straight."""
    start, end = place[faces[:, 0]], place[faces[:, 1]]
    upper: list[np.ndarray] = []
    lower: list[np.ndarray] = []
    here, before = at, -1
    back = np.empty((0, 2))
    used = np.zeros(len(faces), dtype=bool)
    round_off = ROUND_OFF * np.abs(points).max()
    while True:
        # the material is on the left of an edge: one that leaves the tip has it below the crack
        leaves = np.flatnonzero((start == here) & (end != before))
        arrives = np.flatnonzero((end == here) & (start != before))
        if len(leaves) != 1 or len(arrives) != 1:
            break
        there = end[leaves[0]]
        longer = np.vstack([back, points[there] - points[at]])
        if not _straight(longer, round_off):
            break
        back = longer
        lower.append(faces[leaves[0]])
        upper.append(faces[arrives[0]][[1, 0, 2]])
        used[[leaves[0], arrives[0]]] = True
        here, before = there, here
    # what ends the faces is an obstacle as everything else: the mouth, a kink, another tip
    last = np.repeat(points[[here]], 2, axis=0)[None]
    others = np.concatenate([obstacles, points[faces[~used][:, :2]], last])
    nearest = shapely.distance(shapely.linestrings(others), shapely.points(points[at])).min()
    keep = slice(None) if np.all(np.array(upper)[:, 2] >= 0) else slice(2)
    return CrackTip(
        points[at],
        float(np.arctan2(-back[-1, 1], -back[-1, 0]) + 0.0),
        np.unique([upper[0][0], lower[0][0]]),
        np.array(upper)[:, keep],
        np.array(lower)[:, keep],
        float(nearest),
    )


def _straight(back: np.ndarray, round_off: float) -> bool:
    """Whether places (k, 2) relative to the tip lie on the line to the last of them."""
    distance = np.linalg.norm(back, axis=1)
    off = np.abs(back[:, 0] * back[-1, 1] - back[:, 1] * back[-1, 0]) / distance[-1]
    return bool(np.all(off <= STRAIGHT * distance + round_off))
