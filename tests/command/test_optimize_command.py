"""`slmm optimize cantilever`: files, tables, pictures, resuming, refusals."""

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from slmm.command.cli import app
from slmm.optimization import Cantilever, search
from slmm.optimization.cantilever.brute_force import brute_force
from slmm.optimization.runs import search_runs
from slmm.pictures.optimization import plot_optimization


def run(*arguments):
    return CliRunner().invoke(app, ["optimize", "cantilever", *(str(argument) for argument in arguments)])


def test_brute_force_writes_all_valid_designs_in_order(tmp_path):
    output, plot = tmp_path / "out.nc", tmp_path / "out.png"
    result = run("--grid", "5x4", "--algorithm", "brute-force", "-o", output, "--plot", plot)
    assert result.exit_code == 0, result.stderr
    assert plot.read_bytes().startswith(b"\x89PNG")
    with xr.open_dataset(output) as found:
        beam = Cantilever(5, 4)
        assert found.sizes["rank"] == int(found.n_valid)
        assert (np.diff(found.endpoint_displacement) >= 0).all()
        best = beam.solved_directly(found.best_design.values.astype(bool))
        assert best == pytest.approx(float(found.endpoint_displacement[0]), rel=1e-9)
        assert found.endpoint_displacement.attrs["units"] == "mm"
        assert f"{int(found.n_valid):,} valid designs" in result.stdout


def test_runs_have_seeds_that_follow_and_come_out_the_same(tmp_path):
    output = tmp_path / "out.nc"
    arguments = "--grid", "5x4", "--depth", 2, "--radius", 2, "--runs", 4, "--seed", 7
    first = run(*arguments, "-o", output, "--json")
    assert first.exit_code == 0, first.stderr
    content = json.loads(first.stdout)
    assert [r["seed"] for r in content["runs"]] == [7, 8, 9, 10]
    assert content["settings"] == {"depth": 2, "radius": 2}
    assert json.loads(run(*arguments, "--json").stdout) == content
    with xr.open_dataset(output) as found:
        assert found.value.values.tolist() == [r["value"] for r in content["runs"]]
        assert found.attrs["algorithm"] == "tbfsl"
    table = run(*arguments)
    assert "best 4 of 4 runs" in table.stdout
    assert "Quartiles:" in table.stdout


def test_a_finished_search_is_resumed_to_the_same_file(tmp_path):
    output = tmp_path / "out.nc"
    arguments = "--grid", "5x4", "--runs", 2, "-o", output
    assert run(*arguments).exit_code == 0
    with xr.open_dataset(output) as found:
        before = found.load()
    output.unlink()
    again = run(*arguments, "--resume")
    assert again.exit_code == 0, again.stderr
    with xr.open_dataset(output) as found:
        xr.testing.assert_identical(found.drop_attrs(), before.drop_attrs())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--grid", "8by5"], "--grid 8by5: must be columns x rows, as 8x5"),
        (["--algorithm", "newton"], "--algorithm newton: must be one of tbfsl, bfsl"),
        (["--set", "temperature"], "--set temperature: must be NAME=VALUE"),
        (["--set", "speed=3"], "speed: is no setting; must be one of depth, radius"),
        (["--set", "seed=3"], "seed: is no setting; must be one of depth, radius"),
        (["--set", "runs=3"], "runs: is no setting"),
        (["--best", 5], "--best 5: is for brute-force alone"),
        (["--resume"], "--resume: needs -o"),
        (["--algorithm", "brute-force", "--seed", 3], "no settings and no seed"),
        (["--algorithm", "brute-force", "--depth", 2], "brute-force has no settings"),
        (["--algorithm", "brute-force", "--grid", "48x16"], "62 free cells at most"),
        (["-o", "out.csv"], "the name must end with .nc"),
    ],
)
def test_bad_input_is_refused_by_name(arguments, words):
    result = run(*arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())


def test_a_file_where_journals_should_lie_is_named(tmp_path):
    (tmp_path / "out.journals").write_text("mine")
    result = run("--grid", "5x4", "-o", tmp_path / "out.nc")
    assert result.exit_code == 2
    assert "there is a file there" in " ".join(result.stderr.split())
    assert (tmp_path / "out.journals").read_text() == "mine"


@pytest.mark.slow
@pytest.mark.parametrize("runs", [1, 6])
def test_an_interrupt_ends_all_processes_and_says_how_to_go_on(tmp_path, runs):
    # kernels of fine grids are compiled: an interrupt waits for the compiler
    search(Cantilever(30, 14), "tbfsl", max_simulations=500)
    # such searches take minutes
    arguments = "--grid", "30x14", "--runs", str(runs), "--workers", "2", "-o", tmp_path / "out.nc"
    process = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from slmm.command.cli import app; app()",
            "optimize",
            "cantilever",
            *arguments,
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    journals = tmp_path / "out.journals"
    deadline = time.monotonic() + 100
    while not list(journals.glob("*.sqlite")) and time.monotonic() < deadline:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    # processes that go on would hold the pipe
    _, told = process.communicate(timeout=200)
    assert process.returncode != 0
    assert "with --resume it goes on" in " ".join(told.split())


def test_pictures_show_the_best_run_and_single_results():
    beam = Cantilever(5, 4)
    found = search_runs(beam, "tbfsl", runs=3)
    figure = plot_optimization(beam, found)
    assert f"{float(found.value.min()):.5g}" in figure.axes[0].get_title()
    assert "3 runs" in figure.axes[1].get_title()
    single = found.isel(run=0, drop=True)
    assert "1 run" in plot_optimization(beam, single).axes[1].get_title()
    assert "best of" in plot_optimization(beam, brute_force(beam, best=10)).axes[1].get_title()
