"""What holds and moves a part: conditions on stretches of its surface.

The short forms of a plate's load become such conditions here, and nowhere else. Voxels, body-fitted models and all that
asks which edges are held read these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.rigid import motions_about
from slmm.part.span import Span
from slmm.scene.sampled import Sampled
from slmm.scene.varying_traction import VaryingTraction

Array = NDArray[np.float64]
Point = tuple[float, float]

#: nodes as near to a stretch lie on it, as a share of its length; round-off
ON_STRETCH = 1e-9


class Load(Protocol):
    """The short form of a plate's load: exactly one kind; the others are None."""

    @property
    def strain(self) -> tuple[float, float, float] | None:
        """e_xx, e_yy, g_xy that prescribe the displacements of all four edges."""

    @property
    def displacement(self) -> float | None:
        """u_y of the top edge, mm; the bottom edge is held in y, the sides are free."""

    @property
    def stress(self) -> float | None:
        """Uniform normal traction on the material of the top and bottom edge, MPa."""


class Affine(NamedTuple):
    """A displacement component that is linear in the place: ``at + by_x x + by_y y``, mm."""

    at: float = 0.0
    by_x: float = 0.0
    by_y: float = 0.0

    def __call__(self, points: Array) -> Array:
        """Values (n,) at points (n, 2), mm."""
        x, y = points.T
        return self.at + self.by_x * x + self.by_y * y


Component = Affine | Sampled


@dataclass(frozen=True, eq=False)
class Stiff:
    """A rigid body on a stretch, or on several: what of its motion is free, and the forces on it that go with that.

    Parameters
    ----------
    middle : (float, float)
        Of the material that it holds, mm; forces act there, and it turns about it.
    reach : float
        Half of that material's length, mm.
    free : (bool, bool, bool)
        Whether it may move along x, along y, and turn.
    force : (float, float, float)
        In these directions, N for each mm of thickness, and the moment, N mm, counter-clockwise.

    Examples
    --------
    >>> bar = Stiff((5.0, 0.0), 5.0, (False, True, True), (0.0, 3.0, 10.0))
    >>> bar.motions(np.array([[10.0, 0.0]])).tolist(), bar.resultants.tolist()
    ([[[0.0, 0.0], [1.0, 1.0]]], [3.0, 2.0])
    """

    middle: Point
    reach: float
    free: tuple[bool, bool, bool]
    force: tuple[float, float, float]

    def motions(self, points: Array) -> Array:
        """Displacements (n, 2, k) of points (n, 2) by its k free motions; a turn moves by 1 at its reach."""
        return motions_about(points, np.array(self.middle), self.reach)[..., np.array(self.free)]

    @property
    def resultants(self) -> Array:
        """Forces (k,) whose work by its free motions is that of the forces on it, N for each mm of thickness."""
        return np.array([*self.force[:2], self.force[2] / self.reach])[np.array(self.free)]


