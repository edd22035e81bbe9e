"""Method boundary: trial cracks in the part by boundary integrals, exact curves without a mesh.

The part is factorised once, of two orders; each trial crack costs its own unknowns. What the lower order, with one
length fewer between breaks, has differently tells the error.
"""

from __future__ import annotations

import numpy as np

from slmm.boundary.model import BoundaryModel
from slmm.boundary.trial_cracks import SOLVED, TrialCracks
from slmm.criteria.coupled import NONE
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.initiation.boundary_field import COVERED, BoundaryField, solve_boundary
from slmm.initiation.paths import IN_LIGAMENT
from slmm.initiation.task import Answer, Task
from slmm.mechanics.stress import principal_stress
from slmm.mechanics.williams import singular_exponent

#: a mode I share of a closed crack that counts as none; round-off
CLOSED = 1e-6
#: what is always there, as a share: interpolation between lengths and round-off; chosen
FLOOR = 1e-5
#: trial cracks in a ligament reach so many of the part's tolerances at least, for the shortest of them is 1/247
#: of the longest; round-off
IN_TOLERANCES = 250.0


def by_boundary(task: Task) -> Answer:
    """Answer position by position, from one part that is factorised once."""
    answer = Answer.empty(task.n, "boundary")
    task.progress(0.0, "boundary integrals")
    try:
        field = task.solved.get("boundary") or solve_boundary(task.scene)
    except ValueError as error:
        answer.status[:] = Status.NO_TRIAL.of(error)
        return answer
    task.solved["boundary"] = field
    for i in range(task.n):
        if task.n > 1:  # of a single one, whoever asks says where it stands
            task.progress(i / task.n, f"trial cracks, position {i + 1} of {task.n}")
        for longest in dict.fromkeys((task.paths.longest[i], task.paths.lengthened().longest[i])):
            if not _judged(field, task, answer, i, float(longest)):
                break
    for k, outline in enumerate(task.scene.outlines):
        smooth = task.smooth & (task.where.hole == k)
        answer.column("curvature")[smooth] = 0.5 * outline.curvatures(task.where.s[smooth])
    answer.note(**field.described)
    return answer


def _judged(field: BoundaryField, task: Task, answer: Answer, i: int, longest: float) -> bool:
    """Fill one row by cracks up to a length, mm; whether longer ones may have a value."""
    least = IN_TOLERANCES * task.scene.part.tolerance
    if longest < least and longest >= 0.999 * IN_LIGAMENT * task.paths.ligament[i]:
        thin = f"a ligament of {task.paths.ligament[i]:.3g} mm is too thin, at least {least / IN_LIGAMENT:.3g} mm"
        answer.status[i] = Status.NO_TRIAL.of(thin)
        return False
    a = path_points(np.array([longest]))
    points = task.paths.start[i] + a[0, :, None] * task.paths.direction[i]
    sigma, sigma_error = _principal(field, points, singular=not task.smooth[i])
    if sigma.max() <= 0 and task.smooth[i]:
        # without tension anywhere on the path nothing starts there, and no crack needs to be asked
        nothing = np.zeros_like(a)
        curves = PathCurves(a, nothing, sigma[None], nothing, sigma_error[None])
        answer.judge(np.array([i]), curves, task, Status.BEYOND_PATH)
        return False
    try:
        trials = [_trial(model, task, i, longest, solved) for model, solved in _orders(field)]
    except ValueError as error:
        answer.status[i] = Status.NO_TRIAL.of(error)
        return False
    G, lower = (np.concatenate([[0.0], trial.incremental(a[0, 1:])]) for trial in trials)
    if trials[0].exponent == 0:
        G[0], lower[0] = G[1], lower[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        G_error = FLOOR + COVERED * np.where(G > 0, np.abs(G - lower) / G, 0.0)
    curves = PathCurves(a, G[None], sigma[None], G_error[None], sigma_error[None])
    answer.judge(np.array([i]), curves, task, Status.BEYOND_PATH)
    K = trials[0].K
    if answer.status[i] == Status.OK and np.isfinite(answer.load_factor[i]):
        reached = trials[0].lengths <= np.nan_to_num(answer.crack_length[i], nan=longest)
        if np.any(K[reached, 0] < -CLOSED * np.abs(K).max()):
            answer.load_factor[i] = answer.crack_length[i] = answer.error[i] = np.nan
            answer.governed_by[i], answer.status[i] = NONE, Status.CLOSES
    return str(answer.status[i]) == Status.BEYOND_PATH


def _orders(field: BoundaryField) -> tuple[tuple[BoundaryModel, int], ...]:
    """Both models, and at how many lengths between two breaks they are asked."""
    return (field.model, SOLVED), (field.lower, SOLVED - 1)


def _trial(model: BoundaryModel, task: Task, i: int, longest: float, solved: int) -> TrialCracks:
    """Trial cracks of a position up to a length, mm."""
    opening, exponent, tip = float(task.where.corner[i]), 1.0, None
    if opening == 0:
        exponent, tip = 0.0, int(task.where.tip[i])
    elif np.isfinite(opening):
        exponent = 2 * singular_exponent(opening) - 1
    return TrialCracks(model, task.paths.start[i], task.paths.direction[i], longest, exponent, tip, solved)


def _principal(field: BoundaryField, points: np.ndarray, singular: bool) -> tuple[np.ndarray, np.ndarray]:
    """Principal stress (k,) along a path from its mouth, MPa, and its relative error."""
    if singular:
        points = np.concatenate([points[1:2], points[1:]])
    high, low = (principal_stress(model.stress(points)) for model in (field.model, field.lower))
    error = FLOOR * np.abs(high).max() + COVERED * np.abs(high - low)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(high != 0, error / np.abs(high), 0.0)
    if singular:
        high[0], relative[0] = np.inf, 0.0
    return high, relative
