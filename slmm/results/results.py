"""Displacements from the result files of finite element programs: CalculiX's .frd, VTK's, Exodus and meshio's formats.

The model must be plane: plane elements in the x-y plane, or one layer of solid elements between two planes
z = const, which is what CalculiX makes of plane elements. Of such a layer the face with the lowest z is taken.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.results.field import DisplacementField
from slmm.results.frd import FrdField, FrdResult, read_frd
from slmm.results.inp_lines import blocks, plain
from slmm.results.joined_nodes import joined
from slmm.results.mesh_step import chosen_step, mesh_displacements
from slmm.results.plane_elements import PLANE_ELEMENTS

#: pairs of opposite faces, node over node, that can be the two sides of a plane model
FACES = {
    kind: known.element.opposite_faces(ELEMENT_TYPES[known.side].element)
    for kind, known in ELEMENT_TYPES.items()
    if known.side
}

#: beginnings of meshio's names of what has no inside: points and lines, on which loads are applied
THIN = ("vertex", "line")


def read_displacements(path: str | Path, step: int = -1, field: str | None = None) -> DisplacementField:
    """Read the displacements of a plane finite element model.

    Parameters
    ----------
    path : path
        CalculiX's ASCII results (.frd); VTK's .vtu, the pieces that a .pvtu names and the times that a .pvd names;
        Exodus (.e, .exo); or a format of meshio: .vtk, .xdmf, .med, .msh and others. Lengths and displacements in mm.
    step : int
        Which of the steps with displacements, counted from 0; from the end if negative.
    field : str, optional
        Which nodal data are the displacements, or, for a scalar for each direction, what their names have in common.
        By default those that have one of the names of `slmm.results.displacement_names`.

    Raises
    ------
    OSError
        When there is no such file.
    ValueError
        When the file cannot be read, is cut off, holds no displacements or not this step, several data may be the
        displacements, they jump from element to element, or the model is not plane.

    Notes
    -----
    An axisymmetric model with plane output looks like a plane one: only CalculiX's input file of the same name, if it
    is beside the results, tells them apart. A .frd file keeps six digits: a large rigid motion takes them away from the
    strains. Elements or pieces with nodes of their own are joined, see `slmm.results.joined_nodes`.

    Examples
    --------
    >>> field = read_displacements("tests/data/plate_2d.frd")
    >>> field.displacement(np.array([[20.0, 20.0]])).round(6)  # a corner of a plate under e_yy = 0.01
    array([[0. , 0.2]])
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    if path.suffix.lower() == ".frd":
        result, displacement = frd_displacements(path, step, field)
        if _is_axisymmetric(path.with_suffix(".inp")):
            raise ValueError(f"{path}: has axisymmetric elements (CAX) by its .inp: a plane model is needed")
        model: tuple[np.ndarray, Mapping[str, np.ndarray], np.ndarray]
        model = result.nodes, result.cells, displacement.values
    else:
        found = mesh_displacements(path, step, field)
        model = found.mesh.points, found.mesh.cells, found.u
    try:
        if (
            path.suffix.lower() == ".frd"
        ):  # tied parts have nodes of their own; of other files they are joined
            points, cells, u = model
            model = points, joined(points, cells, u)[0], u
        return DisplacementField(*_plane_model(*model))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def frd_displacements(path: Path, step: int, field: str | None = None) -> tuple[FrdResult, FrdField]:
    """All that a .frd file holds, and the displacements of a step, known at all nodes of elements.

    Raises
    ------
    OSError, ValueError
        See `read_displacements`.
    """
    result = read_frd(path)
    if field not in (None, "DISP"):
        raise ValueError(
            f"{path}: field = {field[:60]!r}: the displacements of CalculiX are DISP; there are "
            f"{', '.join(result.fields) or 'none'}"
        )
    if "DISP" not in result.fields:
        raise ValueError(
            f"{path}: holds no displacements (DISP), only {', '.join(result.fields) or 'the mesh'}; ask CalculiX "
            "for them: *NODE FILE, U"
        )
    fields = result.fields["DISP"]
    found = fields[chosen_step(path, step, len(fields))]
    if found.of_mode:
        loaded = [number for number, other in enumerate(fields) if not other.of_mode]
        raise ValueError(
            f"{path}: step {step} of {len(fields)} is a mode of vibration or buckling ({found.value:g}), whose "
            f"displacements have no size of their own; steps under load: {', '.join(map(str, loaded)) or 'none'}"
        )
    # nodes of networks and springs need not move
    of_solids = [nodes.ravel() for kind, nodes in result.cells.items() if not kind.startswith(THIN)]
    used = np.unique(np.concatenate([np.zeros(0, int), *of_solids]))
    missing = used[~np.isfinite(found.values[used]).all(axis=1)]
    if len(missing):
        raise ValueError(
            f"{path}: no finite displacement of node {result.node_ids[missing[0]]} ({len(missing)} of {len(used)} such "
            "nodes); ask CalculiX for all: *NODE FILE without NSET, and see whether the run converged"
        )
    # nodes of flows, shells and beams have more than three
    return result, replace(found, components=found.components[:3], read=lambda: found.values[:, :3])


