"""Errors and time of one way to compute failure indices, on one scene of the chart."""

from __future__ import annotations

import time

import numpy as np
import xarray as xr
from chart_configurations import Configuration, by_method
from chart_picture import KNOBS
from chart_truth import MIDDLE, POSITIONS, SHARES, SINGULAR, Case

from slmm import failure_indices
from slmm.criteria.coupled_curves import criticals
from slmm.criteria.path_curves import PathCurves
from slmm.initiation.positions import find_positions

#: what `auto` takes where the database applies
CHEAP = ("strength", "slmm+ac")
Row = dict[str, object]


def nearest(result: xr.Dataset, points: np.ndarray) -> np.ndarray:
    """Index of the result's position at each point."""
    at = np.column_stack([result.x, result.y])
    return np.argmin(np.linalg.norm(at[None] - points[:, None], axis=-1), axis=1)


def energy_error(result: xr.Dataset, i: int, truth: PathCurves, length: float) -> float:
    """Largest relative error of G_inc up to a crack length, as far as the curves reach; NaN without curves."""
    a, G = result.a.values[i], result.G_inc.values[i]
    if not np.isfinite(a[-1]) or not length > 0:
        return float("nan")
    at = np.geomspace(0.05 * length, min(length, a[-1], truth.a[0, -1]), 20)
    return float(np.max(np.abs(energy_at(at, a, G) / energy_at(at, truth.a[0], truth.G_inc[0]) - 1)))


def energy_at(at: np.ndarray, a: np.ndarray, G_inc: np.ndarray) -> np.ndarray:
    """G_inc at lengths from a curve, by powers between its points: exact for smooth and for singular mouths."""
    return np.exp(np.interp(np.log(at), np.log(a[1:]), np.log(np.maximum(G_inc[1:], 1e-300))))


def measure(case: Case, configuration: Configuration) -> list[Row]:
    """Errors and time of one configuration on one scene; knobs with the middle material only."""
    rows: list[Row] = []
    for m, scene in enumerate(case.scenes):
        if configuration.group in KNOBS and SHARES[m] != MIDDLE:
            continue
        try:
            start = time.perf_counter()
            result = configuration.compute(scene)
            seconds = time.perf_counter() - start
        except (ValueError, RuntimeError) as error:  # a method that does not apply to the whole scene
            rows.append(no_row(case, configuration, m, str(error)))
            continue
        at = nearest(result, case.points)
        FI = result.failure_index.values[at]
        k = case.critical(m)
        true = case.index[m]
        above = true > 0.5 * np.nanmax(true)
        errors = np.abs(FI / true - 1)
        length = 2 * float(criticals(case.curves[k], scene.material, False).crack_length[0])
        rows.append(
            {
                "scene": case.name,
                "singular": case.name in SINGULAR,
                "share": SHARES[m],
                "configuration": configuration.name,
                "group": configuration.group,
                "seconds": seconds,
                "positions": result.sizes["position"],
                "FI_truth": true[k],
                "FI": FI[k],
                "FI_error": errors[k],
                "median_error": float(np.median(errors[above])),
                "errors": " ".join(f"{e:.3g}" for e in errors[above]),
                "G_inc_error": energy_error(result, at[k], case.curves[k], length)
                if "a" in result
                else np.nan,
                "used_method": str(result.used_method.values[at[k]]) if "used_method" in result else "",
                "beyond_cells": int((~np.isin(result.used_method, CHEAP)).sum())
                if "used_method" in result
                else 0,
                "status": str(result.status.values[at[k]]) if "status" in result else "",
            }
        )
    return rows


def no_row(case: Case, configuration: Configuration, m: int, why: str) -> Row:
    missing = dict.fromkeys(("seconds", "FI", "FI_error", "median_error", "G_inc_error"), np.nan)
    return {
        "scene": case.name,
        "singular": case.name in SINGULAR,
        "share": SHARES[m],
        "configuration": configuration.name,
        "group": configuration.group,
        "positions": 0,
        "FI_truth": case.index[m][case.critical(m)],
        "errors": "",
        "used_method": "",
        "beyond_cells": 0,
        "status": why,
        **missing,
    }


def measure_full_fea(case: Case) -> list[Row]:
    """Full FEA as a user gets it, at up to three of the points; its time is that of all positions."""
    rows: list[Row] = []
    for m, scene in enumerate(case.scenes):
        if SHARES[m] != MIDDLE:
            continue
        k = case.critical(m)
        some = [k, *[i for i in range(len(case.points)) if i != k][:2]]
        asked = scene.with_(analysis={"points": case.points[some].tolist()})
        start = time.perf_counter()
        result = failure_indices(asked, "full-fea", curves=True)
        each = (time.perf_counter() - start) / len(some)
        n = len(find_positions(scene, POSITIONS).s)
        errors = np.abs(result.failure_index.values / case.index[m][some] - 1)
        length = 2 * float(criticals(case.curves[k], scene.material, False).crack_length[0])
        rows.append(
            no_row(case, Configuration("full FEA", "full FEA", by_method("full-fea")), m, "ok")
            | {
                "seconds": each * n,
                "positions": n,
                "FI": float(result.failure_index[0]),
                "FI_error": float(errors[0]),
                "median_error": float(np.median(errors)),
                "errors": " ".join(f"{e:.3g}" for e in errors),
                "G_inc_error": energy_error(result, 0, case.curves[k], length),
                "used_method": "full-fea",
                "beyond_cells": n,
            }
        )
    return rows
