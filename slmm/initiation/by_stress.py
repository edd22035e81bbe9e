"""Methods that look at the stress alone: Rankine, Mises, and Taylor's point and line method (thesis 3.1, 3.3.1)."""

from __future__ import annotations

from typing import Any

import numpy as np

from slmm.criteria.coupled import STRESS
from slmm.fem.triangulation import MesherError
from slmm.initiation.by_cells import local_field, note_reasons, rows_with_cells
from slmm.initiation.cells import cell_stress, place_cells, select_modes
from slmm.initiation.meta_model import load_meta_model
from slmm.initiation.task import Answer, Task
from slmm.mechanics.material import Material
from slmm.scene.scene import Scene

SINGULAR = "the stress at a corner or crack tip is infinite: no strength criterion applies"
TOO_DEEP = (
    "the stress sinks to zero within the critical distance, or the path ends: no critical distance applies"
)
NOT_REACHED = "the cell ends before the critical distance"
NEAR = "a corner or crack tip is so near that the stress depends on the mesh"
#: elements between a position and a corner or crack tip, at least: nearer, the estimated error is too small
AWAY_FROM_TIPS = 2
#: points along the distance that the line method averages over
SAMPLES = 41


def point_distance(material: Material) -> float:
    """Depth at which the point method takes the stress, mm: half of l_ch of thesis Eq. 3.16, l_Irwin/(2 pi)."""
    return material.irwin_length / (2 * np.pi)


def line_distance(material: Material) -> float:
    """Depth to which the line method averages, mm: twice l_ch of thesis Eq. 3.16 (Eq. 3.17)."""
    return 2 * material.irwin_length / np.pi


def point_method(eta: np.ndarray, sigma: np.ndarray, material: Material) -> float:
    """Stress of the point method, MPa; NaN where the stress sinks to zero before its depth, or the path ends.

    Parameters
    ----------
    eta, sigma : ndarray (n,)
        Depth from the surface, mm, and tensile stress, MPa.
    material : Material

    Examples
    --------
    A beam in bending, twice as high as the distance: the point lies on the neutral axis.

    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> h = 2 * point_distance(material)
    >>> eta = np.linspace(0, h, 50)
    >>> point_method(eta, 1 - 2 * eta / h, material)
    nan
    """
    d = point_distance(material)
    return float(np.interp(d, eta, sigma)) if _carries(eta, sigma, d) else float("nan")


def line_method(eta: np.ndarray, sigma: np.ndarray, material: Material) -> float:
    """Stress of the line method, MPa; NaN where the stress sinks to zero within its distance, or the path ends.

    Parameters are those of `point_method`.

    Examples
    --------
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> round(line_method(np.array([0.0, 10.0]), np.array([2.0, 2.0]), material), 9)
    2.0
    """
    d = line_distance(material)
    if not _carries(eta, sigma, d):
        return float("nan")
    at = np.linspace(0, d, SAMPLES)
    return float(np.trapezoid(np.interp(at, eta, sigma), at) / d)


def _carries(eta: np.ndarray, sigma: np.ndarray, distance: float) -> bool:
    """Whether the stress is tensile all the way: else its mean cancels, and at a point it says nothing."""
    ends_within = eta[-1] < distance * (1 - 1e-9)
    # a stress that has sunk to round-off is zero
    least = 1e-9 * np.abs(sigma).max()
    return (
        not ends_within and np.interp(distance, eta, sigma) > least and sigma[eta <= distance].min() > least
    )


def by_stress(task: Task, method: str) -> Answer:
    """Answer of a strength criterion at the surface, or of a critical-distance method on the path."""
    answer = Answer.empty(task.n, method)
    material = task.scene.material
    depth = {"point": point_distance(material), "line": line_distance(material)}.get(method, 0.0)
    depths = np.linspace(0.0, depth, SAMPLES) if depth else np.zeros(1)
    stress, error, provenance = _path_stress(task, answer, depths)
    answer.status[~task.smooth] = SINGULAR
    for i in np.flatnonzero(np.isfinite(stress[:, 0, 0])):
        if depth > task.paths.ligament[i]:
            answer.status[i] = TOO_DEEP
            continue
        if not np.isfinite(stress[i]).all():
            answer.status[i] = NOT_REACHED
            continue
        value = _criterion_stress(stress[i], depths, method, material)
        if np.isnan(value):
            answer.status[i] = TOO_DEEP
            continue
        answer.status[i] = "ok"
        answer.load_factor[i] = material.sigma_c / value if value > 0 else np.inf
        answer.governed_by[i] = STRESS if value > 0 else answer.governed_by[i]
        # where there is no tension, what there may be
        largest = error[i].max()
        answer.error[i] = largest / value if value > 0 else max(value + largest, 0.0) / material.sigma_c
    answer.provenance |= provenance
    return answer


