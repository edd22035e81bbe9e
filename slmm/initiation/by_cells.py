"""Methods slmm and slmm+ac: crack cells on a local model (Paper A, 2.3 and 2.4)."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from slmm.criteria.coupled import STRESS
from slmm.criteria.status import Status
from slmm.fem.triangulation import MesherError
from slmm.initiation.cells import Placed, cell_curves, cell_stress, place_cells, select_modes
from slmm.initiation.local_model import STIFFER_VOID, LocalModel, solve_local_model
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.placement import STOPPED
from slmm.initiation.raster import SMALLEST_SIDE
from slmm.initiation.task import Answer, Task
from slmm.initiation.uncracked import UncrackedField, WithStress
from slmm.mechanics.stress import principal
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    from slmm.initiation.part_voxels import PartField

#: voxels = "auto": voxels over the smallest radius of curvature, and the limits of their total number; chosen
VOXELS_PER_RADIUS = 20
FEWEST_VOXELS, MOST_VOXELS = 250**2, 2000**2


def by_cells(task: Task, auto_control: bool) -> Answer:
    """Answer of crack cells on the user's displacements, or on a voxel model of the scene."""
    answer = Answer.empty(task.n, "slmm+ac" if auto_control else "slmm")
    rows = rows_with_cells(task, answer)
    if not len(rows):
        return answer
    # refuses a Poisson's ratio that the voxel solver would fail at
    load_meta_model(task.scene.material.plane_stress_equivalent[1], task.database)
    try:
        local = local_field(task)
    except MesherError as error:
        answer.status[rows] = Status.NO_MESH.of(error)
        return answer
    answer.note(**local.described)
    task.progress(0.6, f"{len(rows)} positions")
    cells_on(local, task, auto_control, answer, rows)
    return answer


def rows_with_cells(task: Task, answer: Answer) -> np.ndarray:
    """Positions that may have cells; the others get their status."""
    answer.status[np.isfinite(task.where.corner)] = Status.CORNER
    answer.status[task.where.tip >= 0] = Status.CRACK_TIP
    if task.scene.load is None:
        answer.status[task.smooth] = Status.UNKNOWN_SUPPORT
        return np.empty(0, dtype=int)
    if task.scene.cracks:
        answer.status[task.smooth] = Status.CRACKED
        return np.empty(0, dtype=int)
    return np.flatnonzero(task.smooth)


def local_field(task: Task) -> UncrackedField:
    """The part without a crack that the task gives or asks for."""
    if task.displacements is not None:
        return task.displacements
    if task.scene.analysis.local_model == "body-fitted":
        from slmm.initiation.body_fitted import solve_body_fitted  # imports the finite element libraries

        task.progress(0.0, "local model, body-fitted")
        return solve_body_fitted(task.scene)
    if by_boundary_integrals(task.scene):
        from slmm.initiation.boundary_field import solve_boundary  # imports the kernels

        task.progress(0.0, "local model, boundary integrals")
        return solve_boundary(task.scene)
    return voxel_model(task)


def by_boundary_integrals(scene: Scene) -> bool:
    """Whether the local model is that: asked for, or by itself under conditions that no crack cell knows."""
    asked = scene.analysis.local_model
    return asked == "boundary" or (asked == "auto" and scene.load is None)


def has_own_stress(task: Task) -> bool:
    """Whether the local model tells stress at surfaces itself; on voxels under [load] crack cells do."""
    if task.displacements is not None:
        return isinstance(task.displacements, WithStress)
    scene = task.scene
    return scene.load is None or scene.analysis.local_model in ("body-fitted", "boundary")


