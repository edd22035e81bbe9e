"""An upper bound of the failure index at every position, also where no method has a value.

No crack starts before the strength is reached all along it: the index is at most the stress at the surface, over the
strength. Where a mean or the stress at a depth counts, it is the largest stress on the path instead. Nothing bounds it
so at a corner or a crack tip, where the stress is infinite, nor by criteria that know no such strength.
"""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np

from slmm.criteria.status import Status
from slmm.initiation.task import Answer, Task
from slmm.initiation.uncracked import WithStress

#: depths of a path as shares of its ligament, where the largest stress is looked for; the far side has one of its
#: own; chosen
DEPTHS = np.linspace(0.0, 0.99, 100) ** 2


def upper_bounds(task: Task, answer: Answer) -> np.ndarray:
    """Upper bounds (n,) of the failure index: value and error, or strength; infinite where nothing is known.

    A model is solved only where positions without a value leave it open whether a crack starts: a body-fitted one, or
    without the mesher one by boundary integrals.

    Parameters
    ----------
    task : Task
        Its criterion decides which stress bounds the index.
    answer : Answer
    """
    with np.errstate(divide="ignore"):
        index = 1 / answer.load_factor
    missing = answer.status != Status.OK
    bound = np.where(missing, np.inf, index + np.nan_to_num(answer.index_error, nan=0.0))
    if task.criterion.bounded_by == "nothing":
        return bound
    whole_path = task.criterion.bounded_by == "path"
    if not whole_path:
        stress, error = answer.curves.sigma_I[:, 0], answer.curves.sigma_error[:, 0]
        known = missing & task.smooth & np.isfinite(stress) & np.isfinite(error)
        bound[known] = np.maximum(stress * (1 + error), 0.0)[known] / task.scene.material.sigma_c
    largest = float(np.max(index[~missing], initial=0.0))
    left = np.flatnonzero(missing & task.smooth & (bound > largest))
    if len(left) and largest < 1 and task.displacements is None:
        bound[left] = np.minimum(bound[left], _strength(task.among(left), whole_path))
    if "outline_error" in answer.columns:  # which is in the error of the values already
        bound[missing] *= 1 + np.nan_to_num(answer.columns["outline_error"][missing])
    return bound


def _strength(task: Task, whole_path: bool) -> np.ndarray:
    """Bounds (n,) from the stress of a model of the part; infinite where that cannot tell."""
    from slmm.initiation.by_stress import AWAY_FROM_TIPS, distance_to_tips
    from slmm.mechanics.stress import principal_stress  # these import the finite element libraries

    task.progress(0.9, f"strength at {task.n} positions without a value")
    # the model is fine where these positions are
    its = f"strength at {task.paths.start.tobytes().hex()}"
    if its not in task.solved:
        task.solved[its] = _model(task)
    model: WithStress | None = task.solved[its]
    if model is None:  # the positions keep no bound, and the summary says so
        return np.full(task.n, np.inf)
    paths = task.paths
    depths = paths.ligament[:, None] * (DEPTHS if whole_path else DEPTHS[:1])
    points = paths.start[:, None] + depths[..., None] * paths.direction[:, None]
    sigma, error = model.stress(points.reshape(-1, 2))
    stress = (principal_stress(sigma) + error).reshape(depths.shape)
    stress[np.isnan(stress[:, 0])] = np.inf
    bound = np.maximum(np.nanmax(stress, axis=1), 0.0) / task.scene.material.sigma_c
    near = distance_to_tips(task.scene, paths.start) < AWAY_FROM_TIPS * model.element_size(paths.start)
    return np.where(near, np.inf, bound)


def _model(task: Task) -> WithStress | None:
    """A model whose stress is good at surfaces; None where there is none."""
    from slmm.boundary.panelling import TooManyPointsError
    from slmm.fem.triangulation import MesherError

    try:
        if find_spec("netgen") is not None:
            from slmm.initiation.by_dislocations import body_fitted_model

            return body_fitted_model(task)
        from slmm.initiation.boundary_field import solve_boundary

        return solve_boundary(task.scene)
    except (MesherError, TooManyPointsError):
        return None
