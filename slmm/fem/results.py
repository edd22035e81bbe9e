"""Displacements from the result files of finite element programs: CalculiX's .frd, and whatever meshio reads.

The model must be plane: plane elements in the x-y plane, or one layer of solid elements between two planes
z = const, which is what CalculiX makes of plane elements. Of such a layer the face with the lowest z is taken.
"""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np

from slmm.fem.field import ELEMENTS, DisplacementField
from slmm.fem.frd import FrdField, FrdResult, read_frd
from slmm.fem.inp_lines import blocks, plain

#: what programs call nodal displacements, in lower case; the first one found is taken
NAMES = ("displacement", "displacements", "disp", "u")

#: how meshio names the steps of a MED file: "name[0] - time"
_STEP_NAME = re.compile(r"(?P<name>.*?)(\[(?P<number>\d+)\] - .*)?")

#: elements that carry nothing in a plane model: points and lines, on which loads are applied
_THIN = re.compile("vertex|line")

#: plane elements by their number of nodes, as faces of solid elements
_FACE_KINDS = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}


def _both_ways(face: Sequence[int], opposite: Sequence[int]) -> list[tuple[list[int], list[int]]]:
    return [([*face], [*opposite]), ([*opposite], [*face])]


#: pairs of opposite faces, node over node, that can be the two sides of a plane model; in VTK's order of nodes
FACES: dict[str, list[tuple[list[int], list[int]]]] = {
    "hexahedron": [
        *_both_ways((0, 1, 2, 3), (4, 5, 6, 7)),
        *_both_ways((0, 1, 5, 4), (3, 2, 6, 7)),
        *_both_ways((0, 3, 7, 4), (1, 2, 6, 5)),
    ],
    "hexahedron20": [
        *_both_ways((0, 1, 2, 3, 8, 9, 10, 11), (4, 5, 6, 7, 12, 13, 14, 15)),
        *_both_ways((0, 1, 5, 4, 8, 17, 12, 16), (3, 2, 6, 7, 10, 18, 14, 19)),
        *_both_ways((0, 3, 7, 4, 11, 19, 15, 16), (1, 2, 6, 5, 9, 18, 13, 17)),
    ],
    "wedge": _both_ways((0, 1, 2), (3, 4, 5)),
    "wedge15": _both_ways((0, 1, 2, 6, 7, 8), (3, 4, 5, 9, 10, 11)),
}


