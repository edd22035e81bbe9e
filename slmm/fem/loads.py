"""A loading as nodal forces and prescribed displacements of a body-fitted model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.polynomial.legendre import leggauss
from scipy.sparse.csgraph import connected_components
from skfem import MeshTri2

from slmm.mechanics.rigid import free_motions
from slmm.scene.load_checks import UNBALANCED
from slmm.scene.loading import ON_STRETCH, Condition, Loading, Stiff

#: Gauss points on an edge for tractions that vary along it (chosen)
EDGE_POINTS = 3


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
    adrift : ndarray of bool, shape (n,)
        Nodes of pieces that nothing holds and the load carries away.
    bodies : tuple of (Stiff, ndarray of int (k,), ndarray (k, 2))
        Rigid bodies on the surface, their nodes, and what of their motion is given there, mm.
    """

    force: np.ndarray
    prescribed: np.ndarray
    value: np.ndarray
    supports: np.ndarray
    adrift: np.ndarray
    bodies: tuple[tuple[Stiff, np.ndarray, np.ndarray], ...] = ()


def nodal_load(loading: Loading, mesh: MeshTri2, points: np.ndarray, closed: np.ndarray) -> NodalLoad:
    """A loading on the nodes of a mesh.

    Each piece of a severed part is held by itself, where its displacements are not prescribed, if what acts on it
    balances.

    Parameters
    ----------
    loading : Loading
    mesh : skfem.MeshTri2
        Vertices first, then the middles of the facets.
    points : ndarray, shape (n, 2)
        Its nodes, mm.
    closed : ndarray, shape (k, 2)
        Nodes on either face of a path that is held together.

    Raises
    ------
    ValueError
        When a part in one piece is free to move and its forces do not balance.
    """
    force, value = np.zeros_like(points), np.zeros_like(points)
    prescribed, supports = np.zeros(points.shape, dtype=bool), np.zeros(points.shape, dtype=bool)
    _check_ends(loading, mesh)
    for condition in loading:
        on = condition.on(points)
        for i, component in enumerate(condition.displacement):
            if component is not None:
                prescribed[on, i] = True
                value[on, i] = component(points[on])
        if condition.is_loaded:
            force += forces_of(condition, mesh, points, on)
    adrift = np.zeros(len(points), dtype=bool)
    pieces = pieces_of(mesh, closed)
    bodies = tuple((body, *_body(body, loading, points)) for body in loading.stiff)
    if bodies and len(pieces) > 1:
        raise ValueError(
            f"the cracks sever the part, in {len(pieces)} pieces, and what is stiff on it may be carried away with one"
        )
    for nodes in pieces:
        free = free_motions(points[nodes], prescribed[nodes])
        if not free.shape[1]:
            continue
        # a scene lets through what its supports carry without a trace
        work = free.T @ force[nodes].ravel()
        if np.any(np.abs(work) > 2 * UNBALANCED * np.abs(force[nodes]).sum()):
            if len(pieces) == 1:
                raise ValueError(
                    "load: the part is free to move, and what acts on it does not balance: forces of "
                    f"({force[:, 0].sum():.4g}, {force[:, 1].sum():.4g}) N for each mm of thickness are left, or a "
                    "moment; prescribe displacements"
                )
            adrift[nodes] = True
        for node, i in _supports(points, nodes, prescribed, _first_stretch(loading, points[nodes])):
            supports[node, i] = True
    return NodalLoad(force, prescribed | supports, value, supports, adrift, bodies)


