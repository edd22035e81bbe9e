"""Lines of the input files of CalculiX and Abaqus (.inp): keywords with their parameters and data, across *INCLUDE.

A keyword line begins with one asterisk, a comment with two; what follows a keyword line is its data. Keywords, types
and names are the same in capitals or not.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

#: a number as Fortran reads it: 1.5, .5, 5., 1.5e3, 1.5d3, 1.5D+3, 1.5+3
_REAL = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[EeDdQq]([+-]?\d+)|([+-]\d+))?")

#: numbers that arrays hold
_WHOLE = re.compile(r"[+-]?\d{1,18}")

_INCLUDE = re.compile(r"\*\s*include\b", re.IGNORECASE)
_INPUT = re.compile(r"\binput\s*=\s*(.+)", re.IGNORECASE)

#: files within files: as many as CalculiX takes; and files in all, of which small ones that name each other twice
#: would else become as many as there are atoms (chosen)
INCLUDE_DEPTH, INCLUDES = 9, 1000


def real(text: str) -> float:
    """A finite number as Fortran reads it.

    Raises
    ------
    ValueError
        When it is none.

    Examples
    --------
    >>> real("2.1d5"), real("1.5+3"), real(" .3 ")
    (210000.0, 1500.0, 0.3)
    """
    found = _REAL.fullmatch(text.strip())
    if found is None or not math.isfinite(value := float(f"{found[1]}e{found[2] or found[3] or 0}")):
        raise ValueError(f"{text!r} is no finite number")
    return value


def whole(text: str) -> int:
    """A whole number.

    Raises
    ------
    ValueError
        When it is none, or has more than 18 digits.
    """
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is no whole number")
    return int(text)


class Line(NamedTuple):
    """A line with the place it comes from."""

    path: Path
    number: int
    text: str

    def error(self, text: str) -> ValueError:
        """What is wrong in it."""
        return ValueError(f"{self.path}, line {self.number}: {text}")

    @property
    def quoted(self) -> str:
        """Its text in an error message, no longer than a line on a screen."""
        return repr(self.text if len(self.text) <= 80 else f"{self.text[:77]}...")

    @property
    def fields(self) -> list[str]:
        """What stands between its commas; a comma at the end separates nothing."""
        return [part.strip() for part in self.text.rstrip(", \t").split(",")]

    def numbers(self, kind: Callable[[str], int] | Callable[[str], float], blank: str = "") -> list:
        """Its fields as numbers; what a blank one stands for may be given."""
        try:
            return [kind(part or blank) for part in self.fields]
        except ValueError:
            what = "whole numbers" if kind is whole else "numbers"
            raise self.error(f"{self.quoted}: {what} are expected") from None


@dataclass(frozen=True)
class Block:
    """A keyword line with its data."""

    line: Line
    keyword: str
    parameters: dict[str, str]
    data: list[Line]

    @property
    def called(self) -> str:
        """The keyword as it is written."""
        return self.line.fields[0][:40].upper()

    def named(self, parameter: str) -> str:
        """A parameter that must be there."""
        if not self.parameters.get(parameter):
            raise self.line.error(f"{self.called} has no {parameter}")
        return self.parameters[parameter]


def plain(text: str) -> str:
    """Without blanks, in capitals."""
    return "".join(text.split()).upper()


def blocks(path: Path) -> Iterator[Block]:
    """The keywords of a file; what stands before the first one is passed over, as CalculiX does.

    Raises
    ------
    OSError
        When a file cannot be opened.
    ValueError
        When there is no keyword, or an included file is not there or not allowed; the message names file and line.
    """
    keyword: Line | None = None
    data: list[Line] = []
    for line in _Files(path).lines(path):
        if line.text.startswith("*"):
            if keyword is not None:
                yield _block(keyword, data)
            keyword, data = line, []
        elif keyword is not None and not data and _goes_on(keyword, line):
            keyword = keyword._replace(text=keyword.text + line.text)
        elif keyword is not None:
            data.append(line)
    if keyword is None:
        raise ValueError(f"{path}: holds no keyword, such as *NODE: is it an input file?")
    yield _block(keyword, data)


def _goes_on(keyword: Line, line: Line) -> bool:
    """Abaqus goes on with parameters in the next line; names of sets may be data as well."""
    if not keyword.text.endswith(",") or not line.text[0].isalpha():
        return False
    return "=" in line.text or not plain(keyword.text).startswith(("*ELSET", "*NSET"))


def _block(line: Line, data: list[Line]) -> Block:
    name, *parameters = line.fields
    values = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        values[plain(key)] = value.strip().strip('"').upper()
    return Block(line, plain(name.lstrip("*")), values, data)


class _Files:
    """A file and what it includes, all of which lies in its folder: a file of others reads none of its reader's."""

    def __init__(self, path: Path):
        self.folder = path.parent
        self.left = INCLUDES

    def lines(self, path: Path, including: tuple[Path, ...] = ()) -> Iterator[Line]:
        """Lines without comments, those of included files in their place."""
        content = path.read_text(encoding="utf-8-sig", errors="replace")
        for number, text in enumerate(re.split(r"\r\n|\n|\r", content), 1):
            text = text.strip()
            if not text or plain(text[:80]).startswith("**"):
                continue
            line = Line(path, number, text)
            if not _INCLUDE.match(text):
                yield line
                continue
            within = (*including, path.resolve())
            if len(within) > INCLUDE_DEPTH:
                raise line.error(f"*INCLUDE within more than {INCLUDE_DEPTH} files")
            self.left -= 1
            if self.left < 0:
                raise line.error(f"more than {INCLUDES} files are included")
            yield from self.lines(self.included(line, within), within)

    def included(self, line: Line, within: tuple[Path, ...]) -> Path:
        """The file that a line names, as CalculiX finds it, or beside the file that names it."""
        named = _INPUT.search(line.text)
        if named is None:
            raise line.error("*INCLUDE has no INPUT")
        if "\0" in named[1]:
            raise line.error(f"{line.quoted}: no name of a file")
        name = Path(named[1].strip().strip("\"'"))
        found = [folder / name for folder in (self.folder, line.path.parent)]
        try:
            outside = not all(file.resolve().is_relative_to(self.folder.resolve()) for file in found)
            if name.is_absolute() or ".." in name.parts or outside:
                raise line.error(
                    f"{line.quoted}: only files in the folder of {within[0].name}, or below it, are read"
                )
            for file in found:
                if file.resolve() in within:
                    raise line.error(f"{file} includes itself")
                if file.is_file():
                    return file
        except (OSError, RuntimeError) as error:  # a name that is too long, links that go round
            raise line.error(f"{line.quoted}: {type(error).__name__}") from error
        raise line.error(f"{found[0]}: no such file")
