"""The equilibrium path of a part that breaks, with its snap-backs, and what it does where the force is controlled.

The part is linear and elastic between events, so that its state before step k lies on the ray F = S_k u, and the step
happens at (u_c, S_k u_c). Neither the path nor the order of events depends on what is controlled: F(u) of a controlled
displacement and that of a controlled force go along the path where they can, and leave it where the path turns back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.events import Kind
from slmm.fracture.history import History, Outcome

Array = NDArray[np.float64]


class EquilibriumPath(NamedTuple):
    """Points of the path, joined by straight lines.

    Attributes
    ----------
    u, F : ndarray, shape (n,)
        mm and N.
    step : ndarray, shape (n,) of int
        Which step happens there, -1 where none does.
    jump : ndarray, shape (n,) of bool
        Whether nothing in between was in equilibrium: a crack had started, at once with its first length.
    """

    u: Array
    F: Array
    step: NDArray[np.int64]
    jump: NDArray[np.bool_]


def equilibrium_path(history: History) -> EquilibriumPath:
    """States in which the next event just happens.

    The last of the ligament before a surface that a crack runs into needs no load: there the path comes back to the
    origin, from which the part is loaded anew. It ends at the last step of a part that is severed.
    """
    points = [(0.0, 0.0, -1, False)]
    before = None
    for k, step in enumerate(history.steps):
        if before is not None and before.arrested_by and before.kind is Kind.GROWTH:
            points.append((0.0, 0.0, -1, False))
        points.append(
            (step.u_c, step.stiffness * step.u_c, k, before is not None and before.kind is Kind.START)
        )
        before = step
    if history.last_u > 0:
        if before is not None and before.arrested_by:
            points.append((0.0, 0.0, -1, False))
        points.append((history.last_u, history.last_stiffness * history.last_u, -1, False))
    u, F, step_of, jump = zip(*points, strict=True)
    return EquilibriumPath(np.array(u), np.array(F), np.array(step_of), np.array(jump))


def released_in_equilibrium(history: History) -> Array:
    """Energy (n,) that growth takes from the part along the path, mJ: the area between the path and both its rays.

    With u_c at both ends of an increment it is u_k u_(k+1) (S_k - S_(k+1))/2, and equals G_c times the new area up to
    the second order in the increment; NaN of other steps.
    """
    u = np.array([*(step.u_c for step in history.steps), np.nan])
    S = history.stiffnesses
    grows = np.array(
        [step.kind is Kind.GROWTH and not step.arrested_by for step in history.steps], dtype=bool
    )
    cracks = np.array([*(step.crack for step in history.steps), -1])
    kinds = np.array([*(step.kind is Kind.GROWTH for step in history.steps), False])
    goes_on = grows & (cracks[1:] == cracks[:-1]) & kinds[1:]
    return np.where(goes_on, 0.5 * u[:-1] * u[1:] * (S[:-1] - S[1:]), np.nan)


class ForceControl(NamedTuple):
    """A part under a force that grows.

    Attributes
    ----------
    u, F : ndarray, shape (n,)
        Corner points of the curve, mm and N: the displacement jumps at constant force.
    peak : float
        Largest force of the path, N.
    step : int
        At which the part breaks, since the force would have to fall from there on; -1 if it was not severed.
    """

    u: Array
    F: Array
    peak: float
    step: int


def force_control(history: History) -> ForceControl:
    """What happens if the force is controlled in place of the displacement."""
    S = history.stiffnesses
    forces = np.array([step.stiffness * step.u_c for step in history.steps])
    points, last = [(0.0, 0.0)], int(forces.argmax()) if len(forces) else -1
    for k in range(last + 1):
        highest = points[-1][1]
        F = max(highest, float(forces[k]))
        if highest < F:
            points.append((F / S[k], F))
        if k < last:
            if (
                len(points) > 2 and points[-2][1] == F
            ):  # of jumps at one force the first and the last point count
                points.pop()
            points.append((F / S[k + 1], F))
    peak = points[-1][1]
    if (end := history.last_stiffness * history.last_u) > peak:
        points.append((history.last_u, end))
        peak = end
    u, force = np.array(points).T
    return ForceControl(u, force, peak, last if history.outcome is Outcome.SEVERED else -1)
