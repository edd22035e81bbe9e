"""A journal keeps values, bounds and failures, and tells when it was changed."""

import sqlite3
from contextlib import closing

import pytest
from expensive_problems import Rows
from quick_problems import same

from slmm.optimization import search
from slmm.optimization.journal import FORMAT, open_journal
from slmm.optimization.problem import Bound


def recorded(path):
    """Designs in each table of a journal."""
    with closing(sqlite3.connect(path)) as connection:
        return {
            table: {design for (design,) in connection.execute(f"SELECT design FROM {table}")}
            for table in ("evaluation", "bound", "failure")
        }


def test_a_journal_keeps_bounds_as_bounds_and_failures_with_their_reason(tmp_path):
    path, log = tmp_path / "run.sqlite", tmp_path / "log"
    first = search(Rows(log), "tbfsl", seed=3, journal=path)
    assert all(recorded(path).values())
    with closing(sqlite3.connect(path)) as connection:
        reasons = {reason for (reason,) in connection.execute("SELECT reason FROM failure")}
        (least,) = connection.execute("SELECT min(least) FROM bound").fetchone()
    assert reasons == {"ArithmeticError: the mesh is tangled"}
    assert least >= first.value
    log.unlink()
    assert same(first, search(Rows(log), "tbfsl", seed=3, journal=path, resume=True))
    assert not log.exists()


@pytest.mark.parametrize("table", ["bound", "failure"])
def test_a_journal_that_was_changed_is_damaged(table, tmp_path):
    path = tmp_path / "run.sqlite"
    search(Rows(), "tbfsl", seed=3, journal=path)
    column = {"bound": "least", "failure": "below"}[table]
    for change in (f"{column} + 1", "'x'"):
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute(f"UPDATE {table} SET {column} = {change}")
        with pytest.raises(ValueError, match="is damaged: a value"):
            search(Rows(), "tbfsl", seed=3, journal=path, resume=True)


def test_a_journal_of_values_alone_is_read_and_one_of_the_future_is_not(tmp_path):
    path = tmp_path / "run.sqlite"
    run = {"of": "a test"}
    with open_journal(path, run) as journal:
        journal.add({b"a": 1.0, b"b": float("nan")})
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript("DROP TABLE bound; DROP TABLE failure; PRAGMA user_version = 0")
    with open_journal(path, run, resume=True) as journal:
        assert str(journal.memory().values) == "{b'a': 1.0, b'b': nan}"
        journal.write_one(b"c", 2.0, Bound(3.0))
    with open_journal(path, run, resume=True) as journal:
        assert journal.memory().bounds == {b"c": 3.0}
    with closing(sqlite3.connect(path)) as connection:
        connection.execute(f"PRAGMA user_version = {FORMAT + 1}")
    with (
        pytest.raises(
            ValueError, match=f"has the format {FORMAT + 1}; this version of slmm reads those up to"
        ),
        open_journal(path, run, resume=True),
    ):
        pass
