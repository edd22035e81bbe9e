"""The picture of crack initiation: notches, failure index along them and the coupled criterion."""

from __future__ import annotations

from typing import Any

import matplotlib
import xarray as xr
from matplotlib.figure import Figure

from slmm.initiation.summary import by_criticality, index_with_error, method_used
from slmm.pictures.along_notch_panel import draw_along_notch
from slmm.pictures.criterion_panel import draw_criterion
from slmm.pictures.notch_panel import draw_notch
from slmm.pictures.style import STYLE
from slmm.scene.scene import Scene


def plot_initiation(scene: Scene, result: xr.Dataset, displacements: Any = None) -> Figure:
    """Notches and cracks, the failure index along them, and the coupled criterion at the most critical position.

    Parameters
    ----------
    scene : Scene
        What was computed.
    result : Dataset
        From `slmm.failure_indices`; the third panel needs ``curves=True``.
    displacements : path, DisplacementField or (points, cells, u), optional
        What the result was computed on, for the stress behind the notches; without it, a result on given displacements
        is drawn on white.

    Returns
    -------
    Figure
        Not known to pyplot; ``figure.savefig("result.pdf")`` writes it.
    """
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(12.5, 6.6))
        # fixed places: automatic layouts cannot cope with a panel of fixed aspect and two colour bars
        notch = figure.add_axes((0.055, 0.22, 0.40, 0.65), label="notch")
        bars = figure.add_axes((0.465, 0.27, 0.013, 0.55)), figure.add_axes((0.105, 0.09, 0.30, 0.02))
        along = figure.add_axes((0.60, 0.58, 0.345, 0.31), label="along notch")
        criterion = figure.add_axes((0.60, 0.09, 0.345, 0.33), label="criterion")
        draw_notch(notch, bars, scene, result, displacements)
        draw_along_notch(along, scene, result)
        draw_criterion(criterion, scene, result)
        ranked = by_criticality(result)
        FI = f"FI = {index_with_error(result, ranked[0])}" if ranked else "no failure index"
        method = method_used(result, ranked[0]) if ranked else result.attrs["method"]
        figure.suptitle(f"{scene.title or 'Crack initiation'}: {FI} ({method})", parse_math=False)
    return figure
