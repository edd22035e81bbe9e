"""A simulation's history as a labelled dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.fracture.events import COMPETING
from slmm.fracture.history import History
from slmm.part.part import Part
from slmm.running.labelled import labelled
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

#: what covers the difference between two orders, as in `slmm.boundary.model`; chosen
COVERS = 4.0
ERROR_IS = (
    f"{COVERS:g} times what a finer model changes where the displacement rises, and what steps of stable "
    "growth leave out; not whether competing events turn the path"
)


def fracture_result(
    scene: Scene, part: Part, history: History, settings: Mapping[str, Any], reached: Sequence[Sequence[int]]
) -> xr.Dataset:
    """The result of `simulate`.

    Parameters
    ----------
    scene : Scene
    part : Part
        At the end.
    history : History
    settings : mapping
        How it was made.
    reached : sequence of sequence of int
        For each crack the steps that led to its points.
    """
    steps = history.steps
    u, F = history.corners
    x, y, step = _paths(part, reached)
    error = COVERS * history.discretisation_error + history.increment_error
    ends = np.array([s.end for s in steps]).reshape(-1, 2)
    K = np.array([s.K for s in steps]).reshape(-1, 2)
    gap = np.array([s.gap for s in steps])
    root_mm = "MPa sqrt(mm)"
    dissipated = np.array([s.length for s in steps]) * scene.material.G_c * part.thickness
    result = labelled(
        {
            "u": ("corner", u, "mm", "displacement conjugate to the force"),
            "F": ("corner", F, "N", "force"),
            "u_c": ("step", [s.u_c for s in steps], "mm", "critical displacement"),
            "u_load": ("step", history.loads, "mm", "displacement at which it happens"),
            "stiffness": ("step", history.stiffnesses[:-1], "N/mm", "stiffness before the step"),
            "event": ("step", np.array([str(s.kind) for s in steps], dtype=str), "1", "what happens"),
            "tip": ("step", np.array([s.crack for s in steps], dtype=int), "1", "crack whose tip it is"),
            "x": ("step", ends[:, 0], "mm", "x of the tip after the step"),
            "y": ("step", ends[:, 1], "mm", "y of the tip after the step"),
            "arrested_by": (
                "step",
                np.array([s.arrested_by for s in steps], dtype=str),
                "1",
                "what it ran into",
            ),
            "K_I": ("step", K[:, 0], root_mm, "stress intensity of mode I at the critical load"),
            "K_II": ("step", K[:, 1], root_mm, "stress intensity of mode II at the critical load"),
            "released": ("step", history.released, "mJ", "stored energy set free by the step"),
            "dissipated": ("step", dissipated, "mJ", "G_c times the new crack's area"),
            "gap": ("step", gap, "1", "by which the next event's load is higher, relative"),
            "touches": (
                "step",
                np.array([s.touches for s in steps], dtype=bool),
                "1",
                "whether faces of cracks meet",
            ),
            "crack_x": (("crack", "point"), x, "mm", "x along the cracks"),
            "crack_y": (("crack", "point"), y, "mm", "y along the cracks"),
            "crack_step": (("crack", "point"), step, "1", "step that led there, -1 before the first"),
            "U_T": ((), history.toughness, "mJ", "tensile toughness"),
            "U_T_error": ((), error, "mJ", "estimated error of the tensile toughness"),
            "stored": ((), history.stored, "mJ", "energy stored at the end"),
        },
        title=scene.title,
        outcome=f"{history.outcome}: {history.reason}" if history.reason else str(history.outcome),
        error_is=ERROR_IS,
        **settings,
    )
    competing = int(np.sum(gap < COMPETING))
    result.attrs["competing_events"] = competing
    result.attrs["sliding_tips"] = history.slid
    result["gap"].attrs["comment"] = (
        f"below {COMPETING:g} events compete, and the path may fork; ties below 1e-5 go to tips before starts, "
        "then to the lowest hole, y and x"
    )
    return result


def _paths(part: Part, reached: Sequence[Sequence[int]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates and steps (cracks, points) along the cracks, NaN beyond their ends."""
    longest = max((len(crack.points) for crack in part.cracks), default=0)
    values = np.full((3, len(part.cracks), longest), math.nan)
    for k, (crack, steps) in enumerate(zip(part.cracks, reached, strict=True)):
        n = len(crack.points)
        values[:2, k, :n] = crack.points.T
        values[2, k, :n] = steps
    return values[0], values[1], values[2]
