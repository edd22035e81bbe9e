"""`slmm info`: what it tells of a database, and which it refuses."""

import xarray as xr
from command_line import refused, run

from slmm.running.cell_file import shipped_database


def test_info_says_what_the_shipped_database_holds():
    result = run("info")
    assert result.exit_code == 0, result.stderr
    for word in (
        "schema",
        "curvature",
        "poisson",
        "crack_length",
        "modes",
        "slmm-precompute",
        "verified",
        "MB",
    ):
        assert word in result.stdout


def test_info_refuses_an_altered_database(tmp_path):
    path = tmp_path / "cells.nc"
    with xr.open_dataset(shipped_database()) as cells:
        cells.isel(poisson=[0]).to_netcdf(path)  # and the old checksum
    assert refused(run("info", path), "altered")
    path.write_bytes(shipped_database().read_bytes()[:10_000])
    assert refused(run("info", path), "cells.nc")
