"""Source stress: components on the path, from crack cells or a body-fitted model, for criteria that need no energy."""

from __future__ import annotations

import numpy as np

from slmm.criteria.distances import SAMPLES
from slmm.criteria.path_curves import PathCurves
from slmm.criteria.status import Status
from slmm.criteria.surface import mises_stress
from slmm.fem.triangulation import MesherError
from slmm.initiation.by_cells import has_own_stress, local_field, note_reasons, rows_with_cells
from slmm.initiation.cells import cell_stress, place_cells, select_modes
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
    material = task.scene.material
    depth = task.criterion.depth(material)
    depths = np.linspace(0.0, depth, SAMPLES) if depth else np.zeros(1)
    stress, error = _path_stress(task, answer, depths)
    answer.status[~task.smooth] = Status.SINGULAR
    rows = np.flatnonzero(np.isfinite(stress[:, 0, 0]))
    too_deep, reached = depth > task.paths.ligament[rows], np.isfinite(stress[rows]).all(axis=(1, 2))
    answer.status[rows[~reached]] = Status.CELL_ENDS
    answer.status[rows[too_deep]] = Status.TOO_DEEP
    rows = rows[reached & ~too_deep]
    across, along, shear = stress[rows].swapaxes(0, 1)
    if "equivalent stress" in task.criterion.needs:
        measure = mises_stress(across, along, shear, material)
    else:
        measure = principal(across, along, shear)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(measure != 0, error[rows] / np.abs(measure), 0.0)
    nothing = np.full(measure.shape, np.nan)
    curves = PathCurves(np.tile(depths, (len(rows), 1)), nothing, measure, nothing, relative)
    answer.put(rows, task.criterion.judge(curves, material), Status.CELL_ENDS)
    return answer


def _path_stress(task: Task, answer: Answer, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Stress across, along, shear (n, 3, k) at depths (k,), and an error (n, k), both MPa."""
    stress = np.full((task.n, 3, len(depths)), np.nan)
    error = np.full((task.n, len(depths)), np.nan)
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
            return stress, error
        answer.note(**field.described)
        if isinstance(field, WithStress):
            _own_stress(field, task, answer, depths, rows, stress, error)
        else:
            _cell_stress(field, task, answer, depths, rows, stress, error)
    return stress, error


def _own_stress(
    field: WithStress,
    task: Task,
    answer: Answer,
    depths: np.ndarray,
    rows: np.ndarray,
    stress: np.ndarray,
    error: np.ndarray,
) -> None:
    """Fill in, at some positions, what a field says itself."""
    paths = task.paths
    size = field.element_size(paths.start[rows])
    near = distance_to_tips(task.scene, paths.start[rows]) < AWAY_FROM_TIPS * size
    answer.status[rows[near]] = Status.NEAR_SINGULAR
    rows = rows[~near]
    points = paths.start[rows, None] + depths[:, None] * paths.direction[rows, None]
    sigma, found = field.stress(points.reshape(-1, 2))
    t = paths.direction[rows]
    xx, yy, xy = np.moveaxis(sigma.reshape(len(rows), len(depths), 3), -1, 0)
    tx, ty = t[:, :1], t[:, 1:]
    stress[rows] = np.stack(
        [
            xx * ty**2 + yy * tx**2 - 2 * xy * tx * ty,
            xx * tx**2 + yy * ty**2 + 2 * xy * tx * ty,
            (yy - xx) * tx * ty + xy * (tx**2 - ty**2),
        ],
        axis=1,
    )
    error[rows] = found.reshape(len(rows), len(depths))


def _cell_stress(
    field: UncrackedField,
    task: Task,
    answer: Answer,
    depths: np.ndarray,
    rows: np.ndarray,
    stress: np.ndarray,
    error: np.ndarray,
) -> None:
    """Fill in, at some positions, what crack cells on a field say."""
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
            found = left[placed.rows]
            stress[found], error[found] = cell_stress(placed, meta, scene, depths)
            left = left[~np.isfinite(stress[left]).all(axis=(1, 2))]


def distance_to_tips(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Distances (n,) from points (n, 2) to the nearest corner of a notch or crack tip, mm; inf where there is none."""
    corners = [outline.points(outline.corners[outline.corner_angles < np.pi]) for outline in scene.outlines]
    tips = [np.array([line[-1] for line in scene.part.tips]).reshape(-1, 2)]
    singular = np.concatenate([*corners, *tips])
    steps = points[:, None] - singular
    return np.hypot(steps[..., 0], steps[..., 1]).min(axis=1, initial=np.inf)
