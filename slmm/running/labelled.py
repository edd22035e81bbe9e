"""Datasets that say what they hold: units and long name of each variable, and the version that made them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr

from slmm import __version__


def labelled(
    variables: Mapping[str, tuple[str | tuple[str, ...], Any, str, str]],
    coordinates: Mapping[str, tuple[Any, str, str]] | None = None,
    **attributes: Any,
) -> xr.Dataset:
    """A dataset from variables with their labels.

    Parameters
    ----------
    variables : mapping of str to (dimensions, values, units, long_name)
        Units are "1" where there are none.
    coordinates : mapping of str to (values, units, long_name), optional
        Each along the dimension of its name.
    **attributes
        Of the dataset, after the version.

    Examples
    --------
    >>> crack = labelled({"K_I": ("tip", [30.0], "MPa sqrt(mm)", "stress intensity of mode I")}, title="edge crack")
    >>> crack.K_I.attrs["units"], list(crack.attrs)
    ('MPa sqrt(mm)', ['version', 'title'])
    """

    def label(units: str, long_name: str) -> dict[str, str]:
        return {"units": units, "long_name": long_name}

    return xr.Dataset(
        {name: (dims, values, label(*rest)) for name, (dims, values, *rest) in variables.items()},
        {name: (name, values, label(*rest)) for name, (values, *rest) in (coordinates or {}).items()},
        {"version": __version__, **attributes},
    )
