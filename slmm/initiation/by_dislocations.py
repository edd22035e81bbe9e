"""Method dislocations: a body-fitted model of the uncracked part, in which trial cracks open as dislocations."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.interpolate import PchipInterpolator

from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.fem.triangulation import MesherError
from slmm.initiation.body_fitted import ANGLE_MAX, BodyFitted, solve_body_fitted
from slmm.initiation.cell_errors import faded, reference_stress
from slmm.initiation.dislocations import DislocationCurves, DislocationModel
from slmm.initiation.evidence import Stands
from slmm.initiation.meta_model import polynomial_matrix
from slmm.initiation.positions import is_within
from slmm.initiation.task import Answer, Task
from slmm.mechanics.stress import principal_stress
from slmm.part.outline_splines import curvature_jumps
from slmm.scene.scene import Scene

#: element size of the coarser mesh at a position over the longest crack, and least one over the outline's
#: length; both chosen
SIZE_PER_CRACK, SIZE_PER_OUTLINE = 0.25, 1 / 120
#: and largest one over the distance to the plate's edge; chosen
SIZE_PER_DISTANCE = 0.3
#: the same where the curvature jumps, over what the outline's bend asks for; chosen: the stress of random scene 182
#: converges from there
AT_JOINT = 0.25
#: longest crack as a share of the ligament: beyond, the opposite surface is too near for the samples of its
#: answer; chosen
SAMPLED_LIGAMENT = 0.6
#: a critical crack shorter than this share of the longest one is looked at again, with this multiple of it as the
#: longest; both chosen
SHORT, CLOSE_UP = 0.1, 4.0
#: longest cracks that are tried for a position; chosen
ATTEMPTS = 3
#: on what the extrapolation changed, and what is always there, as a share of the reference stress; chosen such that
#: more than nineteen errors of twenty lie below, and near what a fit gives (validation/fit_dislocation_errors.py)
SAFETY, ENERGY_FLOOR, STRESS_FLOOR = 1.2, 3.2e-4, 1.6e-4
#: positions whose dipoles are solved for at once; chosen
CHUNK = 64


def by_dislocations(task: Task, coarseness: float = 1.0) -> Answer:
    """Answer from one body-fitted model of the uncracked part, its elements ``coarseness`` times the usual ones."""
    answer = Answer.empty(task.n, "dislocations")
    answer.status[~task.smooth] = Status.NO_DISLOCATIONS
    rows = np.flatnonzero(task.smooth)
    if task.scene.loading.stiff:
        answer.status[rows] = Status.STIFF
    elif len(rows):
        task.progress(0.0, "body-fitted model")
        try:
            model = body_fitted_model(task.among(rows), coarseness)
        except MesherError as error:
            answer.status[rows] = Status.NO_MESH.of(error)
            return answer
        dislocations_on(model, task, answer, rows)
    return answer


def body_fitted_model(task: Task, coarseness: float = 1.0) -> BodyFitted:
    """The uncracked part, fine where the positions' cracks start."""
    where, scene = task.where, task.scene
    length = np.array([outline.length for outline in scene.outlines])[where.hole]
    size = np.maximum(SIZE_PER_CRACK * task.paths.longest, SIZE_PER_OUTLINE * length)
    to_edge = shapely.distance(scene.outer.exterior, shapely.points(where.points))
    if scene.plate is None:  # its own surface is no edge that a notch could leave it by
        to_edge[where.hole == len(scene.part.holes)] = np.inf
    # where the notch meets the plate's edge the stress may be singular
    size = np.minimum(size, SIZE_PER_DISTANCE * to_edge)
    joints, across = _joints(scene)
    fine_at = np.concatenate([where.points, joints]), coarseness * np.concatenate([size, across])
    return solve_body_fitted(scene, angle_max=coarseness * ANGLE_MAX, fine_at=fine_at)


