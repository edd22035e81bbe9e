"""What is wrong with a plate's load: edges that have no material, and forces that do not balance."""

from __future__ import annotations

import numpy as np

from slmm.part.edges import Array, Edges
from slmm.scene.loading import Load

#: share of an edge below which its material does not count; chosen
LEAST = 1e-4
#: force and moment of a uniform stress on top and bottom that may be left, over the force; the curves' polygons are
#: this far off their crossings with an edge, at most; chosen
UNBALANCED = 1e-4


def load_problems(load: Load, edges: Edges, width: float, height: float) -> list[str]:
    """Problems of a load on a plate in one piece, each one a sentence that starts with its key.

    Parameters
    ----------
    load : Load
    edges : Edges
        Where the plate's edges have material.
    width, height : float
        Size of the plate, mm.
    """
    empty = [
        name
        for name, length in zip(Edges._fields, (width, width, height, height), strict=True)
        if np.diff(getattr(edges, name)).sum() < LEAST * length
    ]
    if load.strain is not None:
        if len(empty) < len(Edges._fields):
            return []
        return [
            "load.strain: the plate has no material at any of its edges, which the load moves;"
            " leave some between the notches"
        ]
    key = "load.displacement" if load.displacement is not None else "load.stress"
    loaded = [name for name in ("top", "bottom") if name in empty]
    if loaded:
        return [
            f"{key}: no material at the {' and '.join(loaded)} edge, where it acts; leave some between the notches,"
            " or prescribe a strain"
        ]
    if load.stress is None:
        return []
    (top, top_moment), (bottom, bottom_moment) = (_resultant(stretches, width) for stretches in edges[1::-1])
    if max(abs(top - bottom), abs(top_moment - bottom_moment) / width) <= UNBALANCED * max(top, bottom):
        return []
    force, moment = (load.stress * value for value in (top - bottom, top_moment - bottom_moment))
    return [
        f"load.stress = {load.stress:g}: the notches leave {top:.6g} mm of the top edge and {bottom:.6g} mm of the"
        f" bottom edge, so the stress on both is not in equilibrium: {force:.4g} N and {moment:.4g} N mm about the"
        " middle for each mm of thickness are left; prescribe a displacement or a strain instead"
    ]


def _resultant(stretches: Array, width: float) -> tuple[float, float]:
    """Force and moment about the middle of the plate of a unit stress on stretches of an edge."""
    start, end = stretches.T
    return float((end - start).sum()), float(((end - start) * ((start + end) / 2 - width / 2)).sum())
