"""The input files of CalculiX and Abaqus (.inp): what a mesh file does not keep of elements, sections and materials.

A keyword line begins with one asterisk, a comment with two; what follows a keyword line is its data. Keywords, types
and names are the same in capitals or not.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from slmm.fem.elasticity import Elasticity
from slmm.fem.elements import element_named

#: options of a material that leave it linear elastic
HARMLESS = re.compile(
    "CONDUCTIVITY|DAMPING|DENSITY|ELECTRICALCONDUCTIVITY|MAGNETICPERMEABILITY|SPECIFICGASCONSTANT|SPECIFICHEAT"
)

#: keywords that end the options of a material; any other is taken for one, so that no option is passed over
AFTER_MATERIAL = re.compile(
    ".*SECTION|AMPLITUDE|BOUNDARY|CLEARANCE|CONTACT.*|CONTROLS|COUPLING|CYCLICSYMMETRYMODEL|DASHPOT|DESIGNVARIABLES|"
    "DISTRIBUTING.*|DISTRIBUTION|ELEMENT|ELSET|EQUATION|FRICTION|GAP|HEADING|INITIALCONDITIONS|KINEMATIC|MASS|"
    "MATERIAL|MPC|NODALTHICKNESS|NODE|NORMAL|NSET|ORIENTATION|PHYSICALCONSTANTS|PREPRINT|RESTART|RIGIDBODY|SPRING|"
    "STEP|SUBMODEL|SURFACE.*|TIE|TIMEPOINTS|TRANSFORM|VALUESATINFINITY"
)

#: keywords, and types of initial conditions, after which stresses are no longer the answer to the displacements alone
BEYOND = re.compile("CHANGEMATERIAL|CHANGEPLASTIC|CHANGESOLIDSECTION|INITIALSTRAININCREASE|MODELCHANGE")
BEYOND_INITIAL = re.compile("STRESS|PLASTICSTRAIN")

#: assemblies number the elements of each part anew
NOT_FLAT = re.compile("PART|INSTANCE|ASSEMBLY")


_INCLUDE = re.compile(r"\*\s*include\b", re.IGNORECASE)
_INPUT = re.compile(r"\binput\s*=\s*(.+)", re.IGNORECASE)


class Section(NamedTuple):
    """A *SOLID SECTION: elements, sorted by their numbers, their material, and the thickness that the line states."""

    elements: np.ndarray
    material: str
    thickness: float | None


@dataclass(frozen=True)
class InpModel:
    """What an input file says about solid and plane elements; names are in capitals.

    Parameters
    ----------
    path : Path
    node_ids, nodes : ndarray (n,), (n, 3)
        Numbers and coordinates of the nodes.
    cell_ids : dict of str to ndarray (el,)
        Numbers of the elements of each type, such as CPE8R.
    cells : dict of str to ndarray (el, k)
        Numbers of their nodes, for the types of `slmm.fem.elements`.
    sections : tuple of Section
    materials : dict of str to Elasticity or None
        None where a material is not isotropic and linear elastic.
    reasons : dict of str to str
        Why, for these materials.
    nlgeom : bool
        Whether any step is geometrically nonlinear.
    """

    path: Path
    node_ids: np.ndarray
    nodes: np.ndarray
    cell_ids: dict[str, np.ndarray]
    cells: dict[str, np.ndarray]
    sections: tuple[Section, ...]
    materials: dict[str, Elasticity | None]
    reasons: dict[str, str]
    nlgeom: bool

    def types_of(self, ids: np.ndarray) -> np.ndarray:
        """Element types (el,) by the elements' numbers.

        Raises
        ------
        ValueError
            When there is no such element.
        """
        number, kind = self._types
        ids = np.asarray(ids)
        at = np.minimum(np.searchsorted(number, ids), max(len(number) - 1, 0))
        missing = ids[number[at] != ids] if len(number) else ids
        if len(missing):
            raise ValueError(
                f"{self.path}: has no element {missing[0]} ({len(missing)} of {len(ids)} such elements)"
            )
        return kind[at]

    def section_of(self, ids: np.ndarray) -> np.ndarray:
        """Places (el,) in ``sections`` by the elements' numbers; the last section that names an element is its own.

        Raises
        ------
        ValueError
            When an element has no section.
        """
        ids = np.asarray(ids)
        place = np.full(len(ids), -1)
        for k, section in enumerate(self.sections):
            place[np.isin(ids, section.elements)] = k
        missing = ids[place < 0]
        if len(missing):
            raise ValueError(
                f"{self.path}: element {missing[0]} has no *SOLID SECTION ({len(missing)} of {len(ids)} such elements)"
            )
        return place

    @cached_property
    def _types(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of all elements, sorted, and their types."""
        number = np.concatenate([np.zeros(0, int), *self.cell_ids.values()])
        kind = np.repeat(np.array([*self.cell_ids], dtype=str), [len(ids) for ids in self.cell_ids.values()])
        order = np.argsort(number)
        return number[order], kind[order]


