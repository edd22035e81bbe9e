"""Cracks with two ends in a prediction: every tip is a position, ligaments may end at a crack, parts may be severed."""

import numpy as np
import pytest
from typer.testing import CliRunner

from slmm import Scene, failure_indices
from slmm.command.cli import app
from slmm.initiation.positions import find_positions
from slmm.initiation.v_notches import crack_notch
from slmm.initiation.verdict import conclude
from slmm.scene.toml_file import read_toml

pytest.importorskip("netgen")

PLATE = {"width": 40.0, "height": 120.0}


def scene(*cracks, **tables):
    return Scene.from_dict(
        {
            "plate": PLATE,
            "material": {"name": "PMMA"},
            "load": {"stress": 10.0},
            "cracks": [{"points": points} for points in cracks],
            **tables,
        }
    )


def test_both_tips_of_an_internal_crack_are_positions_with_isidas_intensity():
    part = scene([[10, 60], [30, 60]])
    assert find_positions(part).points.tolist() == [[10, 60], [30, 60]]
    result = failure_indices(part, "griffith")
    assert result.stress_intensity_I.values / (10 * np.sqrt(10 * np.pi)) == pytest.approx(1.1867, rel=2e-3)
    full = failure_indices(part, "full-fea")
    assert full.failure_index.values == pytest.approx(result.failure_index.values, rel=5e-3)


def test_explicit_points_find_either_tip():
    part = scene([[10, 60], [30, 60]], analysis={"points": [[30, 60], [10, 60]]})
    assert find_positions(part).tip.tolist() == [1, 0]


def test_a_tip_is_clear_up_to_the_other_end_and_to_what_comes_nearer():
    part = scene([[10, 60], [30, 60]]).part
    assert [crack_notch(scene([[10, 60], [30, 60]]), line).clear for line in part.tips] == [10.0, 10.0]
    two = scene([[0, 60], [20, 60]], [[26, 60], [40, 60]])
    assert [crack_notch(two, line).clear for line in two.part.tips] == pytest.approx([6.0, 6.0])
    joined = scene([[5, 60], [20, 60]], [[8, 60], [8, 70]])
    assert len(joined.part.tips) == 3
    assert crack_notch(joined, joined.part.tips[0]).clear == pytest.approx(3.0)


def test_a_ligament_that_ends_at_a_crack_may_be_severed_at_once():
    """So tough a material fails by the whole ligament; its energy is that of the same plate with the slit."""
    hole = {"shape": "circle", "center": [12, 60], "radius": 5}
    part = scene(
        [[20, 50], [20, 70]],
        holes=[hole],
        material={"E": 3000.0, "nu": 0.35, "sigma_c": 5.0, "K_Ic": 30.0},
        load={"displacement": 0.1},
        analysis={"points": [[17, 60]]},
    )
    result = failure_indices(part, "full-fea")
    assert result.status.values.tolist() == ["ok"]
    assert float(result.crack_length[0]) == pytest.approx(3.0, rel=1e-6)
    from slmm.fem.mesh import plate_mesh
    from slmm.fem.plate_model import PlateModel

    top = part.loading.conditions[1]
    whole, slit = (
        PlateModel(plate_mesh(each).refined(), part.material, part.loading).reaction(top)[1]
        for each in (part.part, part.part.with_crack([(17, 60), (20, 60)]))
    )
    released = 0.5 * 0.1 * (whole - slit) / 3.0
    lf = np.sqrt(part.material.G_c / released)
    assert float(result.load_factor[0]) == pytest.approx(lf, rel=3e-3)


@pytest.mark.parametrize("holes", [[], [{"shape": "circle", "center": [20, 30], "radius": 5}]])
def test_a_severed_part_is_said_to_be_one(holes):
    part = scene([[0, 60], [40, 60]], holes=holes, analysis={"positions": 4})
    for method in ("auto", "rankine", "slmm+ac"):
        result = failure_indices(part, method)
        assert result.attrs["pieces"] == 2
        assert np.isnan(result.failure_index.values).all()
        assert set(result.status.values.tolist()) <= {"the cracks sever the part"}
        says = conclude(result)
        assert says.is_open and "sever the part, in 2 pieces" in says.says


def test_the_command_line_says_that_a_part_is_severed(tmp_path):
    file = tmp_path / "severed.toml"
    file.write_text(
        """
[plate]
width = 40.0
height = 120.0
[[cracks]]
points = [[0, 60], [25, 60]]
[[cracks]]
points = [[25, 60], [40, 70]]
[material]
name = "PMMA"
[load]
stress = 10.0
"""
    )
    assert len(read_toml(file)["cracks"]) == 2
    found = CliRunner().invoke(
        app, ["initiation", str(file), "-o", str(tmp_path / "out.nc"), "--plot", str(tmp_path / "out.png")]
    )
    assert found.exit_code == 1, found.output
    assert "sever the part" in found.output and "2 pieces" in found.output
    assert (tmp_path / "out.nc").exists()
