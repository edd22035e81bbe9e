"""Pictures of configurational forces on the nodes of a plane model, ready to print."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named
from slmm.pictures.style import CRITICAL, PALETTE, STRESS_COLOURS, STYLE

#: forces below this share of the largest one are not drawn
SMALLEST_ARROW = 1e-3
#: length of the largest arrow over the side of the panel
LONGEST_ARROW = 0.22
#: the panel of a tip shows this share of the largest contour's radius around it
SHOWN = 0.35


def plot_forces(results: ElementResults, forces: np.ndarray, loading: xr.Dataset) -> Figure:
    """The model with its nodal configurational forces, and the crack tip that is loaded most.

    Parameters
    ----------
    results : ElementResults
        Of a plane model.
    forces : ndarray (n, 2)
        N.
    loading : Dataset
        From `slmm.fracture.crack_tip_loading`.

    Returns
    -------
    Figure
        Not known to pyplot; ``figure.savefig("forces.pdf")`` writes it.

    Raises
    ------
    ValueError
        For a model in space.
    """
    if results.dimension != 2:
        raise ValueError("pictures are drawn of plane models: write a .vtu file of a model in space")
    known = np.flatnonzero(np.isfinite(loading.G.values))
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(12.5, 6.0) if len(known) else (7.5, 6.0), layout="constrained")
        panels = figure.subplots(1, 2 if len(known) else 1, squeeze=False)[0]
        low, high = results.points.min(axis=0), results.points.max(axis=0)
        energy = _draw_energy(panels[0], results)
        _draw_forces(panels[0], results, forces, (low, high))
        for k in range(loading.sizes["tip"]):
            panels[0].annotate(
                f"tip {k}",
                (float(loading.x[k]), float(loading.y[k])),
                xytext=(8, 8),
                textcoords="offset points",
                color=CRITICAL,
            )
        panels[0].set_title("configurational forces")
        if len(known):
            k = int(known[np.argmax(loading.G.values[known])])
            _draw_tip(panels[1], results, forces, loading.isel(tip=k), k)
        figure.colorbar(energy, ax=panels[0], label="energy density in MPa", shrink=0.8)
    return figure


def _draw_energy(axes: Axes, results: ElementResults) -> PolyCollection:
    """Elements coloured by their mean energy density."""
    polygons, density = [], []
    for name, nodes in results.cells.items():
        polygons += list(results.points[nodes[:, : element_named(name).corners]])
        density.append(results.energy[name].mean(axis=1))
    values = np.concatenate(density)
    highest = float(values.max(initial=0.0)) or 1.0
    norm = LogNorm(max(float(np.quantile(values, 0.02)), 1e-4 * highest), highest)
    collection = PolyCollection(
        polygons, array=values, cmap=STRESS_COLOURS, norm=norm, edgecolors="0.75", linewidths=0.2
    )
    axes.add_collection(collection)
    axes.set_aspect("equal")
    axes.set_xlabel("x in mm")
    axes.set_ylabel("y in mm")
    return collection


def _draw_forces(
    axes: Axes, results: ElementResults, forces: np.ndarray, view: tuple[np.ndarray, np.ndarray]
) -> None:
    """Arrows of the forces in a view, the longest as long as a share of it."""
    low, high = view
    size = np.linalg.norm(forces, axis=1)
    seen = ((results.points >= low) & (results.points <= high)).all(axis=1)
    largest = size[seen].max(initial=0.0)
    if largest > 0:
        drawn = seen & (size > SMALLEST_ARROW * largest)
        scale = largest / (LONGEST_ARROW * float((high - low).max()))
        axes.quiver(
            *results.points[drawn].T,
            *forces[drawn].T,
            angles="xy",
            scale_units="xy",
            scale=scale,
            color=PALETTE[0],
            width=0.004,
            zorder=3,
        )
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)


def _draw_tip(axes: Axes, results: ElementResults, forces: np.ndarray, tip: xr.Dataset, number: int) -> None:
    """The surroundings of a tip: forces, contours, J and the direction in which the crack would run."""
    at = np.array([float(tip.x), float(tip.y)])
    side = SHOWN * float(tip.radius.max())
    _draw_energy(axes, results)
    _draw_forces(axes, results, forces, (at - side, at + side))
    for radius in tip.radius.values:
        axes.add_patch(Circle(tuple(at), float(radius), fill=False, ec="0.5", lw=0.8, ls=":"))
    J = np.array([float(tip.J_x.median()), float(tip.J_y.median())])
    if np.isfinite(J).all():
        _arrow(axes, at, 0.7 * side * J / np.linalg.norm(J), PALETTE[2], "J")
    kink = float(tip.kink.sel(criterion="MERR"))
    if np.isfinite(kink):
        heading = np.radians(float(tip.angle) + kink)
        along = 0.7 * side * np.array([np.cos(heading), np.sin(heading)])
        _arrow(axes, at, along, CRITICAL, f"runs on at {kink:.1f}°")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper right")
    axes.set_title(f"tip {number}: G = {float(tip.G):.4g} N/mm")


def _arrow(axes: Axes, at: np.ndarray, along: np.ndarray, colour: str, label: str) -> None:
    axes.quiver(
        *at, *along, angles="xy", scale_units="xy", scale=1, color=colour, width=0.007, zorder=4, label=label
    )
