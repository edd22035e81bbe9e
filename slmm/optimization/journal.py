"""A journal of a search: every value that was computed, in an SQLite file that outlives a kill at any moment.

A search that is resumed runs again from its beginning with these values as its memory, and so ends as it would have
ended undisturbed. What a quick model of neighbours has judged is not in it, and is judged again.

The file has the tables ``run`` (what the run is, as JSON), ``session`` (each time it was started or resumed) and
``evaluation``: a design, by `slmm.optimization.memory.keys`, its value, NULL where the evaluation failed, the
session, and a checksum of design and value, without which a changed value would pass for a computed one. Designs of a
problem of one by one may stand in two more: ``bound`` has what a value is at least, and ``failure`` why an evaluation
failed, and with which limit. A design may stand in all three: it has been asked about with several limits.

While the file is open it is locked. After a kill a second file, ``-wal``, belongs to it, until it is opened again.
"""

from __future__ import annotations

import json
import os
import sqlite3
import struct
import time
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from slmm.optimization.memory import Memory
from slmm.optimization.problem import Bound, Value
from slmm.optimization.workers import Failure
from slmm.running.input_file import input_problem, shown
from slmm.running.whole_file import NotWrittenError

#: values wait this long to be written, s
PATIENCE = 0.1
#: "slmm", by which SQLite tells an application's files
APPLICATION = int.from_bytes(b"slmm", "big")

#: 1, which SQLite has as 0, had values alone; it is read, and becomes 2
FORMAT = 2
#: those of format 1
FIRST_TABLES = (
    "CREATE TABLE run (what TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE session (id INTEGER PRIMARY KEY, started TEXT NOT NULL)",
    "CREATE TABLE evaluation (design BLOB PRIMARY KEY, value REAL, session INTEGER NOT NULL, "
    "checksum INTEGER NOT NULL) WITHOUT ROWID",
)
MORE_TABLES = (
    "CREATE TABLE bound (design BLOB PRIMARY KEY, least REAL NOT NULL, session INTEGER NOT NULL, "
    "checksum INTEGER NOT NULL) WITHOUT ROWID",
    "CREATE TABLE failure (design BLOB PRIMARY KEY, below REAL NOT NULL, reason TEXT NOT NULL, "
    "session INTEGER NOT NULL, checksum INTEGER NOT NULL) WITHOUT ROWID",
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

    def memory(self) -> Memory:
        """All that is in it."""
        memory = Memory(journal=self)
        for design, value in self.rows("evaluation", "value", float | None):
            memory.values[design] = float("nan") if value is None else value
        for design, least in self.rows("bound", "least", float):
            memory.bounds[design] = least
        for design, below, reason in self.rows("failure", "below, reason", float, str):
            memory.failures[design] = below, reason
        return memory

    def rows(self, table: str, columns: str, *kinds: Any) -> Iterator[tuple[Any, ...]]:
        """Designs and columns of a table, as they were written."""
        with _naming(self.path):
            for *row, checksum in self.connection.execute(f"SELECT design, {columns}, checksum FROM {table}"):
                if not all(map(isinstance, row, (bytes, *kinds))):
                    raise ValueError("is damaged: a value that is none")
                if checksum != _checksum(*row):
                    raise ValueError("is damaged: a value has changed since it was written")
                yield tuple(row)

    def add(self, found: Mapping[bytes, float]) -> None:
        """Write values, many at a time."""
        self.waiting.update(found)
        if time.monotonic() - self.written > PATIENCE:
            self.write()

    def write(self) -> None:
        """Write what waits."""
        values = (
            (design, None if value != value else float(value)) for design, value in self.waiting.items()
        )
        self.insert("evaluation", [*values])
        self.waiting.clear()
        self.written = time.monotonic()

    def write_one(self, design: bytes, below: float, found: Value | Bound | Failure) -> None:
        """Write what became of a design that was evaluated with a limit, at once: it may have taken long."""
        match found:
            case Value(value):
                self.insert("evaluation", [(design, value)])
            case Bound(least):
                self.insert("bound", [(design, least)])
            case Failure(reason):
                self.insert("failure", [(design, float(below), reason)])

    def insert(self, table: str, rows: Sequence[tuple[Any, ...]]) -> None:
        """Write rows of a design and what is known of it."""
        if not rows:
            return
        marks = ", ".join("?" * (len(rows[0]) + 2))
        with _naming(self.path), _transaction(self.connection):
            self.connection.executemany(
                f"INSERT OR REPLACE INTO {table} VALUES ({marks})",
                [(*row, self.session, _checksum(*row)) for row in rows],
            )


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


def _checksum(design: bytes, number: float | None, reason: str = "") -> int:
    return zlib.crc32(design + (b"" if number is None else struct.pack("<d", number)) + reason.encode())


def _begin(connection: sqlite3.Connection, run: Mapping[str, Any]) -> None:
    """Make a new file this run's, or see that it is."""
    # one lock for as long as it is open: no memory is shared with other processes, and none of them writes
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")
    new = not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    version = 0 if new else _check(connection, run)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    if version < FORMAT:
        with _transaction(connection):
            connection.execute(f"PRAGMA user_version = {FORMAT}")
            for statement in (*FIRST_TABLES, *MORE_TABLES) if new else MORE_TABLES:
                connection.execute(statement)
            if new:
                connection.execute(f"PRAGMA application_id = {APPLICATION}")
                items = [(what, json.dumps(value)) for what, value in run.items()]
                connection.executemany("INSERT INTO run VALUES (?, ?)", items)


def _check(connection: sqlite3.Connection, run: Mapping[str, Any]) -> int:
    """The format of a file, which is refused if it is not this run's."""
    if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise ValueError("is a database, but no journal of a search")
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version > FORMAT:
        raise ValueError(f"has the format {version}; this version of slmm reads those up to {FORMAT}")
    # those that SQLite makes itself, for keys, have no text
    made = connection.execute("SELECT sql FROM sqlite_master WHERE sql NOT NULL ORDER BY rowid")
    if [sql for (sql,) in made] != [*FIRST_TABLES, *(MORE_TABLES if version == FORMAT else ())]:
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
    return int(version)


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
