import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from typer.testing import CliRunner

from precompute.cli import app
from precompute.spec import SweepSpec
from precompute.sweep import part_file, run_sweep, tasks
from slmm.running.cell_file import read_cells

COARSE = """
curvature = [-0.5, -0.25, 0.0]
crack_length = [0.1, 0.2, 0.5, 1.0]
modes = "published"
orders = 3
path_points = 8
tip = 0.05
growth = 2.0
coarsest = 0.25
"""
FEW = SweepSpec(
    curvature=(-0.5, 0.0),
    poisson=(0.3,),
    crack_length=(0.1, 0.2, 0.5, 1.0),
    modes="published",
    orders=3,
    path_points=8,
    tip=0.1,
    growth=3.0,
    coarsest=0.5,
)


@pytest.fixture
def spec_file(tmp_path):
    path = tmp_path / "coarse.toml"
    path.write_text(COARSE)
    return path


def command(spec_file, *more):
    """A process of its own that runs slmm-precompute in the folder of the spec."""
    arguments = ["slmm-precompute", spec_file.name, "--poisson", "0.3", "-o", "cells.nc", *more]
    return [
        sys.executable,
        "-c",
        f"import sys; sys.argv = {arguments}; from precompute.cli import app; app()",
    ]


def run(spec_file, *more):
    subprocess.run(command(spec_file, *more), cwd=spec_file.parent, check=True, capture_output=True)
    return (spec_file.parent / "cells.nc").read_bytes()


def children(pid):
    path = f"/proc/{pid}/task/{pid}/children"
    with open(path) as stream:
        return [int(child) for child in stream.read().split()]


def is_running(pid):
    try:
        with open(f"/proc/{pid}/stat") as stream:
            return stream.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


@pytest.mark.slow
def test_killed_at_any_moment_it_resumes_and_ends_with_the_same_file(spec_file, tmp_path):
    undisturbed = run(spec_file, "--workers", "1")
    target = tmp_path / "cells.nc"
    target.unlink()
    killed = 0
    for pause in np.random.default_rng(1).uniform(0.0, 0.6, 6):
        with subprocess.Popen(
            command(spec_file, "--workers", "1"),
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as process:
            deadline = time.monotonic() + 30
            while not list(tmp_path.glob("*.parts")) and time.monotonic() < deadline:
                time.sleep(0.01)
            time.sleep(pause)
            killed += process.poll() is None
            process.send_signal(signal.SIGKILL)
        if target.exists():
            read_cells(target)  # never half of a table
            target.unlink()
    assert killed >= 2
    assert run(spec_file, "--workers", "1") == undisturbed
    assert {path.name for path in tmp_path.iterdir()} == {"cells.nc", "coarse.toml"}


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/proc/self/task"), reason="looks for processes in /proc")
def test_workers_end_with_a_killed_parent(spec_file, tmp_path):
    with subprocess.Popen(
        command(spec_file, "--workers", "2"),
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("*.parts/*.npz")) and time.monotonic() < deadline:
            time.sleep(0.02)
        workers = children(process.pid)
        process.send_signal(signal.SIGKILL)
    assert workers
    deadline = time.monotonic() + 20
    while any(map(is_running, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(is_running, workers))


def test_part_that_is_not_whole_is_solved_anew(tmp_path):
    run_sweep(FEW, tmp_path, 1)
    parts = [part_file(tmp_path, task) for task in tasks(FEW)]
    whole = [dict(np.load(part)) for part in parts]
    parts[0].write_bytes(parts[0].read_bytes()[:-200])
    altered = bytearray(parts[1].read_bytes())
    altered[len(altered) // 2] ^= 1
    parts[1].write_bytes(altered)
    parts[2].write_bytes(b"")
    # what a killed run leaves behind
    parts[3].rename(parts[3].with_suffix(".4711.partial"))
    steps = []
    run_sweep(FEW, tmp_path, 1, lambda *told: steps.append(told))
    assert steps == [(k / 4, f"{k} of 4 crack cells") for k in range(5)]
    for part, values in zip(parts, whole, strict=True):
        again = np.load(part)
        assert all(np.array_equal(again[name], value) for name, value in values.items())


def test_sound_parts_are_taken_over(tmp_path):
    run_sweep(FEW, tmp_path, 1)
    before = [part_file(tmp_path, task).stat().st_mtime_ns for task in tasks(FEW)]
    run_sweep(FEW, tmp_path, 1)
    assert [part_file(tmp_path, task).stat().st_mtime_ns for task in tasks(FEW)] == before


def test_command_makes_the_table_of_one_poissons_ratio(spec_file, tmp_path):
    target = tmp_path / "new" / "cells.nc"
    result = CliRunner().invoke(
        app, [str(spec_file), "--poisson", "0.42", "-o", str(target), "--workers", "1"]
    )
    assert result.exit_code == 0, result.output
    cells = read_cells(target)
    assert cells["poisson"].values.tolist() == [0.42]
    assert cells["crack_length"].values.tolist() == [0.0, 0.1, 0.2, 0.5, 1.0]
    assert cells.sizes["mode"] == 16
    for name in cells.variables:
        if cells[name].values.dtype.kind == "f":
            assert cells[name].attrs["units"]
            assert cells[name].attrs["long_name"]
    assert {"schema", "version", "command", "settings", "mesh", "solver", "checksum"} <= set(cells.attrs)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--poisson", "1.2"], "poisson"),
        (["--poisson", "nan"], "poisson"),
        (["missing.toml"], "missing.toml"),
        (["--poisson", "0.3", "-o", "."], "folder"),
    ],
)
def test_wrong_input_ends_with_code_2_and_a_reason(arguments, named, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert named in result.output
    assert list(tmp_path.iterdir()) == []