def _is_axisymmetric(beside: Path) -> bool:
    """Whether an input file has axisymmetric elements; displacements need none, so that none need be readable."""
    try:
        return beside.is_file() and any(
            block.keyword == "ELEMENT" and plain(block.parameters.get("TYPE", "")).startswith("CAX")
            for block in blocks(beside)
        )
    except (OSError, ValueError):
        return False


def _plane_model(
    points: np.ndarray, cells: Mapping[str, np.ndarray], u: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray]:
    """Nodes, plane elements and displacements in the plane."""
    if u.ndim != 2 or u.shape[1] not in (2, 3):
        raise ValueError(f"the displacements have shape {u.shape}: 2 or 3 components are needed")
    cells = {kind: nodes for kind, nodes in cells.items() if not kind.startswith(THIN)}
    unknown = sorted(set(cells) - set(PLANE_ELEMENTS) - set(FACES))
    if unknown:
        raise ValueError(
            f"elements of type {', '.join(unknown)}: a plane model of {', '.join(PLANE_ELEMENTS)} is needed, or one "
            f"layer of {', '.join(FACES)}"
        )
    solid = {kind: nodes for kind, nodes in cells.items() if kind in FACES}
    if not solid:
        return points, cells, u[:, :2]
    faces, _ = lower_faces(points, solid, u[:, :2])
    return points[:, :2], faces, u[:, :2]


def lower_faces(
    points: np.ndarray, cells: Mapping[str, np.ndarray], u: np.ndarray
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """The faces with the lowest z of one layer of solid elements, which must move as the upper ones do.

    Parameters
    ----------
    points, u : ndarray (n, 3), (n, 2)
        Nodes, and their displacements in the plane, mm.
    cells : mapping of str to ndarray (el, k)
        Elements of the types in `FACES`.

    Returns
    -------
    faces : dict of str to ndarray (m, k)
        Plane elements by type.
    solids : dict of str to ndarray (m,)
        Which solid each of them is of, counted through all types.

    Raises
    ------
    ValueError
        When it is not one layer, or the two sides move differently.
    """
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    z = points[:, 2]
    low, high = z[used].min(), z[used].max()
    tolerance = 1e-3 * (high - low)
    of_kind: dict[str, list[np.ndarray]] = {}
    solids: dict[str, list[np.ndarray]] = {}
    difference, first = 0.0, 0
    for kind, nodes in cells.items():
        left = np.ones(len(nodes), dtype=bool)
        for face, opposite in FACES[kind]:
            below = (z[nodes[:, face]] <= low + tolerance).all(axis=1)
            here = below & (z[nodes[:, opposite]] >= high - tolerance).all(axis=1)
            lower, upper = nodes[here][:, face], nodes[here][:, opposite]
            of_kind.setdefault(ELEMENT_TYPES[kind].side, []).append(lower)
            solids.setdefault(ELEMENT_TYPES[kind].side, []).append(first + np.flatnonzero(here))
            difference = max(difference, np.abs(u[lower] - u[upper]).max(initial=0.0))
            left &= ~here
        if left.any():
            raise ValueError(
                f"{kind} {np.flatnonzero(left)[0]} does not reach from z = {low:g} to {high:g} mm with two faces "
                "z = const: a plane model is needed, or one layer of solid elements"
            )
        first += len(nodes)
    allowed = 1e-3 * np.ptp(u[used], axis=0).max() + 1e-5 * np.abs(u[used]).max()
    if difference > allowed:
        raise ValueError(
            f"the displacements in the plane differ by up to {difference:g} mm between z = {low:g} and {high:g} mm: "
            "a plane model is needed"
        )
    return (
        {kind: np.concatenate(faces) for kind, faces in of_kind.items()},
        {kind: np.concatenate(numbers) for kind, numbers in solids.items()},
    )
