"""Which pieces of a part still carry its load, after cracks have cut it: the others come loose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import shapely
from numpy.typing import NDArray

from slmm.mechanics.rigid import motions_about
from slmm.part.part import Part
from slmm.scene.load_checks import UNBALANCED
from slmm.scene.loading import Condition, Loading

Array = NDArray[np.float64]

#: pieces reach so many of the part's tolerances beyond their polygons, for what is held or acts there; round-off
NEAR = 2.0
#: displacements that pieces cannot follow as they are, over the largest prescribed; round-off
STRAINED = 1e-8
#: combinations of rigid motions that move what is held by less, over the largest, are free; round-off
FREE = 1e-8
#: what is shorter than this share of a piece, the root of its area, is a knife edge or a roller, which holds no moment;
#: chosen
KNIFE_EDGE = 0.05
#: Gauss points on a straight stretch of a support or load, which has linear displacements; exact
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(3)


class Loose(NamedTuple):
    """A piece that came loose.

    Attributes
    ----------
    step : int
        After which step, from 0; -1 of a part whose own cracks cut it out.
    x, y : float
        Its middle, mm.
    area : float
        mm2.
    """

    step: int
    x: float
    y: float
    area: float


def carrying_piece(part: Part, loading: Loading) -> shapely.Polygon | None:
    """The piece of a severed part that still carries its load, all others being loose; None where none does.

    Every piece is taken as rigid. A part falls apart where what acts on a piece does not balance. A piece carries
    something if loads act on it, or if it cannot follow the displacements of what holds it as it is: one that has come
    off, and still stands on a support, does not.

    Raises
    ------
    ValueError
        When several pieces carry loads, each by itself.

    Examples
    --------
    A corner that is cut off stands on the edge that holds the plate; a half does not hold the other one.

    >>> from slmm.scene.loading import plate_loading
    >>> plate, pulled = Part.plate(40.0, 40.0), plate_loading(40.0, 40.0, displacement=1.0)
    >>> carrying_piece(plate.with_crack([(0.0, 10.0), (10.0, 0.0)]), pulled).area
    1550.0
    >>> carrying_piece(plate.with_crack([(0.0, 20.0), (40.0, 20.0)]), pulled) is None
    True
    """
    pieces = part.pieces
    matrix, right, of_piece, force, size, loaded = _rigid_pieces(pieces, loading, part.tolerance * NEAR)
    free = la.null_space(matrix, rcond=FREE) if len(right) else np.eye(len(force))
    if np.any(np.abs(free.T @ force) > 2 * UNBALANCED * size.max(initial=0.0)):
        return None
    lacks = np.abs(right - matrix @ np.linalg.lstsq(matrix, right, rcond=FREE)[0])
    strained = lacks > STRAINED * np.abs(right).max(initial=0.0)
    return _only(pieces, loaded | (np.bincount(of_piece, strained, len(pieces)) > 0))


class _Rigid(NamedTuple):
    """Rigid pieces on their supports: three motions of each, and those of the rigid bodies that hold them.

    Attributes
    ----------
    matrix, right : ndarray, shape (n, m), (n,)
        What motions do to the displacements that are prescribed, and these, mm.
    of_piece : ndarray, shape (n,) of int
    force, size : ndarray, shape (m,)
        What acts along each motion, N for each mm of thickness, and the sum of its parts' sizes.
    loaded : ndarray of bool
        On which pieces something acts.
    """

    matrix: Array
    right: Array
    of_piece: NDArray[np.int64]
    force: Array
    size: Array
    loaded: NDArray[np.bool_]


def _rigid_pieces(pieces: Sequence[shapely.Polygon], loading: Loading, near: float) -> _Rigid:
    """The equations of pieces under a loading, which reach so far beyond their polygons, mm."""
    columns, m = {}, 3 * len(pieces)
    for body in loading.stiff:
        columns[body] = slice(m, m := m + len(body.resultants))
    force, size, loaded = np.zeros(m), np.zeros(m), np.zeros(len(pieces), dtype=bool)
    for body, its in columns.items():
        force[its], size[its] = body.resultants, np.abs(body.resultants)
    blocks, right, of_piece = [np.empty((0, m))], [np.empty(0)], []
    for number, piece in enumerate(pieces):
        middle, around = np.array(piece.centroid.coords[0]), piece.buffer(near)
        shapely.prepare(around)
        own = slice(3 * number, 3 * number + 3)
        for condition in loading:
            points, traction, weight = _rule(condition, around, near)
            if not len(points):
                continue
            if weight.sum() < KNIFE_EDGE * np.sqrt(piece.area):
                share = weight[None] / weight.sum()
                points, traction, weight = share @ points, share @ traction, weight.sum(keepdims=True)
            stiff = condition.stiff
            motions = motions_about(points, middle, np.sqrt(piece.area))
            work = np.einsum("n,nc,nck->nk", weight, traction, motions)
            force[own] += work.sum(axis=0)
            size[own] += np.abs(work).sum(axis=0)
            loaded[number] |= bool(np.any(traction) or (stiff is not None and np.any(stiff.resultants)))
            for component, prescribed in enumerate(condition.displacement):
                if prescribed is not None:
                    block = np.zeros((len(points), m))
                    block[:, own] = motions[:, component]
                    if stiff is not None:
                        block[:, columns[stiff]] = -stiff.motions(points)[:, component]
                    blocks.append(block)
                    right.append(prescribed(points))
                    of_piece += [number] * len(points)
    pieces_of = np.array(of_piece, dtype=int)
    return _Rigid(np.concatenate(blocks), np.concatenate(right), pieces_of, force, size, loaded)


def _only(pieces: Sequence[shapely.Polygon], carries: NDArray[np.bool_]) -> shapely.Polygon | None:
    if carries.sum() > 1:
        places = ", ".join(f"({x:.4g}, {y:.4g})" for x, y in _middles(pieces, carries))
        raise ValueError(
            f"the cracks cut the part in {len(pieces)} pieces, of which those at {places} carry loads, each by itself"
        )
    return pieces[int(carries.argmax())] if carries.any() else None


def _middles(pieces: Sequence[shapely.Polygon], chosen: NDArray[np.bool_]) -> list[tuple[float, float]]:
    return [
        piece.representative_point().coords[0] for piece, is_one in zip(pieces, chosen, strict=True) if is_one
    ]


def _rule(condition: Condition, around: shapely.Polygon, near: float) -> tuple[Array, Array, Array]:
    """Points (n, 2), tractions (n, 2), MPa, and weights (n,), mm, along a stretch, as far as it belongs to a piece."""
    if condition.span is not None:
        points, traction, weight = condition.rule
        here = shapely.contains_xy(around, points)
        return points[here], traction[here], weight[here]
    line = shapely.LineString([condition.start, condition.end])
    parts = [each for each in shapely.get_parts(line.intersection(around)) if each.length > 3 * near]
    ends = np.array([shapely.get_coordinates(each)[[0, -1]] for each in parts]).reshape(-1, 2, 2)
    middle, along = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    points = (middle[:, None] + 0.5 * along[:, None] * GAUSS[:, None]).reshape(-1, 2)
    weight = (0.5 * np.hypot(*along.T)[:, None] * WEIGHTS).ravel()
    return points, condition.tractions(points, condition.outward(points)), weight
