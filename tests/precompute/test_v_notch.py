"""The finite element models behind the table of V-notches, and the table itself."""

import json
import math
from dataclasses import asdict, replace

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from precompute import v_notch, v_notch_solution
from precompute.v_notch import app, assemble, write
from precompute.v_notch_mesh import halved, rounded_body, sharp_body
from precompute.v_notch_solution import (
    NotchResult,
    released_energy,
    rounded_notch,
    sharp_release,
    solve_notch,
)
from precompute.v_notch_spec import NotchSpec
from slmm.initiation.v_notch_table import load_v_notches, read_v_notches
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.williams import release_coefficient, singular_exponent
from slmm.running.model_file import shipped

COARSE = NotchSpec(openings=(0.0, 90.0), step=0.2, far=1e5, near=1e-4)
RIGHT = math.pi / 2


@pytest.mark.parametrize(
    ("degrees", "symmetric"),
    [(0, True), (0, False), (45, False), (90, True), (135, True)],
)
def test_sharp_notch_releases_what_wiener_and_hopf_say(degrees, symmetric):
    opening = math.radians(degrees)
    computed = sharp_release(opening, symmetric, replace(COARSE, step=0.15))
    assert computed == pytest.approx(release_coefficient(opening, symmetric), rel=1e-3)


def test_energy_errs_in_proportion_to_the_element_size():
    exact, errors = release_coefficient(RIGHT), []
    for step in (0.2, 0.1):
        body, tip = sharp_body(RIGHT, replace(COARSE, step=step), fine=True)
        errors.append(released_energy(body, RIGHT, 0.0, True)[0][tip] / exact - 1)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.1)
    assert abs(extrapolated(*errors, order=1)[0]) < 0.15 * abs(errors[1])


def test_poissons_ratio_does_not_matter(monkeypatch):
    coarse = replace(COARSE, step=0.3)
    reference = solve_notch(RIGHT, coarse)
    monkeypatch.setattr(v_notch_solution, "NU", 0.0)
    other = solve_notch(RIGHT, coarse)
    assert other.release == pytest.approx(reference.release, rel=5e-3)
    assert other.stress == pytest.approx(reference.stress, abs=2e-3)
    assert other.sharp_release == pytest.approx(reference.sharp_release, rel=5e-3)


@pytest.mark.parametrize("degrees", [0.0, 60.0, 150.0])
def test_tangent_point_lies_where_arc_and_flank_meet(degrees):
    """The free boundary of the mesh: on the arc up to the half width 1, then on the straight flank."""
    opening = math.radians(degrees)
    body, _ = rounded_body(opening, COARSE, fine=False)
    radius = 1 / math.cos(opening / 2)
    xi, eta = body.where[:, np.flatnonzero(body.direction == 0)]
    from_centre = np.hypot(xi, eta + radius)
    arc = np.abs(from_centre - radius) < 1e-9
    assert xi[arc].max() == pytest.approx(1.0, rel=1e-9)
    # depth below the flank's line, whose normal points from the root's centre to the tangent point
    depth = xi * math.cos(opening / 2) + (eta + radius) * math.sin(opening / 2) - radius
    outside = (xi > 1.0) & (eta < 0) & (depth < 1e-9 * from_centre)
    assert outside.sum() > 20
    assert np.all(depth[xi > 1.0] > -1e-9 * from_centre[xi > 1.0])


@pytest.mark.parametrize("degrees", [0.0, 120.0])
def test_root_is_free_and_carries_its_stress_deep_enough(degrees):
    opening = math.radians(degrees)
    length, release, stress = rounded_notch(opening, COARSE)
    across, along = stress
    assert abs(along[0]) < 1e-3 * across[0]
    # the stress along the path rises as in equilibrium at a circle: d along/d eta = across/radius
    rise = (along[1] - along[0]) / length[1]
    assert rise == pytest.approx(across[0] * math.cos(opening / 2), rel=0.05)
    assert np.all(np.diff(release) < 0)


