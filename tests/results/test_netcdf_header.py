"""The header's walk passes what the library writes in every format, and stops at counts that cannot be."""

import netCDF4
import numpy as np
import pytest

from slmm.results.netcdf_header import check_netcdf
from slmm.results.results import read_displacements


def written(path, form):
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.title, file.numbers = "odd", np.arange(3.0)
        file.createDimension("n", 5)
        file.createDimension("time", None)
        values = file.createVariable("x", "f8", ("time", "n"))
        values.units, values[:] = "mm", np.ones((2, 5))
    return path


@pytest.mark.parametrize("form", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4"])
def test_every_format_passes(form, tmp_path):
    check_netcdf(written(tmp_path / "a.nc", form))


@pytest.mark.parametrize("form", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"])
def test_a_header_that_is_cut_off_is_refused_everywhere(form, tmp_path):
    path = written(tmp_path / "a.e", form)
    data = path.read_bytes()
    for end in range(0, data.index(b"units"), 3):
        path.write_bytes(data[:end])
        with pytest.raises(ValueError, match=r"a\.e: cannot be read as Exodus: it"):
            read_displacements(path)


def test_a_count_beyond_the_file_is_refused(tmp_path):
    path = written(tmp_path / "a.e", "NETCDF3_CLASSIC")
    data = path.read_bytes()
    for at in (12, 16):  # how many dimensions there are, how long the first one's name is
        path.write_bytes(data[:at] + b"\x7f\xff\xff\xff" + data[at + 4 :])
        with pytest.raises(ValueError, match="its header is cut off or damaged"):
            read_displacements(path)
