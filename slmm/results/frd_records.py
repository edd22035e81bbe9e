"""Lines of fixed columns, as .frd files have them: numbers may touch each other, and records go on in further lines."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

_LONG_EXPONENT = re.compile(rb"\s*(-?\d\.\d{5}E[+-]\d{3})")


class Records:
    """The lines of a file; errors name them.

    Parameters
    ----------
    path : path

    Raises
    ------
    OSError
        When the file cannot be opened.
    """

    def __init__(self, path: str | Path) -> None:
        """Read the lines."""
        self.path = path
        self.lines = Path(path).read_bytes().splitlines()

    def error(self, line: int, text: str) -> ValueError:
        """What is wrong in a line, counted from 0."""
        return ValueError(f"{self.path}, line {line + 1}: {text}")

    def whole(self, line: int, start: int, end: int) -> int:
        """The whole number in some columns of a line."""
        text = self.lines[line][start:end]
        if not re.fullmatch(rb" *-?\d+ *", text):
            raise self.error(line, f"columns {start + 1} to {end} hold {quoted(text)}: a number is expected")
        return int(text)

    def records(self, lines: range, skip: int) -> tuple[list[int], list[bytes]]:
        """First lines of the records, -1 with what follows it in -2, and what they hold after so many columns."""
        first, text = [], []
        for i in lines:
            line = self.lines[i]
            if line.startswith(b" -1"):
                first.append(i)
                text.append(line[skip:].rstrip())
            else:
                text[-1] += line[skip:].rstrip()
        return first, text

    def numbers(self, text: list[bytes], width: int, count: int, kind: type, lines: list[int]) -> np.ndarray:
        """Numbers (n, count) in columns of a width, of the records that begin in these lines.

        Where a program has written asterisks, since its number did not fit, the value is NaN.
        """
        if all(len(record) == count * width for record in text):
            columns = np.frombuffer(b"".join(text), f"S{width}").copy()
        else:
            columns = np.array(
                [
                    number
                    for line, record in zip(lines, text, strict=True)
                    for number in self.split(record, width, count, line)
                ]
            )
        if kind is float:
            columns[np.char.startswith(columns, b"*")] = b"nan"
        try:
            return columns.astype(kind).reshape(-1, count)
        except ValueError:
            wrong = [k for k, number in enumerate(columns.tolist()) if not _is(kind, number)]
        raise self.error(
            lines[wrong[0] // count],
            f"{quoted(columns[wrong[0]])} in place of a {'' if kind is float else 'whole '}number "
            f"({len(wrong)} of {len(columns)} in this block)",
        )

    def split(self, record: bytes, width: int, count: int, line: int) -> list[bytes]:
        """The numbers of a record, one by one."""
        if len(record) == count * width:
            return [record[i : i + width] for i in range(0, len(record), width)]
        # exponents of three digits need no columns: where less is left of a number, it is none
        long = _LONG_EXPONENT.findall(record)
        if len(long) != count or _LONG_EXPONENT.sub(b"", record):
            raise self.error(
                line, f"{len(record)} columns, not {count * width}, for {count} numbers: cut off or damaged"
            )
        return long


def _is(kind: type, text: bytes) -> bool:
    try:
        kind(text)
    except ValueError:
        return False
    return True


def quoted(text: bytes) -> str:
    """A piece of the file in an error message, no longer than a number or a name."""
    return repr(text[:40].decode("latin-1"))
