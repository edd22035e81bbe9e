import netCDF4
import numpy as np
import pytest
import xarray as xr

from precompute.spec import SweepSpec
from precompute.store import assemble, rounded, write
from precompute.sweep import run_sweep
from slmm.running.cell_file import SCHEMA, read_cells
from slmm.running.model_file import DatabaseError

SPEC = SweepSpec(
    curvature=(-0.5, 0.0),
    poisson=(0.0, 0.3),
    crack_length=(0.1, 0.2, 0.5, 1.0),
    modes="published",
    orders=3,
    path_points=8,
    tip=0.1,
    growth=3.0,
    coarsest=0.5,
)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    run_sweep(SPEC, folder, 1)
    path = folder / "cells.nc"
    write(assemble(SPEC, folder), path, folder)
    return path


@pytest.fixture
def database(written, tmp_path):
    path = tmp_path / "cells.nc"
    path.write_bytes(written.read_bytes())
    return path


def test_what_is_written_is_read(written):
    cells = read_cells(written)
    assert cells["K"].values.shape == (2, 2, 5, 16, 16)
    assert cells["stress"].values.shape == (2, 2, 16, 3, 8)
    assert cells["compliance"].values.shape == (2, 2, 4, 3, 3)
    assert cells.attrs["schema"] == SCHEMA


def test_rounding_keeps_nine_digits():
    values = np.random.default_rng(0).normal(size=500) * 10.0 ** np.arange(-250, 250)
    assert np.abs(rounded(values) / values - 1).max() < 1e-9
    assert rounded(np.zeros(2)).tolist() == [0.0, 0.0]


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(DatabaseError, match=r"no\.nc: no such file; `slmm-precompute"):
        read_cells(tmp_path / "no.nc")


def test_folder_is_refused(tmp_path):
    with pytest.raises(DatabaseError, match="no such file"):
        read_cells(tmp_path)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_truncated_file_is_refused(database, share):
    whole = database.read_bytes()
    database.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(DatabaseError, match="truncated or not a netCDF file"):
        read_cells(database)


def test_file_with_flipped_bytes_is_refused_or_holds_the_same_values(database, written):
    whole, values = database.read_bytes(), read_cells(written).dataset()
    random = np.random.default_rng(0)
    refused = 0
    for at in random.integers(0, len(whole), 60):
        changed = bytearray(whole)
        changed[at] ^= int(random.integers(1, 256))
        database.write_bytes(changed)
        try:
            assert read_cells(database).dataset().equals(values)
        except DatabaseError:
            refused += 1
    assert refused > 10


@pytest.mark.parametrize(
    "name",
    ["K", "stress", "compliance", "curvature", "poisson", "crack_length", "eta", "mode_p", "right_edge"],
)
def test_file_with_one_altered_value_is_refused(database, name):
    with netCDF4.Dataset(database, "a") as file:
        variable = file[name]
        variable[(0,) * variable.ndim] = variable[(0,) * variable.ndim] + 1
    with pytest.raises(DatabaseError, match="altered"):
        read_cells(database)


@pytest.mark.parametrize("schema", [SCHEMA + 1, 0, "one", np.array([1, 2])])
def test_file_of_another_schema_is_refused(database, schema):
    with netCDF4.Dataset(database, "a") as file:
        file.schema = schema
    with pytest.raises(DatabaseError, match="this version reads schema"):
        read_cells(database)


def test_foreign_netcdf_is_refused(tmp_path):
    path = tmp_path / "rain.nc"
    xr.Dataset({"rain": ("day", np.arange(3.0))}).to_netcdf(path)
    with pytest.raises(DatabaseError, match="not a file of `slmm-precompute`"):
        read_cells(path)


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "notes.nc"
    path.write_text("not netCDF")
    with pytest.raises(DatabaseError, match="not a netCDF file"):
        read_cells(path)


@pytest.mark.parametrize("name", ["K", "mode_q"])
def test_file_without_a_variable_is_refused(database, name):
    with xr.open_dataset(database) as opened:
        cells = opened.load()
    database.unlink()
    cells.drop_vars(name).to_netcdf(database)
    with pytest.raises(DatabaseError, match=f"variable {name} "):
        read_cells(database)


def test_writing_that_fails_leaves_the_old_file(database, monkeypatch):
    before = database.read_bytes()
    cells = read_cells(database).dataset()

    def fail(self, path, **_):
        path.write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(OSError, match="no space"):
        write(cells, database, database.parent)
    assert database.read_bytes() == before
    assert [path.name for path in database.parent.iterdir()] == ["cells.nc"]
