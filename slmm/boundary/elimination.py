"""Cracks and divided panels of a body as a border of its factorised system."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.border import Kind, Member
from slmm.boundary.crack_panels import CrackPanels
from slmm.boundary.densities import (
    Targets,
    displacement_by_g,
    of_cracks,
    stress_of_boundary,
    traction_of,
)
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex

if TYPE_CHECKING:
    from slmm.boundary.body import Body

Rows = NDArray[np.int64]
#: weights of cracks that are computed at once, 128 kB of each kind, and of at least so many panels; both chosen: what
#: comes and goes is little beside what stays
AT_ONCE, FEW = 8_192, 2


class Eliminated(NamedTuple):
    """Where unknowns of a border stand.

    Attributes
    ----------
    panels, cracks : ndarray of int
        Of the panels in place of divided ones, and of the cracks, in their order.
    """

    panels: Rows
    cracks: Rows


class _Sources(NamedTuple):
    """Members of one kind: their panels, which of all these they are, and their rows."""

    panels: Panels | CrackPanels
    which: Rows
    rows: Rows


def eliminated(body: Body, cracks: CrackPanels | None) -> Eliminated:
    """Bring a body's border up to what divided panels and cracks ask for; only new ones are computed."""
    base, border = body.base, body.border
    outside = body.panels.chosen(np.flatnonzero(body.of_base < 0))
    divided = [Member(Kind.DIVIDED, (k,), 2 * body.p) for k in body.removed.tolist()]
    panels = [Member(Kind.PANEL, interval.key, 2 * body.p) for interval in outside.intervals]
    along = [] if cracks is None else _members(cracks)
    new = border.keep([*divided, *panels, *along])
    if new:
        old = len(border.right)
        places = _Places(border.members, new)
        m = places.size - old
        columns, rows, right = border.room(m)
        B = columns.T
        corner, felt = np.zeros((m, old + m)), np.zeros((old, m))
        added = set(new)
        for k, member in enumerate(divided):
            if member in added:
                unknowns = body.removed[k] * member.width + np.arange(member.width)
                own = places.of([member]) - old
                B[unknowns, own] = rows[own, unknowns] = 1.0
        fresh: list[_Sources] = []
        stays: list[_Sources] = []
        for members, source in ((panels, outside), (along, cracks)):
            is_new = np.array([member in added for member in members], dtype=bool)
            for found, which in ((fresh, np.flatnonzero(is_new)), (stays, np.flatnonzero(~is_new))):
                if len(which):
                    assert source is not None
                    chosen = source.chosen(which)
                    found.append(_Sources(chosen, which, places.of([members[k] for k in which.tolist()])))
        for one in fresh:
            own = one.rows - old
            if isinstance(one.panels, Panels):
                B[: base.unknowns, own], rows[own], right[own] = _of_panels(body, one.panels)
            else:
                count = len(one.which)
                turns = min(-(-len(one.panels.z) * base.panels.n // AT_ONCE), max(1, count // FEW))
                for few in np.array_split(np.arange(count), turns):
                    at = own.reshape(count, -1)[few].ravel()
                    B[: base.unknowns, at], rows[at], right[at] = _of_cracks(body, one.panels.chosen(few))
            for by in (*fresh, *stays):
                corner[np.ix_(own, by.rows)] = _direct(body, one, by)
            for target in stays:
                felt[np.ix_(target.rows, own)] = _direct(body, target, one)
        columns[:] = base.solve(B).T
        right -= rows @ base.solution
        border.extend(new, corner, felt)
    places = _Places(border.members, [])
    return Eliminated(places.of(panels), places.of(along))


class _Places:
    """Where the rows of members stand."""

    def __init__(self, members: list[Member], more: list[Member]) -> None:
        self.size, self._spans = 0, {}
        for member in (*members, *more):
            self._spans[member] = np.arange(self.size, self.size + member.width)
            self.size += member.width

    def of(self, members: list[Member]) -> Rows:
        return np.concatenate([self._spans[member] for member in members] or [np.empty(0, dtype=int)])


def _members(cracks: CrackPanels) -> list[Member]:
    keys = zip(cracks.starts.tolist(), cracks.ends.tolist(), strict=True)
    return [
        Member(Kind.TIP if tip else Kind.CRACK, key, 2 * cracks.p)
        for key, tip in zip(keys, cracks.is_tip.tolist(), strict=True)
    ]


def _of_panels(body: Body, panels: Panels) -> tuple[Array, Array, Array]:
    """Columns (2 n, k), rows (k, 2 n + m) and right-hand sides (k,) of panels that the base system has not.

    They add nothing to the resultants on its m motions of rigid bodies.
    """
    base = body.base
    there = Targets.on(base.panels)._replace(own=np.full(base.panels.n, -1))
    B = displacement_by_g(panels, body.kappa, there)
    B += base.motions(base.panels.z) @ base.motions_felt(panels)
    here = Targets.on(panels)._replace(own=np.full(panels.n, -1))
    rows, known = base.displacement(here)
    none = _overlap(base.panels, panels)
    B[none] = 0.0
    rows[:, : base.unknowns][none.T] = 0.0
    return B, rows, -known


def _overlap(old: Panels, new: Panels) -> NDArray[np.bool_]:
    """Which unknowns (2 n,) of panels lie on the same piece of a curve as which (k,) of new ones; (2 n, k).

    These never act on each other: where a new panel is, the one that it is part of is divided.
    """
    (smooth, low, high), (of, begin, end) = (
        np.array([interval.key for interval in panels.intervals]).T for panels in (old, new)
    )
    same = (smooth[:, None] == of) & (low[:, None] < end) & (begin < high[:, None])
    width = 2 * old.p
    return np.repeat(np.repeat(same, width, axis=0), width, axis=1)


def _of_cracks(body: Body, cracks: CrackPanels) -> tuple[Array, Array, Array]:
    """The same of panels of cracks."""
    z = body.base.panels.z
    B = of_cracks(cracks, z, np.full(len(z), -1)).displacement(body.kappa).real()
    rows, known = body.base.traction(cracks.z, np.repeat(cracks.direction, cracks.p))
    return B, rows, -known


def _direct(body: Body, target: _Sources, source: _Sources) -> Array:
    """What members cause at members, without the base system; (2 t, 2 s)."""
    of, by = target.panels, source.panels
    p = of.p
    place = np.full(max(target.which.max(), source.which.max()) + 1, -1)
    place[source.which] = np.arange(len(source.which))
    same = isinstance(of, Panels) == isinstance(by, Panels)
    on = np.repeat(place[target.which], p) if same else np.full(len(of.z), -1)
    if isinstance(by, CrackPanels):
        caused = of_cracks(by, of.z, on)
        if isinstance(of, CrackPanels):
            return traction_of(caused.P, caused.Q, -1.0, _directions(of)).real()
        return caused.displacement(body.kappa).real()
    if isinstance(of, CrackPanels):
        return traction_of(*stress_of_boundary(by, of.z), -1.0, _directions(of)).real()
    own = np.where(on < 0, -1, on * p + np.tile(np.arange(p), len(target.which)))
    W = displacement_by_g(by, body.kappa, Targets(of.z, own, np.repeat(of.smooth, p)))
    W += body.base.motions(of.z) @ body.base.motions_felt(by)
    there = np.flatnonzero(own >= 0)
    for part in (0, 1):
        W[2 * there + part, 2 * own[there] + part] -= body.kappa + 1
    return W


def _directions(cracks: CrackPanels) -> Complex:
    return np.repeat(cracks.direction, cracks.p)
