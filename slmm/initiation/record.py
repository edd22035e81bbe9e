"""One position of a result in words and numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.running.labelled import LabelledArrays

if TYPE_CHECKING:
    import xarray as xr


def index_with_error(result: LabelledArrays | xr.Dataset, i: int) -> str:
    """Failure index of position i, with its estimated error where the method has one.

    Examples
    --------
    >>> import xarray as xr
    >>> index_with_error(xr.Dataset({"failure_index": ("p", [0.9]), "failure_index_error": ("p", [0.0123])}), 0)
    '0.900 ± 0.012'
    """
    FI, error = (float(result[name].values[i]) for name in ("failure_index", "failure_index_error"))
    if not math.isfinite(error):
        return f"{FI:.3f}"
    # a digit of the error, as far as one is of use
    digits = 4 if error < 5e-4 else 3
    return f"{FI:.{digits}f} ± {error:.{digits}f}"


def position_record(result: LabelledArrays | xr.Dataset, i: int) -> dict[str, Any]:
    """All single values of position i; None where there is none."""
    values = {
        str(name): variable.values[i]
        for name, variable in result.variables.items()
        if variable.dims == ("position",)
    }
    return {"position": i, **{name: plain(value) for name, value in values.items()}}


def plain(value: Any) -> Any:
    """A value as strict JSON knows it: no numpy, and null for what is not finite."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
