"""How large elements may be: small where outlines bend, gaps are narrow or stresses singular, larger elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numba import njit

from slmm.mechanics.nearest import Nearest
from slmm.part.crack import Crack
from slmm.part.outline import AT_CORNER, Outline
from slmm.part.part import Part

#: growth of the element size with the distance from where it is prescribed, mm per mm; chosen
SIZE_GROWTH = 0.3
#: intervals on an outline whose turn is measured, more only where it bends sharply: digitised outlines are not smooth
#: on a much finer scale; and the shortest of them over the outline's length; both chosen
INTERVALS, SHARPEST = 256, 1e-6
#: elements in the narrowest part of a gap; chosen
ACROSS_GAP = 2
#: a crack that turns by less goes straight on, rad; chosen, the stress at such a kink rises with r^-0.0006 at most
STRAIGHT_ON = 1e-3

#: squares that sample the size, in sizes: it changes by less than half over them; chosen
SAMPLED = 2.0
#: where the quarters of a square lie about its centre, in halves of their sides
QUARTERS = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])


@dataclass(frozen=True)
class SizePolicy:
    """How fine a mesh shall be.

    Parameters
    ----------
    largest : float, optional
        Largest element, mm; by default a twelfth of the part's shorter side.
    turn : float
        How far an outline may turn along one element edge, rad.
    at_tips : float
        Element size at the tip of a crack and at a corner of the material, as a share of the crack's length or of the
        sides that meet at the corner.
    at_kinks : float
        The same at the kinks of a crack and where cracks meet, where the stress is less singular, if at all.
    """

    largest: float | None = None
    turn: float = 0.12
    at_tips: float = 1e-3
    at_kinks: float = 1e-3


class ElementSize:
    """Size wanted at a point: prescribed at sources, growing with the distance from them, never above ``largest``.

    Examples
    --------
    >>> size = ElementSize(10.0)
    >>> size.prescribe(np.array([[0.0, 0.0]]), np.array([1.0]))
    >>> size(np.array([[0.0, 0.0], [10.0, 0.0], [99.0, 0.0]]))
    array([ 1.,  4., 10.])
    """

    def __init__(self, largest: float):
        """No source yet."""
        self.largest = float(largest)
        self._points = np.empty((0, 2))
        self._sizes = np.empty(0)

    def prescribe(self, points: np.ndarray, sizes: np.ndarray) -> None:
        """Sizes (n,), mm, at points (n, 2); those above the largest say nothing."""
        matters = sizes < self.largest
        self._points = np.concatenate([self._points, points[matters]])
        self._sizes = np.concatenate([self._sizes, sizes[matters]])

    def take_back(self, point: np.ndarray) -> None:
        """Forget what was prescribed at a point (2,)."""
        others = np.linalg.norm(self._points - point, axis=1) > 1e-9 * self.largest
        self._points, self._sizes = self._points[others], self._sizes[others]

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Sizes (n,) at points (n, 2), mm."""
        return _sizes(np.ascontiguousarray(points), self._points, self._sizes, self.largest)

    def sampled(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 2) in a rectangle and the sizes (n,) wanted there, where these are below the largest, mm.

        They are the centres of squares that cover it, none larger than SAMPLED times the size at its centre.

        Examples
        --------
        >>> size = ElementSize(10.0)
        >>> size.prescribe(np.array([[0.0, 0.0]]), np.array([4.0]))
        >>> size.sampled(np.array([0.0, 0.0]), np.array([16.0, 16.0]))[0]
        array([[ 4.,  4.],
               [12.,  4.],
               [ 4., 12.],
               [12., 12.]])
        """
        side = float((high - low).max())
        centres = low[None] + side / 2
        points = []
        while len(centres):
            enough = side <= SAMPLED * self(centres)
            points.append(centres[enough])
            side /= 2
            centres = (centres[~enough, None] + side / 2 * QUARTERS).reshape(-1, 2)
            centres = centres[(centres - side / 2 < high).all(axis=1)]
        found = np.concatenate(points)
        sizes = self(found)
        matters = sizes < self.largest
        return found[matters], sizes[matters]


@njit(cache=True)
def _sizes(points, sources, prescribed, largest):
    size = np.full(len(points), largest)
    for i in range(len(points)):
        for k in range(len(sources)):
            allowed = size[i] - prescribed[k]
            if allowed > 0.0:
                dx, dy = points[i, 0] - sources[k, 0], points[i, 1] - sources[k, 1]
                grown = SIZE_GROWTH * np.sqrt(dx * dx + dy * dy)
                if grown < allowed:
                    size[i] = prescribed[k] + grown
    return size


def follow_outline(size: ElementSize, outline: Outline, policy: SizePolicy, body: shapely.Polygon) -> None:
    """No edge on the outline turns by more than is allowed; small elements at corners of the body."""
    angle_max = policy.turn
    ends = np.concatenate([outline.corners, outline.corners[:1] + outline.length])
    if not len(outline.corners):
        ends = np.array([0.0, outline.length])
    for s0, s1 in pairwise(ends):
        inset = 2 * AT_CORNER * outline.length  # a corner has two tangents
        s, turn = _turns(outline, s0 + inset, s1 - inset, angle_max)
        middle = outline.points(0.5 * (s[1:] + s[:-1]))
        size.prescribe(middle, angle_max * np.diff(s) / np.maximum(turn, 1e-12))
    if not len(outline.corners):
        return
    side = np.diff(ends)
    shorter = np.minimum(side, np.roll(side, 1))
    singular = outline.corner_angles < np.pi  # the material's angle is above 180 degrees
    if singular.any():
        at = outline.points(outline.corners[singular])
        # a notch that cuts the outer edge has corners outside
        of_body = shapely.distance(shapely.points(at), body) < 1e-9 * body.length
        size.prescribe(at[of_body], policy.at_tips * shorter[singular][of_body])


def _turns(outline: Outline, s0: float, s1: float, angle_max: float) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths (n,) from s0 to s1, so close that none of the turns (n - 1,) between them exceeds angle_max."""
    s = np.linspace(s0, s1, max(4, round(INTERVALS * (s1 - s0) / outline.length)) + 1)
    while True:
        t = outline.tangents(s)
        turn = np.abs(np.arctan2(t[:-1, 0] * t[1:, 1] - t[:-1, 1] * t[1:, 0], (t[:-1] * t[1:]).sum(axis=1)))
        sharp = (turn > angle_max) & (np.diff(s) > SHARPEST * outline.length)
        if not sharp.any():
            return s, turn
        s = np.insert(s, np.flatnonzero(sharp) + 1, 0.5 * (s[1:] + s[:-1])[sharp])


