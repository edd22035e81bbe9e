"""The states of a simulated part at its critical loads, from the result alone: cracks, displacements and stress."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.boundary.model import BoundaryModel
from slmm.boundary.rules import values_at
from slmm.boundary.stretches import COARSE
from slmm.fracture.loose_pieces import carrying_piece
from slmm.fracture.work_conjugate import work_conjugate
from slmm.part.crack import TIP
from slmm.part.part import Part
from slmm.part.remains import remains
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: Gauss points on panels of the boundary and of cracks; chosen: K, and so the critical load, within 1e-4
ORDER = 8
#: displacements of a crack's faces are those so far beside it, over the length of its segment; round-off
BESIDE_CRACK = 1e-8
#: places on each panel that its outline is drawn by; chosen
ON_PANEL = np.linspace(-1.0, 1.0, 7)


def part_before(scene: Scene, result: xr.Dataset, step: int) -> Part:
    """The part with the cracks that it had before a step; all of them if it is the number of steps.

    Without the pieces that had come loose, unless it is severed.

    Examples
    --------
    >>> from slmm.fracture.simulation import simulate
    >>> from slmm.scene.gallery import tensile_plate
    >>> scene = tensile_plate()
    >>> result = simulate(scene, increment=8.0, errors=False)
    >>> [round(float(part_before(scene, result, k).tips[0][-1, 0]), 6) for k in (0, 1, 2)]
    [10.0, 18.0, 26.0]
    """
    lines = []
    for x, y, made in zip(
        result.crack_x.values, result.crack_y.values, result.crack_step.values, strict=True
    ):
        known = made < step  # false of NaN, too
        if known.any():
            lines.append(np.column_stack([x, y])[known])
    whole = replace(scene.part, cracks=())
    cracked = whole.with_cracks(lines) if lines else whole
    kept = carrying_piece(cracked, scene.loading) if (result.loose_step < step).any() else None
    return cracked if kept is None else remains(cracked, kept).part


class Faces(NamedTuple):
    """Both faces of a crack.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Along the crack from its start to its end, mm.
    left, right : ndarray, shape (n, 2)
        Displacements of the faces on either side of that way, mm.
    """

    points: Array
    left: Array
    right: Array


@dataclass(frozen=True, eq=False)
class CriticalState:
    """A part at the load at which a step happens.

    Parameters
    ----------
    model : BoundaryModel
        Under the scene's own load.
    factor : float
        Critical load over the scene's own.
    u, F : float
        mm and N.
    """

    model: BoundaryModel
    factor: float
    u: float
    F: float

    def displacement(self, points: Array) -> Array:
        """Displacements (k, 2) at points (k, 2), mm."""
        return self.factor * self.model.displacement(points)

    def stress(self, points: Array) -> Array:
        """Stress xx, yy, xy (k, 3) at points (k, 2), MPa."""
        return self.factor * self.model.stress(points)

    @cached_property
    def surfaces(self) -> list[tuple[Array, Array]]:
        """Each panel of the outlines: places (n, 2) along it, and their displacements (n, 2), mm."""
        panels, p = self.model.panels, self.model.panels.p
        at = values_at(ON_PANEL, p)
        z, g = panels.z.reshape(-1, p) @ at.T, self.model.g.reshape(-1, p) @ at.T
        z[panels.straight] = 0.5 * (panels.ends @ np.array([1 - ON_PANEL, 1 + ON_PANEL]))[panels.straight]
        u = self.factor * self.model.body.scale * g
        return [(_plane(a), _plane(b)) for a, b in zip(z, u, strict=True)]

    @cached_property
    def faces(self) -> list[Faces]:
        """The faces of each crack."""
        cracks = self.model.cracks
        if cracks is None:
            return []
        points = shapely.points(_plane(cracks.z))
        found = []
        for crack, line in zip(self.model.part.cracks, self.model.part.crack_lines, strict=True):
            shape = shapely.LineString(line)
            own = np.flatnonzero(shapely.distance(shape, points) < self.model.part.tolerance)
            way = shapely.line_locate_point(shape, points[own])
            own, way = own[np.argsort(way)], np.sort(way)
            length = np.linalg.norm(np.diff(line, axis=0), axis=1)
            segment = np.clip(np.searchsorted(np.cumsum(length), way), 0, len(length) - 1)
            along = (np.diff(line, axis=0) / length[:, None])[segment]
            aside = BESIDE_CRACK * length[segment, None] * np.column_stack([-along[:, 1], along[:, 0]])
            places = shapely.get_coordinates(points[own])
            left, right = (self.displacement(places + side * aside) for side in (1.0, -1.0))
            # to the ends: tips are closed
            u = np.stack([left, right])[:, [0, *range(len(own)), -1]]
            for k, end in ((0, crack.start), (-1, crack.end)):
                if end == TIP:
                    u[:, k] = u[:, k].mean(axis=0)
            found.append(Faces(np.concatenate([line[:1], places, line[-1:]]), *u))
        return found


def critical_state(scene: Scene, result: xr.Dataset, step: int) -> CriticalState:
    """The part right before a step, at the load at which that happens, or at the end at the largest displacement.

    Fields are those of boundary integrals, whichever engine simulated the fracture.

    Parameters
    ----------
    scene : Scene
    result : Dataset
        From `slmm.fracture.simulate`.
    step : int
        Or their number for the end, of a part that was loaded further after the last one.

    Raises
    ------
    ValueError
        When there is no such state, as of a severed part.

    Examples
    --------
    >>> from slmm.fracture.simulation import simulate
    >>> from slmm.scene.gallery import tensile_plate
    >>> scene = tensile_plate()
    >>> result = simulate(scene, increment=8.0, errors=False)
    >>> state = critical_state(scene, result, 1)
    >>> state.u == float(result.u_c[1]), round(state.F / float(result.stiffness[1] * result.u_c[1]), 3)
    (True, 1.0)
    """
    if not 0 <= step < number_of_states(result):
        raise ValueError(f"step = {step}: the simulation has {number_of_states(result)} states, from 0 on")
    part = part_before(scene, result, step)
    model = BoundaryModel(part, scene.material, scene.loading, ORDER, ORDER, contact=True, grading=COARSE)
    conjugate = work_conjugate(scene.loading, part.thickness)
    F, u = conjugate.force_and_displacement(model.work * part.thickness)
    u_c = float(result.u_c[step] if step < result.sizes["step"] else result.u[-1])
    return CriticalState(model, u_c / u, u_c, F / u * u_c)


def number_of_states(result: xr.Dataset) -> int:
    """How many critical states a result has: one for each step, and one more if the part was loaded further."""
    u = float(result.u_load[-1]) if result.sizes["step"] else 0.0
    return int(result.sizes["step"]) + int(float(result.u[-1]) > u)


def _plane(z: NDArray[np.complex128]) -> Array:
    """Points (n, 2) of complex numbers (n,)."""
    return np.column_stack([z.real, z.imag])
