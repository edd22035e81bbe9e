"""The table of rounded V-notches is smooth, and read only whole, unaltered and of this version."""

import math

import netCDF4
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.initiation.v_notch_table import SCHEMA, load_v_notches, read_v_notches
from slmm.running.model_file import DatabaseError, shipped


@given(degrees=st.floats(0.0, 180.0))
def test_curves_are_smooth_over_the_opening(degrees):
    """Between stored angles nothing swings: curvature as seen by three angles half a degree apart stays small."""
    a = np.array([0.01, 0.3, 5.0, 90.0])
    angles = np.radians(np.clip(degrees, 0.5, 179.5) + np.array([-0.5, 0.0, 0.5]))
    table = load_v_notches()
    values = [np.log([table.release(o, a), table.bisector_stress(o, a)[0]]) for o in angles]
    assert np.abs(values[0] - 2 * values[1] + values[2]).max() < 2e-3


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "v_notches.nc"
    path.write_bytes(shipped("v_notches.nc").read_bytes())
    return path


def test_table_is_read_once_and_anew_when_it_changes(table):
    assert load_v_notches(table) is load_v_notches(table)
    with netCDF4.Dataset(table, "a") as file:
        file["stress"][0, 0, 0] = 2.0
    with pytest.raises(DatabaseError, match="altered"):
        load_v_notches(table)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_truncated_table_is_refused(table, share):
    whole = table.read_bytes()
    table.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(DatabaseError, match="truncated or not a netCDF file"):
        read_v_notches(table)


@pytest.mark.parametrize("name", ["release", "stress", "opening", "length", "sharp_release"])
def test_altered_table_is_refused(table, name):
    with netCDF4.Dataset(table, "a") as file:
        file[name][(0,) * file[name].ndim] += 1e-6
    with pytest.raises(DatabaseError, match="altered"):
        read_v_notches(table)


def test_table_of_another_schema_or_none_is_refused(table, tmp_path):
    with netCDF4.Dataset(table, "a") as file:
        file.schema = SCHEMA + 1
    with pytest.raises(DatabaseError, match="this version reads schema"):
        load_v_notches(table)
    with pytest.raises(DatabaseError, match=r"no such file; `python -m precompute\.v_notch"):
        load_v_notches(tmp_path / "none.nc")


def test_table_without_a_variable_is_refused(table):
    with netCDF4.Dataset(table, "a") as file:
        file.renameVariable("release", "energy")
    with pytest.raises(DatabaseError, match="variable release with dimensions"):
        read_v_notches(table)


def test_shipped_table_reaches_from_crack_to_straight_edge():
    table = load_v_notches()
    assert table.opening[0] == 0 and table.opening[-1] == math.pi
    assert table.length[0] == 0 and table.length[1] <= 0.0103 and table.length[-1] == pytest.approx(100.0)
    assert shipped("v_notches.nc").stat().st_size < 300_000
