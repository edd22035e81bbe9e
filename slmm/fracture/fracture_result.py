"""A simulation's history as a labelled dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.fracture.directions import Direction
from slmm.fracture.equilibrium import equilibrium_path, force_control, released_in_equilibrium
from slmm.fracture.events import COMPETING, TIED
from slmm.fracture.history import WHOLE, Candidate, Excluded, Step
from slmm.fracture.process import Process
from slmm.fracture.stable_growth import left_out
from slmm.running.labelled import labelled
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

#: what covers the difference between two orders, as in `slmm.boundary.model`; chosen
COVERS = 4.0
ERROR_IS = (
    f"{COVERS:g} times what a finer model changes where the displacement rises, and what drops of the "
    "force leave out of stable growth (of U_T_integrated: how far lines there miss the energy that growth takes); not "
    "whether competing events turn the path"
)


def fracture_result(
    scene: Scene, process: Process, direction: Direction, settings: Mapping[str, Any]
) -> xr.Dataset:
    """The result of `simulate`.

    Parameters
    ----------
    scene : Scene
    process : Process
        That has come to its end.
    direction : Direction
        By which tips turned.
    settings : mapping
        How it was made.
    """
    history, loose = process.history, process.loose
    steps = history.steps
    u, F = history.corners
    x, y, step = _paths(process.lines, process.reached)
    dissipated = np.array([s.length for s in steps]) * scene.material.G_c * scene.part.thickness
    candidates = [(k, candidate) for k, step in enumerate(steps) for candidate in step.candidates]
    excluded = [(k, each) for k, step in enumerate(steps) for each in step.excluded]
    path, controlled, lacks = equilibrium_path(history), force_control(history), left_out(history, dissipated)
    U_T, discretisation = history.toughness, COVERS * history.discretisation_error
    work = float(np.trapezoid(F, u))
    ends = np.array([s.end for s in steps]).reshape(-1, 2)
    K = np.array([s.K for s in steps]).reshape(-1, 2)
    gap = np.array([s.gap for s in steps])
    root_mm = "MPa sqrt(mm)"
    result = labelled(
        {
            "u": ("corner", u, "mm", "displacement conjugate to the force"),
            "F": ("corner", F, "N", "force"),
            "u_c": ("step", [s.u_c for s in steps], "mm", "critical displacement"),
            "u_load": ("step", history.loads, "mm", "displacement at which it happens"),
            "stiffness": ("step", history.stiffnesses[:-1], "N/mm", "stiffness before the step"),
            "event": ("step", np.array([str(s.kind) for s in steps], dtype=str), "1", "what happens"),
            "criterion": (
                "step",
                np.array([s.event.criterion for s in steps], dtype=str),
                "1",
                "what decides on it",
            ),
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
            "T": (
                "step",
                [s.T for s in steps],
                "MPa",
                "stress along the crack at the critical load, for GMTS",
            ),
            "released": ("step", history.released, "mJ", "stored energy set free by the step"),
            "dissipated": ("step", dissipated, "mJ", "G_c times the new crack's area"),
            "excess": (
                "step",
                history.released - dissipated,
                "mJ",
                "energy set free that the new crack does not take: it goes into vibrations",
            ),
            "released_in_equilibrium": (
                "step",
                released_in_equilibrium(history),
                "mJ",
                "energy that stable growth by the step would set free, at falling or rising displacement",
            ),
            "gap": ("step", gap, "1", "by which the next event's load is higher, relative"),
            "tie": (
                "step",
                np.array([_tied(s) for s in steps], dtype=int),
                "1",
                f"how many events had its load, within {TIED:g}: what is nearest to the step before happens",
            ),
            "touches": (
                "step",
                np.array([s.closed > 0 for s in steps], dtype=bool),
                "1",
                "whether faces of cracks meet",
            ),
            "closed": (
                "step",
                [s.closed for s in steps],
                "mm",
                "length of cracks whose faces hold each other",
            ),
            "crack_x": (("crack", "point"), x, "mm", "x along the cracks"),
            "crack_y": (("crack", "point"), y, "mm", "y along the cracks"),
            "crack_step": (("crack", "point"), step, "1", "step that led there, -1 before the first"),
            **_candidates(candidates),
            **_excluded(excluded),
            "loose_step": (
                "loose",
                np.array([piece.step for piece in loose], dtype=int),
                "1",
                "step that set a piece loose, which carries nothing and is taken away; -1 before the first",
            ),
            "loose_x": ("loose", np.array([piece.x for piece in loose]), "mm", "x of its middle"),
            "loose_y": ("loose", np.array([piece.y for piece in loose]), "mm", "y of its middle"),
            "loose_area": ("loose", np.array([piece.area for piece in loose]), "mm2", "its area"),
            "equilibrium_u": ("state", path.u, "mm", "displacement along the equilibrium path"),
            "equilibrium_F": ("state", path.F, "N", "force along the equilibrium path"),
            "equilibrium_step": ("state", path.step, "1", "step that happens there, -1 for none"),
            "equilibrium_jump": (
                "state",
                path.jump,
                "1",
                "whether there is no equilibrium between the state before and this one",
            ),
            "force_controlled_u": (
                "force_corner",
                controlled.u,
                "mm",
                "displacement if the force is controlled, until the part breaks",
            ),
            "force_controlled_F": ("force_corner", controlled.F, "N", "force if it is controlled"),
            "F_peak": ((), controlled.peak, "N", "largest force"),
            "peak_step": (
                (),
                controlled.step,
                "1",
                "step at which the part breaks if the force is controlled, -1 if it was not severed",
            ),
            "U_T": ((), U_T, "mJ", "tensile toughness, the area below F(u)"),
            "U_T_error": (
                (),
                discretisation + lacks.by_growth + lacks.by_starts,
                "mJ",
                "estimated error of the tensile toughness",
            ),
            "U_T_integrated": (
                (),
                U_T + lacks.by_growth,
                "mJ",
                "tensile toughness with F falling steadily where cracks grow steadily",
            ),
            "U_T_integrated_error": (
                (),
                discretisation + lacks.error + lacks.by_starts,
                "mJ",
                "estimated error of the tensile toughness with F falling steadily",
            ),
            "work": ((), work, "mJ", "work of the force"),
            "stored": ((), history.stored, "mJ", "energy stored at the end"),
            "imbalance": (
                (),
                work - float(np.sum(history.released)) - history.stored,
                "mJ",
                "work less what was dissipated, went into vibrations and is stored",
            ),
        },
        title=scene.title,
        outcome=f"{history.outcome}: {history.reason}" if history.reason else str(history.outcome),
        error_is=ERROR_IS,
        **settings,
    )
    if excluded:
        reasons = "; ".join(sorted({each.reason for _, each in excluded}))
        result.attrs["excluded_starts"] = f"critical before what happened, and not let crack: {reasons}"
    if history.outcome not in WHOLE:
        result.U_T.attrs["comment"] = f"a lower bound: the simulation ended early ({history.outcome})"
    if direction.asks_for_T:
        result.attrs["forking_directions"] = int(np.sum([direction.forks(*s.K, s.T) for s in steps]))
    competing = int(np.sum(gap < COMPETING))
    result.attrs["competing_events"] = competing
    result["gap"].attrs["comment"] = (
        f"below {COMPETING:g} events compete, and the path may fork; ties below {TIED:g} go to tips before starts, "
        "then to what is nearest to where the step before ended, and if that is the same to the lowest hole, y and x"
    )
    return result


def _tied(step: Step) -> int:
    """How many events might have been a step."""
    loads = np.array([candidate.u_c for candidate in step.candidates])
    return int(np.sum(loads <= loads.min(initial=math.inf) * (1 + TIED)))


def _candidates(candidates: Sequence[tuple[int, Candidate]]) -> dict[str, tuple[str, Any, str, str]]:
    """Everything that was in question, step by step."""
    every = [candidate for _, candidate in candidates]
    values = {
        "step": (np.array([k for k, _ in candidates], dtype=int), "1", "step in which it was in question"),
        "u_c": (np.array([c.u_c for c in every]), "mm", "its critical displacement"),
        "event": (np.array([str(c.kind) for c in every], dtype=str), "1", "what would have happened"),
        "tip": (np.array([c.crack for c in every], dtype=int), "1", "crack whose tip it is, -1 of a surface"),
        "hole": (
            np.array([c.hole for c in every], dtype=int),
            "1",
            "outline where a crack would start, -1 of a straight edge and of tips",
        ),
        "x": (np.array([c.x for c in every]), "mm", "x of the tip or the place on the surface"),
        "y": (np.array([c.y for c in every]), "mm", "y of the tip or the place on the surface"),
    }
    return {f"candidate_{name}": ("candidate", *labels) for name, labels in values.items()}


def _excluded(excluded: Sequence[tuple[int, Excluded]]) -> dict[str, tuple[str, Any, str, str]]:
    """Surfaces that would have cracked first, and are not let, step by step."""
    every = [each for _, each in excluded]
    values = {
        "step": (
            np.array([k for k, _ in excluded], dtype=int),
            "1",
            "step before which it would have cracked",
        ),
        "u_c": (np.array([e.u_c for e in every]), "mm", "critical displacement of what is not let crack"),
        "x": (np.array([e.x for e in every]), "mm", "x of what is not let crack"),
        "y": (np.array([e.y for e in every]), "mm", "y of what is not let crack"),
        "reason": (np.array([e.reason for e in every], dtype=str), "1", "why it is not let crack"),
    }
    return {f"excluded_{name}": ("excluded", *labels) for name, labels in values.items()}


def _paths(
    lines: Sequence[np.ndarray], reached: Sequence[Sequence[int]]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates and steps (cracks, points) along the cracks, NaN beyond their ends."""
    longest = max((len(line) for line in lines), default=0)
    values = np.full((3, len(lines), longest), math.nan)
    for k, (line, steps) in enumerate(zip(lines, reached, strict=True)):
        n = len(line)
        values[:2, k, :n] = line.T
        values[2, k, :n] = steps
    return values[0], values[1], values[2]
