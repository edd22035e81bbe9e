"""Cracks from smooth surfaces of a part, all at once: what they set free, from a system of 32 unknowns for each crack.

The energy that a crack sets free is half of the traction that was there times its jump (Clapeyron's theorem), so every
length is computed for itself, and none for the sake of another.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from slmm.boundary.along_path import AlongPaths
from slmm.boundary.mirrored import Tangent
from slmm.boundary.model import BoundaryModel
from slmm.boundary.part_corrections import Starts, corrections
from slmm.boundary.rules import Array, values_at
from slmm.boundary.unit_crack import unit_crack

#: places of a path that tell the part's correction (chosen on tests/boundary/test_surface_cracks.py)
PLACES = 6
#: places of a path where the part's stress is asked for, and lengths of its cracks that are solved; both chosen on
#: tests/boundary/test_surface_cracks.py
STRESSES, LENGTHS = 16, 9


class SurfaceCracks:
    """Straight cracks of all lengths from some places of smooth surfaces, each alone in the part.

    Parameters
    ----------
    model : BoundaryModel
        The part, which has no cracks.
    starts : Starts
        All cracks up to the longest lie inside the part.
    tangents : sequence of Tangent
        What stands for the surface at each start, see `slmm.boundary.part_corrections.tangents`.
    places : int
        Of each path that tell what the part adds.

    Attributes
    ----------
    lengths : ndarray, shape (k, n)
        That are solved, mm.

    Examples
    --------
    An edge crack in a wide plate under 10 MPa sets half of 1.1215^2 pi sigma^2 a/E free.

    >>> from slmm.boundary.part_corrections import tangents
    >>> from slmm.mechanics.material import Material
    >>> from slmm.part.part import Part
    >>> from slmm.scene.loading import plate_loading
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1, state="plane stress")
    >>> plate = BoundaryModel(Part.plate(400.0, 800.0), material, plate_loading(400.0, 800.0, stress=10.0))
    >>> right = np.array([1.0 + 0j])
    >>> starts = Starts(np.array([400j]), right, right, np.zeros(1), np.ones(1))
    >>> cracks = SurfaceCracks(plate, starts, tangents(plate, starts))
    >>> float(cracks.incremental(np.array([[1.0]]))[0, 0].round(3))
    0.198
    """

    def __init__(
        self, model: BoundaryModel, starts: Starts, tangents: Sequence[Tangent], places: int = PLACES
    ) -> None:
        """Solve for what the part adds; lengths when they are asked for."""
        self._model, self._starts, self._tangents, self._places = model, starts, tangents, places
        bend = np.maximum(np.abs(starts.curvature), 1 / starts.longest)
        self._stresses = AlongPaths(starts.longest, 1 / bend, STRESSES, with_ends=True)
        self._paths = AlongPaths(starts.longest, 1 / bend, LENGTHS)
        self.lengths = self._paths.places

    @cached_property
    def _stress(self) -> Array:
        """Stress xx, yy, xy (k, n, 3) at the places where it is asked for, MPa."""
        mouth, direction = self._starts.mouth, self._starts.direction
        z = mouth[:, None] + direction[:, None] * self._stresses.places
        found = self._model.stress(np.column_stack([z.real.ravel(), z.imag.ravel()]))
        return found.reshape(*z.shape, 3)

    def stress(self, a: Array) -> Array:
        """Stress xx, yy, xy (k, m, 3) of the part without cracks at distances a (k, m) from the mouths, MPa."""
        return self._stresses.at(a) @ self._stress

    @cached_property
    def _solved(self) -> tuple[Array, Array]:
        """G_inc/a (k, n), N/mm^2, and K (k, n, 2), MPa sqrt(mm)."""
        unit, starts = unit_crack(), self._starts
        k, n = self.lengths.shape
        m = len(unit.x)
        a = self.lengths[:, :, None] * unit.x
        stress = self.stress(a.reshape(k, -1)).reshape(k, n, m, 3)
        e = starts.direction[:, None, None]
        # on the left of the crack, along it and across
        normal = 1j * e
        traction = (stress[..., 0] * normal.real + stress[..., 2] * normal.imag) + 1j * (
            stress[..., 2] * normal.real + stress[..., 1] * normal.imag
        )
        traction *= e.conj()
        acts = np.stack([traction.real, traction.imag], axis=-1).reshape(k, n, 2 * m)
        matrix = unit.own / self.lengths[:, :, None, None]
        matrix += self._reflected()
        matrix += self._added(a)
        jump = np.linalg.solve(matrix, -acts[..., None])[..., 0]
        weight = np.repeat(unit.weight, 2)
        per_length = 0.5 * self._model.body.scale * (acts * jump) @ weight / self.lengths
        across_and_along = jump.reshape(k, n, m, 2)[..., ::-1]
        K = np.einsum("m,knmc->knc", unit.at_tip, across_and_along) / np.sqrt(self.lengths[..., None])
        return per_length, K

    def _reflected(self) -> Array:
        """Tractions (k, n, 2 m, 2 m) by what the surfaces reflect."""
        unit, starts = unit_crack(), self._starts
        known: dict[tuple[object, ...], Array] = {}
        found = []
        for i, tangent in enumerate(self._tangents):
            # cracks alike but for a turn are so in what is reflected
            e = complex(starts.direction[i])
            alike = (
                tangent.side,
                bool(tangent.mouth),
                round(float(starts.curvature[i] * starts.longest[i]), 9),
                np.round(complex(starts.inwards[i]) / e, 9),
                round(float(starts.longest[i]), 9),
            )
            if alike not in known:
                known[alike] = np.array(
                    [unit.reflected(tangent, starts.mouth[i], e, a) for a in self.lengths[i].tolist()]
                )
            found.append(known[alike])
        return np.array(found)

    def _added(self, a: Array) -> Array:
        """Tractions (k, n, 2 m, 2 m) by what the part adds, at the places a (k, n, m) of the cracks' jumps."""
        unit = unit_crack()
        k, n, m = a.shape
        q = self._places
        S = corrections(self._model, self._starts, self._tangents, q).reshape(k, q, 2, q, 2)
        share = 2 * a / self._starts.longest[:, None, None] - 1
        at = values_at(share.ravel(), q).reshape(k, n, m, q)
        S = S.transpose(0, 2, 4, 1, 3)[:, None]
        left = at[:, :, None, None] @ S
        weighted = at * (unit.weight * self.lengths[:, :, None])[..., None]
        both = left @ weighted[:, :, None, None].swapaxes(-1, -2)
        return np.asarray(both.transpose(0, 1, 4, 2, 5, 3).reshape(k, n, 2 * m, 2 * m))

    @property
    def K(self) -> Array:
        """K_I and K_II (k, n, 2) at the tips of the lengths, MPa sqrt(mm); negative K_I means that faces overlap."""
        return self._solved[1]

    def incremental(self, a: Array) -> Array:
        """G_inc (k, m), N/mm, of cracks of lengths a (k, m), mm."""
        return np.asarray((self._paths.at(a) @ self._solved[0][..., None])[..., 0] * a)

    @property
    def tail(self) -> Array:
        """What interpolation between lengths may leave out of G_inc, as a share (k,) of its largest over a."""
        per_length = self._solved[0]
        return self._paths.tail(per_length) / np.abs(per_length).max(axis=1)
