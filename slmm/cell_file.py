"""The file format of the crack-cell database: what the precompute stage and the library agree on."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import xarray as xr

#: version of the layout below; a file of another one is refused
SCHEMA = 1

#: variables of a database and their dimensions
LAYOUT: dict[str, tuple[str, ...]] = {
    "K": ("curvature", "poisson", "crack_length", "mode", "mode_"),
    "stress": ("curvature", "poisson", "mode", "component", "eta"),
    "compliance": ("curvature", "direction", "length_open", "order", "order_"),
    "right_edge": ("curvature",),
    "mode_direction": ("mode",),
    "mode_p": ("mode",),
    "mode_q": ("mode",),
}


class DatabaseError(ValueError):
    """The file is not a crack-cell database that this version can use; the message says why."""


def checksum(dataset: xr.Dataset) -> str:
    """SHA-256 over names, shapes and values of all variables and coordinates."""
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        values = np.ascontiguousarray(dataset[name].values)
        if values.dtype.kind not in "fiu":
            values = np.array([str(v) for v in values.ravel()], dtype="U64")
        digest.update(f"{name}{values.shape}".encode())
        digest.update(values.astype("<f8").tobytes() if values.dtype.kind in "fiu" else values.tobytes())
    return digest.hexdigest()


def read_cells(path: Path | str) -> xr.Dataset:
    """Read a database into memory and verify it.

    Raises
    ------
    DatabaseError
        When the file is missing, truncated, altered, or of another schema.
    """
    path = Path(path)
    if not path.is_file():
        raise DatabaseError(f"{path}: no such file; `slmm-precompute -o {path}` makes it")
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            dataset = opened.load()
    except (
        Exception
    ) as error:  # HDF5 meets a damaged file with any of them, AttributeError and MemoryError too
        raise DatabaseError(f"{path}: truncated or not a netCDF file ({error})") from error
    schema = dataset.attrs.get("schema")
    if schema is None:
        raise DatabaseError(f"{path}: not a crack-cell database (no schema attribute)")
    if not np.array_equal(schema, SCHEMA):
        raise DatabaseError(
            f"{path}: schema {schema}, this version reads schema {SCHEMA}; make it anew with slmm-precompute"
        )
    for name, dims in LAYOUT.items():
        if name not in dataset.variables or dataset[name].dims != dims:
            raise DatabaseError(f"{path}: variable {name} with dimensions {dims} is missing")
    if dataset.attrs.get("checksum") != checksum(dataset):
        raise DatabaseError(f"{path}: the contents do not match their checksum, the file has been altered")
    return dataset