def follow_cracks(
    size: ElementSize, cracks: Sequence[Crack], lines: Sequence[np.ndarray], policy: SizePolicy
) -> None:
    """Small elements at tips and kinks, and where cracks meet such that a corner of the material is left.

    The lines (n, 2) of the cracks have points of their own where they meet.
    """
    directions: dict[bytes, list[np.ndarray]] = {}
    for line in lines:
        for here, other in [*pairwise(line), *pairwise(line[::-1])]:
            directions.setdefault(here.tobytes(), []).append(other - here)
    for crack, line in zip(cracks, lines, strict=True):
        surface = [end.kind == "surface" for end in (crack.start, crack.end)]
        inner = line[surface[0] : len(line) - surface[1]]
        at = np.array([point for point in inner if _has_corner(directions[point.tobytes()])]).reshape(-1, 2)
        is_tip = np.array([len(directions[point.tobytes()]) == 1 for point in at], dtype=bool)
        length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        size.prescribe(at, length * np.where(is_tip, policy.at_tips, policy.at_kinks))


def _has_corner(directions: Sequence[np.ndarray]) -> bool:
    """Whether cracks that leave a point in some directions leave an angle of material above 180 degrees."""
    angles = np.sort([np.arctan2(y, x) for x, y in directions])
    return bool(np.diff(angles, append=angles[0] + 2 * np.pi).max() > np.pi + STRAIGHT_ON)


def resolve_gaps(size: ElementSize, body: shapely.Polygon) -> None:
    """Two elements at least between a closed curve around the body and the others."""
    rings = [body.exterior, *body.interiors]
    if len(rings) == 1:
        return
    parts = np.linspace(0, 1, 257)[:-1]
    points = [shapely.get_coordinates(ring.interpolate(parts, normalized=True)) for ring in rings]
    for k, own in enumerate(points):
        others = np.concatenate([p for j, p in enumerate(points) if j != k])
        # the distance to their points bounds the one to the curves: exact only where it may matter
        coarse = np.linalg.norm(others[Nearest(others).numbers(own, 1)[:, 0]] - own, axis=1)
        near = coarse < 2 * ACROSS_GAP * size.largest + 2 * max(ring.length for ring in rings) / 256
        lines = shapely.MultiLineString([ring for j, ring in enumerate(rings) if j != k])
        size.prescribe(own[near], shapely.distance(shapely.points(own[near]), lines) / ACROSS_GAP)


def along_path(path: np.ndarray) -> np.ndarray:
    """Sizes (k,) at the nodes (k, 2) of a path: the shorter of the steps that meet there, mm."""
    step = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return np.minimum(np.append(step, step[-1]), np.append(step[0], step))


def all_sizes(
    policy: SizePolicy, part: Part, cracks: Sequence[np.ndarray], path: np.ndarray | None
) -> ElementSize:
    """Sizes for a part: outlines, gaps, cracks along lines (n, 2), a trial path (k, 2) of given nodes."""
    shorter = float(np.ptp(part.outer, axis=0).min())
    size = ElementSize(shorter / 12 if policy.largest is None else policy.largest)
    for outline in part.outlines:
        follow_outline(size, outline, policy, part.body)
    follow_cracks(size, part.cracks, cracks, policy)
    resolve_gaps(size, part.body)
    if path is not None:
        # a crack tip or corner that it goes on from is as fine as its own steps: the mesher follows no sudden change
        size.take_back(path[0])
        size.prescribe(path, along_path(path))
    return size
