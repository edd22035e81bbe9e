"""Meshes and nodal data of one time from Exodus II files, which MOOSE, Sierra and Cubit write.

The form is that of "EXODUS II: A Finite Element Data Model" (SAND92-2137), appendix A: netCDF with agreed names. It is
read here and not by meshio 5.3, which takes the first time, where nothing has moved yet, and the nodes of quadratic
bricks in an order that is not theirs.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.results.file_mesh import FileMesh, checked
from slmm.results.netcdf_header import check_netcdf

#: kinds of elements, and where in the file their nodes stand, by what their names begin with and the number of nodes
NAMED = {
    (beginning, known.count): (known.kind, known.exodus.order)
    for known in ELEMENT_TYPES.values()
    if known.exodus is not None
    for beginning in known.exodus.beginnings
}

#: types that carry nothing in a plane or solid model
THIN = ("SPHERE", "CIRCLE", "NODE", "BEAM", "BAR", "EDGE", "TRUSS", "ROD", "NULL")

#: by how much compression in a netCDF-4 file may shrink an array: DEFLATE's limit; published
LARGEST_RATIO = 1032


def read_exodus(path: Path, chosen: Callable[[int], int]) -> FileMesh:
    """The mesh of an Exodus file, and its data of one time.

    Parameters
    ----------
    path : path
    chosen : callable
        The number of the time, from 0, by how many there are.

    Raises
    ------
    OSError, ValueError
        When the file cannot be read, is damaged, or has elements that are not known.
    """
    try:
        check_netcdf(path)
    except ValueError as error:
        raise ValueError(f"{path}: cannot be read as Exodus: {error}") from error
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            return checked(path, _mesh(file, path.stat().st_size, chosen))
    except ValueError as error:
        raise ValueError(f"{path}: {str(error).removeprefix(f'{path}: ')}") from error
    # what netCDF4 raises at a damaged file, and numpy at arrays of other shapes
    except (OSError, RuntimeError, LookupError, AttributeError, TypeError, MemoryError) as error:
        raise ValueError(f"{path}: cannot be read as Exodus: {error}") from error


def _mesh(file: netCDF4.Dataset, size: int, chosen: Callable[[int], int]) -> FileMesh:
    if "num_nodes" not in file.dimensions:
        raise ValueError("cannot be read as Exodus: it has no dimension num_nodes")
    _check_sizes(file, size)
    blocks = {name: file[name] for name in file.variables if re.fullmatch(r"connect\d+", name)}
    step = chosen(file.dimensions["time_step"].size) if "time_step" in file.dimensions else chosen(0)
    cells: dict[str, list[np.ndarray]] = {}
    numbers: dict[str, list[int]] = {}
    for name, block in sorted(blocks.items(), key=lambda item: int(item[0][7:])):
        found = _type(name, str(block.elem_type), block.shape[-1])
        if found is not None:
            kind, order = found
            nodes = block[:].astype(np.int64) - 1
            cells.setdefault(kind, []).append(nodes if order is None else nodes[:, order])
            numbers.setdefault(kind, []).append(int(name[7:]))
    return FileMesh(
        _points(file),
        {kind: np.concatenate(parts) for kind, parts in cells.items()},
        _point_data(file, step),
        _cell_data(file, step, numbers),
    )


def _type(name: str, called: str, count: int) -> tuple[str, tuple[int, ...] | None] | None:
    """The kind of the elements of a block and where their nodes stand, None for points and lines."""
    upper = called.strip("\0 ").upper()
    if upper.startswith(THIN):
        return None
    for (beginning, nodes), found in NAMED.items():
        # TRISHELL is a plane element like TRI
        if upper.startswith(beginning) and nodes == count:
            return found
    raise ValueError(
        f"{name} has elements of type {called[:20]!r} with {count} nodes: known are "
        f"{', '.join(dict.fromkeys(kind for kind, _ in NAMED.values()))}"
    )


def _points(file: netCDF4.Dataset) -> np.ndarray:
    if "coord" in file.variables:
        points = np.asarray(file["coord"][:], dtype=float).T
    else:
        axes = [axis for axis in "xyz" if axis in "xy" or f"coord{axis}" in file.variables]
        points = np.stack([np.asarray(file[f"coord{axis}"][:], dtype=float) for axis in axes], axis=1)
    return points


def _check_sizes(file: netCDF4.Dataset, size: int) -> None:
    """Refuse arrays that a damaged header makes larger than the file can hold."""
    for name, variable in file.variables.items():
        if math.prod(variable.shape) * np.dtype(variable.dtype).itemsize > max(LARGEST_RATIO * size, 2**20):
            raise ValueError(f"{name} has the shape {variable.shape}, more than the file can hold")


def _names(file: netCDF4.Dataset, variable: str) -> list[str]:
    """Names, each a row of letters."""
    if variable not in file.variables:
        return []
    return [
        b"".join(row).split(b"\0")[0].decode("utf-8", "replace").strip() for row in file[variable][:].tolist()
    ]


def _point_data(file: netCDF4.Dataset, step: int) -> dict[str, np.ndarray]:
    found = {}
    for k, name in enumerate(_names(file, "name_nod_var")):
        if f"vals_nod_var{k + 1}" in file.variables:
            found[name] = np.asarray(file[f"vals_nod_var{k + 1}"][step], dtype=float)
        elif "vals_nod_var" in file.variables:  # all in one, in old files
            found[name] = np.asarray(file["vals_nod_var"][step, k], dtype=float)
    return found


def _cell_data(
    file: netCDF4.Dataset, step: int, numbers: dict[str, list[int]]
) -> dict[str, dict[str, np.ndarray]]:
    """Data of elements, for the kinds all of whose blocks have them."""
    found: dict[str, dict[str, np.ndarray]] = {}
    for k, name in enumerate(_names(file, "name_elem_var")):
        for kind, blocks in numbers.items():
            variables = [f"vals_elem_var{k + 1}eb{block}" for block in blocks]
            if all(variable in file.variables for variable in variables):
                values = [np.asarray(file[variable][step], dtype=float) for variable in variables]
                found.setdefault(name, {})[kind] = np.concatenate(values)
    return found
