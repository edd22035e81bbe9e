"""Which cracks may start, and at which load, on a part that is solved by boundary integrals.

All look where the point method finds peaks of the stress, for it is cheap. The coupled criterion then asks trial cracks
there, or a crack cell of the database whose displacements are the simulation's own, where one fits. Where the stress at
the surface alone keeps a site above what else happens, nothing dearer is asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.boundary.model import BoundaryModel
from slmm.boundary.trial_cracks import TrialCracks
from slmm.criteria.coupled import coupled_criterion
from slmm.criteria.status import Status
from slmm.fracture.events import Event, Kind, starts
from slmm.fracture.growth import Surroundings
from slmm.fracture.initiation_sites import critical_sites
from slmm.fracture.surface_peaks import Site
from slmm.initiation.contact import closes_at, held
from slmm.mechanics.stress import principal_stress
from slmm.mechanics.williams import singular_exponent
from slmm.scene.scene import Scene

Array = NDArray[np.float64]
Initiation = Callable[[BoundaryModel, float], list[Event]]

#: sites are asked whose stress at the point method's depth is so many times what that would need: by the coupled
#: criterion they may crack at a load that much lower; chosen
LESS_STRESS = 0.7
#: trial cracks over Irwin's length, and how much longer a second set of them is; chosen
IN_IRWIN_LENGTHS, LONGER = 1.5, 4.0
#: no trial crack reaches farther to the next surface or crack; chosen
IN_LIGAMENT = 0.8
#: trial cracks in a ligament are no shorter than so many of the part's tolerances; the shortest of a set is 1/247 of
#: the longest, and below a tolerance it is none; round-off
SHORTEST_IN_LIGAMENT = 250.0
#: lengths, over the longest, at which both criteria are compared; the stress falls near the surface; chosen
COMPARED = (np.arange(60) + 1.0) ** 2 / 60.0**2
#: a cell knows nothing of cracks that are nearer than so many of its heights; chosen
BESIDE_CRACK = 1.5


def point_method(model: BoundaryModel, load: float) -> list[Event]:
    """Where the stress at the critical distance reaches the strength (Paper D, section 2.2.2)."""
    material = model.body.material
    return starts(critical_sites(model, material.sigma_c / load), material)


class CoupledCriterion:
    """Stress and energy of trial cracks, straight into the material.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene: Scene) -> None:
        """Nothing is asked yet."""
        self.surroundings = Surroundings(scene.part)

    def __call__(self, model: BoundaryModel, load: float) -> list[Event]:
        """Cracks that may start below a load."""
        return self.at(model, critical_sites(model, LESS_STRESS * model.body.material.sigma_c / load), load)

    def at(self, model: BoundaryModel, sites: list[Site], load: float) -> list[Event]:
        """Cracks that start at some of the sites, and what would start at excluded ones by the point method."""
        found = starts([site for site in sites if site.excluded], model.body.material)
        for site in sites:
            event = None if site.excluded else self._start(model, site, load)
            if event is not None:
                found.append(event)
                load = load if event.excluded else min(load, event.load)
        return found

    def _start(self, model: BoundaryModel, site: Site, load: float) -> Event | None:
        """The crack that starts at a site, if its load may be below another.

        In a thin ligament a longer crack always needs less: what the longest one needs is an upper bound of the load.
        A crack that closes sets no more free from there on.
        """
        material = model.body.material
        if self.surroundings.part.holes is not model.part.holes:  # a piece came loose
            self.surroundings = Surroundings(model.part)
        way = self.surroundings.way(site.point, site.inward, [crack.points for crack in model.part.cracks])
        longest = min(IN_IRWIN_LENGTHS * material.irwin_length, IN_LIGAMENT * way)
        shortest = SHORTEST_IN_LIGAMENT * model.part.tolerance
        if longest == IN_LIGAMENT * way and longest < shortest:
            least = shortest / IN_LIGAMENT
            excluded = f"in a ligament of {way:.3g} mm, too thin for trial cracks: at least {least:.3g} mm"
            return replace(starts([site], material)[0], excluded=excluded)
        while True:
            a = longest * COMPARED
            points = site.point + a[:, None] * site.inward
            stress = np.asarray(principal_stress(model.stress(points)))
            if material.sigma_c > load * stress.max():
                return None
            trial = TrialCracks(model, site.point, site.inward, longest, _exponent(model, site))
            closed = closes_at(trial.lengths[None], trial.K[None])
            G_inc = held(a[None], trial.incremental(a)[None], closed)[0]
            if not G_inc.any():
                return None
            critical = coupled_criterion(a, G_inc, stress, material)
            if not np.isnan(critical.load_factor):
                break
            if longest >= IN_LIGAMENT * way:
                return _event(site, float(np.sqrt(material.G_c / G_inc[-1])), longest, "coupled, at most")
            longest = min(LONGER * longest, IN_LIGAMENT * way)
        if not np.isfinite(critical.load_factor):
            return None
        return _event(site, critical.load_factor, critical.crack_length, "coupled")


