"""The result files of CalculiX (.frd): nodes, elements and nodal results of every step.

The format is that of the manual of CalculiX GraphiX, chapter "Result Format": fixed columns, so that numbers may
touch each other, in blocks 2C (nodes), 3C (elements) and 100C (results), each of which ends with -3. Node and
element numbers have 5 columns in the short form and 10 in the long one, values 12; where a program writes exponents
of three digits, as on Windows, a negative value has 13.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.results.frd_records import Records, quoted

#: kinds of elements by CalculiX's numbers, how many nodes they have, and where in the file these stand
NUMBERED: dict[int, tuple[str, int, tuple[int, ...] | None]] = {
    known.frd.number: (known.kind, known.count, known.frd.order)
    for known in ELEMENT_TYPES.values()
    if known.frd is not None
} | {11: ("line", 2, None), 12: ("line3", 3, None)}
VALUE_WIDTH = 12

#: kinds of analysis: of vibration, where all displacements are modes, and of buckling, where those are after the first,
#: which have a factor on the load
VIBRATION, BUCKLING = b"2", b"4"

#: records -4, a result, and -5, one of its components: name, menu, kind, two indices, then 1 when the component is
#: not in the file but calculated from the others. Some that CalculiX writes have tabs, which move the columns
_RESULT = re.compile(rb" -4\s+(?P<name>\S.*?)(\s+\d+){2}\s*")
_COMPONENT = re.compile(rb" -5\s+(?P<name>\S.*?)(\s+\d+){4}(\s+(?P<calculated>\d).*)?")


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
    of_mode : bool
        It belongs to a mode of vibration or buckling, whose size is arbitrary.
    read : callable
        Reads the values. Few of many results are wanted, and what is wrong with the others does not matter.
    """

    value: float
    step: int
    components: tuple[str, ...]
    of_mode: bool
    read: Callable[[], np.ndarray] = field(repr=False)

    @cached_property
    def values(self) -> np.ndarray:
        """Values (n, len(components)) at every node of the file; NaN where the block says nothing.

        Raises
        ------
        ValueError
            When the block is damaged; the message names the line.
        """
        return self.read()


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
        Rows of ``nodes`` for the elements of each type, by its kind and in the order of
        `slmm.mechanics.element_types`.
    cell_ids : dict of str to ndarray, shape (m,)
        Numbers of these elements in the file. Composite shells have an element for each layer, with a number of its
        own.
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


