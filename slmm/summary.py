"""A result in words and numbers: the most critical position, the verdict, the table as JSON."""

from __future__ import annotations

import json
import math
from collections import Counter
from typing import Any

import numpy as np
import xarray as xr


def by_criticality(result: xr.Dataset) -> list[int]:
    """Indices of the positions that have a failure index, the most critical one first.

    Examples
    --------
    >>> by_criticality(xr.Dataset({"failure_index": ("position", [0.2, np.nan, 0.9])}))
    [2, 0]
    """
    FI = result["failure_index"].values
    # of equal positions, as symmetry makes them, the first one: -FI keeps their order, a reversal would not
    return [int(i) for i in np.argsort(-FI, kind="stable") if math.isfinite(FI[i])]


def status_counts(result: xr.Dataset) -> dict[str, int]:
    """Number of positions by status, the most frequent first."""
    return dict(Counter(str(status) for status in result["status"].values).most_common())


def index_with_error(result: xr.Dataset, i: int) -> str:
    """Failure index of position i, with its estimated error where the method has one.

    Examples
    --------
    >>> index_with_error(xr.Dataset({"failure_index": ("p", [0.9]), "failure_index_error": ("p", [0.0123])}), 0)
    '0.900 ± 0.012'
    """
    FI, error = (float(result[name].values[i]) for name in ("failure_index", "failure_index_error"))
    if not math.isfinite(error):
        return f"{FI:.3f}"
    # a digit of the error, as far as one is of use
    digits = 4 if error < 5e-4 else 3
    return f"{FI:.{digits}f} ± {error:.{digits}f}"


def method_used(result: xr.Dataset, i: int) -> str:
    """The method that was asked for, and, where it is another one, that which gave the value of position i."""
    asked, used = str(result.attrs["method"]), str(result["used_method"].values[i])
    return asked if used == asked else f"{asked}: {used}"


def methods_used(result: xr.Dataset) -> list[str]:
    """The methods that gave the values, sorted."""
    return sorted({str(result["used_method"].values[i]) for i in by_criticality(result)})


def verdict(result: xr.Dataset) -> str:
    """The most critical position in two sentences."""
    ranked = by_criticality(result)
    if not ranked:
        return "No position has a failure index."
    worst = position_record(result, ranked[0])
    FI, lf, a = worst["failure_index"], worst["load_factor"], worst["crack_length"]
    if not FI > 0 or lf is None:
        return "No crack starts at any of the positions, however high the load."
    at_tip = worst["hole"] < 0
    says = (
        f"Most critical: position {worst['position']}{', a crack tip,' if at_tip else ''}"
        f" at ({worst['x']:.2f}, {worst['y']:.2f}) mm,"
        f" failure index {index_with_error(result, ranked[0])}, load factor {lf:.3f}"
    )
    if a:
        says += f", critical crack length {a:.3g} mm"
    if FI >= 1:
        event = "The crack goes on" if at_tip else "A crack starts"
        return f"{says}. {event} there under this load (FI >= 1)."
    return f"{says}. No crack starts under this load (FI < 1); one does at {lf:.3f} times the load."


def position_record(result: xr.Dataset, i: int) -> dict[str, Any]:
    """All single values of position i; None where there is none."""
    values = {name: result[name].values[i] for name in result.data_vars if result[name].dims == ("position",)}
    return {"position": i, **{str(name): plain(value) for name, value in values.items()}}


def as_json(result: xr.Dataset) -> str:
    """All positions as JSON; null where a value is missing."""
    ranked = by_criticality(result)
    attrs = dict(result.attrs)
    if isinstance(attrs.get("settings"), str):
        attrs["settings"] = json.loads(attrs["settings"])
    positions = [position_record(result, i) for i in range(result.sizes["position"])]
    content = plain(attrs) | {
        "units": {name: result[name].attrs.get("units", "") for name in positions[0] if name in result},
        "verdict": verdict(result),
        "status_counts": status_counts(result),
        "most_critical": positions[ranked[0]] if ranked else None,
        "positions": positions,
    }
    return json.dumps(content, indent=2, allow_nan=False)


def plain(value: Any) -> Any:
    """A value as strict JSON knows it: no numpy, and null for what is not finite."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
