"""Where surfaces are critical by the point method, and at which load (Paper D, section 2.2.2).

The stress along the surface follows from a model's densities without kernels; the principal stress at depth is asked
for only where that could beat the lowest load so far.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from slmm.boundary.contour import Contour, Places
from slmm.boundary.model import BESIDE, BoundaryModel
from slmm.criteria.distances import point_distance
from slmm.mechanics.stress import principal_stress

Array = NDArray[np.float64]

#: the principal stress at depth is at most so many times the stress along the surface there; chosen
ABOVE_SURFACE = 1.3
#: less than this share of the largest stress along surfaces is no tension; round-off and discretisation
NO_TENSION = 1e-3
#: peaks between points may be so much higher than at the points; chosen
BETWEEN = 1.1
#: points nearer to the mouth of a crack, or to a corner, than so many depths belong to it; chosen
BESIDE_MOUTH = 2.5
#: points that a peak is sought by in each of two rounds, and how much the second one is narrower; chosen
SOUGHT, NARROWER = 7, 0.15
#: peaks that are followed, at most: a uniform stress has one at every point; chosen
MOST_PEAKS = 12


class Site(NamedTuple):
    """Where a crack may start.

    Attributes
    ----------
    point, inward : ndarray, shape (2,)
        mm, and the unit normal into the body.
    hole : int
        Which outline of the part, -1 for a straight outer edge.
    stress : float
        Principal stress at the critical distance under the model's load, MPa.
    """

    point: Array
    inward: Array
    hole: int
    stress: float


def critical_sites(model: BoundaryModel, least: float) -> list[Site]:
    """Peaks of the principal stress at the critical distance below the free surfaces, the highest first.

    Parameters
    ----------
    model : BoundaryModel
    least : float
        Lower ones are of no interest, MPa.
    """
    depth = point_distance(model.body.material)
    hoop = model.hoop
    least = max(least, NO_TENSION * float(np.abs(hoop).max()))
    hoop = np.where(_may_start(model, depth), ABOVE_SURFACE * hoop, -np.inf)
    found = _at_corners(model, depth)
    least = max(least, max((site.stress for site in found), default=0.0) / BETWEEN)
    if hoop.max(initial=-np.inf) > least:
        found += _along_surfaces(model, depth, hoop, least)
    return sorted((site for site in found if site.stress >= least), key=lambda site: -site.stress)


def _may_start(model: BoundaryModel, depth: float) -> NDArray[np.bool_]:
    """Which points (n,) of the boundary are free and beside no mouth of a crack, corner or end of a support."""
    z, body = model.panels.z, model.body
    free = ~body.known.held.any(axis=1)
    corners = [
        outline.points(outline.corners[outline.corner_angles < np.pi]) for outline in model.part.outlines
    ]
    at_corners = np.concatenate([np.empty((0, 2)), *corners]) @ [1, 1j]
    # where a support ends its model has a stress that the support itself would not have
    supports = [condition.ends for condition in body.loading if any(condition.is_held)]
    at_supports = np.concatenate([np.empty((0, 2)), *supports]) @ [1, 1j]
    for place in (*body.mouths, *at_corners.tolist(), *at_supports.tolist()):
        free = free & (np.abs(z - place) > BESIDE_MOUTH * depth)
    return np.asarray(free)


def _stress_below(model: BoundaryModel, where: Places, depth: float) -> Array:
    """Principal stress (k,) at a depth below places, MPa."""
    points = where.points + depth * where.inward
    deep = depth >= BESIDE * model.panel_length(where.points)
    stress = np.empty((len(points), 3))
    for these, stress_at in ((deep, model.stress_inside), (~deep, model.stress)):
        if these.any():
            stress[these] = stress_at(points[these])
    return np.asarray(principal_stress(stress))


def _along_surfaces(model: BoundaryModel, depth: float, hoop: Array, least: float) -> list[Site]:
    """Peaks on smooth stretches."""
    panels = model.panels
    below = np.full(panels.n, -np.inf)
    allowed = np.isfinite(hoop)
    todo = hoop > least
    # first where the surface's own stress is largest: the others need to beat that
    first = np.flatnonzero(todo)[np.argsort(hoop[todo])[-SOUGHT:]]
    for rows in (first, None):
        if rows is None:
            rows = np.flatnonzero(todo & (hoop > max(least, below.max() / BETWEEN)) & np.isneginf(below))
        if len(rows):
            z, normal = panels.z[rows], 1j * panels.tangent[rows]
            points, inward = (np.column_stack([v.real, v.imag]) for v in (z, normal))
            where = Places(points, inward, rows)
            below[rows] = _stress_below(model, where, depth)
    brackets = []
    for number in np.unique(panels.contour):
        contour = Contour(model.part, panels, int(number))
        nodes, way = contour.nodes, contour.way
        value = below[nodes]
        before, after = np.roll(value, 1), np.roll(value, -1)
        step_back = np.mod(way - np.roll(way, 1), contour.length)
        step_on = np.mod(np.roll(way, -1) - way, contour.length)
        # not into what belongs to a mouth or a corner
        step_back[np.roll(~allowed[nodes], 1)] = 0.0
        step_on[np.roll(~allowed[nodes], -1)] = 0.0
        peaks = (value >= before) & (value >= after) & (value > max(least, below.max()) / BETWEEN)
        brackets += [
            (value[k], contour, way[k] - step_back[k], way[k] + step_on[k]) for k in np.flatnonzero(peaks)
        ]
    brackets.sort(key=lambda bracket: -bracket[0])
    brackets = brackets[:MOST_PEAKS]
    return _followed(model, depth, brackets) if brackets else []


def _followed(
    model: BoundaryModel, depth: float, brackets: list[tuple[float, Contour, float, float]]
) -> list[Site]:
    """The peaks within brackets (value at its point, contour, from, to)."""
    contours = [bracket[1] for bracket in brackets]
    middle = np.array([0.5 * (low + high) for *_, low, high in brackets])
    half = np.array([0.5 * (high - low) for *_, low, high in brackets])
    x = chebyshev.chebpts1(SOUGHT)
    fine = np.linspace(-1.0, 1.0, 401)
    to_fine = chebyshev.chebvander(fine, SOUGHT - 1) @ np.linalg.inv(chebyshev.chebvander(x, SOUGHT - 1))
    for width in (half, NARROWER * half):
        ways = middle[:, None] + width[:, None] * x
        where = _joined([contour.at(way) for contour, way in zip(contours, ways, strict=True)])
        value = _stress_below(model, where, depth).reshape(len(brackets), SOUGHT) @ to_fine.T
        best = value.argmax(axis=1)
        middle = middle + width * fine[best]
    sites = _joined([contour.at(np.array([way])) for contour, way in zip(contours, middle, strict=True)])
    return [
        Site(point, inward, int(hole), float(stress))
        for point, inward, hole, stress in zip(*sites, value.max(axis=1), strict=True)
    ]


def _joined(places: list[Places]) -> Places:
    return Places(*(np.concatenate(values) for values in zip(*places, strict=True)))


def _at_corners(model: BoundaryModel, depth: float) -> list[Site]:
    """Corners that point into the material, along their bisectors."""
    found = []
    for k, outline in enumerate(model.part.outlines):
        s = outline.corners[outline.corner_angles < np.pi]
        if not len(s):
            continue
        points = outline.points(s)
        z = points[:, 0] + 1j * points[:, 1]
        ends = model.panels.ends.ravel()
        near = np.abs(z[:, None] - ends).argmin(axis=1)
        on_surface = np.abs(ends[near] - z) <= 2 * model.part.tolerance
        held = np.asarray(model.body.known.held.reshape(len(model.panels.ends), -1).any(axis=1))[near // 2]
        cut = np.array([bool(np.any(np.abs(np.array(model.body.mouths) - at) <= depth)) for at in z])
        here = np.flatnonzero(on_surface & ~held & ~cut)
        if not len(here):
            continue
        where = Places(points[here], outline.normals(s[here]), np.full(len(here), k))
        stress = _stress_below(model, where, depth)
        found += [Site(p, n, k, float(v)) for p, n, v in zip(*where[:2], stress, strict=True)]
    return found