def _event(site: Site, load: float, length: float, criterion: str) -> Event:
    return Event(
        load, Kind.START, site.point, site.inward, hole=site.hole, length=length, criterion=criterion
    )


def _exponent(model: BoundaryModel, site: Site) -> float:
    """By which power of its length G of a short crack grows there."""
    if site.hole < 0:
        return 1.0
    outline = model.part.outlines[site.hole]
    corner = int(outline.corner_at(outline.project(site.point[None]))[0])
    return 1.0 if corner < 0 else 2 * singular_exponent(float(outline.corner_angles[corner])) - 1


class CellCriterion:
    """The coupled criterion by crack cells (slmm+ac); trial cracks where none fits.

    Parameters
    ----------
    scene : Scene
        A plate under [load], of which cells know how its edges are held.

    Raises
    ------
    ValueError
        For other parts.
    """

    def __init__(self, scene: Scene) -> None:
        """Nothing is asked yet."""
        if scene.plate is None or scene.load is None:
            raise ValueError(
                "initiation = 'slmm+ac': crack cells know plates under [load] alone; take 'coupled' or 'point'"
            )
        from slmm.initiation.raster import rasterised  # cells alone need it

        self.scene, self.raster = scene.with_(cracks=[]), rasterised(scene)
        self.holes, self.coupled = scene.part.holes, CoupledCriterion(scene)

    def __call__(self, model: BoundaryModel, load: float) -> list[Event]:
        """Cracks that may start below a load."""
        if model.part.holes is not self.holes:  # a piece came loose: the scene's holes are others
            return self.coupled(model, load)
        sites = critical_sites(model, LESS_STRESS * model.body.material.sigma_c / load)
        on_holes = [site for site in sites if site.hole >= 0 and not site.excluded]
        by_cell = self._by_cells(model, on_holes) if on_holes else {}
        found = [_event(on_holes[k], *critical, "slmm+ac") for k, critical in by_cell.items()]
        others = [site for site in sites if site.hole < 0 or not any(site is on_holes[k] for k in by_cell)]
        return found + self.coupled.at(model, others, min([load, *(event.load for event in found)]))

    def _by_cells(self, model: BoundaryModel, sites: list[Site]) -> dict[int, tuple[float, float]]:
        """Load and crack length by the number of a site, where a cell answers."""
        from slmm.criteria.coupled_curves import Coupled
        from slmm.initiation.boundary_field import LowerOrder
        from slmm.initiation.by_cells import cells_on
        from slmm.initiation.paths import trial_paths
        from slmm.initiation.positions import positions_on
        from slmm.initiation.settings import DEFAULT
        from slmm.initiation.task import Answer, Task
        from slmm.running.cell_file import shipped_database
        from slmm.running.progress import silent

        scene, outlines = self.scene, self.scene.outlines
        hole = np.array([site.hole for site in sites])
        s = np.array([outlines[k].project(site.point[None])[0] for k, site in zip(hole, sites, strict=True)])
        where = positions_on(scene, hole, s, np.full(len(s), -1))
        field = LowerOrder(model, self.raster)
        paths = trial_paths(scene, where)
        task = Task(scene, where, paths, Coupled(), 0.01, DEFAULT, shipped_database(), field, silent)
        answer = Answer.empty(len(s), "slmm+ac")
        rows = np.flatnonzero(task.smooth)
        cells_on(field, task, True, answer, rows)
        heights = answer.column("cell_height")
        found = {}
        for k in np.flatnonzero(answer.status == Status.OK).tolist():
            place = shapely.Point(sites[k].point)
            lines = [shapely.LineString(crack.points) for crack in model.part.cracks]
            near = BESIDE_CRACK * heights[k]
            if not any(shapely.dwithin(line, place, near) for line in lines):
                found[k] = float(answer.load_factor[k]), float(answer.crack_length[k])
        return found


#: by their names; each is made for a scene
INITIATIONS: dict[str, Callable[[Scene], Initiation]] = {
    "point": lambda scene: point_method,
    "coupled": CoupledCriterion,
    "slmm+ac": CellCriterion,
}
