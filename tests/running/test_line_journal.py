"""Journals of lines: numbers come back to the bit, cut lines are dropped, damage and other runs are told."""

import errno
import subprocess
import sys

import numpy as np
import pytest

from slmm.running.line_journal import LineJournal, open_lines
from slmm.running.whole_file import NotWrittenError

RUN = {"scene": "plate (12ab)", "increment": 2.0}


@pytest.fixture
def written(tmp_path):
    path = tmp_path / "run.jsonl"
    with open_lines(path, RUN) as journal:
        for k in range(3):
            journal.add({"step": k, "u": 0.1 * k})
    return path


def records(path, run=RUN):
    with open_lines(path, run, resume=True) as journal:
        return journal.records


def test_numbers_come_back_to_the_bit(tmp_path):
    values = [*np.random.default_rng(0).normal(size=50).tolist(), 5e-324, -0.0, 1e300, float("inf")]
    with open_lines(tmp_path / "run.jsonl", RUN) as journal:
        journal.add({"values": values, "none": float("nan")})
    (again,) = records(tmp_path / "run.jsonl")
    assert [value.hex() for value in again["values"]] == [value.hex() for value in values]
    assert np.isnan(again["none"])


def test_a_journal_cut_at_any_byte_goes_on_behind_its_last_whole_line(written):
    content = written.read_bytes()
    for size in range(len(content)):
        written.write_bytes(content[:size])
        kept = max(content[:size].count(b"\n") - 1, 0)
        with open_lines(written, RUN, resume=True) as journal:
            assert [record["step"] for record in journal.records] == list(range(kept))
            for k in range(kept, 3):
                journal.add({"step": k, "u": 0.1 * k})
        assert written.read_bytes() == content


def test_a_changed_number_is_told(written):
    content = written.read_bytes().replace(b'"u": 0.1', b'"u": 0.3')
    written.write_bytes(content)
    with pytest.raises(ValueError, match="damaged: line 3 has changed since it was written"):
        records(written)


def test_another_run_is_refused_with_what_differs(written):
    with pytest.raises(ValueError, match=r"another run, with increment = 2.0; this one has increment = 4.0"):
        records(written, {**RUN, "increment": 4.0})


def test_a_run_at_work_is_not_begun_anew_and_one_that_has_ended_is(written):
    with pytest.raises(ValueError, match="is there already; resume it, or name another file"):
        open_lines(written, RUN).__enter__()
    with open_lines(written, RUN, resume=True) as journal:
        journal.add_end({"outcome": "severed"})
    with open_lines(written, RUN, resume=True) as journal:
        assert journal.end == {"outcome": "severed"} and len(journal.records) == 3
    with open_lines(written, RUN) as journal:
        assert journal.end is None and not journal.records


def test_records_behind_those_that_are_kept_are_dropped_with_the_end(written):
    with open_lines(written, RUN, resume=True) as journal:
        journal.add_end({"outcome": "severed"})
    with pytest.raises(ValueError, match="holds 3 steps, and cannot go on behind step 4"):
        open_lines(written, RUN, resume=True, keep=4).__enter__()
    with open_lines(written, RUN, resume=True, keep=2) as journal:
        kept = journal.records
        assert journal.end is None and len(kept) == 2
    assert records(written) == kept


@pytest.mark.parametrize("content", [b"title = 'a scene'\n", b"\x89PNG\n\x00", b"half a sentence"])
@pytest.mark.parametrize("resume", [True, False])
def test_what_is_no_journal_is_left_as_it_is(tmp_path, content, resume):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"scene\.toml: is no journal of a simulation"):
        open_lines(path, RUN, resume).__enter__()
    assert path.read_bytes() == content


def test_a_folder_and_a_place_that_cannot_be_written_are_told(tmp_path):
    with pytest.raises(ValueError, match="it is a folder"):
        open_lines(tmp_path, RUN).__enter__()
    with pytest.raises(NotWrittenError, match="cannot be written"):
        open_lines(tmp_path / "no" / "run.jsonl", RUN).__enter__()


def test_a_run_that_fails_before_its_first_record_leaves_no_file(tmp_path):
    with pytest.raises(RuntimeError), open_lines(tmp_path / "run.jsonl", RUN):
        raise RuntimeError("nothing holds the part")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="no locks")
def test_a_journal_in_use_is_refused(written):
    other = (
        "import sys; from slmm.running.line_journal import open_lines\n"
        "try: open_lines(sys.argv[1], {}, True).__enter__()\n"
        "except ValueError as error: print(error)"
    )
    with open_lines(written, RUN, resume=True):
        done = subprocess.run([sys.executable, "-c", other, written], capture_output=True, text=True)
    assert "is in use by another process" in done.stdout


class Narrow:
    """A file that takes three bytes at a time, and so many at all."""

    def __init__(self, room):
        self.room, self.content = room, b""

    def write(self, data):
        if len(self.content) >= self.room:
            raise OSError(errno.ENOSPC, "No space left on device")
        self.content += bytes(data[:3])
        return len(data[:3])


def test_a_record_is_written_to_its_end_and_a_full_disk_is_told(tmp_path):
    wide, narrow = Narrow(10**6), Narrow(10)
    LineJournal(tmp_path / "run.jsonl", wide).add({"u": 0.125})
    assert wide.content.endswith(b'{"u": 0.125}\n')
    with pytest.raises(NotWrittenError, match=r"run\.jsonl: cannot be written: No space left"):
        LineJournal(tmp_path / "run.jsonl", narrow).add({"u": 0.125})
