"""The input files of CalculiX and Abaqus (.inp): what a mesh file does not keep of elements, sections and materials."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from slmm.mechanics.elements import element_named
from slmm.results.inp_lines import Block, Line, blocks, plain, real, whole
from slmm.results.inp_materials import AFTER_MATERIAL, OPTIONS, elasticity
from slmm.results.inp_model import InpModel, Section
from slmm.running.input_file import check_input

#: keywords, and types of initial conditions, after which stresses are no longer the answer to the displacements alone
BEYOND = re.compile("CHANGEMATERIAL|CHANGEPLASTIC|CHANGESOLIDSECTION|INITIALSTRAININCREASE|MODELCHANGE")
BEYOND_INITIAL = re.compile("STRESS|PLASTICSTRAIN")

#: assemblies number the elements of each part anew
NOT_FLAT = re.compile("PART|INSTANCE|ASSEMBLY")


#: numbers of nodes of elements without an entry in `slmm.mechanics.elements`, which tell where the next one begins
NODES = {
    **dict.fromkeys(("SPRING1", "MASS", "DCOUP3D"), 1),
    **dict.fromkeys(("B21", "B31", "B31R", "T2D2", "T3D2", "GAPUNI", "DASHPOTA", "SPRINGA", "SPRING2"), 2),
    **dict.fromkeys(("B32", "B32R", "T3D3", "D", "CAX3", "M3D3", "S3"), 3),
    **dict.fromkeys(("CAX4", "CAX4R", "M3D4", "M3D4R", "S4", "S4R", "F3D4"), 4),
    **dict.fromkeys(("CAX6", "M3D6", "S6", "F3D6"), 6),
    **dict.fromkeys(("CAX8", "CAX8R", "M3D8", "M3D8R", "S8", "S8R", "F3D8", "F3D8R"), 8),
}


def read_inp(path: str | Path) -> InpModel:
    """Read element types, sections and materials from an input file of CalculiX or Abaqus.

    Parameters
    ----------
    path : path
        A flat file, without *PART and *INSTANCE. Files that *INCLUDE names lie in its folder or below it, relative to
        that folder, as for CalculiX, or else to the file that names them.

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
    check_input(path)
    return _Reader(Path(path)).model()


