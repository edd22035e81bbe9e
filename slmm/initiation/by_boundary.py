"""Method boundary: trial cracks in the part by boundary integrals, exact curves without a mesh.

The part is factorised once, of two orders. At smooth surfaces all positions are one block of right-hand sides, and each
crack has a system of its own; elsewhere, and where that is not enough, a trial crack is a border to the factorised
part. What the lower order, with fewer places or lengths, has differently tells the error.
"""

from __future__ import annotations

import numpy as np

from slmm.boundary.model import BoundaryModel
from slmm.boundary.part_corrections import Starts, tangents
from slmm.boundary.surface_cracks import PLACES, SurfaceCracks
from slmm.boundary.trial_cracks import SOLVED, TrialCracks
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.initiation.boundary_field import COVERED, BoundaryField, solve_boundary
from slmm.initiation.cell_errors import reference_stress
from slmm.initiation.evidence import Stands
from slmm.initiation.paths import IN_LIGAMENT, Paths
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
#: an estimated error of G_inc, as a share, beyond which a crack is asked as a border, where the index is at least this
#: share of the largest (both chosen)
ENOUGH, MATTERS = 2e-3, 0.25
#: why a position is none of a smooth surface's
NO_CIRCLE = "another crack, or a corner or jump of the curvature within the crack's length"
#: lengths between two breaks of cracks at corners and tips, where the power is known: 2e-5 of G_inc (chosen)
BY_POWER = 4
#: panels about uncertain positions are as short as this share of their longest cracks asks for, at so many of them at
#: most (both chosen)
FINER, MOST_FINER = 0.3, 24
#: fewer places of the lower order
FEWER = 1
#: numbers of the closed forms that are kept at once: 64 MB (chosen)
MOST_NUMBERS = 2_000_000


def by_boundary(task: Task) -> Answer:
    """Answer all positions from one part that is factorised once."""
    answer = Answer.empty(task.n, "boundary")
    field = _field(task, answer)
    if field is None:
        return answer
    field = _from_surfaces(field, task, answer, ENOUGH)
    left = _not_enough(answer)
    for k, i in enumerate(left.tolist()):
        if len(left) > 1:  # of a single one, whoever asks says where it stands
            task.progress(k / len(left), f"trial cracks, position {k + 1} of {len(left)}")
        _one_by_one(field, task, answer, i)
    return answer


def by_surfaces(task: Task) -> Answer:
    """Answer what needs no crack as a border: positions on smooth surfaces, all at once."""
    answer = Answer.empty(task.n, "boundary")
    field = _field(task, answer)
    if field is not None:
        _from_surfaces(field, task, answer, task.tolerance)
        answer.status[answer.status == ""] = Status.NO_TRIAL.of(NO_CIRCLE)
    return answer


def by_borders(task: Task) -> Answer:
    """Answer position by position, with cracks as borders alone."""
    answer = Answer.empty(task.n, "boundary")
    field = _field(task, answer)
    if field is not None:
        for i in range(task.n):
            _one_by_one(field, task, answer, i)
    return answer


def _field(task: Task, answer: Answer) -> BoundaryField | None:
    """The factorised part; the answer says why there is none."""
    task.progress(0.0, "boundary integrals")
    answer.column("curvature")[:] = 0.5 * _bend(task)
    try:
        field: BoundaryField = task.solved.get("boundary") or solve_boundary(task.scene)
    except ValueError as error:
        answer.status[:] = Status.NO_TRIAL.of(error)
        return None
    task.solved["boundary"] = field
    answer.note(**field.described)
    return field


def _bend(task: Task) -> np.ndarray:
    """Curvature (n,) of the surface at smooth positions, 1/mm."""
    bend = np.full(task.n, np.nan)
    for k, outline in enumerate(task.scene.outlines):
        smooth = task.smooth & (task.where.hole == k)
        bend[smooth] = outline.curvatures(task.where.s[smooth])
    return bend


def _not_enough(answer: Answer) -> np.ndarray:
    """Positions that need a closer look: without curves, or where the energy's error is too large for the index."""
    has_value = answer.status == Status.OK
    with np.errstate(divide="ignore"):
        index = np.where(has_value, 1 / answer.load_factor, np.nan)
    large = index >= MATTERS * np.nanmax(index, initial=0.0)
    curves = answer.curves
    away = np.abs(curves.a - np.nan_to_num(answer.crack_length)[:, None])
    at = np.nan_to_num(away, nan=np.inf).argmin(axis=1)
    uncertain = large & (curves.G_error[np.arange(len(at)), at] > ENOUGH)
    settled = has_value | np.isin(answer.status, (Status.CLOSES, Status.BEYOND_PATH))
    return np.flatnonzero(~settled | uncertain)


