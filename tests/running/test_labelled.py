"""Labelled arrays hold what a dataset of the same file holds."""

import numpy as np
import xarray as xr

from slmm.running.labelled import LabelledArrays, Variable, read_netcdf


def test_a_file_is_read_as_xarray_reads_it(tmp_path):
    written = xr.Dataset(
        {
            "G_inc": (("position", "a"), np.array([[0.0, np.nan], [1.0, 2.0]]), {"units": "N/mm"}),
            "status": ("position", ["ok", "no cell: undercut"]),
            "count": ("a", np.array([3, 4])),
        },
        {"a": ("a", [0.0, 0.5], {"units": "mm"})},
        {"title": "two positions", "schema": 1},
    )
    written.to_netcdf(tmp_path / "two.nc", engine="netcdf4")
    arrays = read_netcdf(tmp_path / "two.nc")
    assert arrays.dataset().identical(written)
    assert arrays.sizes == dict(written.sizes)
    assert "count" in arrays and "G" not in arrays


def test_a_variable_along_the_dimension_of_its_name_is_a_coordinate():
    arrays = LabelledArrays(
        {
            "a": Variable(("a",), np.array([0.0, 0.5]), {}),
            "G_inc": Variable(("a",), np.array([1.0, 2.0]), {}),
        },
        {},
    )
    assert float(arrays.dataset().G_inc.sel(a=0.5)) == 2.0
