"""The uncracked part by boundary integrals: displacement and stress at any point without a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from slmm.boundary.body import Body
from slmm.boundary.model import BoundaryModel
from slmm.boundary.panelling import Panelling
from slmm.boundary.stretches import FINE, boundary_of
from slmm.initiation.raster import rasterised
from slmm.initiation.uncracked import Raster
from slmm.scene.loading import Loading

#: Gauss points on a panel, and on those of the model that the error is told from (chosen)
ORDER, LOWER_ORDER = 10, 8
#: what the lower order changes may be less than the error of the higher one by this factor, where both converge slowly
#: (chosen on validation/boundary_errors.py)
COVERED = 2.0
#: voxels along a panel that resolve displacements as well: the field is smooth between its points
VOXELS_PER_PANEL = 40


@dataclass(frozen=True)
class BoundaryField:
    """A part by boundary integrals of two orders: an `uncracked.UncrackedField` that has its stress, too.

    Attributes
    ----------
    scene : Scene
        With ``plate``, ``part``, ``outlines``, ``material`` and ``loading``.
    model, lower : BoundaryModel
    """

    scene: Any
    model: BoundaryModel
    lower: BoundaryModel

    @cached_property
    def raster(self) -> Raster:
        """Where the material is."""
        return rasterised(self.scene)

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"local_model": "boundary", "boundary_points": self.model.panels.n}

    @property
    def coarser(self) -> LowerOrder:
        """The field of the lower order."""
        return LowerOrder(self.lower, self.raster)

    def finer_about(self, ahead: np.ndarray) -> BoundaryField:
        """The same with panels that are as short as crack tips at points ``ahead`` (k,) would ask for, mm.

        Raises
        ------
        ValueError
            When these are too many.
        """

        def finer(model: BoundaryModel) -> BoundaryModel:
            old = model.body
            body = Body(old.part, old.material, old.loading, old.p, old.grading, ahead.tolist())
            return BoundaryModel(old.part, old.material, old.loading, old.p, model.crack_p, body)

        return BoundaryField(self.scene, finer(self.model), finer(self.lower))

    def under(self, loading: Loading) -> BoundaryField:
        """The same part under other loads; where they act on the same stretches, what is factorised stays."""

        def loaded(model: BoundaryModel) -> BoundaryModel:
            body = model.body.under(loading)
            return BoundaryModel(model.part, body.material, loading, body.p, model.crack_p, body)

        return BoundaryField(self.scene, loaded(self.model), loaded(self.lower))

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm."""
        return self.model.displacement(points)

    def resolution(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the voxels that would resolve the displacements at points (k, 2) as well, mm."""
        return self.model.panel_length(points) / VOXELS_PER_PANEL

    def element_size(self, points: np.ndarray) -> np.ndarray:
        """Length (k,) of the panels next to points (k, 2), mm."""
        return self.model.panel_length(points)

    def stress(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Stress xx, yy, xy (k, 3) at points (k, 2), and an estimate of its error (k,), MPa."""
        stress, lower = self.model.stress(points), self.lower.stress(points)
        return stress, COVERED * np.abs(stress - lower).max(axis=1)


@dataclass(frozen=True)
class LowerOrder:
    """Displacements of a part by boundary integrals of one order."""

    model: BoundaryModel
    raster: Raster
    coarser: None = None

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"local_model": "boundary, one order", "boundary_points": self.model.panels.n}

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm."""
        return self.model.displacement(points)

    def resolution(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the voxels that would resolve the displacements at points (k, 2) as well, mm."""
        return self.model.panel_length(points) / VOXELS_PER_PANEL


def boundary_points(scene: Any) -> int:
    """How many points on its boundary a scene needs."""
    part = scene.part
    side = float(np.ptp(part.outer, axis=0).min())
    return Panelling(boundary_of(part, scene.loading), side, part.tolerance, FINE).first(ORDER).n


def solve_boundary(scene: Any) -> BoundaryField:
    """Solve a scene by boundary integrals.

    Parameters
    ----------
    scene : Scene
        With ``plate``, ``part``, ``outlines``, ``material`` and ``loading``.

    Raises
    ------
    ValueError
        When cracks sever the part, or its outlines need more points than a dense matrix holds.
    """
    model, lower = (BoundaryModel(scene.part, scene.material, scene.loading, p) for p in (ORDER, LOWER_ORDER))
    return BoundaryField(scene, model, lower)
