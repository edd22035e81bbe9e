"""`slmm initiation` of results: what it takes a file for, and what it needs to know of the material."""

from pathlib import Path

import pytest
from command_line import refused, run

from slmm.command.solved_part import ResultFlags, scene_of

DATA = Path(__file__).parents[1] / "data"
NONE = ResultFlags(None, None, None, None, None, False, None, None)


def test_a_material_by_its_name_or_constants():
    by_name = scene_of(DATA / "plate_2d.frd", NONE._replace(material="PMMA", plane_strain=True), None)
    assert by_name.material.state == "plane strain" and by_name.material.sigma_c == 70.5
    # stiffness from plate_2d.inp beside it
    beside = scene_of(DATA / "plate_2d.frd", NONE._replace(strength=70.0, toughness=1.0), None)
    assert (beside.material.E, beside.material.nu) == (2960.0, 0.35)
    assert beside.material.K_Ic == pytest.approx(1.0 * 1000**0.5)
    own = NONE._replace(strength=70.0, toughness=1.0, young=3000.0, poisson=0.3)
    assert scene_of(DATA / "plate.vtu", own, None).material.E == 3000.0


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("plate_2d.frd", [], "needs a --material"),
        ("plate_2d.frd", ["--strength", "70"], "needs a --material, or --strength and --toughness"),
        ("plate_2d.frd", ["--material", "steel"], "known are"),
        ("plate_2d.frd", ["--material", "PMMA", "--strength", "70"], "contradicts --strength"),
        ("plate.vtu", ["--strength", "70", "--toughness", "1"], "give --young and --poisson"),
        ("plate.vtu", ["--strength", "70", "--toughness", "1", "--young", "3000"], "belong together"),
        ("plate_2d.frd", ["--material", "PMMA", "--step", "7"], "step = 7"),
        ("plate_2d.frd", ["--material", "PMMA", "--symmetry", "above"], "must be one of left"),
        (
            "plate_2d.frd",
            ["--material", "PMMA", "--displacements", str(DATA / "plate.vtu")],
            "--displacements",
        ),
        ("edge_crack_2d.frd", ["--material", "PMMA"], "tip of a crack"),
        ("bar_3d.frd", ["--material", "PMMA"], "act on nodes inside the part"),
    ],
)
def test_what_does_not_go_together(name, options, says):
    refused(run("initiation", DATA / name, *options), says)


def test_options_of_results_belong_to_no_scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("[plate]\nwidth = 10.0\nheight = 10.0\n")
    refused(run("initiation", path, "--material", "PMMA"), "--material: belongs to results")
    refused(run("initiation", path, "--symmetry", "left"), "--symmetry: belongs to results")