@pytest.mark.parametrize("degrees", [5.0, 175.0])
def test_table_holds_between_the_stored_angles(degrees):
    opening = math.radians(degrees)
    length, release, stress = rounded_notch(opening, NotchSpec(step=0.15))
    table = load_v_notches()
    assert table.release(opening, length[1:]) == pytest.approx(release[1:] * length[1:], rel=1e-3)
    assert table.bisector_stress(opening, length) == pytest.approx(stress, rel=3e-4, abs=3e-4 * stress[0, 0])


def test_table_holds_between_the_stored_lengths():
    spec = NotchSpec(step=0.2, shortest=0.002, longest=300.0)
    length, release, _ = rounded_notch(RIGHT, spec)
    assert load_v_notches().release(RIGHT, length[1:]) == pytest.approx(release[1:] * length[1:], rel=1e-3)


def test_flat_notch_is_nearly_a_straight_edge():
    release, stress = rounded_notch(math.radians(179.5), COARSE)[1:]
    assert release == pytest.approx(np.full_like(release, release_coefficient(math.pi)), rel=0.04)
    assert stress[0] == pytest.approx(np.ones_like(release), rel=0.03)


def test_halved_elements_keep_the_ends():
    ends = np.array([0.0, 0.5, 2.0])
    assert halved(ends)[::2].tolist() == ends.tolist()


def test_same_settings_give_the_same_table_and_it_is_read(tmp_path):
    coarse = replace(COARSE, step=0.4)
    first, second = (
        assemble(coarse, [solve_notch(math.radians(angle), coarse) for angle in coarse.openings])
        for _ in range(2)
    )
    assert first.identical(second)
    path = tmp_path / "v_notches.nc"
    write(first, path)
    assert [p.name for p in tmp_path.iterdir()] == ["v_notches.nc"]
    table = read_v_notches(path)
    assert np.degrees(table.opening) == pytest.approx([0.0, 90.0, 180.0])
    for variable in first.variables.values():
        assert variable.attrs["units"] and variable.attrs["long_name"]
    for attribute in ("version", "command", "settings", "platform", "checksum"):
        assert first.attrs[attribute]


def test_failed_write_leaves_the_old_table(tmp_path, monkeypatch):
    path = tmp_path / "v_notches.nc"
    path.write_bytes(b"old")
    length = np.array([0.0, 1.0, 2.0])
    flat = NotchResult(length, np.ones(3), np.ones((2, 3)), (1.0, math.nan))

    def fail(self, path, **_):
        path.write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(OSError, match="no space"):
        write(assemble(replace(COARSE, openings=(0.0,)), [flat]), path)
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["v_notches.nc"]


@pytest.mark.parametrize(
    ("output", "why"), [("", "the name must end with .nc"), ("missing/v_notches.nc", "there is no folder")]
)
def test_impossible_output_is_refused_before_the_work(output, why, tmp_path):
    result = CliRunner().invoke(app, ["-o", str(tmp_path / output)])
    assert result.exit_code == 2
    assert why in " ".join(result.output.split())


def test_command_writes_the_table(tmp_path, monkeypatch):
    tiny = replace(COARSE, step=0.4, openings=(60.0,))
    monkeypatch.setattr(v_notch, "NotchSpec", lambda: tiny)
    path = tmp_path / "v_notches.nc"
    result = CliRunner().invoke(app, ["-o", str(path)])
    assert result.exit_code == 0, result.output
    assert read_v_notches(path).opening == pytest.approx([math.pi / 3, math.pi])


def test_shipped_table_is_that_of_the_settings_and_its_meshes_are_good():
    with xr.open_dataset(shipped("v_notches.nc")) as table:
        assert json.loads(table.attrs["settings"]) == json.loads(json.dumps(asdict(NotchSpec())))
        for opening, sharp in zip(table["opening"].values, table["sharp_release"].values, strict=True):
            for symmetric, computed in zip((True, False), sharp, strict=True):
                if singular_exponent(opening, symmetric) < 1 or symmetric:
                    assert computed == pytest.approx(release_coefficient(opening, symmetric), rel=2e-4)
                else:
                    assert np.isnan(computed)
