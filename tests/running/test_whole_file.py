"""On a full disk every writer says so in one sentence, and leaves nothing behind."""

import errno
import subprocess
import sys
from pathlib import Path

import pytest

from slmm.running.whole_file import NotWrittenError, whole_file

ROOT = Path(__file__).parents[2]
CASE = next((ROOT.parent / "shared" / "cases").glob("r12-*"))


def test_a_failure_is_told_with_file_and_cause(tmp_path):
    path = tmp_path / "a.txt"
    with (
        pytest.raises(NotWrittenError, match=r"a\.txt: cannot be written: No space left on device"),
        whole_file(path) as unfinished,
    ):
        unfinished.write_text("some of it")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert list(tmp_path.iterdir()) == []


def test_names_may_be_as_long_as_the_file_system_allows(tmp_path):
    path = tmp_path / ("a" * 255)
    with whole_file(path) as unfinished:
        unfinished.write_text("all of it")
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


#: a process that may write 2 kB into a file, as on a disk that is full
LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))
sys.argv[0] = "slmm"
from {module} import app
app()
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files")
@pytest.mark.parametrize(
    ("module", "command", "target"),
    [
        ("slmm.command.cli", ["initiation", "examples/circle.toml", "--method", "rankine", "-o"], "x.nc"),
        (
            "slmm.command.cli",
            ["initiation", "examples/circle.toml", "--method", "rankine", "--plot"],
            "x.png",
        ),
        (
            "slmm.command.cli",
            ["initiation", "examples/circle.toml", "--method", "rankine", "--plot"],
            "x.pdf",
        ),
        (
            "slmm.command.cli",
            ["initiation", "examples/circle.toml", "--method", "rankine", "--plot"],
            "x.svg",
        ),
        ("slmm.command.cli", ["forces", "examples/inclined_crack.frd", "-o"], "x.vtu"),
        ("slmm.command.cli", ["optimize", "cantilever", "--grid", "4x3", "-o"], "x.nc"),
        (
            "slmm.command.cli",
            ["optimize", "cantilever", "--grid", "5x4", "--algorithm", "brute-force", "-o"],
            "x.nc",
        ),
        ("precompute.cli", [str(CASE / "spec.toml"), "--workers", "1", "-o"], "x.nc"),
        ("precompute.cli", [str(CASE / "spec.toml"), "--workers", "2", "-o"], "x.nc"),
    ],
    ids=lambda value: "-".join(value[:1]) if isinstance(value, list) else value,
)
def test_what_cannot_be_written_is_named_and_nothing_partial_remains(tmp_path, module, command, target):
    ended = subprocess.run(
        [sys.executable, "-c", LIMITED.format(module=module), *command, str(tmp_path / target)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    says = [line for line in ended.stderr.splitlines() if line.startswith("error: ")]
    assert ended.returncode == 1, ended.stderr
    assert "Traceback" not in ended.stderr
    assert len(says) == 1
    assert "x." in says[0] and "cannot be written" in says[0]
    assert not (tmp_path / target).exists()
    assert list(tmp_path.rglob("*.partial")) == []
