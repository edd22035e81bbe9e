"""Edges of elements as parabolas through start, end and middle."""

from __future__ import annotations

import numpy as np

#: pieces of a curved edge when the nearest edge is looked for; chosen
EDGE_PIECES = 8
#: of Newton's method for the nearest point of an edge; chosen
ITERATIONS = 30


def on_edge(curve: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of edges (start, end, middle) at s in 0 to 1, with first and second derivative by s.

    Parameters
    ----------
    curve : ndarray (..., 3, 2)
    s : ndarray (...)

    Examples
    --------
    >>> at, slope, bend = on_edge(np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.5]]), np.array([0.0, 0.5]))
    >>> at.tolist(), slope.tolist()
    ([[0.0, 0.0], [1.0, 0.5]], [[2.0, 2.0], [2.0, 0.0]])
    """
    start, end, middle = (curve[..., i, :] for i in range(3))
    chord, bulge, s = end - start, 4 * (middle - (start + end) / 2), s[..., None]
    return (
        start + s * chord + s * (1 - s) * bulge,
        chord + (1 - 2 * s) * bulge,
        np.broadcast_to(-2 * bulge, chord.shape),
    )


def nearest_on_edge(curve: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The s (n,) and the point (n, 2) of each edge (n, 3, 2) that is nearest to a point (n, 2).

    Examples
    --------
    >>> s, at = nearest_on_edge(np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]]), np.array([[0.5, 3.0]]))
    >>> s.tolist(), at.tolist()
    ([0.25], [[0.5, 0.0]])
    """
    samples = np.linspace(0, 1, EDGE_PIECES + 1)
    distance = np.linalg.norm(on_edge(curve[:, None], samples[None, :])[0] - points[:, None], axis=-1)
    s = samples[distance.argmin(axis=1)]
    for _ in range(ITERATIONS):
        at, slope, bend = on_edge(curve, s)
        descent = np.sum((at - points) * slope, axis=1)
        length = np.sum(slope * slope, axis=1)
        # where the distance is not convex, and at the end of a quarter-point edge, where it stands still
        curvature = np.maximum(length + np.sum((at - points) * bend, axis=1), 0.25 * length)
        s = np.clip(s - np.divide(descent, curvature, out=np.zeros_like(s), where=curvature > 0), 0, 1)
    return s, on_edge(curve, s)[0]
