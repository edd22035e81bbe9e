"""What the dislocations' estimate of their errors is made of: its factors fitted to full FEA on random scenes.

`slmm.initiation.by_dislocations` puts the error of the energy at ENERGY_FLOOR times what the stress has faded to, and
SAFETY times what two meshes and the samples of the surroundings leave open; beside a surface that is compared with a
straight edge (`slmm.initiation.dislocations`) BEND_UNSEEN times the bend along the crack is open, too. That of the
stress is STRESS_FLOOR and SAFETY times what the extrapolation changed.

Data: random outlines, loads and materials of stability.py, Irwin's length 0.02 to 1 times the mean radius of the notch;
at the position of the highest stress and at a random one with at least a tenth of it, eight crack lengths. True is full
FEA on three meshes; its own error is taken off. Fit: quantile regression, see fitting.py, of energies and stresses
together, since both have SAFETY. Required: the constants in the package leave one error of twenty, at most, above its
estimate.

Completes validation/results/fit_dislocation_errors.csv, one line for each crack length, some five seconds a scene;
started again, it goes on with what is missing, ``--scenes 40`` does less. ``--quick`` fits to what is there.
"""

from __future__ import annotations

from unittest import mock

import numpy as np
import stability
from checks import Check, show
from estimates import COVERED, with_irwin_length
from fitting import Row, completed, judged_factors, run, stored, task_at
from scipy.interpolate import CubicSpline

from slmm.criteria.path_curves import PathCurves
from slmm.fem.triangulation import MesherError
from slmm.initiation import by_dislocations, dislocations
from slmm.initiation.by_dislocations import SAMPLED_LIGAMENT, body_fitted_model, sampled
from slmm.initiation.cell_errors import faded, reference_stress
from slmm.initiation.full_fea import full_fea_curves
from slmm.mechanics.stress import principal_stress

NAME, SCENES = "fit_dislocation_errors", 200
POSITIONS = 24
#: crack lengths of a position, and the longest over the shortest
LENGTHS, SPAN = 8, 30.0
#: share of the highest stress below which a position is left out; and of the highest G_inc/a, a length
LEAST_STRESS, LEAST_ENERGY = 0.1, 0.01
NAMES = ("ENERGY_FLOOR", "STRESS_FLOOR", "SAFETY", "SAFETY BEND_UNSEEN")


def examine(number: int) -> list[Row]:
    """Errors, and what tells of them, at two positions of one random scene."""
    rng = np.random.default_rng([number, 2])
    scene = stability.scene(np.random.default_rng(number))
    mean_radius = scene.outlines[0].length / (2 * np.pi)
    scene = with_irwin_length(scene, mean_radius * float(np.exp(rng.uniform(np.log(0.02), 0.0))))
    task = task_at(scene, POSITIONS)
    try:
        model = body_fitted_model(task)
    except MesherError:
        return []
    stress = principal_stress(model.stress(task.where.points)[0])
    top = int(np.nanargmax(stress))
    others = np.flatnonzero(stress > LEAST_STRESS * max(stress[top], 0.0))
    others = rng.permutation(others[others != top])
    if not stress[top] > 0:
        return []
    rows: list[Row] = []
    with mock.patch.object(dislocations, "BEND_UNSEEN", 0.0):
        of_part = dislocations.DislocationModel(scene, model, task.n)
        for i in (top, *others[:1].tolist()):
            outline, s = scene.outlines[task.where.hole[i]], float(task.where.s[i])
            longest = min(task.paths.longest[i], SAMPLED_LIGAMENT * task.paths.ligament[i])
            trial = of_part.trial(outline, s, float(longest))
            (found,) = of_part.curves([trial])
            with mock.patch.multiple(by_dislocations, SAFETY=1.0, ENERGY_FLOOR=0.0, STRESS_FLOOR=0.0):
                curves = sampled(found, reference_stress(scene))
            try:
                rows += against_full_fea(scene, int(task.where.hole[i]), s, curves, trial)
            except (ValueError, RuntimeError):  # no mesh with a slit
                continue
    return [{"scene": number} | row for row in rows]


def against_full_fea(scene, hole: int, s: float, curves: PathCurves, trial: dislocations.Trial) -> list[Row]:
    """Lines of one position, one for each crack length."""
    a_max = float(curves.a[0, -1])
    true = full_fea_curves(scene, hole, s, a_max, n_lengths=LENGTHS, a_min=a_max / SPAN)
    a, at = true.a, curves.a[0]
    per_length = CubicSpline(at[1:], curves.G_inc[0, 1:] / at[1:])(a)
    sigma = CubicSpline(at, curves.sigma_I[0])(a)
    G_change, change = (np.interp(a, at, values[0]) for values in (curves.G_error, curves.sigma_error))
    fade = faded(reference_stress(scene), sigma)
    bend = abs(trial.curvature) * a if np.isinf(trial.radius) else np.zeros_like(a)
    G = np.maximum(per_length * a, 1e-300)
    G_off = np.maximum(np.abs(G - true.G_inc) - true.G_inc_error, 0.0) / G
    off = np.maximum(np.abs(sigma - true.sigma_I[1:]) - true.sigma_I_error[1:], 0.0) / np.abs(sigma)
    opens = true.G_inc / a > LEAST_ENERGY * np.max(true.G_inc / a)
    names = ("s", "a", "fade", "bend", "G_error", "G_change", "sigma_error", "sigma_change")
    columns = (np.full(len(a), s), a, fade, bend, G_off, G_change, off, change)
    return [dict(zip(names, map(float, line), strict=True)) for line in np.column_stack(columns)[opens]]


def judged(rows: list[Row]) -> list[Check]:
    """Fitted factors beside the constants."""
    fade, bend, G_error, G_change, error, change = (
        np.array([row[name] for row in rows])
        for name in ("fade", "bend", "G_error", "G_change", "sigma_error", "sigma_change")
    )
    none = np.zeros_like(fade)
    energy = np.column_stack([fade, none, G_change, bend])
    stress = np.column_stack([none, fade, change, none])
    safety = by_dislocations.SAFETY
    constants = (
        by_dislocations.ENERGY_FLOOR,
        by_dislocations.STRESS_FLOOR,
        safety,
        safety * dislocations.BEND_UNSEEN,
    )
    scenes = len({row["scene"] for row in rows})
    G_above, above, bent = G_error > energy @ constants, error > stress @ constants, bend > 0
    alone = [
        Check(
            f"{len(values)} errors, {what} alone",
            "constants: errors above their estimate",
            1 - COVERED,
            float(values.mean()),
            rule="told",
        )
        for what, values in (("energy", G_above), ("energy beside a bend", G_above[bent]), ("stress", above))
    ]
    return alone + judged_factors(
        f"{scenes} random scenes, {2 * len(rows)} errors",
        NAMES,
        constants,
        np.vstack([energy, stress]),
        np.concatenate([G_error, error]),
    )


def main(quick: bool = False, scenes: int = SCENES) -> list[Check]:
    rows = stored(NAME) if quick else completed(NAME, scenes, examine)
    checks = judged(rows)
    show("Errors of dislocations: factors of the estimate", checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__, SCENES)
