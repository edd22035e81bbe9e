"""Rigid motions of a set of points, and which of them prescribed displacements leave free."""

from __future__ import annotations

import numpy as np

#: rigid motions whose displacements are as small, squared and against the largest, are held; round-off
HELD = 1e-9


def rigid_motions(points: np.ndarray) -> np.ndarray:
    """Displacements (n, 2, 3) of points (n, 2), about 1, by motions along x and y and a turn about the middle."""
    middle = points.mean(axis=0)
    return motions_about(points, middle, np.abs(points - middle).max())


def motions_about(points: np.ndarray, middle: np.ndarray, reach: float) -> np.ndarray:
    """Displacements (n, 2, 3) of points (n, 2) by motions along x and y by 1, and a turn that moves by 1 at a reach."""
    motions = np.zeros((*points.shape, 3))
    motions[:, 0, 0] = motions[:, 1, 1] = 1.0
    motions[:, 0, 2] = (middle[1] - points[:, 1]) / reach
    motions[:, 1, 2] = (points[:, 0] - middle[0]) / reach
    return motions


def names_of(points: np.ndarray, free: np.ndarray) -> str:
    """What rigid motions (2 n, k) of points (n, 2) are: along x or y, a turn.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> rollers = np.array([[False, True], [False, True], [False, False], [False, False]])
    >>> names_of(corners, free_motions(corners, rollers))
    'along x'
    """
    basis = np.linalg.qr(free)[0]
    names = [
        name
        for name, motion in zip(
            ("along x", "along y", "to turn"), rigid_motions(points).reshape(-1, 3).T, strict=True
        )
        if np.linalg.norm(motion - basis @ (basis.T @ motion)) < 1e-6 * np.linalg.norm(motion)
    ]
    # a turn about a point that is held
    return " and ".join(names or ["to turn"])


def free_motions(points: np.ndarray, prescribed: np.ndarray) -> np.ndarray:
    """Rigid motions (2 n, k) of points (n, 2) that prescribed displacements (n, 2) leave free.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> rollers = np.array([[False, True], [False, True], [False, False], [False, False]])
    >>> free_motions(corners, rollers).round(3).reshape(4, 2, 1)[..., 0].tolist()
    [[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0]]
    """
    motions = rigid_motions(points)
    if not prescribed.any():
        return motions.reshape(-1, 3)
    return motions.reshape(-1, 3) @ unheld(motions[prescribed]).T


def unheld(held: np.ndarray) -> np.ndarray:
    """Combinations (k, 3) of rigid motions in which none of the displacements (n, 3) that are held takes part."""
    _, size, modes = np.linalg.svd(held.T @ held)
    return np.asarray(modes[size <= HELD * max(size[0], 1.0)])
