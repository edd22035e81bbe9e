"""Models that may be halves of a part: a side moves as a plane of symmetry does, and a notch ends on it."""

from __future__ import annotations

import numpy as np

from slmm.results.field import DisplacementField
from slmm.results.mirrored import ON_PLANE, SAME, SIDES
from slmm.scene.loading import Loading


def half_model_doubts(field: DisplacementField, loading: Loading) -> list[str]:
    """A sentence for each side of a model's box that is held across alone and ends where the box goes on.

    A whole part that rests on a side has no notch that opens there, as a rule.

    Examples
    --------
    >>> half_model_doubts(DisplacementField(
    ...     np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), {"triangle": np.array([[0, 1, 2]])}, np.zeros((3, 2))
    ... ), Loading(()))
    []
    """
    used = np.unique(np.concatenate([nodes.ravel() for nodes in field.cells.values()]))
    at = field.points[used]
    low, high = at.min(axis=0), at.max(axis=0)
    near = ON_PLANE * float((high - low).max())
    largest = float(np.abs(field.u[used]).max())
    found = []
    for side, (axis, is_upper) in SIDES.items():
        place = high[axis] if is_upper else low[axis]
        for condition in loading:
            ends = np.array([condition.start, condition.end])
            across, along = condition.displacement[axis], condition.displacement[1 - axis]
            if across is None or along is not None or condition.is_loaded:
                continue
            # along the side, from one corner of the box to the other
            whole = (np.abs(np.sort(ends[:, 1 - axis]) - [low[1 - axis], high[1 - axis]]) < near).all()
            moved = across(condition.points(np.array([0.0, 0.5, 1.0])))
            if (np.abs(ends[:, axis] - place) < near).all() and not whole and np.ptp(moved) < SAME * largest:
                found.append(
                    f"symmetry: the {side} side is held as a plane of symmetry is, and a notch or a free edge ends on "
                    f"it; if the model is half a part, say so (symmetry = {side!r}, --symmetry {side}): else cracks "
                    "beside it are those of a part that ends there"
                )
                break
    return found
