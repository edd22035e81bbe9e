"""A step with displacements of any file but CalculiX's: which reader takes the file, and what is joined in its mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slmm.results.displacement_names import find_displacements
from slmm.results.file_mesh import FileMesh, side_by_side
from slmm.results.joined_nodes import first_of_equal, joined, mean_of_joined

#: files that are read here; meshio reads others by their name's end
_EXODUS = (".e", ".exo", ".exii", ".ex2", ".g")

#: files whose name is not enough: what they are, and what to give in their place
_NOT_READ = {
    ".vtp": "polygons of surfaces: an unstructured grid (.vtu) is needed",
    ".pvtp": "polygons of surfaces: an unstructured grid (.vtu) is needed",
    ".vti": "an image: an unstructured grid (.vtu) is needed",
    ".vtr": "a rectilinear grid: an unstructured grid (.vtu) is needed",
    ".vts": "a structured grid: an unstructured grid (.vtu) is needed",
    ".vtm": "an index of several data sets: one of them (.vtu) is needed",
    ".vtkhdf": "VTK's HDF5, which is not read: the same as .vtu is needed",
    ".odb": "Abaqus' database, which only Abaqus reads: export it, as .vtu for instance",
}


@dataclass(frozen=True)
class MeshStep:
    """A step of a file: its mesh, of which parts hang together, with the data of all steps; and its displacements.

    Parameters
    ----------
    mesh : FileMesh
    u : ndarray (n, 2 or 3)
        mm.
    number : int
        Of the step in the names of the data, -1 when the mesh has this step alone.
    """

    mesh: FileMesh
    u: np.ndarray
    number: int


def mesh_displacements(path: Path, step: int, field: str | None = None) -> MeshStep:
    """A step with displacements of any file but a .frd.

    Raises
    ------
    OSError, ValueError
        See `slmm.results.results.read_displacements`.
    """
    mesh, alone = _read_mesh(path, lambda count: chosen_step(path, step, count))
    try:
        _, steps = find_displacements(mesh.point_data, mesh.components, field)
        number = sorted(steps)[chosen_step(path, -1 if alone else step, len(steps))]
        cells, node = joined(mesh.points, mesh.cells, steps[number])
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    data, cell_data = mesh.point_data, mesh.cell_data
    if (node != np.arange(len(node))).any():
        data = {
            name: mean_of_joined(values, node) if values.dtype.kind == "f" else values
            for name, values in data.items()
        }
        # pieces overlap where ghosts are not marked
        once = {kind: first_of_equal(nodes) for kind, nodes in cells.items()}
        cells = {kind: nodes[once[kind]] for kind, nodes in cells.items()}
        cell_data = {
            name: {kind: values[once[kind]] for kind, values in own.items()}
            for name, own in cell_data.items()
        }
    return MeshStep(FileMesh(mesh.points, cells, data, cell_data), steps[number], number)


def _read_mesh(path: Path, chosen: Callable[[int], int]) -> tuple[FileMesh, bool]:
    """The mesh of a file, and whether its data are of the chosen time alone."""
    # readers are imported where they are needed: each brings a library
    suffix = path.suffix.lower()
    if suffix in _NOT_READ:
        raise ValueError(f"{path}: holds {_NOT_READ[suffix]}")
    if suffix in (".vtu", ".pvtu"):
        return _read_vtk(path), False
    if suffix == ".pvd":
        from slmm.results.vtk_index import files_of_steps

        steps = files_of_steps(path)
        return side_by_side([_read_vtk(file) for file in steps[chosen(len(steps))]]), True
    # MOOSE numbers its files with other meshes: name.e-s002
    if suffix.split("-")[0] in _EXODUS:
        from slmm.results.exodus import read_exodus

        return read_exodus(path, chosen), True
    if suffix == ".vtk":
        from slmm.results.vtk_legacy import dataset_of, read_legacy

        # meshio makes elements of images and structured grids
        if dataset_of(path) == "UNSTRUCTURED_GRID":
            return read_legacy(path), False
    from slmm.results.meshio_file import read_with_meshio

    return read_with_meshio(path, chosen)


def _read_vtk(path: Path) -> FileMesh:
    if path.suffix.lower() == ".pvtu":
        from slmm.results.vtk_index import read_pvtu

        return read_pvtu(path)
    from slmm.results.vtk_xml import read_vtu

    return read_vtu(path)


def chosen_step(path: Path, step: int, count: int) -> int:
    """The step, when there are so many that it is one of them.

    Raises
    ------
    ValueError
        Else.
    """
    if not -count <= step < count:
        raise ValueError(f"{path}: step = {step}: steps with displacements: {count}, counted from 0")
    return step
