"""Source stress: components on the path, from crack cells or a body-fitted model, for criteria that need no energy."""

from __future__ import annotations

import numpy as np

from slmm.criteria.distances import SAMPLES
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.criteria.surface import mises_stress
from slmm.fem.triangulation import MesherError
from slmm.initiation.by_cells import has_own_stress, local_field, note_reasons, rows_with_cells
from slmm.initiation.cells import cell_stress, place_cells, select_modes
from slmm.initiation.evidence import Stands
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.task import Answer, Task
from slmm.initiation.uncracked import UncrackedField, WithStress
from slmm.mechanics.stress import principal
from slmm.scene.scene import Scene

#: elements between a position and a corner or crack tip, at least: nearer, the estimated error is too small; chosen
AWAY_FROM_TIPS = 2


def by_stress(task: Task) -> Answer:
    """Answer of a strength criterion at the surface, or of a critical-distance method on the path."""
    answer = Answer.empty(task.n, "stress")
    depth = task.criterion.depth(task.scene.material)
    depths = np.linspace(0.0, depth, SAMPLES) if depth else np.zeros(1)
    if depth and task.for_shorter:
        depths = path_points(np.array([depth]))[0]
    own = has_own_stress(task)
    rows = np.flatnonzero(task.smooth) if own else rows_with_cells(task, answer)
    if len(rows):
        if not own:
            # first, because it refuses a Poisson's ratio that the voxel solver would fail at
            load_meta_model(task.scene.material.plane_stress_equivalent[1], task.database)
        try:
            field = local_field(task)
        except MesherError as failure:
            answer.status[rows] = Status.NO_MESH.of(failure)
        else:
            answer.note(**field.described)
            if isinstance(field, WithStress):
                _own_stress(field, task, answer, depths, rows)
            else:
                _cell_stress(field, task, answer, depths, rows)
            without = rows[answer.status[rows] != Status.OK]
            answer.status[without[depth > task.paths.ligament[without]]] = Status.TOO_DEEP
    answer.status[~task.smooth] = Status.SINGULAR
    return answer


def _weigh(
    task: Task, answer: Answer, rows: np.ndarray, depths: np.ndarray, stress: np.ndarray, error: np.ndarray
) -> None:
    """Apply the criterion to stress across, along, shear (k, 3, d) at depths (d,), with errors (k, d).

    NaN where a source ends.
    """
    across, along, shear = stress.swapaxes(0, 1)
    if "equivalent stress" in task.criterion.needs:
        measure = mises_stress(across, along, shear, task.scene.material)
    else:
        measure = principal(across, along, shear)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(measure != 0, error / np.abs(measure), 0.0)
    a = np.tile(depths, (len(rows), 1))
    reached = np.isfinite(stress).all(axis=1)
    for k in np.flatnonzero(~reached.all(axis=1)):
        # the same number of points as far as there is a stress
        last = int(reached[k].argmin()) - 1
        if last < 1:
            a[k] = np.nan
            continue
        a[k] = depths[last] * (depths / depths[-1])
        measure[k], relative[k] = (
            np.interp(a[k], depths[: last + 1], of[k, : last + 1]) for of in (measure, relative)
        )
    nothing = np.full(measure.shape, np.nan)
    curves = PathCurves(a, nothing, measure, nothing, relative)
    stands = Stands.below(task.paths.ligament[rows], Status.TOO_DEEP)
    answer.weigh(rows, curves, task, Status.CELL_ENDS, stands=stands)


def _own_stress(field: WithStress, task: Task, answer: Answer, depths: np.ndarray, rows: np.ndarray) -> None:
    """Fill some positions with what a field says itself."""
    paths = task.paths
    size = field.element_size(paths.start[rows])
    near = distance_to_tips(task.scene, paths.start[rows]) < AWAY_FROM_TIPS * size
    answer.status[rows[near]] = Status.NEAR_SINGULAR
    rows = rows[~near]
    points = paths.start[rows, None] + depths[:, None] * paths.direction[rows, None]
    sigma, error = field.stress(points.reshape(-1, 2))
    t = paths.direction[rows]
    xx, yy, xy = np.moveaxis(sigma.reshape(len(rows), len(depths), 3), -1, 0)
    tx, ty = t[:, :1], t[:, 1:]
    stress = np.stack(
        [
            xx * ty**2 + yy * tx**2 - 2 * xy * tx * ty,
            xx * tx**2 + yy * ty**2 + 2 * xy * tx * ty,
            (yy - xx) * tx * ty + xy * (tx**2 - ty**2),
        ],
        axis=1,
    )
    _weigh(task, answer, rows, depths, stress, error.reshape(len(rows), len(depths)))


def _cell_stress(
    field: UncrackedField, task: Task, answer: Answer, depths: np.ndarray, rows: np.ndarray
) -> None:
    """Fill some positions with what crack cells on a field say; a wide cell is asked where the fine one ends early."""
    scene, where, settings = task.scene, task.where, task.settings
    meta = select_modes(
        load_meta_model(scene.material.plane_stress_equivalent[1], task.database), settings.modes
    )
    for k, outline in enumerate(scene.outlines):
        left = rows[where.hole[rows] == k]
        for rule in dict.fromkeys((settings.fine, settings.wide)):
            if not len(left):
                break
            placed = place_cells(scene, outline, where.s[left], field, meta, settings, rule)
            note_reasons(answer, left, placed)
            stress, error = cell_stress(placed, meta, scene, depths)
            found = left[placed.rows]
            _weigh(task, answer, found, depths, stress, error)
            reached = found[np.isfinite(stress).all(axis=(1, 2))]
            left = np.setdiff1d(left, reached)


def distance_to_tips(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Distances (n,) from points (n, 2) to the nearest corner of a notch or crack tip, mm; inf where there is none."""
    corners = [outline.points(outline.corners[outline.corner_angles < np.pi]) for outline in scene.outlines]
    tips = [np.array([line[-1] for line in scene.part.tips]).reshape(-1, 2)]
    singular = np.concatenate([*corners, *tips])
    steps = points[:, None] - singular
    return np.hypot(steps[..., 0], steps[..., 1]).min(axis=1, initial=np.inf)
