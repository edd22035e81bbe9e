"""Cells of VTK as elements by kind, with nodes in the order of the kind.

Numbers of types and orders of nodes are those of vtkCellType.h and of the cells' own documentation. Lagrange cells of
first and second order have the nodes of the usual elements in the usual order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

#: types that carry nothing in a plane or solid model: points and lines
THIN = {0, 1, 2, 3, 4, 21, 35, 68}

#: elements by type and number of nodes; of Lagrange cells, 8 nodes of a quadrilateral and 20 of a brick are
#: serendipity elements, as dolfinx writes them
KINDS = {
    (5, 3): "triangle",
    (7, 3): "triangle",
    (7, 4): "quad",
    (8, 4): "quad",
    (9, 4): "quad",
    (10, 4): "tetra",
    (11, 8): "hexahedron",
    (12, 8): "hexahedron",
    (13, 6): "wedge",
    (22, 6): "triangle6",
    (23, 8): "quad8",
    (24, 10): "tetra10",
    (25, 20): "hexahedron20",
    (26, 15): "wedge15",
    (28, 9): "quad9",
    (29, 27): "hexahedron27",
    (32, 18): "wedge18",
    (69, 3): "triangle",
    (69, 6): "triangle6",
    (70, 4): "quad",
    (70, 8): "quad8",
    (70, 9): "quad9",
    (71, 4): "tetra",
    (71, 10): "tetra10",
    (72, 8): "hexahedron",
    (72, 20): "hexahedron20",
    (72, 27): "hexahedron27",
    (73, 6): "wedge",
    (73, 15): "wedge15",
    (73, 18): "wedge18",
}

#: orders of nodes that differ: the sides of pixels and voxels run the same way, those of others around
ORDERS = {8: [0, 1, 3, 2], 11: [0, 1, 3, 2, 4, 5, 7, 6]}

#: Lagrange bricks of the second order had these edges the other way before version 2.1 of XML, 5.1 of legacy files
FORMER = {(72, 27): [*range(18), 19, 18, *range(20, 27)]}

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
        (kind, count)
        for kind in np.unique(types).tolist()
        for count in np.unique(counts[types == kind]).tolist()
    ]
    for kind, count in pairs:
        if kind in THIN:
            continue
        number = np.flatnonzero((types == kind) & (counts == count))
        if (kind, count) not in KINDS:
            raise ValueError(
                f"cell {number[0]} is a {NAMES.get(kind, 'cell')} (VTK's type {kind}) of {count} nodes: known are "
                f"{', '.join(sorted(set(KINDS.values())))}"
            )
        if degrees is not None and kind in LAGRANGE:
            _check_degrees(kind, count, degrees[number], int(number[0]))
        nodes = connectivity[start[number][:, None] + np.arange(count)]
        order = ORDERS.get(kind) or (FORMER.get((kind, count)) if former else None)
        nodes = nodes if order is None else nodes[:, order]
        found.setdefault(KINDS[kind, count], []).append(Cells(nodes, number))
    return {
        name: Cells(
            np.concatenate([own.nodes for own in cells]), np.concatenate([own.number for own in cells])
        )
        for name, cells in found.items()
    }


def _check_degrees(kind: int, count: int, degrees: np.ndarray, first: int) -> None:
    """Refuse cells that have as many nodes as one of the second order, but as other rows."""
    directions = 2 if kind in (69, 70) else 3
    degrees = degrees[:, :directions]
    if (degrees != degrees[:, :1]).any():
        raise ValueError(
            f"cell {first}, or one like it, is a {NAMES[kind]} of {count} nodes with another degree in each "
            "direction: the first or the second in all is needed"
        )
