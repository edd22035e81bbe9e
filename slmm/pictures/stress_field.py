"""The maximum principal stress over a plate, as pictures show it: from voxels, or around cracks body-fitted."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.initiation.local_model import solve_local_model
from slmm.mechanics.material import Material
from slmm.mechanics.stress import plane_stiffness_constants, principal
from slmm.scene.scene import Scene

Array = NDArray[np.float64]
View = tuple[float, float, float, float]

#: voxels, or points, across a picture, and limits of the number of voxels of the plate
ACROSS = 200
FEWEST_VOXELS, MOST_VOXELS = 10_000, 1_000_000


class StressField(NamedTuple):
    """Maximum principal stress on a grid.

    Attributes
    ----------
    sigma_I : ndarray (ny, nx)
        MPa; row 0 is the lowest one; NaN where there is no material, if that is known.
    extent : (x0, x1, y0, y1)
        Of the grid, mm.
    cracked : bool
        Whether the scene's cracks are in it.
    """

    sigma_I: Array
    extent: View
    cracked: bool


def stress_in_view(scene: Scene, view: View, displacements: Any = None) -> StressField:
    """The stress in a part of the plate, or in the whole plate, finely enough for the part.

    Voxels do not see cracks. A scene with cracks is solved body-fitted where the extra ``fea`` is installed, and else
    without its cracks.

    Parameters
    ----------
    scene : Scene
    view : (x0, x1, y0, y1)
        The part, mm.
    displacements : path, DisplacementField or (points, cells, u), optional
        The user's own, in place of the scene's load.
    """
    if displacements is not None:
        return _of_displacements(scene, view, displacements)
    if scene.load is None:
        return _by_boundary_integrals(scene, view)
    if scene.cracks:
        try:
            return _around_cracks(scene, view)
        except ImportError:
            pass  # the caller is told by ``cracked``
    x0, x1, y0, y1 = view
    width, height = (scene.box[1] - scene.box[0]).tolist()
    fineness = ACROSS / max(x1 - x0, y1 - y0)
    voxels = int(np.clip(width * height * fineness**2, FEWEST_VOXELS, MOST_VOXELS))
    return StressField(principal_stress_field(scene, voxels), (0.0, width, 0.0, height), not scene.cracks)


def _around_cracks(scene: Scene, view: View) -> StressField:
    from slmm.fem.mesh import plate_mesh  # these import the finite element libraries
    from slmm.fem.plate_model import PlateModel
    from slmm.mechanics.stress import principal_stress

    mesh = plate_mesh(scene.part, nodes_at=scene.loading.ends)
    model = PlateModel(mesh, scene.material, scene.loading)
    extent, (nx, ny) = _grid(scene, view)
    x, y = (
        start + (np.arange(n) + 0.5) * (end - start) / n
        for start, end, n in ((*extent[:2], nx), (*extent[2:], ny))
    )
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return StressField(principal_stress(model.stress(points)).reshape(ny, nx), extent, True)


def _by_boundary_integrals(scene: Scene, view: View) -> StressField:
    """Under `[[boundary]]`: fine wherever the view is."""
    from slmm.boundary.model import BoundaryModel  # imports the kernels
    from slmm.mechanics.stress import principal_stress

    model = BoundaryModel(scene.part, scene.material, scene.loading)
    extent, (nx, ny) = _grid(scene, view)
    x, y = (
        start + (np.arange(n) + 0.5) * (end - start) / n
        for start, end, n in ((*extent[:2], nx), (*extent[2:], ny))
    )
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    sigma_I = np.full(len(points), np.nan)
    inside = shapely.contains_xy(scene.part.body, points)
    sigma_I[inside] = principal_stress(model.stress(points[inside]))
    return StressField(sigma_I.reshape(ny, nx), extent, True)


def _of_displacements(scene: Scene, view: View, displacements: Any) -> StressField:
    from slmm.initiation.given_field import displacement_field  # imports the readers of result files

    field, _ = displacement_field(displacements)
    extent, (nx, ny) = _grid(scene, view)
    x, y = np.linspace(*extent[:2], nx + 1), np.linspace(*extent[2:], ny + 1)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    u = field.displacement(points.reshape(-1, 2)).reshape(points.shape)
    sigma_I = _principal_stress(u, x[1] - x[0], y[1] - y[0], scene.material)
    # in the notches the field is a continuation; at their rim it is wanted, so that no gap is left
    near = scene.part.body.buffer(2 * (x[1] - x[0]))
    sigma_I[~shapely.contains_xy(near, *np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2))] = np.nan
    return StressField(sigma_I, extent, True)


def _grid(scene: Scene, view: View) -> tuple[View, tuple[int, int]]:
    """What of the view lies in the part's box, and the number of square cells across it."""
    (left, bottom), (right, top) = scene.box.tolist()
    x0, x1 = max(view[0], left), min(view[1], right)
    y0, y1 = max(view[2], bottom), min(view[3], top)
    step = max(x1 - x0, y1 - y0) / ACROSS
    return (x0, x1, y0, y1), (max(round((x1 - x0) / step), 1), max(round((y1 - y0) / step), 1))


def principal_stress_field(scene: Scene, voxels: int) -> Array:
    """Maximum principal stress (ny, nx) in the middle of each voxel, MPa; row 0 lies at y = 0. Without cracks."""
    model = solve_local_model(scene, voxels, tol=1e-4)
    return _principal_stress(model.u, model.hx, model.hy, scene.material)


def _principal_stress(u: Array, hx: float, hy: float, material: Material) -> Array:
    """In the middle of rectangles with sides hx, hy and displacements u (ny + 1, nx + 1, 2) at their corners."""
    lower, upper = u[:-1], u[1:]
    along_x = (lower[:, 1:] + upper[:, 1:] - lower[:, :-1] - upper[:, :-1]) / (2 * hx)
    along_y = (upper[:, 1:] + upper[:, :-1] - lower[:, 1:] - lower[:, :-1]) / (2 * hy)
    E, nu = material.plane_stress_equivalent
    direct, coupling, shear = (E * factor for factor in plane_stiffness_constants(nu))
    s_xx = direct * along_x[..., 0] + coupling * along_y[..., 1]
    s_yy = coupling * along_x[..., 0] + direct * along_y[..., 1]
    s_xy = shear * (along_x[..., 1] + along_y[..., 0])
    return principal(s_xx, s_yy, s_xy)
