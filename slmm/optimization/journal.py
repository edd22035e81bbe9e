"""A journal of a search: every value that was computed, in an SQLite file that outlives a kill at any moment.

A search that is resumed runs again from its beginning with these values as its memory, and so ends as it would have
ended undisturbed. What a quick model of neighbours has judged is not in it, and is judged again.

The file has the tables ``run`` (what the run is, as JSON), ``session`` (each time it was started or resumed) and
``evaluation``: a design, by `slmm.optimization.evaluation.keys`, its value, NULL where the evaluation failed, the
session, and a checksum of design and value, without which a changed value would pass for a computed one. While it is
open it is locked. After a kill a second file, ``-wal``, belongs to it, until it is opened again.
"""

from __future__ import annotations

import json
import os
import sqlite3
import struct
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from slmm.running.input_file import input_problem, shown
from slmm.running.whole_file import NotWrittenError

#: values wait this long to be written, s
PATIENCE = 0.1
#: "slmm", by which SQLite tells an application's files
APPLICATION = int.from_bytes(b"slmm", "big")

TABLES = (
    "CREATE TABLE run (what TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE session (id INTEGER PRIMARY KEY, started TEXT NOT NULL)",
    "CREATE TABLE evaluation (design BLOB PRIMARY KEY, value REAL, session INTEGER NOT NULL, "
    "checksum INTEGER NOT NULL) WITHOUT ROWID",
)
#: what SQLite says of a disk, and not of a file
OF_THE_DISK = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_READONLY)


@dataclass
class Journal:
    """An open journal."""

    path: Path
    connection: sqlite3.Connection
    session: int
    waiting: dict[bytes, float] = field(default_factory=dict)
    written: float = field(default_factory=time.monotonic)

    def known(self) -> dict[bytes, float]:
        """All values by the designs' keys; NaN where the evaluation failed."""
        found = {}
        with _naming(self.path):
            for design, value, checksum in self.connection.execute(
                "SELECT design, value, checksum FROM evaluation"
            ):
                if not isinstance(design, bytes) or not isinstance(value, float | None):
                    raise ValueError("is damaged: a value that is none")
                if checksum != _checksum(design, value):
                    raise ValueError("is damaged: a value has changed since it was written")
                found[design] = float("nan") if value is None else value
        return found

    def add(self, found: Mapping[bytes, float]) -> None:
        """Write values, many at a time."""
        self.waiting.update(found)
        if time.monotonic() - self.written > PATIENCE:
            self.write()

    def write(self) -> None:
        """Write what waits."""
        values = {design: None if value != value else float(value) for design, value in self.waiting.items()}
        rows = [(key, value, self.session, _checksum(key, value)) for key, value in values.items()]
        with _naming(self.path), _transaction(self.connection):
            self.connection.executemany("INSERT OR REPLACE INTO evaluation VALUES (?, ?, ?, ?)", rows)
        self.waiting.clear()
        self.written = time.monotonic()


@contextmanager
def open_journal(path: str | Path, run: Mapping[str, Any], resume: bool = False) -> Iterator[Journal]:
    """The journal of a run.

    Parameters
    ----------
    path : str or Path
    run : mapping of str
        What the run is, of what JSON can hold.
    resume : bool
        Continue the run that is in the file, if there is one.

    Raises
    ------
    ValueError
        For a file that is there and shall not be resumed, is damaged, no journal or that of another run, or is in use.
    NotWrittenError
        When the disk is full, or cannot be written to.
    """
    path = Path(path)
    new = not os.path.lexists(path)
    if not new:
        if not resume:
            raise ValueError(f"journal {shown(path)}: is there already; resume it, or name another file")
        if problem := input_problem(path):
            raise ValueError(f"journal {shown(path)}: {problem}")
    with _naming(path):
        connection = sqlite3.connect(path, timeout=1.0, isolation_level=None)
    with closing(connection):
        try:
            with _naming(path):
                _begin(connection, run)
                session = _new_session(connection)
        except NotWrittenError:
            if new:  # without tables it would be in the way of the next run
                connection.close()
                path.unlink(missing_ok=True)
            raise
        journal = Journal(path, connection, session)
        try:
            yield journal
        except NotWrittenError:
            raise  # writing what still waits would fail again
        except BaseException:
            journal.write()
            raise
        journal.write()


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Errors of SQLite and of what a file holds, with the file's name."""
    try:
        yield
    except sqlite3.Error as error:
        # a code has its details above the lowest eight bits; errors of the module itself have none
        if getattr(error, "sqlite_errorcode", 0) & 0xFF in OF_THE_DISK:
            raise NotWrittenError(f"journal {shown(path)}: cannot be written: {error}") from error
        raise ValueError(f"journal {shown(path)}: cannot be read: {error}") from error
    except (ValueError, RecursionError) as error:
        raise ValueError(f"journal {shown(path)}: {error}") from error


def _checksum(design: bytes, value: float | None) -> int:
    return zlib.crc32(design + (b"" if value is None else struct.pack("<d", value)))


def _begin(connection: sqlite3.Connection, run: Mapping[str, Any]) -> None:
    """Make a new file this run's, or see that it is."""
    # one lock for as long as it is open: no memory is shared with other processes, and none of them writes
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")
    new = not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if not new:
        _check(connection, run)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    if new:
        with _transaction(connection):
            connection.execute(f"PRAGMA application_id = {APPLICATION}")
            for statement in TABLES:
                connection.execute(statement)
            items = [(what, json.dumps(value)) for what, value in run.items()]
            connection.executemany("INSERT INTO run VALUES (?, ?)", items)


def _check(connection: sqlite3.Connection, run: Mapping[str, Any]) -> None:
    """Refuse a file that is not this run's."""
    if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise ValueError("is a database, but no journal of a search")
    # those that SQLite makes itself, for keys, have no text
    made = connection.execute("SELECT sql FROM sqlite_master WHERE sql NOT NULL ORDER BY rowid")
    if [sql for (sql,) in made] != [*TABLES]:
        raise ValueError("has other tables than the journals of this version")
    (sound,) = connection.execute("PRAGMA integrity_check(1)").fetchone()
    if sound != "ok":
        raise ValueError(f"is damaged: {' '.join(sound.split())}")
    rows = connection.execute("SELECT what, value FROM run")
    its = {what: json.loads(value) for what, value in rows}
    this = json.loads(json.dumps(run))
    if differ := [what for what in this if its.get(what) != this[what]]:
        theirs, ours = (", ".join(f"{what} = {a.get(what)}" for what in differ) for a in (its, this))
        raise ValueError(f"is that of another run, with {theirs}; this one has {ours}")


def _new_session(connection: sqlite3.Connection) -> int:
    now = datetime.now(UTC).isoformat(timespec="seconds")
    with _transaction(connection):
        return int(connection.execute("INSERT INTO session (started) VALUES (?)", [now]).lastrowid or 0)


@contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """All of it or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
    except BaseException:
        connection.execute("ROLLBACK")
        raise
    connection.execute("COMMIT")
