"""Method full-fea: a body-fitted model with a true slit for every position.

Where no crack of the usual lengths meets both conditions with the least load, the path goes through the whole ligament.
A crack may then start that severs it at once: the energy released is that of the severed part (infinite where the
load carries a piece away), and the stress has to reach the strength over the whole ligament.

The third of three meshes costs four fifths of the time. Where a tolerance is asked for, two come first.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.initiation.full_fea import LEVELS, FullFEA, full_fea_curves
from slmm.initiation.paths import IN_LIGAMENT, ligament_end
from slmm.initiation.task import Answer, Task

#: crack lengths of a path, and the longest over the shortest; both chosen
LENGTHS, SPAN = 25, 120.0
#: of a path through a ligament, up to its middle; both chosen
HALF_LENGTHS, HALF_SPAN = 20, 60.0
#: meshes of a model that need not be the best; chosen
FEWER_LEVELS = 2

#: stress that stands for none where its logarithm is taken, MPa; its square is not yet zero; computed
LEAST = 1e-100
#: of the stress, as a share of the largest along the path: two meshes may agree to more digits than either has (chosen)
ROUND_OFF = 1e-6


def by_full_fea(task: Task, least: float | None = None, reached: np.ndarray | None = None) -> Answer:
    """Answer position by position.

    Parameters
    ----------
    task : Task
    least : float, optional
        Two meshes do where they meet the task's tolerance, of the failure index or of this one, whichever is larger;
        by default three are made in any case.
    reached : ndarray (n,), optional
        Up to which lengths curves are known to end too early, mm; NaN where nothing is known.
    """
    reached = np.full(task.n, np.nan) if reached is None else reached
    answer = Answer.empty(task.n, "full-fea")
    for i in range(task.n):
        if task.n > 1:  # of a single one, whoever asks says where it stands
            task.progress(i / task.n, f"full FEA, position {i + 1} of {task.n}")
        _at_position(task, answer, i, least, float(reached[i]))
    for k, outline in enumerate(task.scene.outlines):
        smooth = task.smooth & (task.where.hole == k)
        answer.column("curvature")[smooth] = 0.5 * outline.curvatures(task.where.s[smooth])
    answer.note(local_model="body-fitted, with a slit for each position")
    return answer


def _at_position(task: Task, answer: Answer, i: int, least: float | None, reached: float) -> None:
    """Fill one row: with the usual path, a longer one, and one through the ligament, as long as none is enough."""
    within = IN_LIGAMENT * float(task.paths.ligament[i])
    usual, longer = float(task.paths.longest[i]), float(task.paths.lengthened().longest[i])
    # what reaches that far goes through at once; where that cannot be meshed, curves up to there are bounds
    shorter = [
        longest for longest in (usual, longer) if longest < 0.999 * within and not longest <= 1.001 * reached
    ]
    for longest in (*shorter, np.inf, within):
        for levels in (LEVELS,) if least is None else (FEWER_LEVELS, LEVELS):
            try:
                model = _model(task, i, longest, levels)
            except (ValueError, RuntimeError) as error:
                answer.status[i] = answer.status[i] or Status.NO_MESH.of(error)
                break
            curves = sampled(model, float(task.where.corner[i]))
            answer.judge(np.array([i]), curves, task, Status.BEYOND_PATH, np.array([model.severs]))
            allowed = task.tolerance * max(1 / answer.load_factor[i], least or 0.0)
            if answer.status[i] != Status.OK or answer.index_error[i] <= allowed:
                break
        if answer.status[i] == Status.OK:
            return


def _model(task: Task, i: int, longest: float, levels: int) -> FullFEA:
    """The model of a position's path, as long as given, mm, or, when that is infinite, through its ligament."""
    paths = task.paths
    start, direction, singular = paths.start[i], paths.direction[i], not task.smooth[i]
    if np.isfinite(longest):
        return full_fea_curves(
            task.scene,
            a_max=longest,
            n_lengths=LENGTHS,
            a_min=longest / SPAN,
            start=start,
            direction=direction,
            singular=singular,
            levels=levels,
        )
    end = ligament_end(task.scene, paths, i)
    return full_fea_curves(
        task.scene,
        n_lengths=HALF_LENGTHS,
        a_min=0.5 * paths.ligament[i] / HALF_SPAN,
        start=start,
        direction=direction,
        singular=singular,
        end=end,
        levels=levels,
    )


def sampled(model: FullFEA, corner: float) -> PathCurves:
    """The curves of one path (1, CURVE_POINTS).

    Parameters
    ----------
    model : FullFEA
    corner : float
        Opening angle where the path starts at a corner or, 0, at a crack tip, rad; NaN at a smooth surface.
    """
    a = path_points(model.a[-1:])
    logarithm = np.log(np.maximum(a, model.a[0]))
    G = np.zeros_like(a)
    if model.G_inc[0] > 0:  # else the crack is closed from its mouth on
        # towards a far surface the energy may turn sharply
        energy = (PchipInterpolator if model.severs else CubicSpline)(np.log(model.a), np.log(model.G_inc))
        # below the shortest crack the power law goes on: linear at a smooth surface, constant at a crack tip, between
        # them at a corner, where that of a narrow notch is hardly above round-off
        slope = 1.0 if np.isnan(corner) else 0.0 if corner == 0 else float(energy(np.log(model.a[0]), 1))
        exponent = max(slope, 0.0)
        G = np.exp(energy(logarithm)) * np.where(a < model.a[0], a / model.a[0], 1.0) ** exponent
    if np.isnan(corner):
        sigma = CubicSpline(model.eta, model.sigma_I)(a)
        sigma_error = np.interp(a, model.eta, model.sigma_I_error)
    else:
        # infinite at the mouth, where the model has none
        sigma = np.exp(np.interp(logarithm, np.log(model.eta), np.log(np.maximum(model.sigma_I, LEAST))))
        sigma_error = np.interp(a, model.eta, model.sigma_I_error)
        sigma[a < model.a[0]] = np.inf
    G_error = np.interp(a, model.a, model.G_inc_error / np.maximum(model.G_inc, 1e-300))
    with np.errstate(invalid="ignore"):
        finite = np.isfinite(sigma)
        sigma_error = np.maximum(sigma_error, ROUND_OFF * np.max(np.abs(sigma[finite])))
        relative = np.where(finite, sigma_error / np.maximum(np.abs(sigma), 1e-300), 0.0)
    return PathCurves(a, G, sigma, G_error, relative)
