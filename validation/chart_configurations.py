"""The ways to compute failure indices that the chart compares: methods and the knobs that matter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from chart_truth import POSITIONS
from checks import at_spread_positions

from slmm import Scene, failure_indices
from slmm.criteria.coupled_curves import Coupled
from slmm.initiation.by_cells import voxel_count
from slmm.initiation.by_dislocations import body_fitted_model, dislocations_on
from slmm.initiation.paths import trial_paths
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT
from slmm.initiation.task import Answer, Task


@dataclass(frozen=True)
class Configuration:
    """One way to compute failure indices.

    Attributes
    ----------
    name, group : str
        What the chart calls it, and which line or colour it belongs to.
    compute : callable
        From a scene to a result with curves.
    default : bool
        Whether it is what a user gets who asks for its method.
    """

    name: str
    group: str
    compute: Callable[[Scene], xr.Dataset]
    default: bool = False


def by_method(method: str, **options: Any) -> Callable[[Scene], xr.Dataset]:
    return lambda scene: failure_indices(
        at_spread_positions(scene, POSITIONS), method, curves=True, **options
    )


def with_analysis(method: str, **analysis: Any) -> Callable[[Scene], xr.Dataset]:
    return lambda scene: by_method(method)(scene.with_(analysis=analysis))


def with_voxels(factor: float) -> Callable[[Scene], xr.Dataset]:
    """SLMM+AC on a multiple of the voxels that it takes by itself."""

    def compute(scene: Scene) -> xr.Dataset:
        voxels = voxel_count(task_of(scene)) if scene.outlines else 10_000
        return by_method("slmm+ac")(scene.with_(analysis={"voxels": max(int(factor * voxels), 1000)}))

    return compute


def task_of(scene: Scene) -> Task:
    where = find_positions(scene, POSITIONS)
    paths = trial_paths(scene, where)
    return Task(scene, where, paths, Coupled(), 0.02, DEFAULT, Path(), None, lambda fraction, text: None)


def with_mesh(coarseness: float) -> Callable[[Scene], xr.Dataset]:
    """Dislocations on another mesh."""

    def compute(scene: Scene) -> xr.Dataset:
        task = task_of(scene)
        answer = Answer.empty(task.n, "dislocations")
        rows = np.flatnonzero(task.smooth)
        model = body_fitted_model(task.among(rows), coarseness)
        dislocations_on(model, task, answer, rows)
        data = {
            "failure_index": 1 / answer.load_factor,
            "x": task.where.points[:, 0],
            "y": task.where.points[:, 1],
        }
        result = xr.Dataset({name: ("position", values) for name, values in data.items()})
        return result.assign({n: (("position", "crack"), getattr(answer.curves, n)) for n in ("a", "G_inc")})

    return compute


def fine_rule(deviation: float) -> Any:
    return replace(DEFAULT, name="chart", fine=DEFAULT.fine._replace(deviation=deviation))


CONFIGURATIONS = (
    Configuration("Rankine", "stress", by_method("rankine"), True),
    Configuration("point method", "stress", by_method("point"), True),
    Configuration("line method", "stress", by_method("line"), True),
    Configuration("SLMM, paper", "paper", by_method("slmm", settings="published")),
    Configuration("SLMM+AC, paper", "paper", by_method("slmm+ac", settings="published")),
    Configuration("SLMM", "cells", by_method("slmm"), True),
    Configuration("SLMM+AC", "cells", by_method("slmm+ac"), True),
    Configuration("voxels / 16", "voxels", with_voxels(1 / 16)),
    Configuration("voxels / 4", "voxels", with_voxels(1 / 4)),
    Configuration("voxels x 4", "voxels", with_voxels(4)),
    Configuration("5 modes", "modes", by_method("slmm+ac", settings=replace(DEFAULT, modes="important"))),
    Configuration("16 modes", "modes", by_method("slmm+ac", settings=replace(DEFAULT, modes="published"))),
    Configuration("closer cells", "cell choice", by_method("slmm+ac", settings=fine_rule(0.001))),
    Configuration("wider cells", "cell choice", by_method("slmm+ac", settings=fine_rule(0.03))),
    Configuration("cells on a mesh", "mesh", with_analysis("slmm+ac", local_model="body-fitted")),
    Configuration("dislocations", "dislocations", by_method("dislocations"), True),
    Configuration("coarser mesh", "mesh of dislocations", with_mesh(1.5)),
    Configuration("finer mesh", "mesh of dislocations", with_mesh(0.5)),
    Configuration("auto, 5 %", "tolerance", by_method("auto", tolerance=0.05)),
    Configuration("auto, 2 %", "auto", by_method("auto"), True),
    Configuration("auto, 0.5 %", "tolerance", by_method("auto", tolerance=0.005)),
)