def _joints(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 2) where the curvature of outlines jumps, and the element sizes (k,) there, mm.

    Along the bend the stress rises within a part of what a chord of the mesh turns by.
    """
    points, size = [np.empty((0, 2))], [np.empty(0)]
    for outline in scene.outlines:
        s = curvature_jumps(outline.breaks, outline.coefficients)
        s = s[outline.corner_at(s) < 0]
        beside = 1e-6 * outline.length
        bend = np.maximum.reduce([np.abs(outline.curvatures(s + side * beside)) for side in (-1, 1)])
        at = outline.points(s)
        inside = is_within(scene, at)
        points.append(at[inside])
        size.append(ANGLE_MAX * AT_JOINT / bend[inside])
    return np.concatenate(points), np.concatenate(size)


def dislocations_on(model: BodyFitted, task: Task, answer: Answer, rows: np.ndarray) -> None:
    """Fill the answer at some positions."""
    scene, where = task.scene, task.where
    dislocations = DislocationModel(scene, model, len(rows))
    radius, reference = answer.column("reference_radius"), reference_stress(scene)
    left, longest = rows, task.paths.longest.copy()
    for attempt in range(ATTEMPTS):
        if not len(left):
            break
        task.progress(0.2 + 0.2 * attempt, f"dislocations, {len(left)} positions")
        for chunk in np.array_split(left, -(-len(left) // CHUNK)):
            trials = [
                dislocations.trial(
                    scene.outlines[where.hole[i]],
                    float(where.s[i]),
                    min(longest[i], SAMPLED_LIGAMENT * task.paths.ligament[i]),
                )
                for i in chunk
            ]
            for i, found in zip(chunk, dislocations.curves(trials), strict=True):
                radius[i] = found.radius
                curves = sampled(found, reference)
                stands = Stands.everywhere(1)
                if attempt < ATTEMPTS - 1:
                    stands.shortest[:] = SHORT * curves.a[:, -1]
                answer.judge(np.array([i]), curves, task, Status.BEYOND_DISLOCATIONS, stands=stands)
        # once more with longer cracks where they are too short and may be longer, or with samples nearer to short ones
        reached = answer.curves.a[:, -1]
        longer = (answer.status == Status.BEYOND_DISLOCATIONS) & (reached > 0.999 * longest)
        shorter = answer.crack_length < SHORT * reached
        longest = np.where(longer, task.paths.lengthened().longest, longest)
        longest = np.where(shorter, answer.crack_length * CLOSE_UP, longest)
        left = left[(longer | shorter)[left] & (longest[left] > 1e-3 * reached[left])]
    answer.note(**model.described)


def sampled(found: DislocationCurves, reference: float) -> PathCurves:
    """The curves of one path (1, CURVE_POINTS); errors do not fall with a stress below the reference, MPa."""
    a = path_points(found.a[-1:])
    reached = np.maximum(a, found.a[0])
    # G_inc rises linearly from zero: G_inc/a is what interpolates well
    per_length = PchipInterpolator(found.a, found.G_inc / found.a)(reached)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(found.G_inc > 0, np.abs(found.G_inc_change / found.G_inc), 0.0)
    at_points = polynomial_matrix(found.eta, a[0])
    sigma, change = at_points @ found.sigma, at_points @ found.sigma_change
    principal = principal_stress(sigma)
    largest = np.abs(change).max(axis=1)
    # under compression the largest component says nothing of the principal stress
    compressed = sigma[:, 0] + sigma[:, 1] < 0
    moved = np.abs([principal_stress(sigma + sign * change) - principal for sign in (-1, 1)]).max(axis=0)
    largest = SAFETY * np.where(compressed, moved, largest) / np.maximum(np.abs(principal), 1e-300)
    fade = faded(reference, principal)
    G_error = ENERGY_FLOOR * fade + SAFETY * np.interp(a, found.a, relative)
    return PathCurves(a, per_length * a, principal[None], G_error, (STRESS_FLOOR * fade + largest)[None])