@dataclass(frozen=True)
class Condition:
    """What acts along a stretch of a part's surface: a straight one, or a span of an outline.

    Parameters
    ----------
    start, end : (float, float)
        The stretch, with the body on its left, mm.
    displacement : (Affine, Sampled or None, and again)
        What u_x and u_y are there; None is free.
    traction : (float, float)
        MPa, in the directions that are free.
    pressure : float
        MPa, onto the surface.
    bearing : (float, float)
        Of a pin that pushes this way: its pressure falls as the cosine, from this one, MPa, to the sides.
    span : Span, optional
        None on a straight stretch.
    stiff : Stiff, optional
        The rigid body that the stretch belongs to; ``displacement`` is then what of its motion is given.
    varying : VaryingTraction, optional
        A traction that changes along the stretch, besides all these.
    """

    start: Point
    end: Point
    displacement: tuple[Component | None, Component | None] = (None, None)
    traction: Point = (0.0, 0.0)
    pressure: float = 0.0
    bearing: Point = (0.0, 0.0)
    span: Span | None = None
    stiff: Stiff | None = None
    varying: VaryingTraction | None = None

    @property
    def length(self) -> float:
        """Of the stretch, mm."""
        if self.span is not None:
            return self.span.length
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    @property
    def is_held(self) -> tuple[bool, bool]:
        """Whether u_x and u_y are prescribed."""
        return self.displacement[0] is not None, self.displacement[1] is not None

    @property
    def is_loaded(self) -> bool:
        """Whether a traction acts."""
        return any(self.traction) or bool(self.pressure) or any(self.bearing) or self.varying is not None

    def on(self, points: Array) -> NDArray[np.bool_]:
        """Which points (n, 2) lie on the stretch."""
        if self.span is not None:
            return self.span.holds(points)
        start, length = np.array(self.start), self.length
        along = (np.array(self.end) - start) / length
        (dx, dy), near = (points - start).T, ON_STRETCH * length
        s = dx * along[0] + dy * along[1]
        return (np.abs(dx * along[1] - dy * along[0]) < near) & (s > -near) & (s < length + near)

    def points(self, share: Array) -> Array:
        """Points (n, 2) at shares (n,) of its length, mm."""
        if self.span is not None:
            return self.span.points(share)
        start = np.array(self.start)
        return start + share[:, None] * (np.array(self.end) - start)

    def outward(self, points: Array) -> Array:
        """Unit normals (n, 2) out of the body at points (n, 2) of the stretch."""
        if self.span is not None:
            return self.span.outward(points)
        x, y = (np.array(self.end) - self.start) / self.length
        return np.broadcast_to(np.array([y, -x]), points.shape)

    def tractions(self, points: Array, outward: Array) -> Array:
        """Tractions (n, 2) at points (n, 2) with unit normals (n, 2) out of the body, MPa; 0 in directions held."""
        onto = self.pressure + np.maximum(-outward @ np.array(self.bearing), 0.0)
        values = np.array(self.traction) - onto[:, None] * outward
        if self.varying is not None:
            values = values + self.varying(points)
        return np.where(self.is_held, 0.0, values)

    @cached_property
    def ends(self) -> Array:
        """Points (n, 2) where it begins and ends, and between them where its traction has a kink, mm."""
        ends = np.array([self.start, self.end])
        if self.span is None or not any(self.bearing):
            return ends
        return np.concatenate([ends, self.span.square_to(np.array(self.bearing))])

    @property
    def rule(self) -> tuple[Array, Array, Array]:
        """Points (n, 2), tractions (n, 2), MPa, and weights (n,), mm, for integrals along the stretch."""
        if self.span is not None:
            points, outward, weight = self.span.rule
            return points, self.tractions(points, outward), weight
        points = np.array([self.start, self.end])
        return points, self.tractions(points, self.outward(points)), np.full(2, 0.5 * self.length)


