"""Triangles between given boundary nodes by netgen, everywhere as large as the size wanted there.

Left to itself, netgen derives the size inside from the edges around, and whether it does so depends on where they
happen to lie: around a small hole elements may grow ten times too fast, or the front of elements finds no end.
So the sizes inside are given to it as well.
"""

from __future__ import annotations

import numpy as np

from slmm.fem.element_size import SIZE_GROWTH, ElementSize


class MesherError(RuntimeError):
    """The mesher found no triangles between the nodes."""


def triangulated(
    points: np.ndarray, segments: np.ndarray, n_boundary: int, size: ElementSize, turn: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Triangulate a plane body.

    Parameters
    ----------
    points : ndarray (n, 2)
        Nodes that have to be vertices, mm.
    segments : ndarray (k, 2)
        Edges between them: the first ``n_boundary`` have the body on their left, the others on both sides.
    n_boundary : int
    size : ElementSize
        Wanted inside.
    turn : float
        Angle by which the body is turned for the mesher, rad: where it gives up on a body, it seldom does on a turned
        one.

    Returns
    -------
    vertices : ndarray (m, 2)
        Those above and others, in no order, mm.
    triangles : ndarray (t, 3)
        Vertex numbers, counter-clockwise.

    Raises
    ------
    ImportError
        Without netgen.
    MesherError
        When netgen gives up.
    """
    try:
        from netgen.geom2d import SplineGeometry
        from netgen.meshing import MeshingParameters, NgException
    except ImportError as error:
        raise ImportError("body-fitted meshes need netgen: pip install slmm[fea]") from error
    geometry = SplineGeometry()
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    number = [geometry.AppendPoint(float(x), float(y)) for x, y in points @ rotation]
    for k, (i, j) in enumerate(segments):
        right = 0 if k < n_boundary else 1
        geometry.Append(["line", number[i], number[j]], leftdomain=1, rightdomain=right, bc=1)
    parameters = MeshingParameters(maxh=size.largest, grading=SIZE_GROWTH)
    at, wanted = size.sampled(points.min(axis=0), points.max(axis=0))
    for (x, y), edge in zip(at @ rotation, wanted, strict=True):
        parameters.RestrictH(x, y, 0.0, edge)
    try:
        mesh = geometry.GenerateMesh(parameters)
    except NgException as error:
        raise MesherError(f"the mesher failed: {error}") from error
    # copies: the mesher's arrays die with its mesh
    vertices = np.array(mesh.Coordinates(), dtype=float)[:, :2] @ rotation.T
    triangles = np.array(mesh.Elements2D().NumPy()["nodes"], dtype=np.int64)[:, :3] - 1
    used, number_used = np.unique(triangles, return_inverse=True)
    triangles = number_used.reshape(-1, 3)
    vertices = vertices[used]
    a, b, c = vertices[triangles].swapaxes(0, 1)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    return vertices, triangles
