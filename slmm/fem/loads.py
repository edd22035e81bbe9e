"""A scene's load as nodal forces and prescribed displacements of a body-fitted model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from skfem import MeshTri2

from slmm.scene.load_checks import UNBALANCED


@dataclass(frozen=True)
class NodalLoad:
    """Forces, and which displacements are prescribed, for n nodes.

    Parameters
    ----------
    force : ndarray, shape (n, 2)
        Nodal forces for a thickness of 1 mm, N.
    prescribed : ndarray of bool, shape (n, 2)
    value : ndarray, shape (n, 2)
        Prescribed displacements, mm; 0 elsewhere.
    supports : ndarray of bool, shape (n, 2)
        Prescribed displacements that only fix the rigid motion: they carry no reaction.
    """

    force: np.ndarray
    prescribed: np.ndarray
    value: np.ndarray
    supports: np.ndarray


#: makes the load of a model from its mesh, its nodes (n, 2) and a scene
Loading = Callable[[MeshTri2, np.ndarray, Any], NodalLoad]


def plate_load(mesh: MeshTri2, points: np.ndarray, scene: Any) -> NodalLoad:
    """Load of a scene's plate.

    Parameters
    ----------
    mesh : skfem.MeshTri2
        Vertices first, then the middles of the facets.
    points : ndarray, shape (n, 2)
        Its nodes, mm.
    scene : Scene
        ``plate`` and ``load`` are used.

    Raises
    ------
    ValueError
        When a uniform stress on top and bottom does not balance.
    """
    plate, load = scene.plate, scene.load
    x, y = points.T
    near = 1e-9 * max(plate.width, plate.height)
    bottom, top = np.abs(y) < near, np.abs(y - plate.height) < near
    force, value = np.zeros_like(points), np.zeros_like(points)
    prescribed, supports = np.zeros(points.shape, dtype=bool), np.zeros(points.shape, dtype=bool)
    if load.strain is not None:
        e_xx, e_yy, g_xy = load.strain
        edge = bottom | top | (np.abs(x) < near) | (np.abs(x - plate.width) < near)
        prescribed[edge] = True
        value[edge] = np.column_stack([e_xx * x + g_xy * y / 2, g_xy * x / 2 + e_yy * y])[edge]
    elif load.displacement is not None:
        prescribed[bottom | top, 1] = True
        value[top, 1] = load.displacement
        supports[np.flatnonzero(bottom)[np.argmin(x[bottom])], 0] = True
    else:
        for edge, stress in ((bottom, -load.stress), (top, load.stress)):
            force[:, 1] += edge_traction(mesh, points, edge, stress)
        moment = np.array([force[:, 1].sum(), (x - plate.width / 2) @ force[:, 1] / plate.width])
        # a scene lets through what its supports carry without a trace
        if np.any(np.abs(moment) > 2 * UNBALANCED * np.abs(force).sum()):
            raise ValueError(
                f"load.stress = {load.stress!r}: notches leave different parts of the top and bottom edge, "
                "so the forces do not balance; use load.displacement or load.strain"
            )
        rows = np.flatnonzero(bottom)
        first, last = rows[np.argmin(x[rows])], rows[np.argmax(x[rows])]
        supports[first] = True
        supports[last, 1] = True
    return NodalLoad(force, prescribed | supports, value, supports)


def edge_traction(mesh: MeshTri2, points: np.ndarray, on_edge: np.ndarray, traction: float) -> np.ndarray:
    """Consistent nodal forces (n,) of a uniform traction (MPa) on the boundary facets between marked nodes."""
    facets = mesh.boundary_facets()
    facets = facets[np.all(on_edge[mesh.facets[:, facets]], axis=0)]
    ends = mesh.facets[:, facets]
    length = np.linalg.norm(points[ends[1]] - points[ends[0]], axis=1)
    force = np.zeros(len(points))
    # Simpson's rule: the consistent forces of a uniform traction
    for nodes, share in ((ends[0], 1 / 6), (ends[1], 1 / 6), (mesh.nvertices + facets, 4 / 6)):
        np.add.at(force, nodes, share * traction * length)
    return force
