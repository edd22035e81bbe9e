"""The outlines of a mesh of plane elements: smooth curves through the nodes of its free edges, and corners.

Nodes lie on the true surface, chords beside it; see `slmm.results.smooth_curve` for what lies between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.part.outline import Outline
from slmm.part.outline_splines import enclosed_area
from slmm.results.boundary_chain import BoundaryChain, boundary_chain
from slmm.results.field import DisplacementField
from slmm.results.plane_elements import PLANE_ELEMENTS
from slmm.results.smooth_curve import curve_through

Array = NDArray[np.float64]

#: a turn by more than this between two edges is a corner, rad: three elements around a quarter circle turn by less
#: (chosen); a smaller one is a corner where it is so many times that of both its neighbours, and more than the least:
#: a mesh on an arc turns evenly, and one on a line not at all (all chosen)
SHARP, LEAST, TIMES = np.radians(45.0), np.radians(8.0), 2.5
#: middle nodes that leave the chord by less than this share of what the turn asks for say nothing of the curve; chosen
STRAIGHT_SIDED = 0.1
#: a turn back by as much is the tip of a crack, rad; chosen
CRACK = np.radians(170.0)


class Ring(NamedTuple):
    """A closed chain of free edges, and the curve through it.

    Attributes
    ----------
    outline : Outline
        With the material on its right, as all outlines of parts.
    edges : ndarray (n, 3)
        Along it, the material on their left: nodes at start, end and middle, or else -1.
    corners : ndarray (n,) of bool
        At the start of which of these the outline has a corner.
    is_outer : bool
    """

    outline: Outline
    edges: NDArray[np.int64]
    corners: NDArray[np.bool_]
    is_outer: bool

    @property
    def nodes(self) -> NDArray[np.int64]:
        """All its nodes."""
        return np.unique(self.edges[self.edges >= 0])


def mesh_outlines(field: DisplacementField) -> list[Ring]:
    """The outlines of a model, the outer one last.

    Raises
    ------
    ValueError
        When the mesh is in several pieces, touches itself in a node, or has cracks.

    Examples
    --------
    >>> from slmm.results.results import read_displacements
    >>> hole, outer = mesh_outlines(read_displacements("tests/data/plate_2d.frd"))  # 20 x 20 mm, a hole of 2 mm
    >>> round(hole.outline.length / (4 * np.pi), 5), len(hole.outline.corners), round(outer.outline.length, 4)
    (1.0, 0, 80.0)
    """
    cells = {PLANE_ELEMENTS[kind].name: nodes for kind, nodes in field.cells.items()}
    chain = boundary_chain(field.points, cells)
    rings = [_ring(field.points, chain, edges) for edges in _closed_chains(chain)]
    outer = [ring for ring in rings if ring.is_outer]
    if len(outer) != 1:
        raise ValueError(
            f"the mesh has {len(outer)} outer edges: it must be of one part, in one piece that hangs together by more "
            "than a node"
        )
    return [*(ring for ring in rings if not ring.is_outer), *outer]


def _closed_chains(chain: BoundaryChain) -> list[NDArray[np.int64]]:
    """The edges of each closed chain, in order."""
    if (chain.after < 0).any():
        x, y = chain.edges[int(np.argmax(chain.after < 0)), :2]
        raise ValueError(
            f"the free edge from node {x} to node {y} has none behind it: the mesh is torn there"
        )
    left, chains = set(range(len(chain.edges))), []
    while left:
        edge = min(left)
        found = []
        while edge in left:
            left.remove(edge)
            found.append(edge)
            edge = int(chain.after[edge])
        chains.append(np.array(found))
    return chains


def _ring(points: Array, chain: BoundaryChain, edges: NDArray[np.int64]) -> Ring:
    back = np.abs(chain.turn[edges]) > CRACK
    if back.any():
        x, y = points[chain.edges[edges[int(back.argmax())], 1]]
        raise ValueError(
            f"the free edges turn back at ({x:.6g}, {y:.6g}) mm: the tip of a crack, whose growth `slmm forces` tells; "
            "give the model without cracks"
        )
    turn = np.roll(chain.turn[edges], 1)  # at the start of each edge
    start, middle = chain.edges[edges, 0], chain.edges[edges, 2]
    corner = _corners(np.abs(turn))
    curved = _curved(points, start, middle, turn)
    nodes = np.stack([start, np.where(curved, middle, -1)], axis=1).ravel()
    corners = np.stack([corner, np.zeros(len(start), bool)], axis=1).ravel()[nodes >= 0]
    at = points[nodes[nodes >= 0]]
    is_outer = enclosed_area(at) > 0
    outline = _outline(at, corners)
    return Ring(outline.reversed() if is_outer else outline, chain.edges[edges], corner, is_outer)


def _corners(turn: Array) -> NDArray[np.bool_]:
    """Which nodes are corners, by how much (n,) a closed chain turns at each, rad."""
    beside = np.maximum(np.roll(turn, 1), np.roll(turn, -1))
    return (turn > SHARP) | ((turn > LEAST) & (turn > TIMES * beside))


def _curved(
    points: Array, start: NDArray[np.int64], middle: NDArray[np.int64], turn: Array
) -> NDArray[np.bool_]:
    """Which edges have a node in the middle that tells how the surface runs."""
    end = np.roll(start, -1)
    chord = points[end] - points[start]
    length = np.hypot(*chord.T)
    off = points[middle] - 0.5 * (points[start] + points[end])
    beside = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / length
    # an arc whose chords turn by an angle has that angle between its ends, and a rise of an eighth of it
    rise = 0.125 * 0.5 * np.abs(turn + np.roll(turn, -1)) * length
    return (middle >= 0) & (beside > STRAIGHT_SIDED * rise) & (beside > 1e-6 * length)


def _outline(at: Array, corners: NDArray[np.bool_]) -> Outline:
    """The curve through points (n, 2) that go round once, with corners at some of them."""
    if not corners.any():
        return Outline.through(curve_through(at, closed=True))
    where = np.flatnonzero(corners)
    pieces = []
    for begin, end in zip(where, [*where[1:], len(at) + where[0]], strict=True):
        run = at[np.arange(begin, end + 1) % len(at)]
        if len(run) == 2 or _is_straight(run):
            pieces.append(run[[0, -1]])
        else:
            pieces.append(curve_through(run, closed=False))
    return Outline.of_pieces(pieces)


def _is_straight(run: Array) -> bool:
    """Whether points (n, 2) lie on the line from the first to the last one, to the digits of files."""
    chord = run[-1] - run[0]
    beside = np.abs(chord[0] * (run[:, 1] - run[0, 1]) - chord[1] * (run[:, 0] - run[0, 0])) / np.hypot(
        *chord
    )
    return bool(beside.max() < 1e-6 * np.abs(run).max() + 1e-9)
