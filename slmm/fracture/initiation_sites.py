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
from slmm.fracture.surface_peaks import BETWEEN, SOUGHT, Sampled, Site, at_corners, at_peaks, may_start
from slmm.mechanics.stress import principal_stress

Array = NDArray[np.float64]

#: the principal stress at depth is at most so many times the stress along the surface there; chosen
ABOVE_SURFACE = 1.3
#: less than this share of the largest stress along free surfaces is no tension; round-off and discretisation
NO_TENSION = 1e-3


def critical_sites(model: BoundaryModel, least: float) -> list[Site]:
    """Peaks of the principal stress at the critical distance below the free surfaces, the highest first.

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
    free = ~model.body.known.held.any(axis=1) & may_start(
        part, loading, np.column_stack([z.real, z.imag]), depth
    )
    # where supports end a stress has no largest value
    least = max(least, NO_TENSION * float(np.abs(hoop[free]).max(initial=0.0)))
    hoop = np.where(free, ABOVE_SURFACE * hoop, -np.inf)
    found = at_corners(part, loading, stress_below, depth)
    least = max(least, max((site.stress for site in found), default=0.0) / BETWEEN)
    if hoop.max(initial=-np.inf) > least:
        found += at_peaks(_sampled(model, depth, hoop, least), stress_below, least)
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
    below = np.full(panels.n, -np.inf)
    todo = hoop > least
    # first where the surface's own stress is largest: the others need to beat that
    first = np.flatnonzero(todo)[np.argsort(hoop[todo])[-SOUGHT:]]
    for rows in (first, None):
        if rows is None:
            rows = np.flatnonzero(todo & (hoop > max(least, below.max() / BETWEEN)) & np.isneginf(below))
        if len(rows):
            z, normal = panels.z[rows], 1j * panels.tangent[rows]
            points, inward = (np.column_stack([v.real, v.imag]) for v in (z, normal))
            below[rows] = _stress_below(model, Places(points, inward, rows), depth)
    contours = [Contour(model.part, panels, int(number)) for number in np.unique(panels.contour)]
    return [
        Sampled(contour, contour.way, np.isfinite(hoop)[contour.nodes], below[contour.nodes])
        for contour in contours
    ]