def read_inp(path: str | Path) -> InpModel:
    """Read element types, sections and materials from an input file of CalculiX or Abaqus.

    Parameters
    ----------
    path : path
        A flat file, without *PART and *INSTANCE. Files that *INCLUDE names lie relative to the file that names them.

    Raises
    ------
    OSError
        When a file cannot be opened.
    ValueError
        When what is read of it is wrong; the message names file and line.

    Notes
    -----
    A material is linear elastic when it has one line of *ELASTIC for isotropic materials, no option that makes it
    something else, and nothing in the file strains elements beforehand (initial stresses, elements that are removed).
    Options for thermal expansion count as something else. Keywords that say nothing about this are skipped.

    Examples
    --------
    >>> model = read_inp("tests/data/mixed_2d.inp")
    >>> {kind: ids.tolist() for kind, ids in model.cell_ids.items()}
    {'CPS8': [1], 'CPS6': [2, 3], 'CPS4': [4], 'CPS3': [5, 6]}
    >>> model.materials, model.nlgeom
    ({'M': Elasticity(E=2960.0, nu=0.35, state='plane strain')}, False)
    """
    return _Reader(Path(path)).model()


class _Line(NamedTuple):
    """A line with the place it comes from."""

    path: Path
    number: int
    text: str

    def error(self, text: str) -> ValueError:
        return ValueError(f"{self.path}, line {self.number}: {text}")

    @property
    def fields(self) -> list[str]:
        """What stands between its commas; a comma at the end separates nothing."""
        return [part.strip() for part in self.text.rstrip(", \t").split(",")]

    def numbers(self, kind: Callable[[str], int] | Callable[[str], float]) -> list:
        try:
            return [kind(part) for part in self.text.rstrip(", \t").split(",")]
        except ValueError:
            what = "whole numbers" if kind is int else "numbers"
            raise self.error(f"{self.text!r}: {what} are expected") from None


@dataclass(frozen=True)
class _Block:
    """A keyword line with its data."""

    line: _Line
    keyword: str
    parameters: dict[str, str]
    data: list[_Line]

    @property
    def called(self) -> str:
        """The keyword as it is written."""
        return self.line.fields[0].upper()

    def named(self, parameter: str) -> str:
        """A parameter that must be there."""
        if not self.parameters.get(parameter):
            raise self.line.error(f"{self.called} has no {parameter}")
        return self.parameters[parameter]


def _lines(path: Path, including: tuple[Path, ...] = ()) -> Iterator[_Line]:
    """Lines without comments, those of included files in their place."""
    text = path.read_text(encoding="utf-8", errors="replace")
    for number, content in enumerate(text.splitlines(), 1):
        content = content.strip()
        if not content or content.startswith("**"):
            continue
        line = _Line(path, number, content)
        if not _INCLUDE.match(content):
            yield line
            continue
        named = _INPUT.search(content)
        if named is None:
            raise line.error("*INCLUDE has no INPUT")
        included = path.parent / named[1].strip().strip("\"'")
        if included.resolve() in (path.resolve(), *including):
            raise line.error(f"{included} includes itself")
        if not included.is_file():
            raise line.error(f"{included}: no such file")
        yield from _lines(included, (*including, path.resolve()))


