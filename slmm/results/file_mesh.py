"""A mesh as a file holds it: nodes, plane and solid elements, and data on both, checked to belong together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class FileMesh:
    """Nodes, elements by kind, and data at one time or at several.

    Parameters
    ----------
    points : ndarray (n, 2 or 3)
        mm.
    cells : mapping of str to ndarray (m, k)
        Nodes of the elements of each kind, in the order of `slmm.mechanics.element_types`.
    point_data : mapping of str to ndarray (n,) or (n, c)
        By the names in the file.
    cell_data : mapping of str to mapping of str to ndarray (m,) or (m, c)
        By the names in the file, then by kind of element; a kind may be missing.
    components : mapping of str to sequence of str
        What the file calls the components of point data, where it does.
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    point_data: Mapping[str, np.ndarray]
    cell_data: Mapping[str, Mapping[str, np.ndarray]]
    components: Mapping[str, Sequence[str]] = field(default_factory=dict)


def checked(path: Path, mesh: FileMesh) -> FileMesh:
    """The mesh, when its elements name nodes that there are and its data are of all nodes and elements.

    Raises
    ------
    ValueError
        Else, with the file, the array and the value.
    """
    if mesh.points.ndim != 2 or mesh.points.shape[1] not in (2, 3):
        raise ValueError(f"{path}: points have the shape {mesh.points.shape}: two or three coordinates each")
    n = len(mesh.points)
    for kind, nodes in mesh.cells.items():
        if nodes.ndim != 2:
            raise ValueError(f"{path}: {kind} has the shape {nodes.shape}: must be (elements, nodes)")
        wrong = np.argwhere((nodes < 0) | (nodes >= n))
        if len(wrong):
            i, j = wrong[0]
            raise ValueError(
                f"{path}: {kind} {i} names node {nodes[i, j]}: nodes are numbered from 0 to {n - 1}"
            )
    for name, values in mesh.point_data.items():
        if len(values) != n:
            raise ValueError(f"{path}: {name} has {len(values)} values: there are {n} nodes")
    for name, by_kind in mesh.cell_data.items():
        for kind, values in by_kind.items():
            if len(values) != len(mesh.cells[kind]):
                raise ValueError(
                    f"{path}: {name} has {len(values)} values of {kind}: there are {len(mesh.cells[kind])}"
                )
    return mesh


def side_by_side(pieces: Sequence[FileMesh]) -> FileMesh:
    """Pieces of one mesh as one, each with nodes of its own; data that some of them lack are left out."""
    filled = [piece for piece in pieces if len(piece.points)]
    if len(filled) == 1:
        return filled[0]
    if not filled:
        return pieces[0]
    first = np.cumsum([0, *(len(piece.points) for piece in filled)])
    kinds = list(dict.fromkeys(kind for piece in filled for kind in piece.cells))
    cells = {
        kind: np.concatenate(
            [
                piece.cells[kind] + start
                for piece, start in zip(filled, first, strict=False)
                if kind in piece.cells
            ]
        )
        for kind in kinds
    }
    point_data = {
        name: np.concatenate([piece.point_data[name] for piece in filled])
        for name, values in filled[0].point_data.items()
        if all(
            name in piece.point_data and piece.point_data[name].shape[1:] == values.shape[1:]
            for piece in filled
        )
    }
    cell_data: dict[str, dict[str, np.ndarray]] = {}
    for name in filled[0].cell_data:
        if all(name in piece.cell_data for piece in filled):
            parts = {
                kind: [piece.cell_data[name][kind] for piece in filled if kind in piece.cells]
                for kind in kinds
            }
            if all(len({part.shape[1:] for part in own}) == 1 for own in parts.values()):
                cell_data[name] = {kind: np.concatenate(own) for kind, own in parts.items()}
    return FileMesh(
        np.concatenate([piece.points for piece in filled]), cells, point_data, cell_data, filled[0].components
    )
