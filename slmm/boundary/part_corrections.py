"""What a part adds to jumps beside its surface, whose closed form knows but a line or circle there.

Beside a mouth the surface is nearly its circle of curvature. What a jump there causes is known in closed form, and the
part's correction is smooth along the crack. By Betti's theorem it follows from what the closed form leaves on the
boundary, and the factorised part's answer to that:

    T_cj(z_i) g_i = integral over the boundary of (T_cj g_i - T_i g_cj) ds

of the tractions T and displacements g of jumps i and j, with c for the correction. A few places of each path tell it,
and all paths are one block of right-hand sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from slmm.boundary.around_mouth import AroundMouth
from slmm.boundary.densities import Linear, Targets, displacement_of_boundary
from slmm.boundary.mirrored import Tangent, surface_fields
from slmm.boundary.model import BoundaryModel
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, rule
from slmm.boundary.surface import feet

#: a surface is a line where it turns by less than this along the crack: a circle's round-off is larger there
STRAIGHT = 1e-6
#: and how far corners and jumps of the curvature are away at least, over a crack's length (chosen)
ALONE = 0.5
#: points of a path whose images are looked for, and how far these are away from the material at least, over their
#: distance from the mouth (both chosen)
AHEAD, CLEAR = 5, 0.5
#: weights of the boundary that are computed at once: 32 MB of each kind (chosen)
MOST_WEIGHTS = 2_000_000


class Starts(NamedTuple):
    """Where cracks start on smooth surfaces.

    Attributes
    ----------
    mouth, direction, inwards : ndarray, shape (k,)
        mm, and unit vectors along the crack and along the normal into the material.
    curvature : ndarray, shape (k,)
        Of the surface, 1/mm, negative at a hole.
    longest : ndarray, shape (k,)
        mm.
    """

    mouth: Complex
    direction: Complex
    inwards: Complex
    curvature: Array
    longest: Array


def tangents(model: BoundaryModel, starts: Starts) -> list[Tangent | None]:
    """What stands for the surface at each start: its circle of curvature, or its tangent; None where neither does.

    What is reflected must be singular outside the material alone, and away from it; and no corner or jump of the
    curvature is nearer than the crack is long.
    """
    found: list[Tangent | None] = []
    share = np.linspace(0.0, 1.0, AHEAD)[1:]
    panels = model.panels
    shapely.prepare(model.part.body)
    for z, e, n, curvature, longest in zip(*(v.tolist() for v in starts), strict=True):
        choices = [Tangent.line(z, n)]
        if abs(curvature) * longest > STRAIGHT:
            circle = Tangent.circle(z, n, curvature)
            choices = [circle, circle.without_pole(z), *choices]
        ends = _ends(panels, int(np.abs(panels.z - z).argmin() // panels.p))
        alone = np.all(np.abs(ends - z) >= ALONE * longest)
        clear = (
            choice for choice in choices if _is_clear(choice.singular(z + longest * share * e), z, model)
        )
        found.append(next(clear, None) if alone else None)
    return found


def _ends(panels: Panels, panel: int) -> Complex:
    """Ends of the smooth curve that a panel is part of; none of a closed one."""
    stretch = panels.intervals[panel].stretch
    return np.array([] if stretch.closed else [stretch.start, stretch.end], dtype=complex)


def _is_clear(at: Complex, mouth: complex, model: BoundaryModel) -> bool:
    """Whether points (k,) lie outside the material, far enough for their distance from the mouth."""
    if shapely.contains_xy(model.part.body, at.real, at.imag).any():
        return False
    nearest = np.abs(at[:, None] - model.panels.z).min(axis=1)
    return bool(np.all(nearest >= CLEAR * np.abs(at - mouth)))


def corrections(model: BoundaryModel, starts: Starts, tangents: Sequence[Tangent], places: int) -> Array:
    """Tractions (k, 2 q, 2 q) at q places of each path, along it and across in turn, by jumps there; for each mm.

    The places are Gauss points of the longest cracks.
    """
    of_part = model.body.base.corrections
    asked = (places, *(values.tobytes() for values in starts))
    # panels of a divided part are none of the base system's
    if model.body.base.panels is not model.panels:
        return _corrections(model, starts, tangents, places)
    if asked not in of_part:
        of_part[asked] = _corrections(model, starts, tangents, places)
    return of_part[asked]


def _corrections(model: BoundaryModel, starts: Starts, tangents: Sequence[Tangent], places: int) -> Array:
    """The same, computed."""
    body, panels = model.body, model.panels
    x = 0.5 * (1 + rule(places)[0])
    at = feet(model.part, panels, np.column_stack([starts.mouth.real, starts.mouth.imag]))
    forms = [
        _ClosedForm.of(
            panels, body.kappa, tangent, z, e, a * x, AroundMouth.of(panels, z, panel, xi, bend, a)
        )
        for tangent, z, e, bend, a, panel, xi in zip(
            tangents,
            starts.mouth.tolist(),
            starts.direction.tolist(),
            starts.curvature.tolist(),
            starts.longest.tolist(),
            at.panel.tolist(),
            at.xi.tolist(),
            strict=True,
        )
    ]
    F, g = (np.concatenate([getattr(form, name) for form in forms], axis=1) for name in ("F", "g"))
    answers = (np.split(values, len(forms), axis=1) for values in _answers(model, F, g))
    ds = np.abs(panels.dz)
    return np.array([form.matrix(ds, g_c, t) for form, g_c, t in zip(forms, *answers, strict=True)])


class _ClosedForm(NamedTuple):
    """What jumps at q places of a path cause on the boundary's n points, beside the circle that stands for it.

    Attributes
    ----------
    F, g, T : ndarray, shape (n, 2 q)
        Resultant forces over kappa + 1, displacements likewise, and tractions.
    around : AroundMouth or None
    g_around, T_around : ndarray, shape (r, 2 q)
        At its places.
    """

    F: Complex
    g: Complex
    T: Complex
    around: AroundMouth | None
    g_around: Complex
    T_around: Complex

    @classmethod
    def of(
        cls,
        panels: Panels,
        kappa: float,
        tangent: Tangent,
        mouth: complex,
        direction: complex,
        places: Array,
        around: AroundMouth | None,
    ) -> _ClosedForm:
        """By jumps at places (q,) of a path, mm from its mouth."""
        tau = mouth - tangent.origin + direction * places
        w, F, T = surface_fields(
            panels.z - tangent.origin, panels.tangent, tau, direction, kappa, *tangent[1:]
        )
        g = w / (kappa + 1)
        F /= kappa + 1
        if around is None:
            return cls(F, g, T, None, g[:0], T[:0])
        w_near, F_near, T_near = surface_fields(
            around.z - tangent.origin, around.tangent, tau, direction, kappa, *tangent[1:]
        )
        F[around.points] = around.gathered @ (F_near / (kappa + 1))
        return cls(F, g, T, around, w_near / (kappa + 1), T_near)

    def matrix(self, ds: Array, g_c: Complex, t: Complex) -> Array:
        """Tractions (2 q, 2 q) at the places, by the corrections' displacements and what held surfaces feel (n, 2 q).

        ``ds`` (n,) are lengths of the boundary at its points, mm.
        """
        if self.around is None:
            return _work(self.g, t - self.T, ds) - _work(self.T, g_c, ds)
        rest = ds.copy()
        rest[self.around.points] = 0.0
        g_near, t_near = (self.around.spread @ values[self.around.points] for values in (g_c, t))
        return (
            _work(self.g, t - self.T, rest)
            - _work(self.T, g_c, rest)
            + _work(self.g_around, t_near - self.T_around, self.around.weight)
            - _work(self.T_around, g_near, self.around.weight)
        )


def _work(one: Complex, other: Complex, ds: Array) -> Array:
    """Integrals (q, r) of the products of vectors (n, q) and (n, r)."""
    return np.asarray(_parts(one).T @ (np.repeat(ds, 2)[:, None] * _parts(other)))


def _answers(model: BoundaryModel, F: Complex, g: Complex) -> tuple[Complex, Complex]:
    """Displacements (n, c) of the corrections, and the tractions (n, c) of what is held.

    By the closed forms' resultants F (n, c) and displacements g (n, c) at the boundary's points.
    """
    body, panels = model.body, model.panels
    base, known, n = body.base, body.known, model.panels.n
    held, given = known.held, -g
    fixed = np.where(held[:, :1], given.real, 0.0) + 1j * np.where(held[:, 1:], given.imag, 0.0)
    on = np.flatnonzero(held.any(axis=1))
    right = np.zeros((len(base.solution), F.shape[1]))
    at = Targets.on(panels)
    turns = max(1, n * n // MOST_WEIGHTS)
    for rows in np.array_split(np.arange(n), turns):
        by_g, by_q = displacement_of_boundary(panels, body.kappa, Targets(*(v[rows] for v in at)))
        W = by_q.real() @ _parts(F)
        if len(on):
            of_held = Linear(*(np.take(of, on, axis=1) for of in by_g)).real()
            W -= of_held @ _parts(fixed[on])
            W += (body.kappa + 1) * _parts(fixed[rows])
        right[np.ravel(2 * rows[:, None] + np.arange(2))] = W
    x = base.solve(right)
    at_points, motions = np.split(x, [2 * n])
    components = at_points.reshape(n, 2, -1)
    free = np.where(held[:, :, None], 0.0, components)
    forces = np.where(held[:, :, None], components, 0.0)
    g_c = free[:, 0] + 1j * free[:, 1] + fixed + known.rigid @ motions
    return g_c, forces[:, 0] + 1j * forces[:, 1]


def _parts(values: Complex) -> Array:
    """Real and imaginary parts (2 n, k) in turn of values (n, k)."""
    return np.stack([values.real, values.imag], axis=1).reshape(2 * len(values), -1)
