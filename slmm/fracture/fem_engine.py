"""Finite elements as the engine of a simulation: a mesh of its own for every increment, as in Paper D (section 2.1).

It shares with the engine of boundary integrals what happens and in which order, not how the part is solved: each is a
reference of the other. K_I and K_II are from the interaction integral over all that is clear around a tip.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.contour import Places
from slmm.criteria.distances import point_distance
from slmm.fem.plate_model import PlateModel
from slmm.fracture.engine import Rules, competing_events, growth_load, unloaded
from slmm.fracture.events import Event, Kind, starts
from slmm.fracture.exclusion import Exclusion
from slmm.fracture.fem_mesh import crack_mesh
from slmm.fracture.fem_surface import Ring, rings
from slmm.fracture.fem_tips import tip_stress_intensities, tip_t_stresses
from slmm.fracture.surface_peaks import Sampled, Site, at_corners, at_peaks
from slmm.mechanics.material import Material
from slmm.mechanics.stress import principal_stress
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: sizes of elements, over those of the coarsest mesh, by the error of U_T that they reach; chosen on
#: validation/fracture_engines.py
FINENESS = ((5e-3, 1.0), (1e-3, 0.5), (0.0, 0.25))
#: K_I is none below this share of the largest stress along surfaces times sqrt(pi a); discretisation
NO_OPENING = 1e-3
#: less than this share of the largest stress along surfaces is no tension; discretisation
NO_TENSION = 1e-3
#: the stress below surfaces may be higher by this factor than a mesh says that is not made for it; and how much smaller
#: elements are, beside where cracks may start, on one that is: its stress is within 3e-4; both chosen
ROUGH, AT_SITES = 1.05, 0.15


class FemState:
    """A part with its cracks under the scene's own load; faces that would overlap hold each other, without friction.

    Parameters
    ----------
    part : Part
    material : Material
    loading : Loading
    fineness : float
        Sizes of elements, over those of the coarsest mesh.
    curves : sequence of Ring
        The closed curves around the part.
    fine_at : (ndarray (k, 2), ndarray (k,)), optional
        Places and how large elements may be there, mm.
    """

    def __init__(
        self,
        part: Part,
        material: Material,
        loading: Loading,
        fineness: float,
        curves: Sequence[Ring],
        fine_at: tuple[Array, Array] | None = None,
    ) -> None:
        """Mesh and solve."""
        self.part, self.material, self.loading = part, material, loading
        self.fineness, self.curves = fineness, curves
        self.depth = point_distance(material)
        self.mesh = crack_mesh(part, loading, self.depth, fineness, fine_at)
        self.model = PlateModel(self.mesh, material, loading, part.thickness, contact=True)
        self._at_sites: FemState | None = None

    @property
    def work(self) -> float:
        """Twice the stored energy, N mm for each mm of thickness."""
        return _work(self.model)

    @property
    def closed(self) -> float:
        """Length of cracks whose faces hold each other, mm."""
        return float(self.model.pairs.length[self.model.touching].sum())

    @cached_property
    def K(self) -> Array:
        """K_I and K_II (k, 2) of the part's tips, MPa sqrt(mm)."""
        return tip_stress_intensities(self.model, self.part)

    def events(self, rules: Rules) -> list[Event]:
        """What may happen next, where it competes with the lowest load; cracks start by the point method."""
        largest = max(float(np.abs(each.below).max()) for each in self._sampled)

        def first_cracks(load: float) -> list[Event]:
            least = max(self.material.sigma_c / load, NO_TENSION * largest)
            places = self._sites(least / ROUGH)
            if not places:
                return []
            self._at_sites = self._fine_at(places)
            return starts(self._at_sites._sites(least), self.material)

        closed = unloaded(self.part, largest, NO_OPENING)
        asks = rules.direction.asks_for_T
        T = tip_t_stresses(self.model, self.part) if asks else np.full(len(self.part.tips), np.nan)
        return competing_events(self.part, self.K, T, closed, first_cracks, self.material, rules.direction)

    def finer(self, event: Event) -> tuple[float, float]:
        """Work and the load of an event on a mesh with elements half as large, for estimates of errors."""
        coarser = self._at_sites if event.kind is Kind.START and self._at_sites else self
        model = PlateModel(
            coarser.mesh.refined(), self.material, self.loading, self.part.thickness, contact=True
        )
        if event.kind is Kind.GROWTH:
            K = tip_stress_intensities(model, self.part)[event.tip]
            return _work(model), growth_load(K, self.material)
        stress = model.stress((event.point + self.depth * event.direction)[None])
        return _work(model), self.material.sigma_c / float(principal_stress(stress)[0])

    @cached_property
    def _exclusion(self) -> Exclusion:
        return Exclusion.of(self.part, self.loading, self.depth)

    @cached_property
    def _sampled(self) -> list[Sampled]:
        """The closed curves around the part with the stress below the mesh's nodes on them."""
        found = []
        for curve in self.curves:
            way = curve.nodes(self.mesh)
            where = curve.at(way)
            free = self._exclusion.free(where.points)
            found.append(Sampled(curve, way, free, self._stress_below(where)))
        return found

    def _sites(self, least: float) -> list[Site]:
        """Where cracks may start, the highest stress first, MPa, none below the least."""
        free = [each._replace(below=np.where(each.allowed, each.below, -np.inf)) for each in self._sampled]
        found = at_corners(self.part, self.loading, self._stress_below, self.depth)
        found += at_peaks(free, self._stress_below, least, self._exclusion)
        return sorted((site for site in found if site.stress >= least), key=lambda site: -site.stress)

    def _stress_below(self, where: Places) -> Array:
        """Principal stress (k,) at the point method's depth below places, MPa; none beyond the material."""
        stress = self.model.stress(where.points + self.depth * where.inward)
        return np.asarray(principal_stress(np.nan_to_num(stress)))

    def _fine_at(self, sites: Sequence[Site]) -> FemState:
        """The same with smaller elements where cracks may start."""
        points, inward = (np.array(values) for values in zip(*(site[:2] for site in sites), strict=True))
        along = self.model.element_size(points)[:, None] * inward[:, ::-1] * [-1, 1]
        places = np.concatenate([points, points + along, points - along, points + self.depth * inward])
        fine = places, AT_SITES * self.model.element_size(places)
        return FemState(self.part, self.material, self.loading, self.fineness, self.curves, fine)


def _work(model: PlateModel) -> float:
    return float(model.u.ravel() @ model.internal_forces.ravel())


class FemEngine:
    """Solves one part after the other on meshes of their own.

    Parameters
    ----------
    material : Material
    loading : Loading
    tolerance : float
        Relative error of U_T that is aimed at.
    """

    keeps = False

    def __init__(self, material: Material, loading: Loading, tolerance: float) -> None:
        """Nothing is solved yet."""
        self.material, self.loading = material, loading
        self.fineness = next(fineness for error, fineness in FINENESS if tolerance >= error)
        self._curves: list[Ring] = []
        self._holes: tuple[Outline, ...] = ()

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"engine": "fem", "fineness": self.fineness, "contact": "without friction"}

    def solve(self, part: Part) -> FemState:
        """The part with its cracks.

        Raises
        ------
        ImportError
            Without netgen, the extra ``fea``.
        MesherError
            When the mesher fails with other sizes, too.
        """
        if not self._curves or part.holes is not self._holes:
            self._curves, self._holes = rings(part), part.holes
        return FemState(part, self.material, self.loading, self.fineness, self._curves)