def _from_surfaces(field: BoundaryField, task: Task, answer: Answer, enough: float) -> BoundaryField:
    """Fill the rows at smooth surfaces for which a circle stands, and give the part that served last.

    Where that leaves more than a relative error ``enough``, panels about the mouths are made as short as cracks there.
    """
    rows = np.flatnonzero(task.smooth)
    if task.scene.part.cracks or not len(rows):
        return field
    _at_once(field, task, answer, rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        index = np.where(answer.status == Status.OK, 1 / answer.load_factor, np.nan)
    largest = np.nanmax(index, initial=0.0) or reference_stress(task.scene) / task.scene.material.sigma_c
    allowed = enough * np.maximum(index, MATTERS * largest)
    uncertain = ~(answer.index_error <= allowed) & ~np.isin(
        answer.status, (Status.CLOSES, Status.BEYOND_PATH)
    )
    rows = rows[uncertain[rows]]
    if not len(rows):
        return field
    # those that are known to be the smallest come last
    rows = rows[np.argsort(-np.nan_to_num(index[rows], nan=np.inf), kind="stable")][:MOST_FINER]
    ahead = task.paths.start[rows] + FINER * task.paths.longest[rows, None] * task.paths.direction[rows]
    try:
        field = field.finer_about(_complex(ahead))
    except ValueError:
        return field
    task.solved["boundary"] = field
    part = task.among(rows)
    found = Answer.empty(part.n, "boundary")
    found.column("curvature")[:] = answer.column("curvature")[rows]
    _at_once(field, part, found, np.arange(part.n))
    known = answer.rows(rows)
    better = (found.status != "") & ~(known.index_error <= found.index_error)
    answer.take(rows[better], found.rows(np.flatnonzero(better)))
    return field


def _at_once(field: BoundaryField, task: Task, answer: Answer, rows: np.ndarray) -> None:
    """Fill some rows at smooth surfaces, with the usual paths, and then longer ones."""
    bend, normal = _bend(task), np.full((task.n, 2), np.nan)
    for k, outline in enumerate(task.scene.outlines):
        on_k = rows[task.where.hole[rows] == k]
        normal[on_k] = outline.normals(task.where.s[on_k])
    at_once = max(1, MOST_NUMBERS // (field.model.panels.n * 2 * PLACES))
    for paths in (task.paths, task.paths.lengthened()):
        for of in np.array_split(rows, -(-len(rows) // at_once)) if len(rows) else []:
            _judged_at_once(field, task, answer, of, paths, bend[of], _complex(normal[of]))
        rows = rows[answer.status[rows] == Status.BEYOND_PATH]


def _complex(vectors: np.ndarray) -> np.ndarray:
    """Vectors (k, 2) as complex numbers (k,)."""
    return np.asarray(vectors[:, 0] + 1j * vectors[:, 1])


def _judged_at_once(
    field: BoundaryField,
    task: Task,
    answer: Answer,
    rows: np.ndarray,
    paths: Paths,
    bend: np.ndarray,
    normal: np.ndarray,
) -> None:
    """Fill some rows by cracks along their paths."""
    starts = Starts(
        _complex(paths.start[rows]), _complex(paths.direction[rows]), normal, bend, paths.longest[rows]
    )
    stand = tangents(field.model, starts)
    known = np.array([tangent is not None for tangent in stand], dtype=bool)
    if not known.any():
        return
    rows, starts = rows[known], Starts(*(values[known] for values in starts))
    found = [tangent for tangent in stand if tangent is not None]
    a = path_points(starts.longest)
    by_order = [
        SurfaceCracks(model, starts, found, places)
        for model, places in ((field.model, PLACES), (field.lower, PLACES - FEWER))
    ]
    sigma, low = (principal_stress(cracks.stress(a).reshape(-1, 3)).reshape(a.shape) for cracks in by_order)
    sigma_error = _relative(sigma, low)
    G, lower = (cracks.incremental(a) for cracks in by_order)
    scale = np.abs(G / np.maximum(a, 1e-300)).max(axis=1, keepdims=True) * a
    with np.errstate(divide="ignore", invalid="ignore"):
        off = COVERED * np.abs(G - lower) + by_order[0].tail[:, None] * scale
        G_error = FLOOR + np.where(G > 0, off / G, 0.0)
    # without tension anywhere on the path nothing starts there
    free = sigma.max(axis=1) <= 0
    G[free] = G_error[free] = 0.0
    closes = _closes(by_order[0].K, by_order[0].lengths)
    closes[free] = np.inf
    curves, stands = PathCurves(a, G, sigma, G_error, sigma_error), Stands.below(closes, Status.CLOSES)
    answer.judge(rows, curves, task, Status.BEYOND_PATH, stands=stands)


def _closes(K: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Lengths (k,) of the shortest cracks that close, mm, of some with K (k, n, 2) at lengths (k, n), mm."""
    closed = K[..., 0] < -CLOSED * np.abs(K).max(axis=(1, 2))[:, None]
    return np.where(closed, lengths, np.inf).min(axis=1)


def _relative(high: np.ndarray, low: np.ndarray) -> np.ndarray:
    """Relative error of stresses (..., k) along paths, by those of the lower order, MPa."""
    error = FLOOR * np.abs(high).max(axis=-1, keepdims=True) + COVERED * np.abs(high - low)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(high != 0, error / np.abs(high), 0.0)


def _one_by_one(field: BoundaryField, task: Task, answer: Answer, i: int) -> None:
    """Fill one row by cracks as borders, with the usual path, and then a longer one."""
    for longest in dict.fromkeys((task.paths.longest[i], task.paths.lengthened().longest[i])):
        if not _judged(field, task, answer, i, float(longest)):
            break


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
        solved = SOLVED if task.smooth[i] else BY_POWER
        orders = (field.model, solved), (field.lower, solved - 1)
        trials = [_trial(model, task, i, longest, lengths) for model, lengths in orders]
    except ValueError as error:
        answer.status[i] = Status.NO_TRIAL.of(error)
        return False
    G, lower = (np.concatenate([[0.0], trial.incremental(a[0, 1:])]) for trial in trials)
    if trials[0].exponent == 0:
        G[0], lower[0] = G[1], lower[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        G_error = FLOOR + COVERED * np.where(G > 0, np.abs(G - lower) / G, 0.0)
    curves = PathCurves(a, G[None], sigma[None], G_error[None], sigma_error[None])
    stands = Stands.below(_closes(trials[0].K[None], trials[0].lengths[None]), Status.CLOSES)
    answer.judge(np.array([i]), curves, task, Status.BEYOND_PATH, stands=stands)
    return str(answer.status[i]) == Status.BEYOND_PATH


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
    relative = _relative(high, low)
    if singular:
        high[0], relative[0] = np.inf, 0.0
    return high, relative
