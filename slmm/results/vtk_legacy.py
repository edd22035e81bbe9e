"""Unstructured grids from VTK's legacy files (.vtk), as text or binary, of versions 1 to 5.

They are read here and not by meshio 5.3, which drops voxels without a word, and does not know the types of numbers that
VTK writes today. The form is that of "VTK Legacy File Formats"
(https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html).
"""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from slmm.results.file_mesh import FileMesh, checked
from slmm.results.vtk_cells import cells_by_kind, check_nodes, check_offsets

#: types of numbers, in binary files the highest byte first
NUMBERS = {
    "char": "i1",
    "unsigned_char": "u1",
    "short": "i2",
    "unsigned_short": "u2",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "float": "f4",
    "double": "f8",
    "vtkidtype": "i4",
    **{
        f"vtktype{sign}int{bits}": f"{sign or 'i'}{bits // 8}"
        for sign in ("", "u")
        for bits in (8, 16, 32, 64)
    },
}

#: arrays by their keyword, and the number of their components
ARRAYS = {
    "VECTORS": 3,
    "NORMALS": 3,
    "TENSORS": 9,
    "TENSORS6": 6,
    "GLOBAL_IDS": 1,
    "PEDIGREE_IDS": 1,
    "EDGE_FLAGS": 1,
}


class _Stream:
    """The bytes of a file: lines of words, and numbers as text or binary."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at, self.binary = data, 0, False

    def line(self) -> bytes:
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        found, self.at = self.data[self.at : end], end + 1
        return found

    def words(self) -> list[str]:
        """Those of the next line that has any; none at the end."""
        while self.at < len(self.data):
            if found := self.line().split():
                return [word.decode("utf-8", "replace") for word in found]
        return []

    def numbers(self, name: str, count: int, kind: str) -> np.ndarray:
        """So many numbers of a type."""
        if kind.lower() not in NUMBERS:
            raise ValueError(f"{name} has numbers of type {kind[:20]!r}: known are {', '.join(NUMBERS)}")
        number = np.dtype(">" + NUMBERS[kind.lower()])
        if not 0 <= count <= len(self.data):
            raise ValueError(f"{name} has {count} numbers: more than the file can hold")
        if self.binary:
            end = self.at + count * number.itemsize
            if end > len(self.data):
                raise ValueError(f"{name} is cut off: {count} numbers are expected")
            found = np.frombuffer(self.data[self.at : end], number).astype(number.newbyteorder("="))
            # the line ends behind them
            self.at = end + 1 if self.data[end : end + 1] == b"\n" else end
            return found
        words: list[bytes] = []
        while len(words) < count and self.at < len(self.data):
            words += self.line().split()
        if len(words) != count:
            raise ValueError(f"{name} has {len(words)} numbers: {count} are expected")
        try:
            return np.array(words).astype(number.newbyteorder("=")) if words else np.zeros(0)
        except (ValueError, OverflowError) as error:
            raise ValueError(f"{name} has a word that is no number of type {kind}") from error


def dataset_of(path: Path) -> str:
    """What a legacy file holds, in VTK's word; empty when it does not say.

    Raises
    ------
    ValueError
        When it holds surfaces.
    """
    with path.open("rb") as file:
        stream = _Stream(file.read(4096))
    stream.line(), stream.line(), stream.line()
    words = stream.words()
    found = words[1].upper() if len(words) > 1 and words[0].upper() == "DATASET" else ""
    if found == "POLYDATA":
        raise ValueError(f"{path}: holds polygons of surfaces (POLYDATA): an unstructured grid is needed")
    return found


def read_legacy(path: Path) -> FileMesh:
    """The plane and solid elements of a legacy file with an unstructured grid.

    Raises
    ------
    ValueError
        When it is damaged, or has cells or numbers that are not known.
    """
    try:
        return checked(path, _mesh(_Stream(path.read_bytes())))
    except (ValueError, IndexError) as error:
        says = (
            str(error).removeprefix(f"{path}: ") if isinstance(error, ValueError) else "a line is too short"
        )
        raise ValueError(f"{path}: cannot be read: {says}") from error


def _mesh(stream: _Stream) -> FileMesh:
    version = re.match(rb"# vtk DataFile Version (\d\.\d)", stream.line())
    if version is None:
        raise ValueError("its first line is not that of VTK's files")
    former = float(version[1]) < 5.1
    stream.line()
    stream.binary = stream.line().strip().upper() == b"BINARY"
    points: np.ndarray
    points = nodes = offsets = types = np.zeros(0)
    data: dict[str, dict[str, np.ndarray]] = {"POINT_DATA": {}, "CELL_DATA": {}, "": {}}
    section, rows = "", 0
    while words := stream.words():
        word = words[0].upper()
        if word == "POINTS":
            points = stream.numbers("POINTS", 3 * _int(words[1]), words[2]).reshape(-1, 3)
        elif word == "CELLS":
            nodes, offsets = _cells(stream, _int(words[1]), _int(words[2]))
        elif word == "CELL_TYPES":
            types = stream.numbers("CELL_TYPES", _int(words[1]), "int")
        elif word in ("POINT_DATA", "CELL_DATA"):
            section, rows = word, _int(words[1])
        elif word == "METADATA":
            while stream.at < len(stream.data) and stream.line().strip():
                pass
        elif word != "DATASET":
            data[section] |= _arrays(stream, word, words, rows)
    if len(types) != len(offsets):
        raise ValueError(f"CELL_TYPES has {len(types)} numbers: there are {len(offsets)} cells")
    check_nodes(nodes, offsets, len(points))
    degrees = data["CELL_DATA"].pop("HigherOrderDegrees", None)
    cells = cells_by_kind(nodes.astype(int), offsets.astype(int), types.astype(int), degrees, former)
    for name, values in data["CELL_DATA"].items():
        if len(values) != len(offsets):
            raise ValueError(f"{name} has {len(values)} values: there are {len(offsets)} cells")
    return FileMesh(
        np.asarray(points, dtype=float).reshape(-1, 3),
        {kind: found.nodes for kind, found in cells.items()},
        data["POINT_DATA"],
        {
            name: {kind: values[found.number] for kind, found in cells.items()}
            for name, values in data["CELL_DATA"].items()
        },
    )


def _int(word: str) -> int:
    if not word.isascii() or not word.isdigit() or len(word) > 12:
        raise ValueError(f"{word[:20]!r} stands where a number of at most 12 digits belongs")
    return int(word)


def _cells(stream: _Stream, count: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of all cells, and where each ends."""
    at = stream.at
    words = stream.words()
    if words[:1] == ["OFFSETS"]:  # since version 5
        offsets = stream.numbers("OFFSETS", count, words[1]).astype(int)
        words = stream.words()
        if words[:1] != ["CONNECTIVITY"]:
            raise ValueError("CONNECTIVITY is missing behind OFFSETS")
        nodes = stream.numbers("CONNECTIVITY", size, words[1]).astype(int)
        if count and (offsets[0] != 0 or offsets[-1] != size):
            raise ValueError(f"OFFSETS run from {offsets[0]} to {offsets[-1]}: must be from 0 to {size}")
        check_offsets(offsets)
        return nodes, offsets[1:]
    stream.at = at
    mixed = stream.numbers("CELLS", size, "int")
    ends: list[int] = []
    starts: list[int] = []
    at = 0
    for _ in range(count):
        if not (at < size and 0 <= mixed[at] < size - at):
            raise ValueError(f"CELLS: cell {len(ends)} reaches beyond the {size} numbers")
        starts.append(at + 1)
        at += 1 + int(mixed[at])
        ends.append(at)
    if at != size:
        raise ValueError(f"CELLS has {size} numbers: {count} cells take {at}")
    of_node = np.ones(size, dtype=bool)
    of_node[np.array(starts, dtype=int) - 1] = False
    return mixed[of_node], np.cumsum(np.array(ends, dtype=int) - np.array(starts, dtype=int))


