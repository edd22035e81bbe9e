"""A journal of records, one a line, that outlives a kill at any moment.

The first line says what the run is; every other one is a record as JSON, the last one how it ended. Each line begins
with a checksum, without which a changed number would pass for a computed one. Numbers are written so that they are read
back to the bit. A line that a kill has cut is dropped when the journal is opened again.

While it is open it is locked, where the system has such locks (not on Windows).
"""

from __future__ import annotations

import contextlib
import json
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import FileIO
from pathlib import Path
from typing import Any

from slmm.running.input_file import input_problem, shown
from slmm.running.whole_file import NotWrittenError

#: of the lines
FORMAT = 1


@dataclass
class LineJournal:
    """An open journal.

    Attributes
    ----------
    path : Path
    file : FileIO
    records : list of dict
        What was in it when it was opened, without the first line.
    end : dict or None
        How the run had ended by then.
    """

    path: Path
    file: FileIO
    records: list[dict[str, Any]] = field(default_factory=list)
    end: dict[str, Any] | None = None

    def add(self, record: Mapping[str, Any]) -> None:
        """Write a record, at once.

        Raises
        ------
        NotWrittenError
            When the disk is full, or cannot be written to.
        """
        left = _line(record)
        with _naming(self.path):
            while left:
                left = left[self.file.write(left) :]

    def add_end(self, record: Mapping[str, Any]) -> None:
        """Write how the run ended; raises as `add`."""
        self.add({"ended": record})


@contextmanager
def open_lines(
    path: str | Path, run: Mapping[str, Any], resume: bool = False, keep: int | None = None
) -> Iterator[LineJournal]:
    """The journal of a run.

    Parameters
    ----------
    path : str or Path
        What is there of a run that has ended gives way, unless it shall be resumed.
    run : mapping of str
        What the run is, of what JSON can hold.
    resume : bool
        Continue the run that is in the file, if there is one.
    keep : int, optional
        Behind so many of its records; what follows them, its end too, is dropped from the file.

    Raises
    ------
    ValueError
        For the file of a run that has not ended and shall not be resumed, one that is damaged, no journal or that of
        another run, in use, or with fewer records than shall be kept.
    NotWrittenError
        When the disk is full, or cannot be written to.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with open_lines(Path(folder, "run.jsonl"), {"increment": 2.0}) as journal:
    ...         journal.add({"u": 0.1})
    ...     with open_lines(Path(folder, "run.jsonl"), {"increment": 2.0}, resume=True) as journal:
    ...         print(journal.records)
    [{'u': 0.1}]
    """
    path = Path(path)
    if keep and not os.path.lexists(path):
        raise ValueError(f"journal {shown(path)}: is not there, and holds no {keep} steps")
    if os.path.lexists(path) and (problem := input_problem(path)):
        raise ValueError(f"journal {shown(path)}: {problem}")
    with _naming(path):
        file = FileIO(path, "a+")
    with file:
        with _naming(path):
            _lock(file)
            journal = _read(path, file, run, resume, keep)
        size = file.tell()
        try:
            if not size:
                journal.add({"slmm": FORMAT, "run": run})
            yield journal
        except BaseException:
            # without a record it would be in the way of the next run
            if not size and file.tell() <= len(_line({"slmm": FORMAT, "run": run})):
                path.unlink(missing_ok=True)
            raise


def _read(path: Path, file: FileIO, run: Mapping[str, Any], resume: bool, keep: int | None) -> LineJournal:
    """What is in a file; it ends then where something may be written."""
    file.seek(0)
    content = file.readall()
    whole = content[: content.rfind(b"\n") + 1]
    records = [_record(number, line) for number, line in enumerate(whole.splitlines(), 1)]
    if not records:
        if not _line({"slmm": FORMAT, "run": run}).startswith(content):
            raise ValueError("is no journal of a simulation")
        if keep:
            raise ValueError(f"holds no steps, and cannot go on behind step {keep}")
        return LineJournal(path, _cut(file, 0))
    first = records.pop(0)
    if first.get("slmm") != FORMAT:
        raise ValueError(f"has the format {first.get('slmm')}; this version of slmm reads {FORMAT}")
    end = records.pop()["ended"] if records and "ended" in records[-1] else None
    if not resume:
        if end is None:
            raise ValueError("is there already; resume it, or name another file")
        return LineJournal(path, _cut(file, 0))
    its, this = first["run"], json.loads(json.dumps(run))
    if differ := [what for what in {**this, **its} if its.get(what) != this.get(what)]:
        theirs, ours = (", ".join(f"{what} = {a.get(what)}" for what in differ) for a in (its, this))
        raise ValueError(f"is that of another run, with {theirs}; this one has {ours}")
    if keep is None:
        return LineJournal(path, _cut(file, len(whole)), records, end)
    if keep > len(records):
        raise ValueError(f"holds {len(records)} steps, and cannot go on behind step {keep}")
    size = sum(map(len, whole.splitlines(keepends=True)[: 1 + keep]))
    return LineJournal(path, _cut(file, size), records[:keep])


def _cut(file: FileIO, size: int) -> FileIO:
    """A file without what is behind its first bytes, and at its end."""
    file.truncate(size)
    file.seek(size)
    return file


def _line(record: Mapping[str, Any]) -> bytes:
    text = json.dumps(record).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def _record(number: int, line: bytes) -> dict[str, Any]:
    """What a line says."""
    checksum, _, text = line.partition(b" ")
    if len(checksum) != 8 or not text.startswith(b"{"):
        raise ValueError("is no journal of a simulation" if number == 1 else f"is damaged in line {number}")
    if checksum != b"%08x" % zlib.crc32(text):
        raise ValueError(f"is damaged: line {number} has changed since it was written")
    record: dict[str, Any] = json.loads(text)
    return record


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Errors of the disk and of what a file holds, with the file's name."""
    try:
        yield
    except OSError as error:
        raise NotWrittenError(
            f"journal {shown(path)}: cannot be written: {error.strerror or error}"
        ) from error
    except (ValueError, RecursionError) as error:
        raise ValueError(f"journal {shown(path)}: {error}") from error


def _lock(file: FileIO) -> None:
    """Keep other processes from going on with the same run at the same time."""
    with contextlib.suppress(ImportError):
        import fcntl

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ValueError("is in use by another process") from None
