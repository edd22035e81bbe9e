"""Curves along a path through its whole ligament, by boundary integrals.

A crack that cuts a ligament between two holes, or a hole and an edge, leaves the part in one piece, and has set a
finite energy free, however steeply the curve rises to it. One that severs the part has no such limit here: its curve
ends where hardly anything of the ligament is left, and energy and stress there bound what severs it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slmm.boundary.along_path import AlongPaths
from slmm.boundary.model import BoundaryModel
from slmm.boundary.opened_path import OpenedPath, with_path
from slmm.boundary.rules import Array
from slmm.boundary.trial_cracks import TrialCracks
from slmm.criteria.path_curves import path_points
from slmm.initiation.contact import closes_at

#: up to this share of the ligament its end is not felt; what is left of it beyond, as a share: the last one is less
#: than a step of the curves (all chosen on tests/initiation/test_through_ligament.py)
FIRST, LAST = 0.4, 0.009


class Through(NamedTuple):
    """Cracks of one order along a path through a ligament.

    Attributes
    ----------
    a : ndarray, shape (CURVE_POINTS,)
        Lengths, mm, up to the ligament or, where that would sever the part, almost.
    G : ndarray, shape (CURVE_POINTS,)
        G_inc, N/mm.
    closed : float
        Length from which on cracks close at their tips, mm, or, where all do not but the one that cuts the ligament
        does anywhere, the longest one before; else infinite.
    cuts : bool
        Whether the longest crack cuts the ligament, and leaves the part in one piece.
    """

    a: Array
    G: Array
    closed: float
    cuts: bool


def through(
    model: BoundaryModel, start: Array, end: Array, exponent: float, tip: int | None, solved: int, longer: int
) -> Through:
    """Cracks from a place of a surface, or a tip, to where the path ends.

    Parameters
    ----------
    model : BoundaryModel
        The part without them.
    start, end : ndarray, shape (2,)
        mm; the end on a surface or on a crack.
    exponent, tip, solved
        As of `TrialCracks`.
    longer : int
        How many longer ones are solved.

    Raises
    ------
    ValueError
        When a crack cannot be solved.
    """
    ligament = float(np.linalg.norm(end - start))
    whole = with_path(model.part, start, end, tip)
    cuts = not whole.is_severed
    a = path_points(np.array([ligament if cuts else (1 - LAST) * ligament]))[0]
    direction = (end - start) / ligament
    trial = TrialCracks(model, start, direction, FIRST * ligament, exponent, tip, solved)
    number = -1 if tip is None else tip
    along = _places(longer)
    left = LAST + along.places[0, ::-1]
    ends = [start + length * direction for length in ligament * (1 - left)]
    if tip is None:
        parts = [model.part.with_short_crack(start, at) for at in ends]
    else:
        parts = [model.part.grown(tip, at) for at in ends]
    old = model.body
    body = old.divided(parts[-1], [complex(*at) for at in ends])
    energy, K = np.empty(len(left)), np.empty((len(left), 2))
    for k, (part, at) in enumerate(zip(parts, ends, strict=True)):
        cracked = BoundaryModel(
            part, old.material, old.loading, old.p, model.crack_p, body, grading=old.grading
        )
        energy[k] = OpenedPath(model, cracked, complex(*start), complex(*at)).energy
        K[k] = cracked.stress_intensities()[number]
    # beyond the last one it is that of the last: at least as much is set free there
    beyond = np.clip(1 - a / ligament - LAST, 0.0, 1 - FIRST - LAST)
    # short cracks set free as their length to the power of the exponent and one
    power = exponent + 1
    series = np.log(energy / (1 - left) ** power)[::-1]
    share = 1 - LAST - beyond
    G = np.exp(along.at(beyond[None])[0] @ series) * share**power / np.maximum(a, a[1])
    short = a <= FIRST * ligament
    G[short] = trial.incremental(np.maximum(a[short], a[1]))
    if exponent > 0:
        G[0] = 0.0
    K, lengths = np.concatenate([trial.K, K]), np.append(trial.lengths, ligament * (1 - left))
    closed = float(closes_at(lengths[None], K[None])[0])
    if cuts:
        cut = OpenedPath(model, model.with_cracks_of(whole), complex(*start), complex(*end))
        G[-1] = cut.energy / ligament
        closed = min(closed, np.inf if cut.is_open else float(lengths[-1]))
    return Through(a, G, closed, cuts)


def _places(longer: int) -> AlongPaths:
    """Of what is left of a ligament, as shares beyond the last one: Chebyshev's in its logarithm."""
    return AlongPaths(np.array([1 - FIRST - LAST]), np.array([LAST]), longer, with_ends=True)
