"""Unstructured grids from VTK's XML files (.vtu): any version up to 2.x, any encoding, any number of pieces.

They are read here and not by meshio 5.3, which refuses what VTK has written since 2023 (version 2.x), keeps the last
piece only, and takes numbers of nodes as they come. VTK's own reader is a wheel of 100 MB.
"""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from slmm.results.file_mesh import FileMesh, checked, side_by_side
from slmm.results.vtk_arrays import NUMBERS, Encoding, read_array
from slmm.results.vtk_cells import cells_by_kind, check_nodes, check_offsets

#: elements within elements, chosen: VTK has seven
DEEPEST = 50

#: bits of vtkGhostType that leave a cell out: of another piece, refined elsewhere, hidden
GHOST = 1 | 8 | 32

#: what else VTK's XML files hold, in words
OTHER_TYPES = {
    "PolyData": "polygons of surfaces",
    "ImageData": "an image",
    "RectilinearGrid": "a rectilinear grid",
    "StructuredGrid": "a structured grid",
    "HyperTreeGrid": "a hyper tree grid",
    "Table": "a table",
    "vtkMultiBlockDataSet": "an index of several data sets",
    "vtkPartitionedDataSet": "an index of several data sets",
    "vtkPartitionedDataSetCollection": "an index of several data sets",
}

#: what ends or cannot stand in XML: bytes of appended data as they are
_APPENDED = re.compile(rb"<AppendedData\b[^>]*>\s*_")


def read_vtu(path: Path) -> FileMesh:
    """The plane and solid elements of all pieces of a .vtu file, without ghosts.

    Raises
    ------
    ValueError
        When the file is no unstructured grid or is damaged, with the array in which that shows.
    """
    try:
        root, appended, in_base64 = _parsed(path.read_bytes())
        _check_root(root, "UnstructuredGrid")
        encoding = Encoding.of(root, appended, in_base64)
        former = float(root.get("version", "0.1")) < 2.1
        pieces = [_piece(piece, encoding, former) for piece in root.findall("UnstructuredGrid/Piece")]
        if not pieces:
            raise ValueError("there is no <Piece> in <UnstructuredGrid>")
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    return checked(path, side_by_side(pieces))


def read_index(path: Path, kind: str) -> Element:
    """The first element of a file that names others: a .pvtu or .pvd.

    Raises
    ------
    ValueError
        When it is of another type, or no XML.
    """
    try:
        root, *_ = _parsed(path.read_bytes())
        _check_root(root, kind)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    return root


