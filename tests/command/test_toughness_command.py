"""`slmm optimize toughness`: searches, pictures while it runs, journals, a Dask cluster, refusals.

Most look for the stiffest plate, which takes one solution a design.
"""

import json
from importlib import import_module

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from slmm.command import toughness_command
from slmm.command.cli import app
from slmm.mechanics.material import Material
from slmm.optimization import HolePattern, search
from slmm.optimization.hole_patterns.plate import CrackedPlate

STIFFEST = "--pattern", "reflected", "--grid", 4, "--figure", "stiffness"


def run(*arguments):
    return CliRunner().invoke(app, ["optimize", "toughness", *(str(argument) for argument in arguments)])


def test_the_stiffest_plate_has_no_holes(tmp_path):
    """For whatever is taken away lets the part give way."""
    output = tmp_path / "out.nc"
    result = run(*STIFFEST, "--algorithm", "brute-force", "-o", output, "--json")
    assert result.exit_code == 0, result.stderr
    content = json.loads(result.stdout)
    assert content["best_design"] == ["0000"] * 4 and content["failed"] == 0
    problem = HolePattern(4, "reflected", figure="stiffness")
    assert content["by_direction"] == problem.by_direction(problem.start).tolist()
    with xr.open_dataset(output) as found:
        assert found.by_direction.attrs["units"] == found.value.attrs["units"] == "N/mm"
        assert float(found.value) == -float(found.by_direction.min())


def test_a_genetic_algorithm_finds_what_it_finds_in_python():
    settings = "--set", "population=4", "--set", "recombinations=2", "--set", "patience=2"
    result = run(*STIFFEST, "--algorithm", "ga", "--seed", 3, *settings, "--json")
    assert result.exit_code == 0, result.stderr
    content = json.loads(result.stdout)
    problem = HolePattern(4, "reflected", figure="stiffness")
    found = search(problem, "ga", seed=3, population=4, recombinations=2, patience=2)
    assert (content["simulations"], -min(content["by_direction"])) == (found.simulations, found.value)


def test_each_better_design_is_drawn_while_it_runs(tmp_path, monkeypatch):
    drawn, target = [], tmp_path / "best.png"

    def draw(problem, design, path):
        drawn.append(problem.evaluate(design, np.inf).value)
        path.write_bytes(b"")

    monkeypatch.setattr(toughness_command, "draw", draw)
    result = run("--pattern", "rotated", "--grid", 3, "--increment", 4, "--plot", target, "--json")
    assert result.exit_code == 0, result.stderr
    assert len(drawn) > 1 and drawn == sorted(drawn, reverse=True)
    assert drawn[-1] == -min(json.loads(result.stdout)["by_direction"])


def test_the_best_design_of_a_small_pattern_is_drawn(tmp_path):
    plot, journal = tmp_path / "best.svg", tmp_path / "run.db"
    arguments = "--pattern", "rotated", "--grid", 3, "--increment", 4, "--journal", journal
    result = run(*arguments, "--plot", plot)
    assert result.exit_code == 0, result.stderr
    assert b"<svg" in plot.read_bytes()
    assert "mJ by directions (0 failed; no better neighbour)" in result.stdout
    assert run(*arguments, "--resume").stdout == result.stdout


PLATE = """
[plate]
width = 40.0
height = 40.0
[[holes]]
shape = "pattern"
values = [[1]]
frame = 10.0
threshold = 0.6
[[cracks]]
points = [[0.0, 20.0], [6.0, 20.0]]
[material]
name = "PS"
[load]
displacement = 1.0
"""


def test_another_plate_comes_from_a_scene_file(tmp_path):
    """Another crack, material and threshold: other values, those of the same problem in Python."""
    scene = tmp_path / "plate.toml"
    scene.write_text(PLATE)
    result = run(*STIFFEST, "--algorithm", "bfsl", "--depth", 1, "--plate", scene, "--json")
    assert result.exit_code == 0, result.stderr
    plate = CrackedPlate(40.0, 6.0, 10.0, threshold=0.6, material=Material.from_name("PS"))
    problem = HolePattern(4, "reflected", figure="stiffness", plate=plate)
    assert json.loads(result.stdout)["by_direction"] == problem.by_direction(problem.start).tolist()


def test_other_mechanics_reach_the_problem(monkeypatch):
    seen = []

    def stops(problem, *arguments, **options):
        seen.append(problem)
        raise ValueError("seen")

    # the package has a function of the module's name
    monkeypatch.setattr(import_module("slmm.optimization.search"), "search", stops)
    given = "--initiation", "coupled", "--engine", "fem", "--first-length", 0.5, "--increment", 1.0
    assert run(*given).exit_code == 2
    (problem,) = seen
    assert (problem.initiation, problem.engine, problem.first_length, problem.increment) == (
        "coupled",
        "fem",
        0.5,
        1.0,
    )


def test_margins_and_a_refined_design_come_beside_the_best_one(tmp_path):
    output, journal = tmp_path / "out.nc", tmp_path / "run.db"
    small = (
        "--pattern",
        "full",
        "--grid",
        1,
        "--sides",
        "left",
        "--increment",
        8,
        "--algorithm",
        "brute-force",
    )
    asked = *small, "--margins", "--refine", 3, "--journal", journal, "-o", output
    result = run(*asked, "--json")
    assert result.exit_code == 0, result.stderr
    content = json.loads(result.stdout)
    assert content["best_design"] == ["1"] and not content["margins"]["forks"]
    refined = content["refined"]
    assert refined["evaluations"] == 3 and min(refined["by_direction"]) >= min(content["by_direction"])
    with xr.open_dataset(output, group="refined") as found:
        assert found.support.values.tolist() == refined["support"]
    with xr.open_dataset(output, group="margins") as found:
        assert found.U_T.values.tolist() == content["by_direction"]
    written = (tmp_path / "run.refined.jsonl").read_bytes()
    again = run(*asked, "--resume")
    assert again.exit_code == 0, again.stderr
    assert "it does not fork" in again.stdout and "Refined in 3 evaluations" in again.stdout
    assert (tmp_path / "run.refined.jsonl").read_bytes() == written


@pytest.mark.slow
def test_two_processes_of_a_dask_cluster_find_what_one_finds(tmp_path):
    distributed = pytest.importorskip("distributed")
    arguments = "--pattern", "rotated", "--grid", 4, "--increment", 4, "--json"
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        there = run(*arguments, "--scheduler", cluster.scheduler_address, "--journal", tmp_path / "run.db")
    assert there.exit_code == 0, there.stderr
    assert json.loads(there.stdout) == json.loads(run(*arguments).stdout)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--start", "full"), "--start full: must be solid or random"),
        (("--figure", "beauty"), "figure = 'beauty': must be one of"),
        (("--resume",), "--resume: needs --journal"),
        (("--workers", 2, "--scheduler", "tcp://localhost:1"), "--workers 2: the cluster at"),
        (("--heaviest", 0.5), "must be a valid design"),
        (("--plate", "nowhere.toml"), "nowhere.toml"),
        (("--engine", "guess", "--grid", 1), "engine = 'guess'"),
    ],
)
def test_what_cannot_be_is_refused(arguments, words):
    result = run(*arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(toughness_command, "PATIENCE", 0.2)
    result = run("--scheduler", "tcp://127.0.0.1:9")
    assert result.exit_code == 2 and "no Dask cluster answers there" in " ".join(result.stderr.split())