def _body(body: Stiff, loading: Loading, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (k,) of the stretches of a rigid body, and what of its motion is given there (k, 2), mm."""
    stretches = [condition for condition in loading if condition.stiff is body]
    nodes = np.flatnonzero(np.any([condition.on(points) for condition in stretches], axis=0))
    x, y = stretches[0].displacement
    assert x is not None and y is not None
    return nodes, np.stack([x(points[nodes]), y(points[nodes])], axis=1)


def _check_ends(loading: Loading, mesh: MeshTri2) -> None:
    """Refuse a mesh whose boundary has no node where a condition ends: it would be taken for longer or shorter."""
    a, b = (mesh.p[:, mesh.facets[k, mesh.boundary_facets()]].T for k in (0, 1))
    along = b - a
    length = np.linalg.norm(along, axis=1)
    for x, y in np.unique(loading.ends, axis=0):
        gap = np.array([x, y]) - a
        share = (gap * along).sum(axis=1) / length**2
        across = np.abs(gap[:, 0] * along[:, 1] - gap[:, 1] * along[:, 0]) / length
        inside = (across < ON_STRETCH * length) & (share > 1e-6) & (share < 1 - 1e-6)
        if inside.any():
            raise ValueError(
                f"the mesh has no node at ({x:g}, {y:g}), where a condition ends: make it with nodes_at = loading.ends"
            )


def pieces_of(mesh: MeshTri2, closed: np.ndarray) -> list[np.ndarray]:
    """Nodes of each piece of a mesh, ascending; pairs of nodes (k, 2) hold what they belong to together."""
    n = mesh.nvertices
    ends = np.concatenate([mesh.t[[0, 1]], mesh.t[[1, 2]], closed[(closed < n).all(axis=1)].T], axis=1)
    graph = sp.coo_array((np.ones(ends.shape[1]), ends), shape=(n, n))
    count, piece = connected_components(graph, directed=False)
    if count == 1:
        return [np.arange(n + mesh.nfacets)]
    of_node = np.concatenate([piece, piece[mesh.facets[0]]])
    return [np.flatnonzero(of_node == k) for k in range(count)]


def _first_stretch(loading: Loading, points: np.ndarray) -> Condition | None:
    """The first condition that has two nodes of a piece at least."""
    return next((condition for condition in loading if np.count_nonzero(condition.on(points)) > 1), None)


def _supports(
    points: np.ndarray, nodes: np.ndarray, prescribed: np.ndarray, stretch: Condition | None
) -> list[tuple[int, int]]:
    """Displacements (node, component) of a piece that fix what is free: at the ends of a stretch, or of the piece."""
    if stretch is not None:
        nodes_there = nodes[stretch.on(points[nodes])]
        # of a whole outline, which has no ends, the outermost nodes
        way = np.array(stretch.end) - stretch.start
        along = points[nodes_there] @ (way if way.any() else np.array([1.0, 0.0]))
        first, last = nodes_there[along.argmin()], nodes_there[along.argmax()]
    else:
        order = np.lexsort(points[nodes].T)
        first, last = nodes[order[0]], nodes[order[-1]]
    across = int(np.abs(points[last] - points[first]).argmin())  # a turn moves the last node that way
    fixed = prescribed[nodes].copy()
    place = {int(node): k for k, node in enumerate(nodes)}
    found = []
    free = free_motions(points[nodes], fixed).shape[1]
    for node, i in ((first, 0), (first, 1), (last, across)):
        more = fixed.copy()
        more[place[int(node)], i] = True
        left = free_motions(points[nodes], more).shape[1]
        if left < free:
            fixed, free = more, left
            found.append((int(node), i))
    return found


def forces_of(condition: Condition, mesh: MeshTri2, points: np.ndarray, on: np.ndarray) -> np.ndarray:
    """Consistent nodal forces (n, 2), N for each mm of thickness, of a condition on the facets between marked nodes."""
    facets = mesh.boundary_facets()
    facets = facets[np.all(on[mesh.facets[:, facets]], axis=0) & on[mesh.nvertices + facets]]
    nodes = np.column_stack([mesh.facets[0, facets], mesh.nvertices + facets, mesh.facets[1, facets]])
    inner = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    force = np.zeros_like(points)
    for x, w in zip(*leggauss(EDGE_POINTS), strict=True):
        shape = np.array([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2])
        slope = np.einsum("k,eki->ei", [x - 0.5, -2 * x, x + 0.5], points[nodes])
        step = np.linalg.norm(slope, axis=1, keepdims=True)
        outward = np.column_stack([slope[:, 1], -slope[:, 0]]) / step
        outward *= np.sign(((points[nodes[:, 1]] - inner) * outward).sum(axis=1))[:, None]
        acts = w * step * condition.tractions(np.einsum("k,eki->ei", shape, points[nodes]), outward)
        for k in range(3):
            np.add.at(force, nodes[:, k], shape[k] * acts)
    return force
