"""An answer as arrays that say what they are."""

from __future__ import annotations

import numpy as np

from slmm import __version__
from slmm.criteria.coupled import GOVERNED_BY
from slmm.initiation.task import Answer, Task
from slmm.running.labelled import LabelledArrays, Variable
from slmm.scene.plausible import unusual_values
from slmm.scene.scene import Scene

#: units and meaning of each variable
UNITS = {
    "x": ("mm", "x coordinate of the notch point"),
    "y": ("mm", "y coordinate of the notch point"),
    "arc_length": ("mm", "arc length along the outline"),
    "hole": ("1", "index of the outline, -1 at a crack tip"),
    "curvature": ("1/mm", "curvature c of the parabola eta = c xi^2"),
    "failure_index": ("1", "failure index FI = 1/load_factor"),
    "failure_index_error": ("1", "estimated error of the failure index"),
    "failure_index_bound": (
        "1",
        "upper bound of the failure index: value and error, or strength; inf where unknown",
    ),
    "turned": ("degrees", "direction of the crack, counter-clockwise from the usual one"),
    "outline_error": ("1", "part of its relative error that the picture of the notch leaves open"),
    "model_error": ("1", "part of its relative error that the finite element results leave open"),
    "load_factor": ("1", "factor on the load at which a crack starts"),
    "crack_length": ("mm", "length with which the crack starts"),
    "governed_by": ("1", "condition that decides the load"),
    "status": ("1", "ok, or why there is no value"),
    "used_method": ("1", "method that gave the value"),
    "reason": ("1", "why this method"),
    "cell_height": ("mm", "height of the crack cell"),
    "control_weight": ("1", "weight of the relaxed boundary"),
    "edge_support": ("1", "share of the held cell's stiffness that the plate's edges give"),
    "misfit": ("1", "part of the boundary displacement that the modes leave"),
    "irwin_length_limit": ("mm", "Irwin's length up to which the curves reach far enough"),
    "reference_radius": ("mm", "radius of the hole whose cracks were corrected, inf for a straight edge"),
    "k_1": ("MPa mm^(1-lambda)", "generalised stress intensity of opening"),
    "k_2": ("MPa mm^(1-lambda)", "generalised stress intensity of sliding, with an exponent of its own"),
    "singular_exponent": ("1", "exponent lambda of the displacements that k_1 opens"),
    "opening_angle": ("degrees", "angle between the flanks, 0 at a crack tip or U-notch"),
    "stress_intensity_I": ("MPa sqrt(mm)", "stress intensity factor K_I of the crack"),
    "stress_intensity_II": ("MPa sqrt(mm)", "stress intensity factor K_II of the crack"),
    "energy_release_rate": ("N/mm", "energy release rate G of the crack"),
    "a": ("mm", "crack length, and distance from the notch"),
    "G_inc": ("N/mm", "incremental energy release rate"),
    "sigma_I": ("MPa", "maximum principal stress without a new crack"),
}


def _irwin_length_limit(scene: Scene, answer: Answer) -> np.ndarray:
    """G_inc E/sigma_I^2 at the longest crack, mm: the applicability factor times the notch radius (Eq. 33).

    A material with a longer Irwin's length starts a crack longer than the curves.
    """
    E = scene.material.plane_stress_equivalent[0]
    stress = answer.curves.sigma_I[:, -1]
    limit = np.full(len(stress), np.nan)
    tension = stress > 0
    limit[tension] = answer.curves.G_inc[tension, -1] * E / stress[tension] ** 2
    return limit


def labelled(
    task: Task, answer: Answer, bound: np.ndarray, curves: bool, facts: dict[str, object]
) -> LabelledArrays:
    """The answer with bounds (n,) and facts, its curves if they are asked for."""
    with np.errstate(divide="ignore"):
        failure_index = 1 / answer.load_factor
    where = task.where
    values = {
        "x": where.points[:, 0],
        "y": where.points[:, 1],
        "arc_length": where.s,
        "hole": where.hole,
        "curvature": answer.column("curvature"),
        "failure_index": failure_index,
        "failure_index_error": answer.index_error,
        "failure_index_bound": bound,
        "load_factor": answer.load_factor,
        "crack_length": answer.crack_length,
        "governed_by": np.array([GOVERNED_BY[code] for code in answer.governed_by]),
        "status": answer.status.astype(str),
        "used_method": answer.method.astype(str),
        "reason": answer.reason.astype(str),
        "cell_height": answer.column("cell_height"),
        "control_weight": answer.column("control_weight"),
        "irwin_length_limit": _irwin_length_limit(task.scene, answer),
    }
    values |= answer.columns
    if curves:
        sigma_I = answer.curves.sigma_I
        # infinite at a corner or a crack tip
        sigma_I = np.where(np.isinf(sigma_I), np.nan, sigma_I)
        values |= {"a": answer.curves.a, "G_inc": answer.curves.G_inc, "sigma_I": sigma_I}
    variables = {}
    for name, array in values.items():
        units, long_name = UNITS[name]
        dims = ("position", "crack")[: array.ndim]
        variables[name] = Variable(dims, array, {"units": units, "long_name": long_name})
    attrs = {"title": task.scene.title, "version": __version__} | answer.described | facts
    if unusual := unusual_values(task.scene):
        attrs["warnings"] = "; ".join(unusual)
    return LabelledArrays(variables, attrs)
