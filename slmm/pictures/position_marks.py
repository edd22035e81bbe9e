"""Positions as panels show them: marked by their kind, at the tip of a crack, joined to their neighbours by a line."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from slmm.scene.scene import Scene

Array = NDArray[np.float64]
#: positions farther apart than this share of the outline are not joined by a line
JOINED = 1 / 6
#: markers of positions on a smooth outline, at its corners and at the tips of cracks
SMOOTH, CORNER, TIP = "o", "D", "s"


def kinds_of_positions(scene: Scene, result: xr.Dataset) -> dict[str, NDArray[np.bool_]]:
    """By their markers, which positions are on a smooth outline, at a corner or at the tip of a crack."""
    hole, s = result["hole"].values, result["arc_length"].values
    corner = np.zeros(len(s), dtype=bool)
    for h, outline in enumerate(scene.outlines):
        corner[hole == h] = outline.corner_at(s[hole == h]) >= 0
    tip = hole < 0
    return {SMOOTH: ~corner & ~tip, CORNER: corner, TIP: tip}


def tip_at(scene: Scene, result: xr.Dataset, i: int) -> int:
    """The crack tip that is position i."""
    tips = np.array([line[-1] for line in scene.part.tips])
    return int(np.linalg.norm(tips - [result["x"].values[i], result["y"].values[i]], axis=1).argmin())


def joined(s: Array, values: Array, length: float) -> list[list[tuple[float, float]]]:
    """Pairs of neighbours ((s, value), (s, value)) on a closed outline that a line may join."""
    order = np.argsort(s, kind="stable")
    s, values = s[order], values[order]
    if len(s) > 2:
        s, values = np.append(s, s[0] + length), np.append(values, values[0])
    gaps = np.diff(s)
    # where a notch leaves the plate, the gap is wider than the equal spacing elsewhere
    near = (gaps <= JOINED * length) & (gaps <= 1.5 * np.median(gaps) if len(gaps) > 2 else True)
    near &= np.isfinite(values[:-1]) & np.isfinite(values[1:])
    points = list(zip(s.tolist(), values.tolist(), strict=True))
    return [[points[k], points[k + 1]] for k in np.flatnonzero(near)]
