"""Cells of VTK as elements by kind, with nodes in the order of the kind.

Which types are elements of ours stands in `slmm.mechanics.element_types`; here, what VTK has besides. Lagrange cells of
first and second order have the nodes of the usual elements in the usual order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slmm.mechanics.element_types import ELEMENT_TYPES

#: types that carry nothing in a plane or solid model: points and lines
THIN = {0, 1, 2, 3, 4, 21, 35, 68}

#: kinds of elements and the order of their nodes, by type and number of nodes
CELLS = {
    (cell.number, known.count): (known.kind, cell) for known in ELEMENT_TYPES.values() for cell in known.vtk
}

#: names of types that are not read
NAMES = {
    6: "triangle strip",
    7: "polygon",
    14: "pyramid",
    15: "pentagonal prism",
    16: "hexagonal prism",
    27: "quadratic pyramid",
    30: "quadratic linear quadrilateral",
    31: "quadratic linear wedge",
    33: "biquadratic quadratic hexahedron",
    34: "biquadratic triangle",
    36: "quadratic polygon",
    37: "triquadratic pyramid",
    41: "convex point set",
    42: "polyhedron",
    69: "Lagrange triangle",
    70: "Lagrange quadrilateral",
    71: "Lagrange tetrahedron",
    72: "Lagrange hexahedron",
    73: "Lagrange wedge",
    74: "Lagrange pyramid",
    75: "Bezier curve",
    76: "Bezier triangle",
    77: "Bezier quadrilateral",
    78: "Bezier tetrahedron",
    79: "Bezier hexahedron",
    80: "Bezier wedge",
    81: "Bezier pyramid",
}

#: types whose order may differ by direction
LAGRANGE = (69, 70, 71, 72, 73)


class Cells(NamedTuple):
    """Elements of one kind, and which of the file's cells they are."""

    nodes: np.ndarray  # (m, k)
    number: np.ndarray  # (m,)


def check_nodes(connectivity: np.ndarray, offsets: np.ndarray, n_points: int) -> None:
    """Refuse cells that name nodes that are not there.

    Raises
    ------
    ValueError
        With the first such cell and its node.
    """
    wrong = np.flatnonzero((connectivity < 0) | (connectivity >= n_points))
    if len(wrong):
        raise ValueError(
            f"the array connectivity: cell {np.searchsorted(offsets, wrong[0], side='right')} names node "
            f"{connectivity[wrong[0]]}: nodes are numbered from 0 to {n_points - 1}"
        )


def check_offsets(offsets: np.ndarray) -> None:
    """Refuse ends of cells that do not ascend.

    Raises
    ------
    ValueError
        With the first cell of which this is so.
    """
    counts = np.diff(offsets, prepend=0)
    wrong = np.flatnonzero(counts < 0)
    if len(wrong):
        i = int(wrong[0])
        raise ValueError(f"the array offsets: cell {i} ends at {offsets[i]}, before it begins: must ascend")


def cells_by_kind(
    connectivity: np.ndarray,
    offsets: np.ndarray,
    types: np.ndarray,
    degrees: np.ndarray | None = None,
    former: bool = False,
) -> dict[str, Cells]:
    """Elements by kind; points and lines are left out.

    Parameters
    ----------
    connectivity : ndarray (k,) of int
        Nodes of all cells.
    offsets : ndarray (m,) of int
        Where each cell ends, ascending up to k.
    types : ndarray (m,) of int
    degrees : ndarray (m, 3), optional
        Of Lagrange cells, by direction.
    former : bool
        The file is of a version with the former order of nodes.

    Raises
    ------
    ValueError
        For a cell of a type, or with a number of nodes, that is not read.

    Examples
    --------
    A pixel, whose rows of nodes run the same way.

    >>> cells_by_kind(np.array([0, 1, 2, 3]), np.array([4]), np.array([8]))["quad"].nodes.tolist()
    [[0, 1, 3, 2]]
    """
    counts = np.diff(offsets, prepend=0)
    start = offsets - counts
    found: dict[str, list[Cells]] = {}
    pairs = [
        (own, count)
        for own in np.unique(types).tolist()
        for count in np.unique(counts[types == own]).tolist()
    ]
    for own, count in pairs:
        if own in THIN:
            continue
        number = np.flatnonzero((types == own) & (counts == count))
        if (own, count) not in CELLS:
            raise ValueError(
                f"cell {number[0]} is a {NAMES.get(own, 'cell')} (VTK's type {own}) of {count} nodes: known are "
                f"{', '.join(sorted({kind for kind, _ in CELLS.values()}))}"
            )
        if degrees is not None and own in LAGRANGE:
            _check_degrees(own, count, degrees[number], int(number[0]))
        kind, cell = CELLS[own, count]
        nodes = connectivity[start[number][:, None] + np.arange(count)]
        order = (former and cell.former) or cell.order
        found.setdefault(kind, []).append(Cells(nodes if order is None else nodes[:, order], number))
    return {
        kind: Cells(
            np.concatenate([part.nodes for part in parts]), np.concatenate([part.number for part in parts])
        )
        for kind, parts in found.items()
    }


def _check_degrees(own: int, count: int, degrees: np.ndarray, first: int) -> None:
    """Refuse cells that have as many nodes as one of the second order, but as other rows."""
    directions = 2 if own in (69, 70) else 3
    degrees = degrees[:, :directions]
    if (degrees != degrees[:, :1]).any():
        raise ValueError(
            f"cell {first}, or one like it, is a {NAMES[own]} of {count} nodes with another degree in each "
            "direction: the first or the second in all is needed"
        )
