"""Precomputed models: where the shipped ones lie, and how a file is verified before it is used."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from slmm.running.labelled import LabelledArrays, read_netcdf

if TYPE_CHECKING:
    import xarray as xr


class DatabaseError(ValueError):
    """The file is not a model that this version can use; the message says why."""


def checksum(model: xr.Dataset | LabelledArrays) -> str:
    """SHA-256 over names, shapes and values of all variables and coordinates."""
    digest = hashlib.sha256()
    for name in sorted(map(str, model.variables)):
        values = np.ascontiguousarray(model[name].values)
        if values.dtype.kind not in "fiu":
            values = np.array([str(v) for v in values.ravel()], dtype="U64")
        else:
            values = values.astype("<f8", copy=False)
        digest.update(f"{name}{values.shape}".encode())
        digest.update(values.data)
    return digest.hexdigest()


def shipped(name: str) -> Path:
    """A model that comes with the package: in models/ of a checkout, slmm/models of a wheel."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "models", package.parent / "models"):
        if (folder / name).is_file():
            return folder / name
    raise DatabaseError(f"no {name} in {package / 'models'} or {package.parent / 'models'}")


def read_verified(
    path: Path | str, schema: int, layout: Mapping[str, tuple[str, ...]], maker: str
) -> LabelledArrays:
    """Read a model into memory and verify it.

    Parameters
    ----------
    path : path
    schema : int
        Version of the layout that is understood.
    layout : mapping of str to tuple of str
        Variables and their dimensions.
    maker : str
        The command that makes such a file.

    Raises
    ------
    DatabaseError
        When the file is missing, truncated, altered, or of another schema.
    """
    path = Path(path)
    if not path.is_file():
        raise DatabaseError(f"{path}: no such file; `{maker} -o {path}` makes it")
    try:
        model = read_netcdf(path)
    except Exception as error:  # HDF5 meets a damaged file with any, AttributeError and MemoryError too
        raise DatabaseError(f"{path}: truncated or not a netCDF file ({error})") from error
    found = model.attrs.get("schema")
    if found is None:
        raise DatabaseError(f"{path}: not a file of `{maker}` (no schema attribute)")
    if not np.array_equal(found, schema):
        raise DatabaseError(
            f"{path}: schema {found}, this version reads schema {schema}; make it anew with `{maker} -o {path}`"
        )
    for name, dims in layout.items():
        if name not in model or model[name].dims != dims:
            raise DatabaseError(f"{path}: variable {name} with dimensions {dims} is missing")
    if model.attrs.get("checksum") != checksum(model):
        raise DatabaseError(f"{path}: the contents do not match their checksum, the file has been altered")
    return model
