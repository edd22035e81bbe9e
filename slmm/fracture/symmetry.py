"""The whole part from a half or quarter model: its image beyond a line of symmetry is added.

On the line u_n = 0 where the part goes on; where it is free to leave the line, there is a crack, whose other face is
the image of this one. So the whole part has its crack tips where `slmm.fracture.tips` finds them, and J, K and nodal
forces are those of the part, not of its half.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from slmm.fracture.tips import SIX_DIGITS
from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named
from slmm.results.boundary_edges import boundary_edges
from slmm.results.internal_forces import nodal_internal_forces

#: displacements below this share of the largest are zero: solvers and penalties leave no more, files of six digits
#: less; round-off
NO_DISPLACEMENT = 1e-5
#: shear on a line of symmetry, as a share of the normal forces there: more than stresses carried to the integration
#: points leave, less than a clamped edge has; chosen
SHEAR = 0.05

_LINE = re.compile(r"\s*(?P<axis>[xy])\s*(=\s*(?P<place>\S+)\s*)?")


@dataclass(frozen=True)
class _Side:
    """A straight side of a model: axis 0 is x = place, axis 1 is y = place.

    ``inward`` is the sign of the normal into the model; ``held`` (e,) of bool says which of its edges (e, 3) have
    u_n = 0 throughout, ``opens`` which of them move into the model; ``inner`` are the held nodes that have no other
    edge of the boundary than those on the line.
    """

    axis: int
    place: float
    inward: int
    edges: np.ndarray
    held: np.ndarray
    opens: np.ndarray
    inner: np.ndarray

    def __str__(self) -> str:
        return f"{'xy'[self.axis]} = {self.place:g}"

    @property
    def has_crack(self) -> bool:
        """Whether edges that are held go over into edges that open."""
        return bool(np.isin(self.edges[self.held, :2], self.edges[self.opens, :2]).any())


def whole_part(results: ElementResults, symmetry: Sequence[str]) -> ElementResults:
    """The part of which a plane model is the half or the quarter.

    Parameters
    ----------
    results : ElementResults
        Of the half or quarter.
    symmetry : sequence of str
        Lines of symmetry: "x" or "y", the direction in which nothing moves there, or where the line is, too:
        "y=20". Without a place it is the side of the model that is held so.

    Returns
    -------
    ElementResults
        The nodes of the model first, those of its images after them. Without symmetry it is the model itself.

    Raises
    ------
    ValueError
        For a model in space, a line that is none of x, y, x=PLACE, y=PLACE, is named twice, is no side of the model, is
        nowhere held, or carries shear.

    Examples
    --------
    >>> from slmm.mechanics.elasticity import Elasticity
    >>> from slmm.mechanics.element_results import linear_elastic
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> half = linear_elastic(
    ...     square, {"CPE4": np.array([[0, 1, 2, 3]])}, 1e-3 * square * [0, 1], Elasticity(100e3, 0.0)
    ... )
    >>> whole = whole_part(half, ["y"])
    >>> whole.points[4:].tolist(), whole.cells["CPE4"].tolist()
    ([[1.0, -1.0], [0.0, -1.0]], [[0, 1, 2, 3], [0, 5, 4, 1]])
    """
    if symmetry and results.dimension != 2:
        raise ValueError(f"symmetry = {symmetry[0]!r}: lines of symmetry belong to plane models")
    whole, named = results, set()
    for text in symmetry:
        match = _LINE.fullmatch(text)
        if match is None:
            raise ValueError(f"symmetry = {text!r}: must be x, y, x=PLACE or y=PLACE, as y=20")
        axis = "xy".index(match["axis"])
        if axis in named:
            raise ValueError(f"symmetry = {text!r}: there is a line {match['axis']} = ... already")
        named.add(axis)
        side = _chosen(text, _sides(whole, axis), match["place"])
        if (shear := _shear(side, nodal_internal_forces(whole))) > SHEAR:
            raise ValueError(
                f"symmetry = {text!r}: {side} carries shear, {100 * shear:.2g} % of the normal force, as a clamped "
                "edge does; a line of symmetry has none"
            )
        whole = _with_image(whole, side)
    return whole


def half_model_side(results: ElementResults) -> str | None:
    """The line, as "y", that looks like the symmetry line of a cracked half model, if there is one."""
    sides = [side for axis in (0, 1) for side in _sides(results, axis) if side.has_crack]
    if not sides:
        return None
    forces = nodal_internal_forces(results)
    for side in sides:
        if _shear(side, forces) <= SHEAR:
            return "xy"[side.axis]
    return None


def _sides(results: ElementResults, axis: int) -> list[_Side]:
    """Both outermost lines across an axis, where edges of the boundary lie on them."""
    points, u = results.points, results.u
    edges = boundary_edges(points, results.cells)
    tolerance = SIX_DIGITS * np.abs(points).max()
    zero = NO_DISPLACEMENT * np.abs(u).max()
    found = []
    for place, inward in ((points[:, axis].min(), 1), (points[:, axis].max(), -1)):
        on_line = np.abs(points[:, axis] - place) <= tolerance
        here = edges[on_line[edges[:, :2]].all(axis=1)]
        # without a middle node the start stands for it
        nodes = np.where(here >= 0, here, here[:, :1])
        moved = inward * u[nodes, axis]
        held = (np.abs(moved) <= zero).all(axis=1)
        opens = ~held & (moved.max(axis=1, initial=0.0) > zero) & (moved.min(axis=1, initial=0.0) >= -zero)
        others = edges[~on_line[edges[:, :2]].all(axis=1)]
        inner = np.setdiff1d(here[held], np.append(others, -1))
        if len(here):
            found.append(_Side(axis, float(place), inward, here, held, opens, inner))
    return found


def _chosen(text: str, sides: list[_Side], place: str | None) -> _Side:
    """The side that is meant, which is held somewhere."""
    if place is not None:
        try:
            at = float(place)
        except ValueError:
            raise ValueError(f"symmetry = {text!r}: {place!r} is no number") from None
        near = [
            side for side in sides if abs(side.place - at) <= SIX_DIGITS * 10 * max(abs(at), abs(side.place))
        ]
        if not near:
            raise ValueError(
                f"symmetry = {text!r}: must be a side of the model, of which it lies on one side; there are "
                f"{' and '.join(map(str, sides)) or 'none across this axis'}"
            )
        sides = near
    held = [side for side in sides if side.held.any()]
    if not held:
        direction = text.strip()[0]
        raise ValueError(
            f"symmetry = {text!r}: no edge of the model on {' or '.join(map(str, sides)) or 'a straight side'} has "
            f"u_{direction} = 0, as it has where the whole part goes on"
        )
    best = [side for side in held if side.has_crack] or held
    if len(best) > 1:
        raise ValueError(
            f"symmetry = {text!r}: may be {' or '.join(map(str, best))}, both are held: say which, as "
            f"{'xy'[best[0].axis]}={best[0].place:g}"
        )
    return best[0]


def _with_image(results: ElementResults, side: _Side) -> ElementResults:
    """The model and its image, joined where the line is held."""
    n, axis = len(results.points), side.axis
    shared = np.zeros(n, dtype=bool)
    joined = side.edges[side.held]
    shared[joined[joined >= 0]] = True
    number = np.arange(n)
    number[~shared] = n + np.arange(n - shared.sum())
    sign = np.ones(2)
    sign[axis] = -1.0
    points, image = results.points.copy(), results.points * sign
    image[:, axis] += 2 * side.place
    on_line = np.unique(side.edges[side.edges >= 0])
    points[on_line, axis] = image[on_line, axis] = side.place
    u, u_image = results.u.copy(), results.u * sign
    u[shared, axis] = 0.0
    cells, stress, energy, region = {}, {}, {}, {}
    for name, nodes in results.cells.items():
        turned, at = element_named(name).turned
        cells[name] = np.concatenate([nodes, number[nodes][:, turned]])
        stress[name] = np.concatenate(
            [results.stress[name], results.stress[name][:, at] * np.outer(sign, sign)]
        )
        energy[name] = np.concatenate([results.energy[name], results.energy[name][:, at]])
        region[name] = np.concatenate([results.region[name]] * 2)
    return replace(
        results,
        points=np.concatenate([points, image[~shared]]),
        u=np.concatenate([u, u_image[~shared]]),
        cells=cells,
        stress=stress,
        energy=energy,
        region=region,
    )


def _shear(side: _Side, forces: np.ndarray) -> float:
    """Internal forces along a line over those across it, at the nodes that only the line holds."""
    size = np.abs(forces[side.inner]).sum(axis=0)
    along, across = size[1 - side.axis], size[side.axis]
    return float(along / across) if across else 0.0
