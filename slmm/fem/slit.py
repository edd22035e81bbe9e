"""True slits in a triangle mesh: cracks and trial paths are opened by giving each face nodes of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from skfem import MeshTri, MeshTri2

from slmm.fem.mesh import PlateMesh


@dataclass(frozen=True)
class SlitMesh:
    """Quadratic triangles on the true notch curves, with open cracks and an open trial path.

    Parameters
    ----------
    mesh : skfem.MeshTri2
        Vertices first, then the middles of the facets.
    origin : ndarray, shape (n_vertices,)
        Vertex of the closed mesh that each vertex was copied from.
    right, left : ndarray, shape (2 k,)
        Nodes of the two faces of the trial path, corners and midsides in turn from the mouth inwards, without
        the deepest tip; with the last corner where the path ends on a surface and has no tip.
    cracks : tuple of ndarray, shape (e, 3, 2)
        Nodes of the edges of each crack from its start to its end: start, middle and end of each, on its right and its
        left face; a tip is on both.
    """

    mesh: MeshTri2
    origin: np.ndarray
    right: np.ndarray
    left: np.ndarray
    cracks: tuple[np.ndarray, ...] = ()


def split_vertices(triangles: np.ndarray, slits: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles whose vertices are told apart where slits separate the triangles around them.

    Parameters
    ----------
    triangles : ndarray, shape (m, 3)
    slits : ndarray, shape (e, 2)
        Edges to open, as vertex pairs.
    n : int
        Number of vertices.

    Returns
    -------
    triangles : ndarray, shape (m, 3)
        With copies of vertices; a tip stays one vertex, a slit's mouth and its inner vertices become two.
    origin : ndarray, shape (n_new,)
        The vertex each one is a copy of; the first n are the vertices themselves.

    Examples
    --------
    A square of four triangles around its middle, slit from a corner to the middle:

    >>> square = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> triangles, origin = split_vertices(square, np.array([[0, 4]]), 5)
    >>> origin.tolist()
    [0, 1, 2, 3, 4, 0]
    """
    m = len(triangles)
    local = np.array([[0, 1], [1, 2], [2, 0]])
    ends = triangles[:, local].reshape(-1, 2)
    place = (3 * np.arange(m)[:, None, None] + local).reshape(-1, 2)  # corners of triangles, numbered
    swap = ends[:, 0] > ends[:, 1]
    ends[swap], place[swap] = ends[swap][:, ::-1], place[swap][:, ::-1]
    key = ends @ [n, 1]
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    one, other = order[pair], order[pair + 1]
    closed = ~np.isin(key[one], np.sort(slits, axis=1) @ [n, 1])
    one, other = one[closed], other[closed]
    # corners of neighbouring triangles at the same vertex belong together, unless a slit lies between
    links = np.concatenate([place[one], place[other]], axis=1)[:, [0, 2, 1, 3]].reshape(-1, 2)
    graph = sp.coo_array((np.ones(len(links)), links.T), shape=(3 * m, 3 * m))
    _, group = connected_components(graph, directed=False)
    vertex = triangles.ravel()
    first_corner = np.unique(group, return_index=True)[1]
    owner = vertex[first_corner]  # the vertex each group belongs to
    # the first group of each vertex keeps its number
    keeps = np.zeros(len(owner), dtype=bool)
    keeps[np.unique(owner, return_index=True)[1]] = True
    number = np.where(keeps, owner, n + np.cumsum(~keeps) - 1)
    return number[group].reshape(-1, 3), np.concatenate([np.arange(n), owner[~keeps]])


def open_slits(mesh: PlateMesh) -> SlitMesh:
    """Open the cracks and the trial path of a mesh."""
    lines = [line for line in (*mesh.cracks, mesh.path) if len(line)]
    slits = np.concatenate([np.empty((0, 2), dtype=int), *(np.column_stack([k[:-1], k[1:]]) for k in lines)])
    n = len(mesh.vertices)
    triangles, origin = split_vertices(mesh.triangles, slits, n)
    opened = MeshTri2.from_mesh(MeshTri(mesh.vertices[origin].T.copy(), triangles.T.copy()))
    doflocs = opened.doflocs.copy()
    facets = np.sort(origin[opened.facets], axis=0).T @ [n, 1]
    edges = np.sort(mesh.edges, axis=1) @ [n, 1]
    order = np.argsort(edges)
    at = np.minimum(np.searchsorted(edges[order], facets), len(edges) - 1)
    curved = np.flatnonzero(edges[order][at] == facets) if len(edges) else np.empty(0, dtype=int)
    doflocs[:, len(origin) + curved] = mesh.edge_midpoints()[order][at[curved]].T
    cracks = tuple(_faces(opened, origin, facets, crack, n) for crack in mesh.cracks)
    faces = _faces(opened, origin, facets, mesh.path, n)
    right, left = faces[:, :2].reshape(-1, 2).T
    if len(faces) and faces[-1, 2, 0] != faces[-1, 2, 1]:
        right, left = np.append(right, faces[-1, 2, 0]), np.append(left, faces[-1, 2, 1])
    return SlitMesh(replace(opened, doflocs=doflocs), origin, right, left, cracks)


def _faces(opened: MeshTri2, origin: np.ndarray, facets: np.ndarray, path: np.ndarray, n: int) -> np.ndarray:
    """Nodes (e, 3, 2) of the edges along a path on its right and its left face, from the facets' vertex pairs."""
    if not len(path):
        return np.empty((0, 3, 2), dtype=int)
    key = np.sort(np.column_stack([path[:-1], path[1:]]), axis=1) @ [n, 1]
    order = np.argsort(key)
    of_path = np.flatnonzero(np.isin(facets, key))
    step = order[np.searchsorted(key[order], facets[of_path])]
    start = opened.p[:, path[step]]
    along = opened.p[:, path[step + 1]] - start
    across = opened.p[:, opened.t[:, opened.f2t[0, of_path]]].mean(axis=1) - start
    on_left = along[0] * across[1] > along[1] * across[0]
    faces = np.empty((len(path) - 1, 3, 2), dtype=int)
    for k, side in enumerate((~on_left, on_left)):
        ends, here = opened.facets[:, of_path[side]], step[side]
        ahead = origin[ends[0]] == path[here]
        faces[here, 0, k] = np.where(ahead, ends[0], ends[1])
        faces[here, 1, k] = len(origin) + of_path[side]
        faces[here, 2, k] = np.where(ahead, ends[1], ends[0])
    return faces
