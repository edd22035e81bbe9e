"""A journal of a search: every value that was computed, in an SQLite file that outlives a kill at any moment.

A search that is resumed runs again from its beginning with these values as its memory, and so ends as it would have
ended undisturbed. What a quick model of neighbours has judged is not in it, and is judged again.

The file has the tables ``run`` (what the run is, as JSON), ``session`` (each time it was started or resumed) and
``evaluation``: a design, by `slmm.optimization.evaluation.keys`, its value, NULL where the evaluation failed, and the
session. While it is open it is locked. After a kill a second file, ``-wal``, belongs to it, until it is opened again.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

#: values wait this long to be written, s
PATIENCE = 0.1
#: "slmm", by which SQLite tells an application's files
APPLICATION = int.from_bytes(b"slmm", "big")

SCHEMA = (
    f"PRAGMA application_id = {APPLICATION}",
    "CREATE TABLE run (what TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE session (id INTEGER PRIMARY KEY, started TEXT NOT NULL)",
    "CREATE TABLE evaluation (design BLOB PRIMARY KEY, value REAL, session INTEGER NOT NULL) WITHOUT ROWID",
)


@dataclass
class Journal:
    """An open journal."""

    connection: sqlite3.Connection
    session: int
    waiting: dict[bytes, float] = field(default_factory=dict)
    written: float = field(default_factory=time.monotonic)

    def known(self) -> dict[bytes, float]:
        """All values by the designs' keys; NaN where the evaluation failed."""
        rows = self.connection.execute("SELECT design, value FROM evaluation")
        return {design: float("nan") if value is None else value for design, value in rows}

    def add(self, found: Mapping[bytes, float]) -> None:
        """Write values, many at a time."""
        self.waiting.update(found)
        if time.monotonic() - self.written > PATIENCE:
            self.write()

    def write(self) -> None:
        """Write what waits."""
        rows = [(design, value, self.session) for design, value in self.waiting.items()]
        with _transaction(self.connection):
            self.connection.executemany("INSERT OR REPLACE INTO evaluation VALUES (?, ?, ?)", rows)
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
        For a file that is there and shall not be resumed, is no journal or that of another run, or is in use.
    """
    path = Path(path)
    if path.exists() and not resume:
        raise ValueError(f"journal {path}: is there already; resume it, or name another file")
    try:
        connection = sqlite3.connect(path, timeout=1.0, isolation_level=None)
    except sqlite3.Error as error:
        raise ValueError(f"journal {path}: {error}") from error
    with closing(connection):
        try:
            _begin(connection, run)
            session = _new_session(connection)
        except (ValueError, sqlite3.Error) as error:
            raise ValueError(f"journal {path}: {error}") from error
        journal = Journal(connection, session)
        try:
            yield journal
        finally:
            journal.write()


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
            for statement in SCHEMA:
                connection.execute(statement)
            items = [(what, json.dumps(value)) for what, value in run.items()]
            connection.executemany("INSERT INTO run VALUES (?, ?)", items)


def _check(connection: sqlite3.Connection, run: Mapping[str, Any]) -> None:
    """Refuse a file that is not this run's."""
    if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise ValueError("is a database, but no journal of a search")
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