@dataclass(frozen=True)
class Loading:
    """Conditions on a part; what none of them names is free of traction.

    Where they leave a rigid motion free, the forces must balance, and the motion is of no importance.

    Parameters
    ----------
    conditions : tuple of Condition

    Examples
    --------
    >>> pulled = plate_loading(40.0, 120.0, stress=5.0)
    >>> [(condition.start, condition.traction) for condition in pulled]
    [((0.0, 0.0), (0.0, -5.0)), ((40.0, 120.0), (0.0, 5.0))]
    """

    conditions: tuple[Condition, ...]

    def __iter__(self) -> Iterator[Condition]:
        return iter(self.conditions)

    @property
    def stiff(self) -> tuple[Stiff, ...]:
        """The rigid bodies, each once."""
        return tuple(dict.fromkeys(condition.stiff for condition in self if condition.stiff is not None))

    @property
    def ends(self) -> Array:
        """Points (n, 2) where conditions begin, end or have kinks, mm: models have nodes there."""
        return np.concatenate([np.empty((0, 2)), *(condition.ends for condition in self)])

    def at_edge(self, start: Point, end: Point) -> Condition:
        """The condition on a whole edge from one corner to the next; a free one where there is none."""
        for condition in self:
            if condition.start == start and condition.end == end:
                return condition
        return Condition(start, end)

    @property
    def strain(self) -> tuple[float, float, float] | None:
        """e_xx, e_yy, g_xy of displacements that are the same linear function wherever anything is prescribed.

        None where they are not one function, or nothing is prescribed.
        """
        fields = {condition.displacement for condition in self}
        if len(fields) != 1 or self.stiff:
            return None
        u_x, u_y = fields.pop()
        if not (isinstance(u_x, Affine) and isinstance(u_y, Affine)):
            return None
        return u_x.by_x, u_y.by_y, u_x.by_y + u_y.by_x

    def nominal_stress(self, E: float) -> float:
        """Largest stress that the load would cause in a part without notches, about, MPa."""
        ends = np.array([point for condition in self for point in (condition.start, condition.end)])
        side = float(np.ptp(ends, axis=0).min()) if len(ends) else 0.0
        # of a short stretch the force counts, over the part's smaller side
        traction = max(
            (
                float(np.abs(condition.rule[1]).max()) * min(1.0, condition.length / side if side else 1.0)
                for condition in self
            ),
            default=0.0,
        )
        if side:
            traction = max([traction, *(float(np.hypot(*stiff.force[:2])) / side for stiff in self.stiff)])
        if self.strain is not None:
            return max(traction, E * float(np.abs(self.strain).max()))
        moved = [
            (component.at, 0.5 * (np.array(condition.start) + condition.end))
            for condition in self
            for component in condition.displacement
            if component is not None
        ]
        stretches = [
            abs(one - other) / np.linalg.norm(here - there)
            for one, here in moved
            for other, there in moved
            if one != other and (here != there).any()
        ]
        return max(traction, E * float(max(stretches, default=0.0)))


def plate_loading(
    width: float,
    height: float,
    strain: Sequence[float] | None = None,
    displacement: float | None = None,
    stress: float | None = None,
) -> Loading:
    """The short form of a load on a plate with its lower left corner at (0, 0), as conditions on its edges.

    Parameters
    ----------
    width, height : float
        mm.
    strain : (e_xx, e_yy, g_xy), optional
        All four edges are displaced by u_x = e_xx x + g_xy y / 2, u_y = g_xy x / 2 + e_yy y.
    displacement : float, optional
        u_y of the top edge, mm; the bottom edge is held in y, the sides are free.
    stress : float, optional
        Uniform tension on the top and the bottom edge, MPa.

    Raises
    ------
    ValueError
        When it is not one kind, or not finite.
    """
    kinds = {"strain": strain, "displacement": displacement, "stress": stress}
    given = {name: value for name, value in kinds.items() if value is not None}
    if len(given) != 1:
        raise ValueError(
            f"load has {list(given) or 'nothing'}: exactly one of strain, displacement, stress is needed"
        )
    for name, value in given.items():
        if not np.isfinite(value).all():
            raise ValueError(f"load.{name} = {value!r}: must be finite")
    bottom, right, top, left = plate_edges(width, height)
    if strain is not None:
        e_xx, e_yy, g_xy = strain
        field = Affine(0.0, e_xx, g_xy / 2), Affine(0.0, g_xy / 2, e_yy)
        return Loading(tuple(Condition(*edge, field) for edge in (bottom, right, top, left)))
    if displacement is not None:
        return Loading((Condition(*bottom, (None, Affine())), Condition(*top, (None, Affine(displacement)))))
    assert stress is not None
    return Loading((Condition(*bottom, traction=(0.0, -stress)), Condition(*top, traction=(0.0, stress))))


def plate_edges(width: float, height: float) -> tuple[tuple[Point, Point], ...]:
    """Bottom, right, top and left edge of a plate, each from its start to its end, counter-clockwise, mm."""
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    return tuple((corner, corners[(k + 1) % 4]) for k, corner in enumerate(corners))
