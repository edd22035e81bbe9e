"""Arrays that say what they hold: units and long name of each variable, and the version that made them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from slmm import __version__

if TYPE_CHECKING:
    import xarray as xr


class Variable(NamedTuple):
    """An array with the names of its dimensions, and what it says of itself."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: dict[str, Any]


@dataclass(frozen=True)
class LabelledArrays:
    """What a file holds or a query finds, before anything computes with the labels.

    Reading and printing need no more, and xarray takes longer to load (with pandas and, where it is installed, Dask)
    than a query takes. What is asked for here has the same name in an `xarray.Dataset`, so that either will do.

    Attributes
    ----------
    variables : dict of str to Variable
    attrs : dict of str to object
        Of all of them.

    Examples
    --------
    >>> tips = LabelledArrays({"K_I": Variable(("tip",), np.array([30.0, 4.0]), {"units": "MPa sqrt(mm)"})}, {})
    >>> float(tips["K_I"].values[1]), tips.sizes, "K_II" in tips
    (4.0, {'tip': 2}, False)
    >>> float(tips.dataset().K_I.max("tip"))
    30.0
    """

    variables: dict[str, Variable]
    attrs: dict[str, Any]

    def __getitem__(self, name: str) -> Variable:
        return self.variables[name]

    def __contains__(self, name: str) -> bool:
        return name in self.variables

    @property
    def sizes(self) -> dict[str, int]:
        """Lengths of the dimensions."""
        return {
            name: length
            for variable in self.variables.values()
            for name, length in zip(variable.dims, variable.values.shape, strict=True)
        }

    def dataset(self) -> xr.Dataset:
        """The same as a dataset; a variable along the dimension of its name is a coordinate."""
        import xarray as xr

        return xr.Dataset(self.variables, attrs=self.attrs)


def read_netcdf(path: Path) -> LabelledArrays:
    """All that a netCDF file holds, read into memory as it stands there."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)  # of masked arrays, which none of ours are, a copy would be made
        variables = {
            name: Variable(
                variable.dimensions,
                variable[...],
                {key: variable.getncattr(key) for key in variable.ncattrs() if key != "_FillValue"},
            )
            for name, variable in file.variables.items()
        }
        return LabelledArrays(variables, {key: file.getncattr(key) for key in file.ncattrs()})


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
    import xarray as xr

    def label(units: str, long_name: str) -> dict[str, str]:
        return {"units": units, "long_name": long_name}

    return xr.Dataset(
        {name: (dims, values, label(*rest)) for name, (dims, values, *rest) in variables.items()},
        {name: (name, values, label(*rest)) for name, (values, *rest) in (coordinates or {}).items()},
        {"version": __version__, **attributes},
    )
