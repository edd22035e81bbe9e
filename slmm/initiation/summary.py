"""A result in words and numbers: its positions in order, the verdict, all of it as JSON."""

from __future__ import annotations

import json
import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from slmm.initiation.record import index_with_error, plain, position_record
from slmm.initiation.verdict import conclude, remedy
from slmm.running.labelled import LabelledArrays

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "as_json",
    "by_criticality",
    "index_with_error",
    "method_used",
    "methods_used",
    "plain",
    "position_record",
    "status_counts",
    "verdict",
]


def by_criticality(result: LabelledArrays | xr.Dataset) -> list[int]:
    """Indices of the positions that have a failure index, the most critical one first.

    Examples
    --------
    >>> import xarray as xr
    >>> by_criticality(xr.Dataset({"failure_index": ("position", [0.2, np.nan, 0.9])}))
    [2, 0]
    """
    FI = result["failure_index"].values
    # of equal positions, as symmetry makes them, the first one: -FI keeps their order, a reversal would not
    return [int(i) for i in np.argsort(-FI, kind="stable") if math.isfinite(FI[i])]


def status_counts(result: LabelledArrays | xr.Dataset) -> dict[str, int]:
    """Number of positions, or variants of a sweep, by status, the most frequent first."""
    return dict(Counter(str(status) for status in result["status"].values.ravel()).most_common())


def method_used(result: LabelledArrays | xr.Dataset, i: int) -> str:
    """The method that was asked for, and, where it is another one, that which gave the value of position i."""
    asked, used = str(result.attrs["method"]), str(result["used_method"].values[i])
    return asked if used == asked else f"{asked}: {used}"


def methods_used(result: LabelledArrays | xr.Dataset) -> list[str]:
    """The methods that gave the values, sorted."""
    return sorted({str(result["used_method"].values[i]) for i in by_criticality(result)})


def as_json(result: LabelledArrays | xr.Dataset) -> str:
    """All positions as JSON; null where a value is missing."""
    ranked, conclusion = by_criticality(result), conclude(result)
    attrs = dict(result.attrs)
    if isinstance(attrs.get("settings"), str):
        attrs["settings"] = json.loads(attrs["settings"])
    positions = [position_record(result, i) for i in range(result.sizes["position"])]
    content = plain(attrs) | {
        "units": {name: result[name].attrs.get("units", "") for name in positions[0] if name in result},
        "verdict": conclusion.says,
        "verdict_is_open": conclusion.is_open,
        "remedy": remedy(result),
        "status_counts": status_counts(result),
        "most_critical": positions[ranked[0]] if ranked else None,
        "positions": positions,
    }
    return json.dumps(content, indent=2, allow_nan=False)


def verdict(result: LabelledArrays | xr.Dataset) -> str:
    """What the result says about the whole part, in words; see `slmm.initiation.verdict.conclude`."""
    return conclude(result).says