def _parsed(data: bytes) -> tuple[Element, bytes, bool]:
    """The elements of a file, its appended data, and whether they are in base64."""
    appended, in_base64 = b"", True
    if match := _APPENDED.search(data):
        end = data.rfind(b"</AppendedData")
        if end < match.end():
            raise ValueError("cannot be read: <AppendedData> has no end")
        appended, in_base64 = data[match.end() : end], b'"raw"' not in match.group().replace(b"'", b'"')
        data = data[: match.end()] + data[end:]
    builder, depth = TreeBuilder(), 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise ValueError(f"cannot be read: elements within each other more than {DEEPEST} times")
        builder.start(name, attributes)

    def end_of(name: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(name)

    def refuse(*_: object) -> None:
        # entities that stand for each other fill any memory, and VTK has none
        raise ValueError("cannot be read: it has a document type, which files of VTK do not have")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = start, end_of
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(f"cannot be read: no XML: {error}") from error
    return builder.close(), appended, in_base64


def _check_root(root: Element, kind: str) -> None:
    found, version = root.get("type", ""), root.get("version", "0.1")
    if root.tag != "VTKFile":
        raise ValueError("cannot be read: its first element is not <VTKFile>")
    if found != kind:
        says = OTHER_TYPES.get(found.removeprefix("P"), OTHER_TYPES.get(found, "something else"))
        raise ValueError(f"holds {says} (type {found[:40]!r}): {kind} is needed")
    if not re.fullmatch(r"[0-2]\.\d{1,3}", version):
        raise ValueError(f"is of version {version[:20]!r} of VTK's XML files: known are 0.1 to 2.x")


def _piece(piece: Element, encoding: Encoding, former: bool) -> FileMesh:
    n_points, n_cells = (_count(piece, name) for name in ("NumberOfPoints", "NumberOfCells"))
    arrays = piece.findall("Points/DataArray")
    if len(arrays) != 1:
        raise ValueError(f"a piece has {len(arrays)} arrays of points: must be one")
    arrays[0].attrib.setdefault("Name", "Points")
    points = np.asarray(read_array(arrays[0], encoding, n_points), dtype=float)
    if n_points == 0:
        points = points.reshape(0, 3)
    elif points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"the points have the shape {points.shape}: three coordinates each are needed")
    cell_data = _data(piece.find("CellData"), encoding, n_cells)
    degrees = cell_data.pop("HigherOrderDegrees", None)
    nodes, offsets, types = _cells(piece, encoding, n_points, n_cells)
    ghosts = cell_data.pop("vtkGhostType", np.zeros(n_cells, np.uint8))
    levels = cell_data.pop("vtkGhostLevels", np.zeros(n_cells))
    own = ((ghosts & GHOST) == 0) & (levels == 0) if np.issubdtype(ghosts.dtype, np.integer) else levels == 0
    cells = cells_by_kind(nodes, offsets, types, degrees, former)
    kept = {kind: own[found.number] for kind, found in cells.items()}
    return FileMesh(
        points,
        {kind: found.nodes[kept[kind]] for kind, found in cells.items()},
        _data(piece.find("PointData"), encoding, n_points),
        {
            name: {kind: values[found.number[kept[kind]]] for kind, found in cells.items()}
            for name, values in cell_data.items()
        },
        _components(piece.find("PointData")),
    )


def _count(piece: Element, name: str) -> int:
    text = piece.get(name, "")
    if not re.fullmatch(r"\s*\d{1,12}\s*", text):
        raise ValueError(f"a piece has {name} = {text[:20]!r}: must be a number of at most 12 digits")
    return int(text)


def _cells(
    piece: Element, encoding: Encoding, n_points: int, n_cells: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes of all cells, where each ends, and their types."""
    arrays = {array.get("Name", ""): array for array in piece.findall("Cells/DataArray")}
    if missing := [name for name in ("connectivity", "offsets", "types") if name not in arrays]:
        raise ValueError(f"the array {missing[0]} is missing in <Cells>")
    offsets, types = (
        _whole_numbers(name, read_array(arrays[name], encoding, n_cells)) for name in ("offsets", "types")
    )
    check_offsets(offsets)
    size = int(offsets[-1]) if n_cells else 0
    nodes = _whole_numbers("connectivity", read_array(arrays["connectivity"], encoding, size))
    check_nodes(nodes, offsets, n_points)
    return nodes, offsets, types


def _whole_numbers(name: str, values: np.ndarray) -> np.ndarray:
    if values.ndim != 1 or values.dtype.kind not in "iu":
        raise ValueError(f"the array {name}: must hold whole numbers, one component each")
    if len(values) and values.max() > np.iinfo(np.int64).max:
        raise ValueError(f"the array {name}: {values.max()} is more than any number of a node")
    return values.astype(np.int64)


def _data(section: Element | None, encoding: Encoding, rows: int) -> dict[str, np.ndarray]:
    """Data of nodes or cells; words are left out."""
    found: dict[str, np.ndarray] = {}
    for array in () if section is None else section.findall("DataArray"):
        name = array.get("Name", "")
        if array.get("TimeStep") is not None:
            raise ValueError(f"the array {name} has several time steps: a file for each is needed (.pvd)")
        if array.get("type") not in NUMBERS:
            continue
        if name in found:
            raise ValueError(f"the array {name} is there twice")
        found[name] = read_array(array, encoding, rows)
    return found


def _components(section: Element | None) -> dict[str, tuple[str, ...]]:
    """Names of the components of data of nodes."""
    found = {}
    for array in () if section is None else section.findall("DataArray"):
        names: list[str] = []
        while (name := array.get(f"ComponentName{len(names)}")) is not None:
            names.append(name)
        if names:
            found[array.get("Name", "")] = tuple(names)
    return found
