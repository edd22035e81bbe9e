"""Configurational forces as a picture: a .vtu file, as ParaView and meshio read it.

The file is written here and not by meshio, which does not take wedges of 15 nodes. Its form is that of "VTK File
Formats", XML unstructured grid, with the data as base64 in place.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named, type_named


def write_vtu(path: str | Path, results: ElementResults, forces: ArrayLike) -> None:
    """Write elements, displacements and configurational forces as a .vtu file.

    Data of the nodes are ``displacement``, mm, and ``configurational_force``, N, three components each; data of the
    elements are ``region`` and ``energy``, the mean energy density of each, MPa.

    Parameters
    ----------
    path : path
    results : ElementResults
    forces : array_like (n, d)
        Configurational forces on the nodes.

    Raises
    ------
    OSError
        When the file cannot be written.
    ValueError
        When the forces are not those of the nodes.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from slmm.fracture.configurational_forces import nodal_configurational_forces
    >>> from slmm.results.read_results import read_element_results
    >>> r = read_element_results("tests/data/bar_3d.frd")
    >>> forces = nodal_configurational_forces(r.points, r.cells, r.u, r.stress, r.energy, r.method)
    >>> with TemporaryDirectory() as folder:
    ...     write_vtu(Path(folder, "bar.vtu"), r, forces)
    ...     Path(folder, "bar.vtu").read_text()[39:75]
    '<VTKFile type="UnstructuredGrid" ver'
    """
    forces = np.asarray(forces, dtype=float)
    if forces.shape != results.points.shape:
        raise ValueError(f"forces have the shape {forces.shape}: there are nodes {results.points.shape}")
    nodes, types = [], []
    for name, own in results.cells.items():
        own, cell = np.asarray(own), type_named(name).vtk[0]
        nodes.append(own if cell.order is None else own[:, np.argsort(cell.order)])
        types.append(np.full(len(own), cell.number, dtype=np.uint8))
    counts = np.concatenate([np.full(len(own), own.shape[1]) for own in nodes])
    file = ElementTree.Element(
        "VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    grid = ElementTree.SubElement(file, "UnstructuredGrid")
    piece = ElementTree.SubElement(
        grid, "Piece", NumberOfPoints=str(len(results.points)), NumberOfCells=str(len(counts))
    )
    sections: Mapping[str, Mapping[str, np.ndarray]] = {
        "Points": {"Points": _in_space(results.points)},
        "Cells": {
            "connectivity": np.concatenate([own.ravel() for own in nodes]).astype(np.int64),
            "offsets": np.cumsum(counts, dtype=np.int64),
            "types": np.concatenate(types),
        },
        "PointData": {
            "displacement": _in_space(results.u),
            "configurational_force": _in_space(forces),
        },
        "CellData": {
            "region": np.concatenate([np.asarray(results.region[name]) for name in results.cells]).astype(
                np.int64
            ),
            "energy": np.concatenate([_mean_energy(results, name) for name in results.cells]),
        },
    }
    for section, arrays in sections.items():
        parent = ElementTree.SubElement(piece, section)
        for name, values in arrays.items():
            _data_array(parent, name, values)
    ElementTree.ElementTree(file).write(path, encoding="utf-8", xml_declaration=True)


def _data_array(parent: ElementTree.Element, name: str, values: np.ndarray) -> None:
    """An array, as its length in bytes and the bytes."""
    kind = {"f": "Float64", "i": "Int64", "u": "UInt8"}[values.dtype.kind]
    array = ElementTree.SubElement(parent, "DataArray", type=kind, Name=name, format="binary")
    if values.ndim == 2:
        array.set("NumberOfComponents", str(values.shape[1]))
    data = values.astype(values.dtype.newbyteorder("<")).tobytes()
    array.text = base64.b64encode(np.array(len(data), dtype="<u8").tobytes() + data).decode()


def _in_space(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) from (n, 2) or (n, 3)."""
    return np.pad(np.asarray(vectors, dtype=float), ((0, 0), (0, 3 - vectors.shape[1])))


def _mean_energy(results: ElementResults, name: str) -> np.ndarray:
    """Energy densities (el,) of one type, weighted with the volumes of the integration points."""
    element = element_named(name)
    X = results.points[results.cells[name]]
    volume = element.weights * np.linalg.det(
        np.einsum("eni,qnj->eqij", X, element.gradient_at_points, optimize=True)
    )
    return (volume * results.energy[name]).sum(axis=1) / volume.sum(axis=1)
