"""Crack tips and interfaces in words and numbers: records for a table, sentences, JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from slmm.fracture.loading import OK
from slmm.initiation.summary import plain
from slmm.mechanics.element_results import ElementResults
from slmm.results.neighbourhood import interface_nodes


def interface_force(results: ElementResults, forces: np.ndarray) -> np.ndarray | None:
    """Sum (d,) of the configurational forces on the nodes between different materials, N; None without any."""
    nodes = interface_nodes(results.cells, results.region)
    return forces[nodes].sum(axis=0) if len(nodes) else None


def tip_record(loading: xr.Dataset, k: int) -> dict[str, Any]:
    """All values of one tip; the contours as lists, the kinks by criterion."""
    tip = loading.isel(tip=k)
    record = {"tip": k} | {str(name): tip[name].values for name in tip.data_vars if name != "kink"}
    return plain(record | {"kink": dict(zip(tip.criterion.values, tip.kink.values, strict=True))})


def tip_sentence(loading: xr.Dataset, k: int) -> str:
    """One tip in words.

    Examples
    --------
    >>> from slmm.results.read_results import read_element_results
    >>> from slmm.fracture.loading import crack_tip_loading
    >>> loading = crack_tip_loading(read_element_results("tests/data/edge_crack_2d.frd"))
    >>> tip_sentence(loading, 0)  # doctest: +ELLIPSIS
    'Tip 0 at (20, 20) mm: G = ... N/mm on 5 contours within ... %, runs on at ... degrees (MERR).'
    """
    tip = loading.isel(tip=k)
    where = f"Tip {k} at ({float(tip.x):.4g}, {float(tip.y):.4g}) mm"
    if not np.isfinite(tip.G):
        return f"{where}: {tip.status.item()}."
    says = (
        f"{where}: G = {float(tip.G):.4g} N/mm on {tip.sizes['contour']} contours within "
        f"{100 * float(tip.spread):.2g} %"
    )
    kink = float(tip.kink.sel(criterion="MERR"))
    if np.isfinite(kink):
        says += f", runs on at {kink:.1f} degrees (MERR)"
    status = tip.status.item()
    return f"{says}." if status == OK else f"{says}; {status}{'' if status.endswith('?') else '.'}"


def as_json(results: ElementResults, forces: np.ndarray, loading: xr.Dataset | None) -> str:
    """Tips and the force on the interfaces as JSON; null where a value is missing."""
    content: dict[str, Any] = {
        "nodes": len(results.points),
        "elements": {name: len(nodes) for name, nodes in results.cells.items()},
        "stresses": results.source,
        "method": results.method,
        "thickness": results.thickness,
        "interface_force": interface_force(results, forces),
    }
    if loading is not None:
        content["units"] = {str(name): loading[name].attrs["units"] for name in loading.data_vars}
        content["symmetry"] = loading.attrs["symmetry"] or None
        content["remark"] = loading.attrs["remark"] or None
        content["tips"] = [tip_record(loading, k) for k in range(loading.sizes["tip"])]
    return json.dumps(plain(content), indent=2, allow_nan=False)
