"""Where on the outlines a crack is looked for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slmm.contours.outline import Outline
from slmm.scene import Scene

#: samples of an outline that decide which part of it lies within the plate
SAMPLES = 4000


class Positions(NamedTuple):
    """Positions on the notches.

    Attributes
    ----------
    hole : ndarray (n,) of int
        Index into ``scene.outlines``.
    s : ndarray (n,)
        Arc length on that outline, mm.
    points : ndarray (n, 2)
        Coordinates, mm.
    """

    hole: np.ndarray
    s: np.ndarray
    points: np.ndarray


def find_positions(scene: Scene, positions: int | None = None) -> Positions:
    """Equally spaced positions on every outline, or the scene's explicit points projected to the nearest one.

    Parameters
    ----------
    scene : Scene
    positions : int, optional
        Number on each hole; in place of what the scene asks for.

    Raises
    ------
    ValueError
        When the scene has no hole.
    """
    outlines = scene.outlines
    if not outlines:
        raise ValueError("holes: the scene has none; a crack is looked for at a hole or notch")
    points = scene.analysis.points
    if positions is None and points is not None:
        wanted = np.asarray(points, dtype=float).reshape(-1, 2)
        s = np.stack([outline.project(wanted) for outline in outlines])
        at = np.stack([outline.points(row) for outline, row in zip(outlines, s, strict=True)])
        hole = np.argmin(np.linalg.norm(at - wanted, axis=-1), axis=0)
        index = np.arange(len(wanted))
        return Positions(hole, s[hole, index], at[hole, index])
    count = scene.analysis.positions if positions is None else positions
    if count < 1:
        raise ValueError(f"positions = {count}: must be at least 1")
    s_of = [_spread(outline, count, scene.plate.width, scene.plate.height) for outline in outlines]
    hole = np.repeat(np.arange(len(outlines)), [len(s) for s in s_of])
    s = np.concatenate(s_of)
    at = np.concatenate([outline.points(row) for outline, row in zip(outlines, s_of, strict=True)])
    return Positions(hole, s, at)


def _spread(outline: Outline, count: int, width: float, height: float) -> np.ndarray:
    """Arc lengths equally spaced over the part of the outline that lies within the plate."""
    s = (np.arange(SAMPLES) + 0.5) * outline.length / SAMPLES
    x, y = outline.points(s).T
    inside = (x > 0) & (x < width) & (y > 0) & (y < height)
    if inside.all():
        return np.arange(count) * outline.length / count
    within = s[inside]
    return within[((np.arange(count) + 0.5) * len(within) / count).astype(int)]
