"""The body-fitted local model: stress and displacement of the uncracked plate, with an error from two meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fem.supports import at_supports, at_unsmooth_stress
from slmm.initiation.raster import rasterised
from slmm.initiation.uncracked import Raster
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.stress import principal_stress

#: largest turn of an outline along one element edge of the coarser mesh, rad; chosen
ANGLE_MAX = 0.12
#: voxels along the side of a quadratic element that resolve displacements as well; chosen
VOXELS_PER_ELEMENT = 4


@dataclass(frozen=True)
class BodyFitted:
    """A part on two body-fitted meshes, the finer one a uniform refinement of the coarser.

    It is an `uncracked.UncrackedField` that has its stress, too.

    Attributes
    ----------
    coarse, fine : PlateModel
    raster : Raster
        Where the material is.
    """

    coarse: PlateModel
    fine: PlateModel
    raster: Raster

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm."""
        return self.fine.displacement(points)

    def element_size(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the elements at points (k, 2), mm."""
        return self.fine.element_size(points)

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"local_model": "body-fitted", "nodes": len(self.fine.points)}

    @property
    def coarser(self) -> CoarseField:
        """The coarser mesh's displacements."""
        return CoarseField(self.coarse, self.raster)

    def resolution(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the voxels that would resolve the displacements at points (k, 2) as well, mm."""
        return self.fine.element_size(points) / VOXELS_PER_ELEMENT

    def stress(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Extrapolated stress xx, yy, xy (k, 3) at points (k, 2), and its estimated error (k,), MPa.

        NaN outside the material.
        """
        # patch recovery from quadratic displacements: the error is cubic in the element size, less so at surfaces and
        # where stresses are singular, so that what is told is the change that a quadratic one would ask for
        coarse, fine = self.coarse.stress(points), self.fine.stress(points)
        sigma, _ = extrapolated(coarse, fine, order=3)
        _, change = extrapolated(coarse, fine, order=2)
        return sigma, np.abs(change).max(axis=1)


@dataclass(frozen=True)
class CoarseField:
    """Displacements of a plate on one body-fitted mesh."""

    model: PlateModel
    raster: Raster
    coarser: None = None

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"local_model": "body-fitted, one mesh", "nodes": len(self.model.points)}

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm."""
        return self.model.displacement(points)

    def resolution(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the voxels that would resolve the displacements at points (k, 2) as well, mm."""
        return self.model.element_size(points) / VOXELS_PER_ELEMENT


def solve_body_fitted(
    scene: Any,
    angle_max: float = ANGLE_MAX,
    fine_at: tuple[np.ndarray, np.ndarray] | None = None,
) -> BodyFitted:
    """Solve a scene on a body-fitted mesh and its uniform refinement.

    Parameters
    ----------
    scene : Scene
        With ``plate``, ``part``, ``outlines``, ``material`` and ``loading``.
    angle_max : float, optional
        Largest turn of an outline along one element of the coarser mesh, rad.
    fine_at : (ndarray (k, 2), ndarray (k,)), optional
        Points of the boundary and of cracks where the coarser mesh's edges must not be longer than given, mm.

    Raises
    ------
    ImportError
        Without the extra ``fea``.
    """
    policy = SizePolicy(turn=angle_max)
    fine = [find(scene.part, scene.loading, policy) for find in (at_supports, at_unsmooth_stress)]
    if fine_at is not None:
        fine.append(fine_at)
    points, sizes = (np.concatenate(each) for each in zip(*fine, strict=True))
    mesh = plate_mesh(scene.part, None, policy, (points, sizes), scene.loading.ends)
    coarse, finer = (
        PlateModel(each, scene.material, scene.loading, scene.part.thickness)
        for each in (mesh, mesh.refined())
    )
    return BodyFitted(coarse, finer, rasterised(scene))


@dataclass(frozen=True)
class NotchStress:
    """Stress along one outline of the uncracked plate.

    Attributes
    ----------
    s : ndarray (n,)
        Arc lengths, mm.
    points : ndarray (n, 2)
        Coordinates, mm.
    sigma_I : ndarray (n,)
        Maximum principal stress, MPa; NaN outside the material.
    sigma_I_error : ndarray (n,)
        Estimate of its error, MPa.
    """

    s: np.ndarray
    points: np.ndarray
    sigma_I: np.ndarray
    sigma_I_error: np.ndarray


def notch_stress(model: BodyFitted, outlines: Any, n: int = 360) -> list[NotchStress]:
    """Maximum principal stress along every outline of the uncracked plate.

    Parameters
    ----------
    model : BodyFitted
    outlines : sequence of Outline
    n : int
        Points on each outline, evenly spaced in arc length from s = 0.
    """
    result = []
    for outline in outlines:
        s = np.linspace(0.0, outline.length, n, endpoint=False)
        points = outline.points(s)
        sigma, error = model.stress(points)
        result.append(NotchStress(s, points, principal_stress(sigma), error))
    return result
