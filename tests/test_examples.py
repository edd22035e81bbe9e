"""Every example scene can be computed and drawn."""

import json
import math
from pathlib import Path

import pytest
from typer.testing import CliRunner

from slmm.command.cli import app
from slmm.mechanics.material import Material

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))


@pytest.mark.parametrize("scene_file", EXAMPLES, ids=lambda path: path.stem)
def test_example(scene_file, tmp_path):
    picture = tmp_path / "picture.png"
    result = CliRunner().invoke(app, ["initiation", str(scene_file), "--json", "--plot", str(picture)])
    assert result.exit_code == 0, result.stderr
    content = json.loads(result.stdout, parse_constant=pytest.fail)
    assert content["most_critical"]["failure_index"] > 0
    # where a longer crack than the cell's could need less there is no value
    assert set(content["status_counts"]) <= {"ok", "crack longer than the cell"}
    assert content["status_counts"]["ok"] >= 0.9 * len(content["positions"])
    assert picture.exists()


def failure_index(name):
    scene_file = Path(__file__).parents[1] / "examples" / name
    result = CliRunner().invoke(app, ["initiation", str(scene_file), "--json"])
    return json.loads(result.stdout)["most_critical"]["failure_index"]


def test_the_edge_crack_has_the_stress_intensity_of_the_handbook():
    """Tada: K_I of an edge crack in a strip, here a quarter of its width deep, to 0.5 %."""
    ratio, depth = 0.25, 10.0
    F = 1.122 - 0.231 * ratio + 10.55 * ratio**2 - 21.71 * ratio**3 + 30.382 * ratio**4
    K_I = 10.0 * math.sqrt(math.pi * depth) * F
    PMMA = Material.from_name("PMMA")
    assert failure_index("edge_crack.toml") == pytest.approx(K_I / math.sqrt(PMMA.E * PMMA.G_c), rel=0.005)


def test_the_v_notch_is_little_stronger_than_a_crack_of_its_depth():
    assert 0.9 < failure_index("v_notch.toml") / failure_index("edge_crack.toml") < 1.0