def voxel_model(task: Task) -> LocalModel | PartField:
    """Solve the voxel model, unless one as fine has been solved on the way."""
    voxels = voxel_count(task)
    if "voxels" in task.solved:
        wanted, solved = task.solved["voxels"]
        if wanted >= voxels:
            return solved
    task.progress(0.0, f"local model, {voxels} voxels")
    scene = task.scene
    void = task.settings.void_stiffness or scene.analysis.void_stiffness
    if scene.load is None:
        from slmm.initiation.part_voxels import solve_part  # plates under [load] need none of it

        return solve_part(scene, voxels, void)
    scene = scene.with_(analysis={"void_stiffness": void})
    local = solve_local_model(scene, voxels)
    if task.settings.relaxed == "unbounded":
        # not only coarser: that its void is stiffer shows in the estimates what the void does
        stiffer = scene.analysis.model_copy(update={"void_stiffness": min(STIFFER_VOID * void, 1.0)})
        rough = scene.model_copy(update={"analysis": stiffer})
        local = replace(local, coarser=solve_local_model(rough, max(voxels // 4, SMALLEST_SIDE**2)))
    task.solved["voxels"] = (voxels, local)
    return local


def voxel_count(task: Task) -> int:
    """Number of voxels that the scene asks for, or that the sharpest notch needs."""
    scene, where = task.scene, task.where
    if scene.analysis.voxels != "auto":
        return int(scene.analysis.voxels)
    sharpest = max(
        float(np.max(-outline.curvatures(where.s[where.hole == k]), initial=0.0))
        for k, outline in enumerate(scene.outlines)
    )
    area = float(np.ptp(scene.box, axis=0).prod())
    wanted = area * (VOXELS_PER_RADIUS * sharpest) ** 2
    return int(np.clip(wanted, FEWEST_VOXELS, MOST_VOXELS))


def cells_on(local: UncrackedField, task: Task, auto_control: bool, answer: Answer, rows: np.ndarray) -> None:
    """Fill the answer at some positions with what cells on a local model say."""
    scene, where, settings = task.scene, task.where, task.settings
    _, nu = scene.material.plane_stress_equivalent
    meta = select_modes(load_meta_model(nu, task.database), settings.modes)
    names = ("curvature", "cell_height", "control_weight", "edge_support", "misfit")
    columns = [answer.column(name) for name in names]
    for k, outline in enumerate(scene.outlines):
        left = rows[where.hole[rows] == k]
        # a wide cell is only asked where the fine one has no answer
        for rule in dict.fromkeys((settings.fine, settings.wide)):
            if len(left) == 0:
                break
            placed = place_cells(scene, outline, where.s[left], local, meta, settings, rule)
            found = left[placed.rows]
            note_reasons(answer, left, placed)
            curves, weight, support = cell_curves(scene, outline, placed, meta, settings, auto_control)
            answer.judge(found, curves, task, Status.BEYOND_CELL)
            values = (placed.curvature, placed.height, weight, support, placed.misfit)
            for column, value in zip(columns, values, strict=True):
                column[found] = value
            left = left[answer.status[left] != Status.OK]
    answer.note(
        settings=json.dumps(settings.describe()),
        database=task.database.name,
        database_checksum=meta.checksum,
    )


#: longest critical crack over Irwin's length where the stress hardly falls: that of a straight edge,
#: 2/(1.1215^2 pi); computed
STRAIGHT_EDGE = 0.506


def strength_on(local: UncrackedField, task: Task, answer: Answer, rows: np.ndarray) -> None:
    """Fill the answer where the stress along any critical crack differs too little for the energy to matter.

    The load that starts a crack lies between those at which the surface, and the depth of the longest critical crack,
    reach the strength: the index is taken half way, with half the difference as an error.
    """
    scene, where, settings = task.scene, task.where, task.settings
    material = scene.material
    meta = select_modes(load_meta_model(material.plane_stress_equivalent[1], task.database), settings.modes)
    depths = np.linspace(0.0, STRAIGHT_EDGE * material.irwin_length, 4)
    for k, outline in enumerate(scene.outlines):
        on_k = rows[where.hole[rows] == k]
        if not len(on_k):
            continue
        placed = place_cells(scene, outline, where.s[on_k], local, meta, settings, settings.fine)
        stress, error = cell_stress(placed, meta, scene, depths)
        sigma_I = principal(*stress.swapaxes(0, 1))
        low, high = sigma_I.min(axis=1), sigma_I.max(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            relative = (0.5 * (high - low) + error[:, 0]) / (0.5 * (high + low))
        enough = (low > 0) & (relative <= task.tolerance)
        found = on_k[placed.rows[enough]]
        answer.load_factor[found] = material.sigma_c / (0.5 * (high + low)[enough])
        answer.error[found], answer.governed_by[found] = relative[enough], STRESS
        answer.status[found], answer.method[found] = Status.OK, "strength"
        answer.column("cell_height")[found] = placed.height[enough]
        answer.column("curvature")[found] = placed.curvature[enough]


def note_reasons(answer: Answer, rows: np.ndarray, placed: Placed) -> None:
    """Say why there is no cell at some of the positions, unless something has been said before."""
    without = np.setdiff1d(np.arange(len(rows)), placed.rows)
    for i, code in zip(rows[without], placed.stopped[without], strict=True):
        answer.status[i] = answer.status[i] or Status.NO_CELL.of(STOPPED[code])