class _File(Records):
    """Blocks of data between the lines that are none."""

    def __init__(self, path: str | Path):
        super().__init__(path)
        self.heads = [i for i, line in enumerate(self.lines) if line[:3] not in (b" -1", b" -2")]
        # the programs that refine meshes leave out the first record, 1C, and begin with what the user may write, 1U
        if not self.lines or self.lines[0][:6] not in (b"    1C", b"    1U"):
            raise ValueError(f"{path}: no CalculiX result file: these begin with '    1C' or '    1U'")

    def result(self) -> FrdResult:
        """Mesh and results, block by block: nodes stand before what names them."""
        nodes_at, elements_at = self.places(b"2C"), self.places(b"3C")
        if not nodes_at:
            raise ValueError(
                f"{self.path}: holds no nodes (2C): the run broke off, or was not asked for results"
            )
        # in a binary file, more looks like heads than there is
        self.width(self.heads[nodes_at[0]])
        if len(nodes_at) > 1 or len(elements_at) > 1:
            raise ValueError(
                f"{self.path}: holds {len(nodes_at)} blocks of nodes (2C) and {len(elements_at)} of elements (3C): "
                "one of each is read"
            )
        node_ids, nodes = self.nodes(self.heads[nodes_at[0]], self.block(nodes_at[0]))
        rows = _Rows(node_ids)
        cells: dict[str, np.ndarray] = {}
        cell_ids: dict[str, np.ndarray] = {}
        for place in elements_at:
            cells, cell_ids = self.elements(self.heads[place], self.block(place), rows)
        fields: dict[str, list[FrdField]] = {}
        for place in self.places(b"100C"):
            name, found = self.field(place, rows)
            fields.setdefault(name, []).append(found)
        if not self.places(b"9999"):
            raise self.error(
                len(self.lines) - 1,
                "the last record, 9999, is missing: the file is cut off, or the run broke off",
            )
        return FrdResult(nodes, node_ids, cells, cell_ids, fields)

    def places(self, key: bytes) -> list[int]:
        """Where among the heads the blocks of a kind begin."""
        return [place for place, i in enumerate(self.heads) if self.lines[i][:6].strip() == key]

    def width(self, head: int) -> int:
        """Columns of a node's number, by the form that the header names."""
        widths = {b"0": 5, b"1": 10}
        form = self.lines[head].rstrip()[-1:]
        if form not in widths:
            raise self.error(
                head,
                f"form {quoted(form)}: only ASCII (0, 1) is read; ask CalculiX for it with *NODE FILE "
                "and *EL FILE in place of *NODE OUTPUT and *ELEMENT OUTPUT",
            )
        return widths[form]

    def block(self, place: int) -> range:
        """Lines of the data after a head; only the record -3 may end them."""
        start = self.heads[place] + 1
        end = self.heads[place + 1] if place + 1 < len(self.heads) else len(self.lines)
        if end == len(self.lines) or self.lines[end].strip() != b"-3":
            raise self.error(min(end, len(self.lines) - 1), "the block is cut off: it does not end with -3")
        if start < end and self.lines[start].startswith(b" -2"):
            raise self.error(start, "the first record of a block begins with -1: cut off or damaged")
        return range(start, end)

    def announced(self, head: int) -> int | None:
        """The number of records that a header names, which old files leave blank."""
        return self.whole(head, 24, 36) if self.lines[head][24:36].strip() else None

    def nodes(self, head: int, lines: range) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (n,) and coordinates (n, 3)."""
        ids, points = self.table(head, lines, 3)
        number, count = np.unique(ids, return_counts=True)
        if (count > 1).any():
            raise self.error(head, f"the block holds node {number[count > 1][0]} more than once")
        return ids, points

    def table(self, head: int, lines: range, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of nodes (n,) and their values (n, count)."""
        width, wanted = self.width(head), self.announced(head)
        first, text = self.records(lines, 3 + width)
        if wanted is not None and wanted != len(first):
            raise self.error(head, f"{wanted} nodes announced, {len(first)} found")
        ids = self.numbers([self.lines[i][3 : 3 + width] for i in first], width, 1, int, first)
        return ids[:, 0], self.numbers(text, VALUE_WIDTH, count, float, first)

    def elements(
        self, head: int, lines: range, rows: _Rows
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Nodes and numbers of the elements, by type."""
        width, announced = self.width(head), self.announced(head)
        first, text = self.records(lines, 3)
        # an element of several layers is announced as one
        if announced is not None and announced > len(first):
            raise self.error(head, f"{announced} elements announced, {len(first)} found")
        of_type: dict[int, list[int]] = {}
        for k, line in enumerate(first):
            of_type.setdefault(self.whole(line, 3 + width, 8 + width), []).append(k)
        cells, cell_ids = {}, {}
        for number, own in of_type.items():
            begin = [first[k] for k in own]
            if number not in NUMBERED:
                raise self.error(begin[0], f"element type {number}: known are 1 to {max(NUMBERED)}")
            kind, count, order = NUMBERED[number]
            of_elements = [self.lines[i][3 : 3 + width] for i in begin]
            cell_ids[kind] = self.numbers(of_elements, width, 1, int, begin)[:, 0]
            # nodes stand in lines of ten or fifteen, or all in one
            of_nodes = [text[k][len(self.lines[first[k]].rstrip()) - 3 :] for k in own]
            ids = self.numbers(of_nodes, width, count, int, begin)
            cells[kind] = self.rows(rows, ids if order is None else ids[:, order], head)
        return cells, cell_ids

    def rows(self, rows: _Rows, ids: np.ndarray, head: int) -> np.ndarray:
        """Rows of nodes with these numbers."""
        found = rows.of(ids)
        if (found < 0).any():
            raise self.error(
                head,
                f"the block names node {ids[found < 0][0]}, which the file does not hold: is the mesh that of an "
                "earlier step?",
            )
        return found

    def field(self, place: int, rows: _Rows) -> tuple[str, FrdField]:
        """A block of results and its name."""
        head, name, components = self.heads[place], "", []
        while place + 1 < len(self.heads) and self.lines[self.heads[place + 1]][:3] in (b" -4", b" -5"):
            place += 1
            line = self.lines[self.heads[place]].rstrip()
            found = (_RESULT if line.startswith(b" -4") else _COMPONENT).fullmatch(line)
            if found is None:
                raise self.error(self.heads[place], f"{quoted(line)}: a name and whole numbers are expected")
            if found.re is _RESULT:
                name = found["name"].decode("latin-1")
            elif found["calculated"] != b"1":
                components.append(found["name"].decode("latin-1"))
        if not name or not components:
            raise self.error(head, "the block of results is cut off: it names no data")
        lines, text = self.block(place), self.lines[head][12:24]
        try:
            value = float(text)
        except ValueError:
            raise self.error(head, f"columns 13 to 24 hold {quoted(text)}: a number is expected") from None

        def values() -> np.ndarray:
            ids, of_ids = self.table(head, lines, len(components))
            of_nodes = np.full((rows.count, len(components)), np.nan)
            of_nodes[self.rows(rows, ids, head)] = of_ids
            return of_nodes

        analysis = self.lines[head][56:58].strip()
        of_mode = analysis == VIBRATION or (analysis == BUCKLING and value != 0)
        return name, FrdField(value, self.whole(head, 58, 63), tuple(components), of_mode, values)


class _Rows:
    """Where the nodes with some numbers are."""

    def __init__(self, node_ids: np.ndarray):
        self.order = np.argsort(node_ids)
        self.sorted = node_ids[self.order]
        self.count = len(node_ids)

    def of(self, ids: np.ndarray) -> np.ndarray:
        """Rows of the nodes, -1 where there is none."""
        if not self.count:
            return np.full(ids.shape, -1)
        at = np.minimum(np.searchsorted(self.sorted, ids), self.count - 1)
        return np.where(self.sorted[at] == ids, self.order[at], -1)