def _arrays(stream: _Stream, word: str, words: list[str], rows: int) -> dict[str, np.ndarray]:
    """The data that a line announces, by name."""
    if word == "FIELD":
        return dict(_array_of_field(stream) for _ in range(_int(words[2])))
    if word == "LOOKUP_TABLE":
        stream.numbers(word, 4 * _int(words[2]), "unsigned_char" if stream.binary else "float")
        return {}
    if word == "COLOR_SCALARS":
        stream.numbers(word, rows * _int(words[2]), "unsigned_char" if stream.binary else "float")
        return {}
    name = unquote(words[1])
    if word == "SCALARS":
        components = _int(words[3]) if len(words) > 3 else 1
        at = stream.at
        if stream.words()[:1] != ["LOOKUP_TABLE"]:  # may be left out
            stream.at = at
        kind = words[2]
    elif word == "TEXTURE_COORDINATES":
        components, kind = _int(words[2]), words[3]
    elif word in ARRAYS:
        components, kind = ARRAYS[word], words[2]
    else:
        raise ValueError(f"{word[:20]!r} stands where a keyword belongs")
    return {name: _shaped(stream.numbers(name, rows * components, kind), components)}


def _array_of_field(stream: _Stream) -> tuple[str, np.ndarray]:
    words = stream.words()
    if words[:1] == ["METADATA"]:  # of the array before
        while stream.at < len(stream.data) and stream.line().strip():
            pass
        words = stream.words()
    name, components, rows = unquote(words[0]), _int(words[1]), _int(words[2])
    return name, _shaped(stream.numbers(name, rows * components, words[3]), components)


def _shaped(values: np.ndarray, components: int) -> np.ndarray:
    return values.reshape(-1, components) if components > 1 else values
