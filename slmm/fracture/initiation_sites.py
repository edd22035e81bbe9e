"""Where surfaces are critical by the point method, and at which load, by boundary integrals (Paper D, section 2.2.2).

The stress along the surface follows from a model's densities without kernels; the principal stress at depth is asked
for only where that could beat the lowest load so far.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.contour import Contour, Places
from slmm.boundary.model import BESIDE, BoundaryModel
from slmm.criteria.distances import point_distance
from slmm.fracture.exclusion import Exclusion
from slmm.fracture.surface_peaks import BETWEEN, Sampled, Site, at_corners, at_peaks
from slmm.mechanics.stress import principal_stress

Array = NDArray[np.float64]

#: the principal stress at depth is at most so many times the stress along the surface there; chosen
ABOVE_SURFACE = 1.3
#: less than this share of the largest stress along free surfaces is no tension; round-off and discretisation
NO_TENSION = 1e-3
#: peaks of the stress along surfaces that are asked first, and points to either side of each, among which the stress at
#: depth has its own peak; chosen
FIRST, TO_EITHER_SIDE = 3, 2


def critical_sites(model: BoundaryModel, least: float) -> list[Site]:
    """Peaks of the principal stress at the critical distance below the free surfaces, the highest first.

    Places are among them where the stress rises to the end of what may crack; they say why they are excluded.

    Parameters
    ----------
    model : BoundaryModel
    least : float
        Lower ones are of no interest, MPa.
    """
    depth = point_distance(model.body.material)
    part, loading, z = model.part, model.body.loading, model.panels.z

    def stress_below(where: Places) -> Array:
        return _stress_below(model, where, depth)

    hoop = model.hoop
    found = at_corners(part, loading, stress_below, depth)
    if not found and ABOVE_SURFACE * hoop.max() <= least:
        return []
    exclusion = Exclusion.of(part, loading, depth)
    free = ~model.body.known.held.any(axis=1) & exclusion.is_clear(np.column_stack([z.real, z.imag]))
    # where supports end a stress has no largest value
    least = max(least, NO_TENSION * float(np.abs(hoop[free]).max(initial=0.0)))
    hoop = np.where(free, ABOVE_SURFACE * hoop, -np.inf)
    least = max(least, max((site.stress for site in found), default=0.0) / BETWEEN)
    if hoop.max(initial=-np.inf) > least:
        found += at_peaks(_sampled(model, depth, hoop, least), stress_below, least, exclusion)
    return sorted((site for site in found if site.stress >= least), key=lambda site: -site.stress)


def _stress_below(model: BoundaryModel, where: Places, depth: float) -> Array:
    """Principal stress (k,) at a depth below places, MPa."""
    points = where.points + depth * where.inward
    deep = depth >= BESIDE * model.panel_length(where.points)
    stress = np.empty((len(points), 3))
    for these, stress_at in ((deep, model.stress_inside), (~deep, model.stress)):
        if these.any():
            stress[these] = stress_at(points[these])
    return np.asarray(principal_stress(stress))


def _sampled(model: BoundaryModel, depth: float, hoop: Array, least: float) -> list[Sampled]:
    """The closed curves around the part, with the stress at depth wherever it could be above the least."""
    panels = model.panels
    contours = [Contour(model.part, panels, int(number)) for number in np.unique(panels.contour)]
    before, behind = np.empty((2, panels.n), dtype=int)
    for contour in contours:
        before[contour.nodes], behind[contour.nodes] = np.roll(contour.nodes, 1), np.roll(contour.nodes, -1)
    below = np.full(panels.n, -np.inf)

    def ask(rows: NDArray[np.int64]) -> None:
        z, normal = panels.z[rows], 1j * panels.tangent[rows]
        points, inward = (np.column_stack([v.real, v.imag]) for v in (z, normal))
        below[rows] = _stress_below(model, Places(points, inward, rows), depth)

    def tops(value: Array) -> NDArray[np.bool_]:
        beside = np.minimum(value[before], value[behind])
        return np.isfinite(beside) & (value >= value[before]) & (value >= value[behind])

    # first where the surface's own stress has its highest peaks: all others need to beat what they have at depth
    todo = hoop > least
    first = np.flatnonzero(todo & tops(hoop))
    rows = first[np.argsort(hoop[first])[-FIRST:]]
    for _ in range(TO_EITHER_SIDE):
        rows = np.unique(np.concatenate([rows, before[rows], behind[rows]]))
    rows = rows[np.isfinite(hoop[rows])]
    if len(rows):
        ask(rows)
    highest = float(below[tops(below)].max(initial=-np.inf))
    rows = np.flatnonzero(todo & (hoop > max(least, highest / BETWEEN)) & np.isneginf(below))
    if len(rows):
        ask(rows)
    return [
        Sampled(contour, contour.way, np.isfinite(hoop)[contour.nodes], below[contour.nodes])
        for contour in contours
    ]