class _Reader:
    """What has been read of a file so far."""

    def __init__(self, path: Path):
        self.path = path
        self.nodes: list[list[float]] = []
        self.ids: dict[str, list[int]] = {}
        self.rows: dict[str, list[list[int]]] = {}
        self.counts = dict(NODES)
        self.of_elements: dict[str, list[int]] = {}
        self.sets: list[Block] = []
        self.solid: list[tuple[Block, float | None]] = []
        self.options: dict[str, list[Block]] = {}
        self.beyond: str | None = None
        self.unlike: list[str] = []
        self.nlgeom = False

    def model(self) -> InpModel:
        """Everything, block by block."""
        readers: dict[str, Callable[[Block], None]] = {
            "NODE": self.node,
            "USERELEMENT": self.user_element,
            "ELEMENT": self.element,
            "ELSET": self.sets.append,
            "SOLIDSECTION": self.section,
            "SHELLSECTION": self.shell_section,
            "INITIALCONDITIONS": self.initial,
            "STEP": self.step,
            "MPC": self.mpc,
            "MODELCHANGE": self.model_change,
            "REFINEMESH": self.refine_mesh,
            "NODEFILE": self.output,
            "ELFILE": self.output,
        }
        material = last = None
        for block in blocks(self.path):
            if NOT_FLAT.fullmatch(block.keyword):
                raise block.line.error(
                    f"{block.called}: parts and instances are not read; write a flat file (in Abaqus/CAE: model "
                    "attributes, do not use parts and assemblies)"
                )
            if AFTER_MATERIAL.fullmatch(block.keyword):
                material = None
            if block.keyword == "STEP":
                last = None
            if block.keyword == "MATERIAL":
                material = last = block.named("NAME")
                self.options[material] = []
            elif material is not None:
                self.options[material].append(block)
            elif last is not None and OPTIONS.fullmatch(block.keyword):
                self.options[last].append(block)
            elif block.keyword in readers:
                readers[block.keyword](block)
            if BEYOND.fullmatch(block.keyword):
                self.beyond = f"{block.called} changes the model in between"
        return self.result()

    def node(self, block: Block) -> None:
        if block.parameters.get("SYSTEM", "R") != "R":
            raise block.line.error(
                f"SYSTEM={block.parameters['SYSTEM']}: only rectangular coordinates are read"
            )
        for line in block.data:
            # blanks are zeros, and the normal of a shell may follow the coordinates
            number, *at = line.numbers(real, blank="0")[:4]
            self.nodes.append([number, *at, *[0.0] * (3 - len(at))])

    def user_element(self, block: Block) -> None:
        count = block.line._replace(text=block.named("NODES")).numbers(whole)[0]
        self.counts[plain(block.named("TYPE"))] = count

    def element(self, block: Block) -> None:
        # heat transfer elements of Abaqus are those of the mechanics to CalculiX
        kind = re.sub("^D(?=C[^O]|S)", "", plain(block.named("TYPE")))
        try:
            count, known = len(element_named(kind).nodes), True
        except ValueError:
            count, known = self.counts.get(kind, 0), False
        ids, rows = self.ids.setdefault(kind, []), self.rows.setdefault(kind, [])
        before = len(ids)
        record: list[int] = []
        for line in block.data:
            record += line.numbers(whole, blank="" if known else "0")
            # elements of which nothing is known go on after a comma, the others until their nodes are complete
            if len(record) <= count or (not count and line.text.endswith(",")):
                continue
            ids.append(record[0])
            if known:
                # CalculiX passes over what more stands in the line
                rows.append(record[1 : count + 1])
            record = []
        if record:
            raise block.data[-1].error(f"element {record[0]} has {len(record) - 1} nodes: {kind} has {count}")
        if name := block.parameters.get("ELSET"):
            self.of_elements.setdefault(name, []).extend(ids[before:])

    def members(self, elements: np.ndarray) -> dict[str, np.ndarray]:
        """Numbers of the elements in each set, with the numbers of all elements, sorted, at hand."""
        sets = {name: np.array(ids, dtype=int) for name, ids in self.of_elements.items()}
        for block in self.sets:
            name = block.named("ELSET")
            parts = [sets.get(name, np.zeros(0, dtype=int))]
            for line in block.data:
                if "GENERATE" in block.parameters:
                    parts.append(self.generated(line, elements))
                    continue
                numbers = []
                for part in filter(None, line.fields):
                    if re.fullmatch(r"[+-]?\d+", part):
                        numbers += line._replace(text=part).numbers(whole)
                    elif (other := part.strip('"').upper()) in sets:
                        parts.append(sets[other])
                    else:
                        raise line.error(f"there is no element set {part[:80]!r} before this line")
                parts.append(np.array(numbers, dtype=int))
            sets[name] = np.concatenate(parts)
        return sets

    def generated(self, line: Line, elements: np.ndarray) -> np.ndarray:
        """Those of the elements that a line of first, last and increment means."""
        numbers = line.numbers(whole)
        if not 2 <= len(numbers) <= 3 or numbers[2:] == [0]:
            raise line.error(f"{line.quoted}: first, last and, if it is not 1, increment are expected")
        first, last, step = (*numbers, 1)[:3]
        if max(first, last) > (largest := elements.max(initial=0)):
            raise line.error(
                f"{line.quoted}: names elements that the file does not have: the last is {largest}"
            )
        low, high = (first, last) if step > 0 else (last, first)
        return elements[(low <= elements) & (elements <= high) & ((elements - first) % step == 0)]

    def section(self, block: Block) -> None:
        block.named("ELSET"), block.named("MATERIAL")
        thickness = None
        if block.data and block.data[0].fields[0]:
            thickness = block.data[0]._replace(text=block.data[0].fields[0]).numbers(real)[0]
        if "NODALTHICKNESS" in block.parameters:
            self.unlike.append(f"{block.called}, NODAL THICKNESS: plane elements of one thickness are read")
        self.solid.append((block, thickness))

    def shell_section(self, block: Block) -> None:
        if "COMPOSITE" in block.parameters:
            self.unlike.append(f"{block.called}, COMPOSITE, makes an element of each layer")

    def model_change(self, block: Block) -> None:
        if any(key in block.parameters for key in ("ADD", "REMOVE")) and "ELEMENT" in block.parameters.get(
            "TYPE", "ELEMENT"
        ):
            self.unlike.append(
                f"{block.called} takes elements away, or adds them, which the results do not tell"
            )

    def refine_mesh(self, block: Block) -> None:
        self.unlike.append(f"{block.called} makes elements of its own")

    def output(self, block: Block) -> None:
        if block.parameters.get("GLOBAL") == "NO":
            self.unlike.append(f"{block.called}, GLOBAL=NO, writes components in local directions")

    def initial(self, block: Block) -> None:
        kind = plain(block.parameters.get("TYPE", ""))
        if BEYOND_INITIAL.fullmatch(kind):
            self.beyond = f"*INITIAL CONDITIONS, TYPE={kind} strains elements beforehand"

    def step(self, block: Block) -> None:
        if "NLGEOM" in block.parameters and block.parameters["NLGEOM"] not in ("NO", "OFF"):
            self.nlgeom = True

    def mpc(self, block: Block) -> None:
        # CalculiX turns on large displacements for all but these, whatever the step says
        if any(line.fields[0].upper() != "MEANROT" for line in block.data[:1]):
            self.nlgeom = True

    def result(self) -> InpModel:
        """The model, once everything is read: CalculiX takes elements, sets and materials before sections."""
        ids = {kind: np.array(numbers, dtype=int) for kind, numbers in self.ids.items()}
        number, count = np.unique(np.concatenate([np.zeros(0, int), *ids.values()]), return_counts=True)
        if (count > 1).any():
            raise ValueError(f"{self.path}: element {number[count > 1][0]} is defined more than once")
        sets = self.members(number)
        found = {name: elasticity(name, options) for name, options in self.options.items()}
        if self.beyond is not None:
            found = dict.fromkeys(found, (None, self.beyond))
        sections = []
        for block, thickness in self.solid:
            name, material = block.parameters["ELSET"], block.parameters["MATERIAL"]
            if name not in sets:
                raise block.line.error(f"there is no element set {name[:80]}")
            if material not in found:
                raise block.line.error(f"there is no material {material[:80]}")
            sections.append(Section(np.unique(sets[name]), material, thickness))
        table = np.array(self.nodes, dtype=float).reshape(-1, 4)
        cells = {kind: np.array(rows, dtype=int) for kind, rows in self.rows.items() if rows}
        return InpModel(
            self.path,
            table[:, 0].astype(int),
            table[:, 1:],
            ids,
            cells,
            tuple(sections),
            {name: known for name, (known, _) in found.items()},
            {name: reason for name, (known, reason) in found.items() if known is None},
            self.nlgeom,
            tuple(dict.fromkeys(self.unlike)),
        )