def _criterion_stress(sigma: np.ndarray, depths: np.ndarray, method: str, material: Material) -> float:
    """What the criterion compares with the strength, MPa, from stress across, along, shear (3, k) on the path."""
    across, along, shear = sigma
    middle, radius = 0.5 * (across + along), np.hypot(0.5 * (across - along), shear)
    if method == "mises":
        out_of_plane = material.nu * (across + along) if material.state == "plane strain" else 0.0 * across
        first, second = middle + radius, middle - radius
        squares = (first - second) ** 2 + (second - out_of_plane) ** 2 + (out_of_plane - first) ** 2
        return float(np.sqrt(0.5 * squares[0]))
    sigma_I = middle + radius
    if method == "rankine" or (sigma_I <= 0).all():
        return float(sigma_I[0])
    return (point_method if method == "point" else line_method)(depths, sigma_I, material)


def _path_stress(
    task: Task, answer: Answer, depths: np.ndarray
) -> tuple[np.ndarray, np.ndarray, dict[str, Any]]:
    """Stress across, along, shear (n, 3, k) at depths (k,), an error (n, k), both MPa, and their origin."""
    if task.scene.analysis.local_model == "body-fitted" and task.displacements is None:
        return _body_fitted_stress(task, answer, depths)
    return _cell_stress(task, answer, depths)


def _body_fitted_stress(task, answer, depths):
    from slmm.initiation.body_fitted import solve_body_fitted  # imports the finite element libraries

    stress = np.full((task.n, 3, len(depths)), np.nan)
    error = np.full((task.n, len(depths)), np.nan)
    paths = task.paths
    rows = np.flatnonzero(task.smooth)
    try:
        model = solve_body_fitted(task.scene)
    except MesherError as failure:
        answer.status[rows] = f"no mesh: {failure}"
        return stress, error, {}
    near = distance_to_tips(task.scene, paths.start[rows]) < AWAY_FROM_TIPS * model.fine.element_size(
        paths.start[rows]
    )
    answer.status[rows[near]] = NEAR
    rows = rows[~near]
    points = paths.start[rows, None] + depths[:, None] * paths.direction[rows, None]
    sigma, found = model.stress(points.reshape(-1, 2))
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
    return stress, error, {"local_model": "body-fitted", "nodes": len(model.fine.points)}


def distance_to_tips(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Distances (n,) from points (n, 2) to the nearest corner of a notch or crack tip, mm; inf where there is none."""
    corners = [outline.points(outline.corners[outline.corner_angles < np.pi]) for outline in scene.outlines]
    tips = [np.array([line[-1] for line in scene.part.tips]).reshape(-1, 2)]
    singular = np.concatenate([*corners, *tips])
    steps = points[:, None] - singular
    return np.hypot(steps[..., 0], steps[..., 1]).min(axis=1, initial=np.inf)


def _cell_stress(task, answer, depths):
    stress = np.full((task.n, 3, len(depths)), np.nan)
    error = np.full((task.n, len(depths)), np.nan)
    rows = rows_with_cells(task, answer)
    if not len(rows):
        return stress, error, {}
    scene, where, settings = task.scene, task.where, task.settings
    _, nu = scene.material.plane_stress_equivalent
    # first, because it refuses a Poisson's ratio that the voxel solver would fail at
    meta = select_modes(load_meta_model(nu, task.database), settings.modes)
    try:
        local, provenance = local_field(task)
    except MesherError as failure:
        answer.status[rows] = f"no mesh: {failure}"
        return stress, error, {}
    for k, outline in enumerate(scene.outlines):
        left = rows[where.hole[rows] == k]
        for rule in dict.fromkeys((settings.fine, settings.wide)):
            if not len(left):
                break
            placed = place_cells(scene, outline, where.s[left], local, meta, settings, rule)
            note_reasons(answer, left, placed)
            found = left[placed.rows]
            stress[found], error[found] = cell_stress(placed, meta, scene, depths)
            left = left[~np.isfinite(stress[left]).all(axis=(1, 2))]
    return stress, error, provenance
