"""Conditions on a part as forces, springs and held displacements of the nodes of a voxel grid."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from slmm.mechanics.rigid import motions_about, unheld
from slmm.part.part import Part
from slmm.scene.load_checks import UNBALANCED
from slmm.scene.loading import Component, Condition, Loading, Stiff
from slmm.voxels.grid import VoxelGrid

Array = NDArray[np.float64]

#: pieces of a stretch in each voxel and in all, at least, and Gauss points on each, for integrals along it (chosen)
PIECES, LEAST_PIECES, GAUSS_POINTS = 4, 200, 2
#: stiffness of the springs that hold a stretch, per area, over Young's modulus by the voxel's size: softer ones give
#: way, stiffer ones hold all nodes of the voxels that a stretch goes through (chosen: of 3 to 300, on bars at angles)
SPRING = 30.0
#: distance from the body's polygon at which a point of its outline counts as on it, in tolerances of the part (chosen)
NEAR = 10.0


Springs = tuple[NDArray[np.int64], Array, Array, Array]


@dataclass(frozen=True)
class PartLoad:
    """What acts on the n nodes of a grid, for a thickness of 1 mm.

    Attributes
    ----------
    force : ndarray, shape (n, 2)
        N.
    held : ndarray of bool, shape (n, 2)
        Displacements that are prescribed: of nodes that lie on a stretch, as on edges along the grid.
    value : ndarray, shape (n, 2)
        What they are, mm; 0 elsewhere.
    springs : list of (ndarray of int (k, 4), ndarray (k, 4), ndarray (k, 2), ndarray (k, 2))
        Along each stretch that is held: nodes around its points and their shares there, the stiffness of either
        direction, N/mm, and the displacements that it pulls towards, mm.
    free : ndarray, shape (k, 3)
        Rigid motions that nothing holds, as combinations of `motions_about` the middle of the grid.
    bodies : tuple of PartLoad
        What each free motion of a rigid body on the surface, by 1 mm, would alone prescribe.
    resultants : ndarray, shape (m,)
        The forces on the bodies that go with these motions, N.
    """

    force: Array
    held: NDArray[np.bool_]
    value: Array
    springs: list[Springs]
    free: Array
    bodies: tuple[PartLoad, ...] = ()
    resultants: Array = field(default_factory=lambda: np.empty(0))

    @property
    def pulls(self) -> Array:
        """Forces (n, 2) by which the springs pull at nodes that have not moved, N."""
        force = np.zeros(self.force.shape)
        for nodes, share, stiffness, wanted in self.springs:
            np.add.at(force, nodes, share[:, :, None] * (stiffness * wanted)[:, None])
        return force


def part_load(part: Part, loading: Loading, grid: VoxelGrid, E: float) -> PartLoad:
    """A loading on the nodes of a grid.

    Tractions act by the shape functions along the outline, so that force and moment are those of the loading. A stretch
    that is held is held by springs along it and, where nodes lie on it, exactly.

    Raises
    ------
    ValueError
        When the part is free to move and its forces do not balance.
    """
    nodes = grid.nodes
    force, value, held = np.zeros(nodes.shape), np.zeros(nodes.shape), np.zeros(nodes.shape, dtype=bool)
    springs: list[Springs] = []
    owners: list[tuple[Condition, NDArray[np.int64]]] = []
    rows, work, acting = [np.empty((0, 3))], np.zeros(3), 0.0
    for condition in loading:
        points, outward, weight = along(condition, part, grid)
        near, share = grid.shares(points)
        motions = motions_about(points, grid.middle, grid.reach)
        if condition.is_loaded:
            pulls = weight[:, None] * condition.tractions(points, outward)
            np.add.at(force, near, share[:, :, None] * pulls[:, None])
            work += np.einsum("ni,nim->m", pulls, motions)
            acting += float(np.abs(pulls).sum())
        directions = np.array(condition.is_held)
        if not directions.any():
            continue
        rows.append(motions[:, directions].reshape(-1, 3))
        wanted = np.stack([_values(u, points) for u in condition.displacement], axis=1)
        springs.append((near, share, SPRING * E / grid.size * weight[:, None] * directions, wanted))
        beside = np.unique(near)
        on = beside[condition.on(nodes[beside])]
        owners.append((condition, on))
        for i, u in enumerate(condition.displacement):
            if u is not None:
                held[on, i], value[on, i] = True, u(nodes[on])
    free = unheld(np.concatenate(rows))
    if np.abs(free @ work).max(initial=0.0) > 2 * UNBALANCED * acting:
        x, y = force.sum(axis=0)
        raise ValueError(
            f"load: the part is free to move, and what acts on it does not balance: forces of ({x:.4g}, {y:.4g}) N for "
            "each mm of thickness are left, or a moment; prescribe displacements"
        )
    load = PartLoad(force, held, value, springs, free)
    moved = [
        _moved(load, body, k, owners, grid) for body in loading.stiff for k in range(len(body.resultants))
    ]
    resultants = np.concatenate([np.empty(0), *(body.resultants for body in loading.stiff)])
    return replace(load, bodies=tuple(moved), resultants=resultants)


def _moved(
    load: PartLoad, body: Stiff, k: int, owners: list[tuple[Condition, NDArray[np.int64]]], grid: VoxelGrid
) -> PartLoad:
    """What the k-th free motion of a rigid body alone prescribes."""
    nodes, value, springs = grid.nodes, np.zeros(load.value.shape), []
    for (condition, on), (near, share, stiffness, wanted) in zip(owners, load.springs, strict=True):
        if condition.stiff is body:
            value[on] = body.motions(nodes[on])[..., k]
            # a point is where its shares are
            points = np.einsum("pk,pki->pi", share, nodes[near])
            springs.append((near, share, stiffness, body.motions(points)[..., k]))
        else:
            springs.append((near, share, stiffness, np.zeros(wanted.shape)))
    return replace(load, force=np.zeros(load.force.shape), value=value, springs=springs)


def along(condition: Condition, part: Part, grid: VoxelGrid) -> tuple[Array, Array, Array]:
    """Points (n, 2) in the material of a stretch, normals (n, 2) out of the body, and weights (n,), mm.

    For integrals of what varies over the voxels of a grid: of pieces that each lie in one of them.
    """
    n = max(int(np.ceil(PIECES * condition.length / grid.size)), LEAST_PIECES)
    cuts = np.linspace(0.0, 1.0, n + 1)
    if condition.span is not None:
        cuts = np.union1d(cuts, condition.span.corners)
    crossings = []
    scaled = (condition.points(cuts) - grid.origin) / (grid.hx, grid.hy)
    for a, b in zip(scaled[:-1].T, scaled[1:].T, strict=True):
        line = np.ceil(np.minimum(a, b))
        crossed = (line > np.minimum(a, b)) & (line < np.maximum(a, b))
        share = (line - a)[crossed] / (b - a)[crossed]
        crossings.append(cuts[:-1][crossed] + share * np.diff(cuts)[crossed])
    cuts = np.unique(np.concatenate([cuts, *crossings]))
    x, w = leggauss(GAUSS_POINTS)
    half = 0.5 * np.diff(cuts)
    share = (cuts[:-1] + half)[:, None] + half[:, None] * x
    points, weight = condition.points(share.ravel()), condition.length * (half[:, None] * w).ravel()
    inside = shapely.dwithin(part.body, shapely.points(points), NEAR * part.tolerance)
    points, weight = points[inside], weight[inside]
    return points, condition.outward(points), weight


def _values(u: Component | None, points: Array) -> Array:
    """A component that is prescribed, at points (n, 2), or zeros."""
    return np.zeros(len(points)) if u is None else u(points)
