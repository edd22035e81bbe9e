"""What the estimated errors of crack cells are made of: factors fitted to dislocations on random scenes.

`slmm.initiation.cell_errors` adds up what was seen to matter: what is always there, the changes from a cell of half the
size and from a coarser local model, and for the energy also the distance between its two bounds, the support of the
plate's edges and whether the cell is a wide one. Each has a factor.

Data: random outlines, loads and materials of stability.py, Irwin's length 0.02 to 1 times the mean radius of the notch;
at eight of 24 positions with at least a tenth of the highest stress, the cell that answers there, at shares of the
critical crack's length. True is `dislocations` (their own errors are twenty times smaller). Fit: quantile regression,
see fitting.py, of stress and energy by themselves. Required: the constants in the package leave one error of twenty,
at most, above its estimate.

Completes validation/results/fit_cell_errors.csv, one line for each crack length, two seconds a scene; started again, it
goes on with what is missing, ``--scenes 40`` does less. ``--quick`` fits to what is there.
"""

from __future__ import annotations

from typing import Any
from unittest import mock

import numpy as np
import stability
from checks import Check, show
from estimates import with_irwin_length
from fitting import Row, completed, judged_factors, run, stored, task_at

from slmm.criteria.path_curves import PathCurves
from slmm.fem.triangulation import MesherError
from slmm.initiation import cell_errors, cells
from slmm.initiation.by_cells import local_field
from slmm.initiation.by_dislocations import body_fitted_model, sampled
from slmm.initiation.cell_errors import reference_stress
from slmm.initiation.cells import Placed, cell_curves, place_cells, select_modes
from slmm.initiation.dislocations import DislocationModel
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.task import Task
from slmm.mechanics.stress import principal_stress

NAME, SCENES = "fit_cell_errors", 200
POSITIONS, CHOSEN = 24, 8
#: crack lengths as shares of the critical one, and the longest that the truth is asked for
SHARES, LONGEST = np.array([0.25, 0.5, 1.0]), 1.2
#: share of the highest stress below which a position is left out
LEAST_STRESS = 0.1
OF_STRESS = ("STRESS_FLOOR", "STRESS_OF_CELL", "STRESS_OF_MODEL")
OF_ENERGY = (
    "ENERGY_FLOOR",
    "ENERGY_OF_SURFACE",
    "ENERGY_OF_CELL",
    "ENERGY_OF_MODEL",
    "ENERGY_OF_BRACKET",
    "ENERGY_OF_EDGES",
    "ENERGY_OF_WIDTH",
)


def examine(number: int) -> list[Row]:
    """Errors, and what tells of them, at some positions of one random scene."""
    rng = np.random.default_rng([number, 3])
    scene = stability.scene(np.random.default_rng(number))
    mean_radius = scene.outlines[0].length / (2 * np.pi)
    scene = with_irwin_length(scene, mean_radius * float(np.exp(rng.uniform(np.log(0.02), 0.0))))
    task = task_at(scene, POSITIONS)
    try:
        model = body_fitted_model(task)
    except MesherError:
        return []
    stress = principal_stress(model.stress(task.where.points)[0])
    if not np.nanmax(stress) > 0:
        return []
    candidates = rng.permutation(np.flatnonzero(stress > LEAST_STRESS * np.nanmax(stress)))
    task = task.among(np.sort(candidates[:CHOSEN]))
    local = local_field(task)
    truth = DislocationModel(scene, model, task.n)
    nu = scene.material.plane_stress_equivalent[1]
    meta = select_modes(load_meta_model(nu, task.database), task.settings.modes)
    rows: list[Row] = []
    for k, outline in enumerate(scene.outlines):
        left = np.flatnonzero(task.where.hole == k)
        # as in `by_cells`: a wide cell is asked where the fine one has no answer
        for rule in (task.settings.fine, task.settings.wide):
            placed = place_cells(scene, outline, task.where.s[left], local, meta, task.settings, rule)
            if not len(placed.rows):
                continue
            curves, told = curves_and_features(task, outline, placed, meta)
            lengths = task.criterion.judge(curves, scene.material).crack_length
            answered = np.flatnonzero(lengths > 0)
            if not len(answered):
                continue
            longest = LONGEST * lengths[answered]
            trials = [
                truth.trial(outline, float(placed.s[j]), a) for j, a in zip(answered, longest, strict=True)
            ]
            for j, true in zip(answered, truth.curves(trials), strict=True):
                true_curves = sampled(true, reference_stress(scene))
                rows += lines(curves.rows(np.array([j])), true_curves, told, j, lengths[j])
            left = np.delete(left, placed.rows[answered])
            if not len(left):
                break
    return [{"scene": number} | row for row in rows]


def curves_and_features(
    task: Task, outline: Any, placed: Placed, meta: Any
) -> tuple[PathCurves, dict[str, Any]]:
    """Curves of cells, and what their estimate was made of."""
    with mock.patch.object(cells, "energy_error", wraps=cells.energy_error) as asked:
        curves, _, _ = cell_curves(task.scene, outline, placed, meta, task.settings, True)
    names = ("of_cell", "of_model", "fade", "bracket", "support", "wide")
    return curves, dict(zip(names, asked.call_args.args, strict=True))


def lines(curves: PathCurves, true: PathCurves, told: dict[str, Any], j: int, critical: float) -> list[Row]:
    """Lines of one cell: at those shares of its critical crack's length that dislocations reach."""
    found = []
    for a in SHARES[SHARES * critical <= true.a[0, -1]] * critical:
        i = int(np.argmin(np.abs(curves.a[0] - a)))
        a, G, sigma = curves.a[0, i], curves.G_inc[0, i], curves.sigma_I[0, i]
        true_G = a * np.interp(a, true.a[0, 1:], true.G_inc[0, 1:] / true.a[0, 1:])
        true_sigma = np.interp(a, true.a[0], true.sigma_I[0])
        row = {
            "a": a,
            "fade": told["fade"][j, i],
            "of_surface": told["of_cell"][j, 0],
            "of_cell": told["of_cell"][j, i],
            "of_model": told["of_model"][j, i],
            "bracket": np.clip(told["bracket"][j, i], 0.0, 5.0),
            "support": abs(told["support"][j]),
            "wide": float(told["wide"]),
            "sigma_error": abs(true_sigma / sigma - 1),
            "G_error": abs(true_G / G - 1),
        }
        found.append({name: float(value) for name, value in row.items()})
    return found


def judged(rows: list[Row]) -> list[Check]:
    """Fitted factors beside the constants."""
    column = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    stress = np.column_stack([column[name] for name in ("fade", "of_cell", "of_model")])
    energy = np.column_stack(
        [column[name] for name in ("fade", "of_surface", "of_cell", "of_model", "bracket", "support", "wide")]
    )
    scenes = len({row["scene"] for row in rows})
    checks: list[Check] = []
    for what, names, features in (("stress", OF_STRESS, stress), ("energy", OF_ENERGY, energy)):
        errors = column["sigma_error" if what == "stress" else "G_error"]
        constants = [getattr(cell_errors, name) for name in names]
        case = f"{scenes} random scenes, {len(rows)} errors, {what}"
        checks += judged_factors(case, names, constants, features, errors)
    return checks


def main(quick: bool = False, scenes: int = SCENES) -> list[Check]:
    rows = stored(NAME) if quick else completed(NAME, scenes, examine)
    checks = judged(rows)
    show("Errors of crack cells: factors of the estimates", checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__, SCENES)
