"""What drops of the force at constant displacement leave out of U_T where a crack grows steadily.

There the equilibrium path falls from the state before an increment to the state after it while the displacement
rises. F(u) as published drops to the lower ray at once (Paper D, section 2.2.3), which leaves out an area of the first
order in the increment; straight lines from state to state leave one of the second order. Behind the last state of a
part that a crack severs steadily, the area is what the crack still takes less what is stored.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.equilibrium import released_in_equilibrium
from slmm.fracture.events import Kind
from slmm.fracture.history import History, Outcome

Array = NDArray[np.float64]


class LeftOut(NamedTuple):
    """Areas, mJ.

    Attributes
    ----------
    by_growth : float
        What U_T lacks where cracks grow steadily.
    error : float
        Estimated error of that: what lines from state to state set free is not quite what the crack takes.
    by_starts : float
        What it would lack, too, if cracks that have started had grown steadily to their first length.
    """

    by_growth: float
    error: float
    by_starts: float


def left_out(history: History, dissipated: Array) -> LeftOut:
    """Areas between the equilibrium path and F(u) as published.

    Parameters
    ----------
    history : History
    dissipated : ndarray, shape (n,)
        What the crack of each step takes, mJ.
    """
    steps, loads = history.steps, history.loads
    # the states before each step, and where the next event would have been when the simulation was stopped
    u = np.array([*(step.u_c for step in steps), history.next_u])
    F = u * history.stiffnesses
    wrong = np.abs(released_in_equilibrium(history) - dissipated)
    by_growth = error = by_starts = 0.0
    near = np.inf  # what was wrong last, for increments of which it is not known
    for k, step in enumerate(steps):
        if not u[k + 1] > loads[k] or step.arrested_by:
            continue
        end = min(u[k + 1], history.last_u) if k + 1 == len(steps) else u[k + 1]
        # the path may pass the largest displacement so far between both states
        at = np.array([loads[k], end])
        area = float(
            np.trapezoid(np.interp(at, u[k : k + 2], F[k : k + 2]) - history.stiffnesses[k + 1] * at, at)
        )
        if step.kind is Kind.START:
            by_starts += area if u[k] == loads[k] else 0.0
        else:
            by_growth += area
            near = float(wrong[k]) if wrong[k] == wrong[k] else min(near, area)
            error += near
    if steps and history.outcome is Outcome.SEVERED and steps[-1].kind is Kind.GROWTH and u[-2] == loads[-1]:
        behind = max(float(dissipated[-1]) - 0.5 * u[-2] * F[-2], 0.0)
        by_growth += behind
        error += min(near, behind)
    return LeftOut(by_growth, error, by_starts)
