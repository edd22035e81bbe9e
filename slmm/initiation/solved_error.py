"""What finite element results leave open of a failure index, told from the same part by boundary integrals.

A mesh makes a part too stiff. Moved at its supports and loads as the model was, the part itself takes less work; by as
much a model under forces has moved too little. What the displacements inside differ by, besides, is of the elements,
or of what no linear elastic part without body forces would do. Where forces
load the part, the noise on them counts, too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slmm.initiation.boundary_field import solve_boundary
from slmm.initiation.solved_scene import SolvedScene
from slmm.initiation.task import Answer, Task
from slmm.mechanics.rigid import motions_about

#: nodes at which displacements are compared; chosen
COMPARED = 400
#: work or displacements that differ by more are not those of a linear elastic part: of sixteen linear triangles around
#: a hole work differs by 0.06 (chosen)
NOT_ELASTIC = 0.15


def add_solved_error(task: Task, answer: Answer) -> None:
    """Add to the errors of an answer what the results of a `SolvedScene` leave open.

    Raises
    ------
    ValueError
        When they are not those of a linear elastic part without body forces.
    """
    scene = task.scene
    assert isinstance(scene, SolvedScene)
    if "boundary" not in task.solved:
        task.solved["boundary"] = solve_boundary(scene)
    model = task.solved["boundary"].model
    surface = np.unique(np.concatenate([ring.nodes for ring in scene.rings]))
    work = float((scene.surface.forces[surface] * scene.solved.u[surface]).sum())
    smaller = min(abs(work), abs(model.work))
    stiffer = abs(work - model.work) / smaller if smaller > 0 else np.inf
    error = max(stiffer, _differs(scene, model.displacement))
    if error > NOT_ELASTIC:
        material = scene.material
        raise ValueError(
            f"{scene.title}: work or displacements inside differ by {100 * error:.2g} % from those of a linear elastic "
            f"part with nu = {material.nu:g} in {material.state}, moved in the same way: is it plastic, heated, "
            "under gravity, of another material, or of too few elements?"
        )
    if any(condition.is_loaded for condition in scene.loading):
        # forces on the surface are as uncertain as what is left of them inside
        error += scene.surface.noise
    answer.column("model_error")[:] = error
    infinite = np.isinf(answer.load_factor)
    answer.error[~infinite] += error


def _differs(scene: SolvedScene, displacement: Callable[[np.ndarray], np.ndarray]) -> float:
    """By how much displacements at nodes inside differ, over those that deform the part; both without rigid motions."""
    field = scene.solved
    inside = np.unique(np.concatenate([nodes.ravel() for nodes in field.cells.values()]))
    inside = np.setdiff1d(inside, np.concatenate([ring.nodes for ring in scene.rings]))
    if not len(inside):
        return 0.0
    inside = inside[:: max(1, len(inside) // COMPARED)]
    at = field.points[inside]
    rigid = motions_about(at, at.mean(axis=0), scene.size).reshape(2 * len(at), 3)

    def deforms(u: np.ndarray) -> np.ndarray:
        return u.ravel() - rigid @ np.linalg.lstsq(rigid, u.ravel(), rcond=None)[0]

    theirs = deforms(field.u[inside])
    ours = deforms(displacement(at))
    return float(np.linalg.norm(ours - theirs) / max(np.linalg.norm(ours), np.linalg.norm(theirs)))
