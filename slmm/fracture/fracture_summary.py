"""A fracture process as JSON: what came of it, its steps, its curves and its cracks."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.initiation.record import plain

if TYPE_CHECKING:
    import xarray as xr

#: variables over these dimensions become columns of a list under the name
TABLES = {"step": "steps", "candidate": "candidates", "excluded": "excluded", "loose": "loose_pieces"}
CURVES = {"corner": "curve", "state": "equilibrium_path", "force_corner": "force_controlled"}


def as_json(result: xr.Dataset) -> str:
    """The whole result of `slmm.fracture.simulate`; null where a value is missing. Steps are numbered from 0.

    Examples
    --------
    >>> from slmm.fracture import simulate
    >>> from slmm.scene.gallery import tensile_plate
    >>> record = json.loads(as_json(simulate(tensile_plate(), increment=20.0, errors=False)))
    >>> record["outcome"], record["U_T_error"], record["steps"][0]["event"], len(record["cracks"][0])
    ('the part is severed', None, 'growth', 6)
    """
    content: dict[str, Any] = plain(dict(result.attrs))
    content["units"] = {str(name): variable.attrs["units"] for name, variable in result.data_vars.items()}
    content |= {str(name): plain(own.item()) for name, own in result.data_vars.items() if not own.dims}
    for dimension, name in TABLES.items():
        columns = _along(result, dimension)
        content[name] = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    for dimension, name in CURVES.items():
        content[name] = _along(result, dimension)
    content["cracks"] = [
        [plain([x, y, step]) for x, y, step in zip(*crack, strict=True) if np.isfinite(x)]
        for crack in zip(result.crack_x.values, result.crack_y.values, result.crack_step.values, strict=True)
    ]
    return json.dumps(content, indent=2, allow_nan=False)


def _along(result: xr.Dataset, dimension: str) -> dict[str, list[Any]]:
    """Variables along one dimension."""
    return {
        str(name): plain(variable.values.tolist())
        for name, variable in result.data_vars.items()
        if variable.dims == (dimension,)
    }