def _blocks(path: Path) -> Iterator[_Block]:
    """The keywords of a file; blanks within them and capitals do not count."""
    keyword: _Line | None = None
    data: list[_Line] = []
    for line in _lines(path):
        if line.text.startswith("*"):
            if keyword is not None:
                yield _block(keyword, data)
            keyword, data = line, []
        elif keyword is None:
            raise line.error(f"{line.text!r}: no keyword stands before it; is this an input file?")
        elif not data and keyword.text.endswith(",") and line.text[0].isalpha():
            # Abaqus goes on with parameters in the next line
            keyword = keyword._replace(text=keyword.text + line.text)
        else:
            data.append(line)
    if keyword is not None:
        yield _block(keyword, data)


def _block(line: _Line, data: list[_Line]) -> _Block:
    name, *parameters = line.fields
    values = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        values[_plain(key)] = value.strip().strip('"').upper()
    return _Block(line, _plain(name.lstrip("*")), values, data)


def _plain(text: str) -> str:
    return "".join(text.split()).upper()


class _Reader:
    """What has been read of a file so far."""

    def __init__(self, path: Path):
        self.path = path
        self.nodes: list[list[float]] = []
        self.ids: dict[str, list[int]] = {}
        self.rows: dict[str, list[list[int]]] = {}
        self.sets: dict[str, list[int]] = {}
        self.solid: list[tuple[_Block, float | None]] = []
        self.options: dict[str, list[_Block]] = {}
        self.beyond: str | None = None
        self.nlgeom = False

    def model(self) -> InpModel:
        """Everything, block by block."""
        readers: dict[str, Callable[[_Block], None]] = {
            "NODE": self.node,
            "ELEMENT": self.element,
            "ELSET": self.elset,
            "SOLIDSECTION": self.section,
            "INITIALCONDITIONS": self.initial,
            "STEP": self.step,
        }
        material: str | None = None
        for block in _blocks(self.path):
            if NOT_FLAT.fullmatch(block.keyword):
                raise block.line.error(
                    f"{block.called}: parts and instances are not read; write a flat file (in Abaqus/CAE: model "
                    "attributes, do not use parts and assemblies)"
                )
            if AFTER_MATERIAL.fullmatch(block.keyword):
                material = None
            if block.keyword == "MATERIAL":
                material = block.named("NAME")
                self.options[material] = []
            elif material is not None:
                self.options[material].append(block)
            elif block.keyword in readers:
                readers[block.keyword](block)
            if BEYOND.fullmatch(block.keyword):
                self.beyond = f"{block.called} changes the model in between"
        return self.result()

    def node(self, block: _Block) -> None:
        if block.parameters.get("SYSTEM", "R") != "R":
            raise block.line.error(
                f"SYSTEM={block.parameters['SYSTEM']}: only rectangular coordinates are read"
            )
        for line in block.data:
            # blanks are zeros, and the normal of a shell may follow the coordinates
            number, *at = line.numbers(lambda part: float(part.strip() or 0))[:4]
            self.nodes.append([number, *at, *[0.0] * (3 - len(at))])

    def element(self, block: _Block) -> None:
        kind = _plain(block.named("TYPE"))
        try:
            count = len(element_named(kind).nodes)
        except ValueError:
            count = 0
        ids, rows = self.ids.setdefault(kind, []), self.rows.setdefault(kind, [])
        before = len(ids)
        record: list[int] = []
        for line in block.data:
            record += line.numbers(int)
            # elements that are not known go on after a comma, the others until their nodes are complete
            if len(record) <= count or (not count and line.text.endswith(",")):
                continue
            if count and len(record) > count + 1:
                raise line.error(f"element {record[0]} has {len(record) - 1} nodes: {kind} has {count}")
            ids.append(record[0])
            if count:
                rows.append(record[1:])
            record = []
        if record:
            raise block.data[-1].error(f"element {record[0]} has {len(record) - 1} nodes: {kind} has {count}")
        if name := block.parameters.get("ELSET"):
            self.sets.setdefault(name, []).extend(ids[before:])

    def elset(self, block: _Block) -> None:
        name = block.named("ELSET")
        members = self.sets.setdefault(name, [])
        for line in block.data:
            if "GENERATE" in block.parameters:
                numbers = line.numbers(int)
                if not 2 <= len(numbers) <= 3 or numbers[2:] == [0]:
                    raise line.error(
                        f"{line.text!r}: first, last and, if it is not 1, increment are expected"
                    )
                step = numbers[2] if len(numbers) == 3 else 1
                members.extend(range(numbers[0], numbers[1] + (1 if step > 0 else -1), step))
                continue
            for part in filter(None, line.fields):
                if re.fullmatch(r"[+-]?\d+", part):
                    members.append(int(part))
                elif (other := part.strip('"').upper()) in self.sets:
                    members.extend(self.sets[other])
                else:
                    raise line.error(f"there is no element set {part!r} before this line")

    def section(self, block: _Block) -> None:
        block.named("ELSET"), block.named("MATERIAL")
        thickness = None
        if block.data and block.data[0].fields[0]:
            thickness = block.data[0]._replace(text=block.data[0].fields[0]).numbers(float)[0]
        self.solid.append((block, thickness))

    def initial(self, block: _Block) -> None:
        kind = _plain(block.parameters.get("TYPE", ""))
        if BEYOND_INITIAL.fullmatch(kind):
            self.beyond = f"*INITIAL CONDITIONS, TYPE={kind} strains elements beforehand"

    def step(self, block: _Block) -> None:
        if "NLGEOM" in block.parameters and block.parameters["NLGEOM"] not in ("NO", "OFF"):
            self.nlgeom = True

    def elasticity(self, material: str) -> tuple[Elasticity | None, str]:
        """A material's elasticity, or why there is none."""
        options = self.options[material]
        other = [b for b in options if b.keyword != "ELASTIC" and not HARMLESS.fullmatch(b.keyword)]
        elastic = [block for block in options if block.keyword == "ELASTIC"]
        if self.beyond is not None:
            return None, self.beyond
        if other:
            return None, f"{material} has {other[0].called}"
        if not elastic:
            return None, f"{material} has no *ELASTIC"
        line, data = elastic[-1].line, elastic[-1].data
        kind = _plain(elastic[-1].parameters.get("TYPE", "ISO"))
        if kind not in ("ISO", "ISOTROPIC"):
            return None, f"{material} has *ELASTIC, TYPE={kind}"
        if len(data) > 1:
            return None, f"{material} has *ELASTIC for {len(data)} temperatures"
        if not data or len(data[0].fields) < 2:
            raise line.error("*ELASTIC needs Young's modulus and Poisson's ratio")
        E, nu, *_ = data[0].numbers(float)
        try:
            return Elasticity(E, nu), ""
        except ValueError as error:
            raise data[0].error(str(error)) from error

    def result(self) -> InpModel:
        """The model, once everything is read."""
        found = {material: self.elasticity(material) for material in self.options}
        sections = []
        for block, thickness in self.solid:
            name, material = block.parameters["ELSET"], block.parameters["MATERIAL"]
            if name not in self.sets:
                raise block.line.error(f"there is no element set {name}")
            if material not in found:
                raise block.line.error(f"there is no material {material}")
            sections.append(Section(np.unique(np.array(self.sets[name], dtype=int)), material, thickness))
        ids = {kind: np.array(numbers, dtype=int) for kind, numbers in self.ids.items()}
        number, count = np.unique(np.concatenate([np.zeros(0, int), *ids.values()]), return_counts=True)
        if (count > 1).any():
            raise ValueError(f"{self.path}: element {number[count > 1][0]} is defined more than once")
        table = np.array(self.nodes, dtype=float).reshape(-1, 4)
        cells = {kind: np.array(rows, dtype=int) for kind, rows in self.rows.items() if rows}
        return InpModel(
            self.path,
            table[:, 0].astype(int),
            table[:, 1:],
            ids,
            cells,
            tuple(sections),
            {material: elasticity for material, (elasticity, _) in found.items()},
            {material: reason for material, (elasticity, reason) in found.items() if elasticity is None},
            self.nlgeom,
        )
