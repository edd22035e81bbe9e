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
#: a point so near to a crack's mouth, over its panel's length, is taken to be beside it by so much of that; both chosen
AT_MOUTH, BESIDE = 1e-4, 1e-3


class Eliminated(NamedTuple):
    """Where unknowns of a border stand.

    Attributes
    ----------
    panels, cracks : ndarray of int
        Of the panels in place of divided ones, and of the cracks, in their order.
    """

    panels: Rows
    cracks: Rows


class _Panels(NamedTuple):
    """Members of one kind: their panels, their rows, and which of them are new."""

    panels: Panels | CrackPanels
    rows: Rows
    is_new: NDArray[np.bool_]

    def chosen(self, which: Rows) -> _Panels:
        """Some of them."""
        width = len(self.rows) // len(self.is_new)
        rows = self.rows.reshape(-1, width)[which].ravel()
        return _Panels(self.panels.chosen(which), rows, self.is_new[which])


def eliminated(body: Body, cracks: CrackPanels | None) -> Eliminated:
    """Bring a body's border up to what divided panels and cracks ask for; only new ones are computed."""
    border = body.border
    divided = [Member(Kind.DIVIDED, (k,), 2 * body.p) for k in body.removed.tolist()]
    panels = [Member(Kind.PANEL, interval.key, 2 * body.p) for interval in body.outside.intervals]
    along = [] if cracks is None else _members(cracks)
    new = border.keep([*divided, *panels, *along])
    if new:
        first = border.size
        try:
            _fill(body, cracks, divided, panels, along, new)
        except BaseException:  # other models go on without them
            border.drop(first)
            raise
    return Eliminated(border.places(panels), border.places(along))


def _fill(
    body: Body,
    cracks: CrackPanels | None,
    divided: list[Member],
    panels: list[Member],
    along: list[Member],
    new: list[Member],
) -> None:
    """Add new ones of all members to a body's border."""
    base, border = body.base, body.border
    first, added = border.size, set(new)
    B, rows, right = border.extend(new)
    B[base.unknowns :] = 0.0
    for number, member in zip(body.removed.tolist(), divided, strict=True):
        if member in added:
            unknowns = number * member.width + np.arange(member.width)
            own = border.places([member]) - first
            B[:, own], rows[own], right[own] = 0.0, 0.0, 0.0
            B[unknowns, own] = rows[own, unknowns] = 1.0
    groups = [
        _Panels(source, border.places(members), np.array([member in added for member in members]))
        for members, source in ((panels, body.outside), (along, cracks))
        if members and source is not None
    ]
    fresh = [group.chosen(np.flatnonzero(group.is_new)) for group in groups if group.is_new.any()]
    stays = [group.chosen(np.flatnonzero(~group.is_new)) for group in groups if not group.is_new.all()]
    for one in fresh:
        # they follow each other as their rows do
        its = slice(one.rows[0] - first, one.rows[-1] + 1 - first)
        if isinstance(one.panels, Panels):
            B[: base.unknowns, its], rows[its], right[its] = _of_panels(body, one.panels)
            continue
        count, width = len(one.is_new), 2 * one.panels.p
        turns = min(-(-len(one.panels.z) * base.panels.n // AT_ONCE), max(1, count // FEW))
        for few in np.array_split(np.arange(count), turns):
            at = slice(its.start + few[0] * width, its.start + (few[-1] + 1) * width)
            B[: base.unknowns, at], rows[at], right[at] = _of_cracks(body, one.panels.chosen(few))
    border.eliminate(first)
    for one in fresh:
        its = slice(one.rows[0], one.rows[-1] + 1)
        for by in groups:
            border.matrix[its, by.rows] += _direct(body, one, by)
        for target in stays:
            border.matrix[target.rows, its] += _direct(body, target, one)


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
    there = Targets.on(base.panels)._replace(z=_off_mouths(body), own=np.full(base.panels.n, -1))
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
    z = _off_mouths(body)
    B = of_cracks(cracks, z, np.full(len(z), -1)).displacement(body.kappa).real()
    rows, known = body.base.traction(cracks.z, np.repeat(cracks.direction, cracks.p))
    return B, rows, -known


def _off_mouths(body: Body) -> Complex:
    """The base system's points (n,), those at mouths of cracks beside them: their panels are divided, and count not."""
    panels = body.base.panels
    length = np.repeat(panels.length, panels.p)
    away = np.abs(panels.z[:, None] - np.array(body.mouths, dtype=complex)).min(axis=1, initial=np.inf)
    along = panels.dz / np.abs(panels.dz)
    return np.asarray(np.where(away < AT_MOUTH * length, panels.z + BESIDE * length * along, panels.z))


def _direct(body: Body, target: _Panels, source: _Panels) -> Array:
    """What members cause at members, without the base system; (2 t, 2 s)."""
    of, by = target.panels, source.panels
    p = of.p
    on = np.full(len(target.is_new), -1)
    if isinstance(of, Panels) == isinstance(by, Panels):
        place = np.full(body.border.size, -1)
        place[source.rows[:: 2 * p]] = np.arange(len(source.is_new))
        on = place[target.rows[:: 2 * p]]
    on = np.repeat(on, p)
    if isinstance(by, CrackPanels):
        caused = of_cracks(by, of.z, on)
        if isinstance(of, CrackPanels):
            return traction_of(caused.P, caused.Q, -1.0, _directions(of)).real()
        return caused.displacement(body.kappa).real()
    if isinstance(of, CrackPanels):
        return traction_of(*stress_of_boundary(by, of.z), -1.0, _directions(of)).real()
    own = np.where(on < 0, -1, on * p + np.tile(np.arange(p), len(target.is_new)))
    W = displacement_by_g(by, body.kappa, Targets(of.z, own, np.repeat(of.smooth, p)))
    W += body.base.motions(of.z) @ body.base.motions_felt(by)
    there = np.flatnonzero(own >= 0)
    for part in (0, 1):
        W[2 * there + part, 2 * own[there] + part] -= body.kappa + 1
    return W


def _directions(cracks: CrackPanels) -> Complex:
    return np.repeat(cracks.direction, cracks.p)