def read_displacements(path: str | Path, step: int = -1) -> DisplacementField:
    """Read the displacements of a plane finite element model.

    Parameters
    ----------
    path : path
        CalculiX's ASCII results (.frd), or a format of meshio: .vtu, .vtk, .xdmf, .med, .msh and others. Lengths and
        displacements in mm. The displacements are nodal data called displacement, displacements, disp or u, in
        capitals or not.
    step : int
        Which of the steps with displacements, counted from 0; from the end if negative.

    Raises
    ------
    OSError
        When there is no such file.
    ValueError
        When the file cannot be read, is cut off, holds no displacements or not this step, or the model is not plane.

    Notes
    -----
    An axisymmetric model with plane output looks like a plane one: only CalculiX's input file of the same name, if it
    is beside the results, tells them apart. A .frd file keeps six digits: a large rigid motion takes them away from the
    strains. Wedges of 15 nodes are read from .frd files only: meshio 5.3 does not know them.

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
        result, displacement = frd_displacements(path, step)
        if _is_axisymmetric(path.with_suffix(".inp")):
            raise ValueError(f"{path}: has axisymmetric elements (CAX) by its .inp: a plane model is needed")
        points, cells, u = result.nodes, result.cells, displacement.values
    else:
        points, cells, u, *_ = mesh_displacements(path, step)
    try:
        return DisplacementField(*_plane_model(points, cells, u))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def frd_displacements(path: Path, step: int) -> tuple[FrdResult, FrdField]:
    """All that a .frd file holds, and the displacements of a step, known at all nodes of elements.

    Raises
    ------
    OSError, ValueError
        See `read_displacements`.
    """
    result = read_frd(path)
    if "DISP" not in result.fields:
        raise ValueError(
            f"{path}: holds no displacements (DISP), only {', '.join(result.fields) or 'the mesh'}; ask CalculiX "
            "for them: *NODE FILE, U"
        )
    fields = result.fields["DISP"]
    field = fields[_chosen(path, step, len(fields))]
    if field.of_mode:
        loaded = [number for number, other in enumerate(fields) if not other.of_mode]
        raise ValueError(
            f"{path}: step {step} of {len(fields)} is a mode of vibration or buckling ({field.value:g}), whose "
            f"displacements have no size of their own; steps under load: {', '.join(map(str, loaded)) or 'none'}"
        )
    # nodes of networks and springs need not move
    of_solids = [nodes.ravel() for kind, nodes in result.cells.items() if not _THIN.match(kind)]
    used = np.unique(np.concatenate([np.zeros(0, int), *of_solids]))
    missing = used[~np.isfinite(field.values[used]).all(axis=1)]
    if len(missing):
        raise ValueError(
            f"{path}: no finite displacement of node {result.node_ids[missing[0]]} ({len(missing)} of {len(used)} such "
            "nodes); ask CalculiX for all: *NODE FILE without NSET, and see whether the run converged"
        )
    # nodes of flows, shells and beams have more than three
    of_space = replace(field, components=field.components[:3], read=lambda: field.values[:, :3])
    return result, of_space


def _is_axisymmetric(beside: Path) -> bool:
    """Whether an input file has axisymmetric elements; displacements need none, so that none need be readable."""
    try:
        return beside.is_file() and any(
            block.keyword == "ELEMENT" and plain(block.parameters.get("TYPE", "")).startswith("CAX")
            for block in blocks(beside)
        )
    except (OSError, ValueError):
        return False


class MeshStep(NamedTuple):
    """A step of a file that meshio reads: nodes, elements by type, displacements, and the data of all steps.

    Data of elements come as an array for each of the ``blocks``, which are named by their types.
    """

    points: np.ndarray
    cells: dict[str, np.ndarray]
    u: np.ndarray
    number: int
    blocks: tuple[str, ...]
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, list[np.ndarray]]


def mesh_displacements(path: Path, step: int) -> MeshStep:
    """A step with displacements of a file that meshio reads.

    Raises
    ------
    ValueError
        See `read_displacements`.
    """
    with _reading(path):
        series = _xdmf_series(path)
    if series is None:
        with _reading(path):
            mesh = meshio.read(path)
        points, blocks, data, cell_data = mesh.points, mesh.cells, mesh.point_data, mesh.cell_data
    else:
        chosen = range(series.num_steps)[_chosen(path, step, series.num_steps)]
        with _reading(path), series:
            points, blocks = series.read_points_cells()
            _, data, cell_data = series.read_data(chosen)
        step = -1
    steps = steps_of(path, data)
    name = next((name for name in NAMES if name in steps), None)
    if name is None:
        raise ValueError(
            f"{path}: holds no displacements: nodal data must have one of the names {', '.join(NAMES)}; there are "
            f"{', '.join(data) or 'none'}"
        )
    number, key = sorted(steps[name].items())[_chosen(path, step, len(steps[name]))]
    of_kind: dict[str, list[np.ndarray]] = {}
    for block in blocks:
        of_kind.setdefault(block.type, []).append(np.asarray(block.data))
    cells = {kind: np.concatenate(parts) for kind, parts in of_kind.items()}
    return MeshStep(points, cells, data[key], number, tuple(block.type for block in blocks), data, cell_data)


def steps_of(path: Path, data: Iterable[str]) -> dict[str, dict[int, str]]:
    """The names of data in lower case, and for each the file's own by the number of the step, -1 if it has none."""
    found: dict[str, dict[int, str]] = {}
    for key in data:
        match = _STEP_NAME.fullmatch(key)
        assert match is not None  # the pattern takes any text
        steps = found.setdefault(match["name"].strip().lower(), {})
        number = int(match["number"] or -1)
        if number in steps:
            raise ValueError(f"{path}: {steps[number]!r} and {key!r} have the same name but for capitals")
        steps[number] = key
    return found


def _xdmf_series(path: Path) -> meshio.xdmf.TimeSeriesReader | None:
    """The steps of an XDMF file that has them."""
    if path.suffix.lower() not in (".xdmf", ".xmf"):
        return None
    try:
        return meshio.xdmf.TimeSeriesReader(path)
    except meshio.ReadError:
        return None


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Make one error of all that happens to a bad file in meshio: it prints, raises anything, or exits."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            yield
    except (Exception, SystemExit) as error:
        reason = " ".join(said.getvalue().split()) or f"{type(error).__name__}: {error}"
        if isinstance(error, KeyError) and error.args == ("wedge15",):
            reason = "it has wedges of 15 nodes (C3D15), which meshio does not take"
        raise ValueError(f"{path}: cannot be read: {reason}") from error


def _chosen(path: Path, step: int, count: int) -> int:
    if not -count <= step < count:
        raise ValueError(f"{path}: step = {step}: steps with displacements: {count}, counted from 0")
    return step


def _plane_model(
    points: np.ndarray, cells: Mapping[str, np.ndarray], u: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray]:
    """Nodes, plane elements and displacements in the plane."""
    if u.ndim != 2 or u.shape[1] not in (2, 3):
        raise ValueError(f"the displacements have shape {u.shape}: 2 or 3 components are needed")
    cells = {kind: nodes for kind, nodes in cells.items() if not _THIN.match(kind)}
    unknown = sorted(set(cells) - set(ELEMENTS) - set(FACES))
    if unknown:
        raise ValueError(
            f"elements of type {', '.join(unknown)}: a plane model of {', '.join(ELEMENTS)} is needed, or one layer "
            f"of {', '.join(FACES)}"
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
            of_kind.setdefault(_FACE_KINDS[len(face)], []).append(lower)
            solids.setdefault(_FACE_KINDS[len(face)], []).append(first + np.flatnonzero(here))
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
