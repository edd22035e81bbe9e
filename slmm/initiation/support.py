"""What the plate's edges lend to a cell: held edges stiffen the crack's surroundings, free ones weaken them.

A crack that opens pushes its surroundings like a pair of forces, and an edge at the distance d answers with a
stiffness that falls with 1/d^2. A cell with held boundary is such a case with near edges; so the stiffness of the crack
against opening, 1/G_inc, lies between that in an unbounded body and that in the held cell in the ratio of these
sums:

    1/G = (1 - rho)/G_unbounded + rho/G_held,   rho = sum_edges k/d^2 / sum_cell 1/d^2

The factors k come from full FEA of holes with radii of 20 and 30 mm in a plate of 100 mm x 100 mm and were tested on
others (validation/edge_support.py); a free edge has k < 0. Where no crack starts in such a plate (one that points at
the edge by which the plate is pulled) nothing was measured, and no correction is made.
"""

from __future__ import annotations

import numpy as np

from slmm.initiation.placement import CELL_HEIGHT, CELL_LENGTH
from slmm.part.outline import Outline
from slmm.part.rays import Lines, are_inside, distances_along
from slmm.scene.loading import Condition, plate_edges
from slmm.scene.scene import Scene

#: k of an edge that the crack points at, and of one beside it, for what holds the edge; of held edges fitted, within
#: 0.1, the others chosen between the fits with and without a plate that bends (validation/fit_support.py)
FACTORS = {
    "held": (0.8, 1.6),  # both displacements prescribed
    "rolling": (0.0, 2.2),  # the normal one prescribed; 0: not measured
    "free": (-1.0, 0.0),
    "loaded": (0.0, -5.5),  # a given traction: the crack lets the part beyond it turn away
}

#: the way to the edge begins beside the notch, at this share of it; chosen
BESIDE = 0.02

#: rho beyond which edges and other notches are too near for the estimate; chosen
LIMIT = 0.7


def edge_support(
    scene: Scene, outline: Outline, s: np.ndarray, height: np.ndarray, curvature: np.ndarray
) -> np.ndarray:
    """Share rho (n,) of the held cell's stiffness that the plate's edges give; negative where they are free.

    Parameters
    ----------
    scene : Scene
        Plate, load and notches.
    outline : Outline
        The notch.
    s : ndarray (n,)
        Arc lengths of the positions, mm.
    height, curvature : ndarray (n,)
        Of the cells, mm and 1/mm; NaN where there is none.
    """
    shares = edge_shares(scene, outline, s, height, curvature)
    total = sum(FACTORS[what][beside] * share for (what, beside), share in shares.items())
    return np.clip(total, -LIMIT, LIMIT)


def edge_shares(
    scene: Scene, outline: Outline, s: np.ndarray, height: np.ndarray, curvature: np.ndarray
) -> dict[tuple[str, int], np.ndarray]:
    """What rho is made of, as in `edge_support`: sums (n,) of 1/d^2 over that of the cell.

    By what holds the edges (a key of `FACTORS`) and where they lie (0: the crack points at them, 1: beside it).
    """
    scale = height / CELL_HEIGHT
    front = scale * (CELL_LENGTH + curvature * scale)
    of_cell = 1 / front**2 + 2 / scale**2
    start, normal, tangent = outline.points(s), outline.normals(s), outline.tangents(s)
    assert scene.plate is not None  # of other parts nothing is known
    bottom, right, *_ = plate_edges(scene.plate.width, scene.plate.height)
    # opposite edges are held alike
    edges = [_holds(scene.loading.at_edge(*edge)) for edge in (bottom, right)]
    shares = {(what, beside): np.zeros(len(s)) for what in FACTORS for beside in (0, 1)}
    for direction, beside in ((normal, 0), (tangent, 1), (-tangent, 1)):
        distance, horizontal = _to_edge(start, direction, scene.plate.width, scene.plate.height)
        # other notches on the way, or this one, keep the edge's answer away
        seen = ~_blocked(scene.notches, start, direction, distance)
        for what, meets in zip(edges, (horizontal, ~horizontal), strict=True):
            shares[what, beside] += np.where(seen & meets, 1 / distance**2, 0.0) / of_cell
    return shares


def _holds(condition: Condition) -> str:
    """What holds an edge."""
    if all(condition.is_held):
        return "held"
    if any(condition.is_held):
        return "rolling"
    return "loaded" if condition.is_loaded else "free"


def _to_edge(
    start: np.ndarray, direction: np.ndarray, width: float, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) to the plate's edge, mm, and whether it is the top or bottom one."""
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(direction > 0, np.array([width, height]) - start, -start)
        steps = np.where(direction == 0, np.inf, np.abs(far / direction))
    return np.maximum(steps.min(axis=1), 1e-9 * width), steps[:, 1] < steps[:, 0]


def _blocked(notches: Lines, start: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Whether a notch lies between the points and the edge."""
    beside = start + (BESIDE * distance)[:, None] * direction
    met = distances_along(start, direction, notches, beyond=BESIDE * distance) <= distance
    return met | are_inside(beside, notches)


def supported(unbounded: np.ndarray, held: np.ndarray, rho: np.ndarray) -> np.ndarray:
    """G_inc (n, ...) of the supported crack from both bounds; the stiffnesses 1/G mix.

    Examples
    --------
    >>> supported(np.array([[2.0]]), np.array([[1.0]]), np.array([0.5])).round(3)
    array([[1.333]])
    """
    rho = rho.reshape(-1, *[1] * (unbounded.ndim - 1))
    stiffness = held * (1 - rho) + unbounded * rho  # times both
    usable = stiffness > 0
    return np.where(usable, unbounded * held / np.where(usable, stiffness, 1.0), unbounded)
