"""Whole models from halves and quarters: mirrored at the sides of their box that are planes of symmetry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slmm.results.field import DisplacementField

#: sides of a model's box: which coordinate, and whether it is the larger one
SIDES = {"left": (0, False), "right": (0, True), "bottom": (1, False), "top": (1, True)}
#: nodes as near to the plane lie on it, over the model's size; displacements across it that differ by less than this
#: share of the largest one are the same: files have six digits
ON_PLANE, SAME = 1e-6, 1e-5


def mirrored(field: DisplacementField, sides: Sequence[str]) -> DisplacementField:
    """A model with what its planes of symmetry leave out.

    Parameters
    ----------
    field : DisplacementField
    sides : sequence of str
        Of `SIDES`, those at which it is mirrored, one after the other.

    Raises
    ------
    ValueError
        When there is no such side, or it does not stay plane.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> quarter = DisplacementField(square, {"quad": np.array([[0, 1, 2, 3]])}, 0.01 * square)
    >>> whole = mirrored(quarter, ["left", "bottom"])
    >>> whole.area(), whole.displacement(np.array([[-0.5, -1.0]])).tolist()
    (4.0, [[-0.005, -0.01]])
    """
    for side in sides:
        if side not in SIDES:
            raise ValueError(f"symmetry = {side!r}: must be one of {', '.join(SIDES)}")
        field = _mirrored(field, side)
    return field


def _mirrored(field: DisplacementField, side: str) -> DisplacementField:
    axis, is_upper = SIDES[side]
    used = np.unique(np.concatenate([nodes.ravel() for nodes in field.cells.values()]))
    x = field.points[used, axis]
    place = x.max() if is_upper else x.min()
    size = float(np.ptp(field.points[used], axis=0).max())
    on = used[np.abs(x - place) < ON_PLANE * size]
    across = field.u[on, axis]
    if len(on) < 2 or np.ptp(across) > SAME * np.abs(field.u[used]).max():
        name = "xy"[axis]
        raise ValueError(
            f"symmetry = {side!r}: {len(on)} nodes lie at {name} = {place:.6g} mm, and u_{name} differs by "
            f"{np.ptp(across):.3g} mm between them; a plane of symmetry stays plane"
        )
    n = len(field.points)
    points, u = field.points.copy(), field.u.copy()
    points[:, axis] = 2 * place - points[:, axis]
    u[:, axis] = 2 * across.mean() - u[:, axis]
    node = n + np.arange(n)
    node[on] = on
    cells = {kind: np.concatenate([nodes, node[nodes]]) for kind, nodes in field.cells.items()}
    return DisplacementField(np.concatenate([field.points, points]), cells, np.concatenate([field.u, u]))
