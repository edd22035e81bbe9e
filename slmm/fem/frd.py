"""The result files of CalculiX (.frd): nodes, elements and nodal results of every step.

The format is that of the manual of CalculiX GraphiX, chapter "Result Format": fixed columns, so that numbers may
touch each other, in blocks 2C (nodes), 3C (elements) and 100C (results), each of which ends with -3. Node and
element numbers have 5 columns in the short form and 10 in the long one, values always 12.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

#: CalculiX's numbers of element types: the name in meshio, and the places in the file of the nodes in VTK's order;
#: CalculiX has the midside nodes of the vertical edges before those of the top
ELEMENT_TYPES: dict[int, tuple[str, tuple[int, ...]]] = {
    1: ("hexahedron", tuple(range(8))),
    2: ("wedge", tuple(range(6))),
    3: ("tetra", tuple(range(4))),
    4: ("hexahedron20", (*range(12), *range(16, 20), *range(12, 16))),
    5: ("wedge15", (*range(9), *range(12, 15), *range(9, 12))),
    6: ("tetra10", tuple(range(10))),
    7: ("triangle", tuple(range(3))),
    8: ("triangle6", tuple(range(6))),
    9: ("quad", tuple(range(4))),
    10: ("quad8", tuple(range(8))),
    11: ("line", tuple(range(2))),
    12: ("line3", tuple(range(3))),
}
VALUE_WIDTH, VALUES_PER_LINE = 12, 6


@dataclass(frozen=True)
class FrdField:
    """One nodal result at one step.

    Parameters
    ----------
    value : float
        Time, frequency or load factor.
    step : int
        The number the file gives it.
    components : tuple of str
        Their names, such as SXX.
    values : ndarray, shape (n, len(components))
        At every node of the file; NaN where the block says nothing.
    """

    value: float
    step: int
    components: tuple[str, ...]
    values: np.ndarray


@dataclass(frozen=True)
class FrdResult:
    """What a .frd file holds; lengths and stresses in the units of its model.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Coordinates.
    node_ids : ndarray, shape (n,)
        Numbers of the nodes in the file.
    cells : dict of str to ndarray, shape (m, k)
        Rows of ``nodes`` for the elements of each type, named as in meshio and in VTK's order of nodes.
    cell_ids : dict of str to ndarray, shape (m,)
        Numbers of these elements in the file.
    fields : dict of str to list of FrdField
        Results by name, such as DISP, STRESS, ENER, in the order of the file.
    """

    nodes: np.ndarray
    node_ids: np.ndarray
    cells: dict[str, np.ndarray]
    cell_ids: dict[str, np.ndarray]
    fields: dict[str, list[FrdField]]


def read_frd(path: str | Path) -> FrdResult:
    """Read an ASCII result file of CalculiX.

    Parameters
    ----------
    path : path
        What *NODE FILE and *EL FILE wrote. Of the binary form that *NODE OUTPUT and *ELEMENT OUTPUT write, nothing is
        read.

    Raises
    ------
    OSError
        When the file cannot be opened.
    ValueError
        When it is none of CalculiX, binary, cut off, or damaged; the message names the line.

    Examples
    --------
    >>> result = read_frd("tests/data/plate_2d.frd")
    >>> {kind: nodes.shape for kind, nodes in result.cells.items()}
    {'quad8': (224, 8)}
    >>> [field.value for field in result.fields["DISP"]], result.fields["ENER"][0].components
    ([1.0, 2.0], ('ENER',))
    """
    return _File(path).result()


class _File:
    """The lines of a file, in blocks of data between the lines that are none."""

    def __init__(self, path: str | Path):
        self.path = path
        self.lines = Path(path).read_bytes().splitlines()
        self.heads = [i for i, line in enumerate(self.lines) if line[:3] not in (b" -1", b" -2")]
        if not self.lines or not self.lines[0].startswith(b"    1C"):
            raise ValueError(f"{path}: no CalculiX result file: these begin with '    1C'")

    def error(self, line: int, text: str) -> ValueError:
        return ValueError(f"{self.path}, line {line + 1}: {text}")

    def result(self) -> FrdResult:
        """Everything, block by block: nodes stand before what names them."""
        if len(self.places(b"2C")) != 1 or len(self.places(b"3C")) > 1:
            raise ValueError(
                f"{self.path}: holds {len(self.places(b'2C'))} blocks of nodes (2C) and "
                f"{len(self.places(b'3C'))} of elements (3C): one of each is read"
            )
        node_ids, nodes = self.nodes(self.places(b"2C")[0])
        order = np.argsort(node_ids, kind="stable")
        cells: dict[str, np.ndarray] = {}
        cell_ids: dict[str, np.ndarray] = {}
        for place in self.places(b"3C"):
            cells, cell_ids = self.elements(place, node_ids, order)
        fields: dict[str, list[FrdField]] = {}
        for place in self.places(b"100C"):
            name, field = self.field(place, node_ids, order)
            fields.setdefault(name, []).append(field)
        if not self.places(b"9999"):
            raise self.error(
                len(self.lines) - 1,
                "the last record, 9999, is missing: the file is cut off, or the run broke off",
            )
        return FrdResult(nodes, node_ids, cells, cell_ids, fields)

    def places(self, key: bytes) -> list[int]:
        """Where among the heads the blocks of a kind begin."""
        return [place for place, i in enumerate(self.heads) if self.lines[i][:6].strip() == key]

    def header(self, line: int, start: int, end: int | None) -> bytes:
        """Columns of a header line."""
        return self.lines[line].rstrip()[start:end].strip()

    def number(self, line: int, start: int, end: int, kind: type = int) -> float:
        """The number in some columns of a line."""
        text = self.lines[line][start:end]
        try:
            return kind(text)
        except ValueError:
            raise self.error(
                line, f"columns {start + 1} to {end} hold {text.decode('latin-1')!r}: a number is expected"
            ) from None

    def width(self, line: int) -> int:
        """Columns of a node's number, by the form that the header names."""
        widths = {b"0": 5, b"1": 10}
        form = self.header(line, -1, None)
        if form not in widths:
            raise self.error(
                line,
                f"form {form.decode('latin-1')!r}: only ASCII (0, 1) is read; ask CalculiX for it with *NODE FILE "
                "and *EL FILE in place of *NODE OUTPUT and *ELEMENT OUTPUT",
            )
        return widths[form]

    def block(self, place: int) -> range:
        """Lines of the data after a head; only the record -3 may end them."""
        start = self.heads[place] + 1
        end = self.heads[place + 1] if place + 1 < len(self.heads) else len(self.lines)
        if end == len(self.lines) or self.lines[end].strip() != b"-3":
            raise self.error(min(end, len(self.lines) - 1), "the block is cut off: it does not end with -3")
        return range(start, end)

    def nodes(self, place: int) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (n,) and coordinates (n, 3)."""
        head = self.heads[place]
        width, lines = self.width(head), self.block(place)
        ids, points = self.table(lines, width, 3)
        self.check_count(head, len(ids), "nodes")
        return ids, points

    def check_count(self, head: int, found: int, what: str) -> None:
        """The number that the header names, which old files leave blank."""
        if self.header(head, 24, 36) and self.number(head, 24, 36) != found:
            raise self.error(head, f"{self.number(head, 24, 36)} {what} announced, {found} found")

    def table(self, lines: Sequence[int], width: int, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (n,) and values (n, count) of records -1, which go on in records -2 after six values."""
        first = [self.lines[i] for i in lines if self.lines[i].startswith(b" -1")]
        per_record = -(-count // VALUES_PER_LINE)
        if len(first) * per_record != len(lines):
            raise self.error(lines[0], f"records of {per_record} line(s) for {count} values expected")
        values = []
        for part in range(per_record):
            here = min(VALUES_PER_LINE, count - part * VALUES_PER_LINE)
            columns = self.columns(lines[part::per_record], 3 + width + here * VALUE_WIDTH)
            number = columns[:, 3 + width :].reshape(-1)
            values.append(self.numbers(number, VALUE_WIDTH, float, lines).reshape(-1, here))
            if part == 0:
                ids = self.numbers(columns[:, 3 : 3 + width], width, int, lines)
        return ids, np.concatenate(values, axis=1)

    def columns(self, lines: Sequence[int], width: int) -> np.ndarray:
        """Characters (n, width) of lines that must have this width."""
        text = [self.lines[i].rstrip() for i in lines]
        for i, line in zip(lines, text, strict=True):
            if len(line) != width:
                raise self.error(i, f"{len(line)} columns, not {width}: cut off or damaged")
        return np.frombuffer(b"".join(text), dtype="S1").reshape(-1, width)

    def numbers(self, columns: np.ndarray, width: int, kind: type, lines: Sequence[int]) -> np.ndarray:
        """The numbers in columns of equal width."""
        text = np.ascontiguousarray(columns).reshape(-1).view(f"S{width}")
        try:
            return text.astype(kind)
        except ValueError as error:
            raise self.error(lines[0], f"in the block that begins here: {error}") from None

    def rows(self, ids: np.ndarray, node_ids: np.ndarray, order: np.ndarray, line: int) -> np.ndarray:
        """Rows of nodes with these numbers; order sorts the nodes' numbers."""
        rows = order[np.minimum(np.searchsorted(node_ids, ids, sorter=order), len(order) - 1)]
        unknown = ids[node_ids[rows] != ids]
        if len(unknown):
            raise self.error(line, f"the block names node {unknown[0]}, which the file does not hold")
        return rows

    def elements(
        self, place: int, node_ids: np.ndarray, order: np.ndarray
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Nodes and numbers of the elements, by type."""
        head = self.heads[place]
        width, lines = self.width(head), self.block(place)
        of_type: dict[float, list[int]] = {}
        for i in lines:
            if self.lines[i].startswith(b" -1"):
                of_type.setdefault(self.number(i, 3 + width, 8 + width), []).append(i)
        self.check_count(head, sum(map(len, of_type.values())), "elements")
        cells, cell_ids = {}, {}
        spare = len(lines)
        for number, first in of_type.items():
            if number not in ELEMENT_TYPES:
                raise self.error(first[0], f"element type {number}: known are 1 to {max(ELEMENT_TYPES)}")
            kind, in_vtk_order = ELEMENT_TYPES[int(number)]
            per_line = 10 if width == 10 else 15
            parts = []
            for k, start in enumerate(range(0, len(in_vtk_order), per_line)):
                here = min(per_line, len(in_vtk_order) - start)
                follow = [i + 1 + k for i in first]
                parts.append(self.columns(follow, 3 + here * width)[:, 3:])
            spare -= len(first) * (1 + len(parts))
            ids = self.numbers(np.concatenate(parts, axis=1), width, int, first)
            ids = ids.reshape(-1, len(in_vtk_order))[:, in_vtk_order]
            cells[kind] = self.rows(ids, node_ids, order, head)
            cell_ids[kind] = np.array([self.number(i, 3, 3 + width) for i in first], dtype=int)
        if spare:
            raise self.error(head, f"{spare} lines of the block belong to no element")
        return cells, cell_ids

    def field(self, place: int, node_ids: np.ndarray, order: np.ndarray) -> tuple[str, FrdField]:
        """A block of results and its name."""
        head = self.heads[place]
        width = self.width(head)
        components = []
        name = None
        while place + 1 < len(self.heads) and self.lines[self.heads[place + 1]][:3] in (b" -4", b" -5"):
            place += 1
            line = self.lines[self.heads[place]]
            if line.startswith(b" -4"):
                name = line[5:13].decode("latin-1").strip()
            # a component that is to be calculated from the others is not in the file
            elif line[33:38].strip() != b"1":
                components.append(line[5:13].decode("latin-1").strip())
        if name is None or not components:
            raise self.error(head, "the block of results is cut off: it names no data")
        lines = self.block(place)
        ids, values = self.table(lines, width, len(components))
        self.check_count(head, len(ids), "nodes")
        of_nodes = np.full((len(node_ids), len(components)), np.nan)
        of_nodes[self.rows(ids, node_ids, order, head)] = values
        value, step = self.number(head, 12, 24, float), int(self.number(head, 58, 63))
        return name, FrdField(value, step, tuple(components), of_nodes)
