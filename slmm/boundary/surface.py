"""Stress at surfaces, and next to them: from the densities there, where kernels lose digits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, differentiation, slopes_at, values_at
from slmm.part.part import Part

#: distances to two sides of a corner are the same within; round-off
SAME = 1e-9


class Feet(NamedTuple):
    """The nearest points of the boundary.

    Attributes
    ----------
    panel : ndarray, shape (k,) of int
    xi : ndarray, shape (k,)
        Place on it, -1 to 1.
    foot, tangent : ndarray, shape (k,)
        mm, and unit vectors along the boundary, the body on their left.
    depth : ndarray, shape (k,)
        Distance into the body, mm; negative beyond the boundary.
    """

    panel: NDArray[np.int64]
    xi: Array
    foot: Complex
    tangent: Complex
    depth: Array


def feet(part: Part, panels: Panels, points: Array) -> Feet:
    """The nearest points of the boundary to points (k, 2)."""
    z = points[:, 0] + 1j * points[:, 1]
    nowhere = np.full(len(z), np.inf)
    found = Feet(np.zeros(len(z), dtype=int), nowhere, nowhere + 0j, nowhere + 0j, nowhere)
    straight = np.flatnonzero(panels.straight)
    if len(straight):
        found = _on_edges(panels, straight, z)
    for k, hole in enumerate(part.outlines):
        s = hole.project(points)
        x, y = hole.points(s).T
        tx, ty = hole.tangents(s).T
        foot, tangent = x + 1j * y, -(tx + 1j * ty)
        depth = _depth(z, foot, tangent)
        of_hole = np.flatnonzero(panels.hole == k)
        if not len(of_hole):
            continue
        panel, xi, inside = _on_hole(panels, of_hole, s, hole.length)
        nearer = inside & (np.abs(z - foot) < np.abs(z - found.foot))
        found = Feet(
            *(
                np.where(nearer, new, old)
                for new, old in zip((panel, xi, foot, tangent, depth), found, strict=True)
            )
        )
    return found


def _on_edges(panels: Panels, rows: NDArray[np.int64], z: Complex) -> Feet:
    """Feet on the straight panels of some rows."""
    a, b = panels.ends[rows].T
    along = b - a
    share = np.clip(((z[:, None] - a) / along).real, 0.0, 1.0)
    foot = a + share * along
    tangent = along / np.abs(along)
    distance = np.abs(z[:, None] - foot)
    inwards = ((z[:, None] - foot) * np.conj(1j * tangent)).real
    # at a corner, of both sides that from which the point stands off most tells on which side of the surface it is
    nearest = distance <= distance.min(axis=1, keepdims=True) * (1 + SAME)
    best = np.where(nearest, np.abs(inwards), -1.0).argmax(axis=1)
    k = np.arange(len(z))
    at = foot[k, best]
    return Feet(rows[best], 2 * share[k, best] - 1, at, tangent[best], _depth(z, at, tangent[best]))


def _depth(z: Complex, foot: Complex, tangent: Complex) -> Array:
    """Distance (n,) from the nearest points of the boundary, which may be corners, negative beyond it, mm."""
    inwards = ((z - foot) * np.conj(1j * tangent)).real
    return np.where(inwards < 0, -1.0, 1.0) * np.abs(z - foot)


def _on_hole(
    panels: Panels, rows: NDArray[np.int64], s: Array, length: float
) -> tuple[NDArray[np.int64], Array, NDArray[np.bool_]]:
    """Panels and places on them of arc lengths on a hole, and whether these lie on the part's boundary at all."""
    first, last = panels.span[rows].T
    way = np.mod(first - s[:, None], length)
    inside = way <= (first - last) * (1 + 1e-12)
    best = np.where(inside, way / (first - last), np.inf).argmin(axis=1)
    k = np.arange(len(s))
    xi = np.clip(2 * way[k, best] / (first - last)[best] - 1, -1.0, 1.0)
    return rows[best], xi, inside.any(axis=1)


def surface_stress(
    panels: Panels, at: Feet, g: Complex, t: Complex, E: float, nu: float, scale: float
) -> Array:
    """Stress xx, yy, xy (k, 3) at places of the boundary, MPa.

    Parameters
    ----------
    panels : Panels
    at : Feet
    g, t : ndarray, shape (n,)
        Displacements over ``scale``, and tractions, MPa, at the panels' points.
    E, nu : float
        Of plane stress.
    scale : float
    """
    p = panels.p
    length = panels.length[at.panel]
    slope = np.einsum("kp,kp->k", slopes_at(at.xi, p), g.reshape(-1, p)[at.panel]) * 2 / length
    traction = np.einsum("kp,kp->k", values_at(at.xi, p), t.reshape(-1, p)[at.panel])
    outward = -1j * at.tangent
    normal, shear = (traction * outward.conj()).real, (traction * at.tangent.conj()).real
    hoop = E * scale * (slope * at.tangent.conj()).real + nu * normal
    (tx, ty), (nx, ny) = (np.array([v.real, v.imag]) for v in (at.tangent, outward))
    return np.column_stack(
        [
            hoop * tx**2 + normal * nx**2 + 2 * shear * tx * nx,
            hoop * ty**2 + normal * ny**2 + 2 * shear * ty * ny,
            hoop * tx * ty + normal * nx * ny + shear * (tx * ny + ty * nx),
        ]
    )


def hoop_stress(panels: Panels, g: Complex, t: Complex, E: float, nu: float, scale: float) -> Array:
    """Normal stress (n,) along the boundary at the panels' points, MPa; parameters as of `surface_stress`."""
    p = panels.p
    slope = (g.reshape(-1, p) @ differentiation(p).T).ravel() * np.repeat(2 / panels.length, p)
    normal = (t * (-1j * panels.tangent).conj()).real
    return np.asarray(E * scale * (slope * panels.tangent.conj()).real + nu * normal)
