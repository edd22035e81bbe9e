"""Pictures of cantilevers and of searches for the best one, ready to print."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from slmm.optimization.cantilever.beam import HEIGHT, LENGTH, Cantilever
from slmm.pictures.style import CRITICAL, PALETTE, STYLE

#: the largest displacement is drawn as long as this share of the beam's height
DRAWN = 0.35
#: of a cell's corners and middles of edges, in the order in which they surround it
_AROUND = [(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0)]


def plot_optimization(beam: Cantilever, result: xr.Dataset) -> Figure:
    """The best design and how it bends, and how the searches came to it.

    Parameters
    ----------
    beam : Cantilever
    result : Dataset
        From `slmm.optimization.search_runs`, `SearchResult.to_dataset` or `slmm.optimization.cantilever.brute_force`.

    Returns
    -------
    Figure
        Not known to pyplot; ``figure.savefig("design.pdf")`` writes it.
    """
    if "endpoint_displacement" in result:
        design, value = result.best_design.values, float(result.endpoint_displacement[0])
    else:
        best = result.isel(run=int(result.value.argmin("run"))) if "run" in result.dims else result
        design, value = best.best_design.values.astype(bool), float(best.value)
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(12.5, 4.6), layout="constrained")
        beside, right = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
        draw_design(beside, beam, design)
        beside.set_title(f"{beam.columns} × {beam.rows} cells: u = {value:.5g} mm")
        if "endpoint_displacement" in result:
            _draw_best(right, result)
        else:
            _draw_convergence(right, result)
    return figure


def draw_design(axes: Axes, beam: Cantilever, design: np.ndarray) -> None:
    """The cells of a design, bent under their weight, and its undeformed outline."""
    u = beam.displacements(design)
    down, across = u.shape[:2]
    x, y = np.meshgrid(np.linspace(0, LENGTH, across), np.linspace(0, HEIGHT, down))
    scale = _rounded(DRAWN * HEIGHT / np.nanmax(np.abs(u)))
    r, c = np.nonzero(design)
    still, bent = [], []
    for i, j in zip(r, c, strict=True):
        row, column = np.transpose([(2 * i + a, 2 * j + b) for a, b in _AROUND])
        here = np.column_stack([x[row, column], y[row, column]])
        # y points down
        still.append(here * [1, -1])
        bent.append((here + scale * u[row, column]) * [1, -1])
    axes.add_collection(PolyCollection(still, facecolors="0.9", edgecolors="none"))
    axes.add_collection(
        PolyCollection(bent, facecolors=PALETTE[4], edgecolors="white", linewidths=0.5, alpha=0.9)
    )
    corner = np.array([LENGTH, 0.0]) + scale * u[0, -1]
    axes.plot(corner[0], -corner[1], "o", color=CRITICAL, ms=5)
    axes.plot([0, 0], [0, -HEIGHT], color="black", lw=3)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_xlabel(f"x in mm; displacements times {scale:g}")
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)


def _draw_convergence(axes: Axes, result: xr.Dataset) -> None:
    """The best value of each run over the number of simulations, up to its end."""
    runs = result if "run" in result.dims else result.expand_dims("run")
    best = int(runs.value.argmin("run"))
    for k in [*(k for k in range(runs.sizes["run"]) if k != best), best]:
        simulation, value = runs.history_simulation.values[k], runs.history_value.values[k]
        known = np.isfinite(value)
        simulation = np.append(simulation[known], float(runs.simulations[k]))
        value = np.append(value[known], value[known][-1])
        colour, width = (CRITICAL, 1.8) if k == best else ("0.7", 0.8)
        axes.step(simulation, value, where="post", color=colour, lw=width)
    axes.set_xscale("log")
    axes.set_xlabel("simulations")
    axes.set_ylabel("endpoint displacement in mm")
    axes.set_title(f"{result.attrs['algorithm']}, {runs.sizes['run']} run{'s' * (runs.sizes['run'] > 1)}")


def _draw_best(axes: Axes, result: xr.Dataset) -> None:
    """The values of the best designs."""
    axes.semilogx(result["rank"], result.endpoint_displacement, color=PALETTE[0])
    axes.set_xlabel("rank")
    axes.set_ylabel("endpoint displacement in mm")
    axes.set_title(f"best of {int(result.n_valid):,} valid designs")


def _rounded(scale: float) -> float:
    """1, 2 or 5 times a power of ten, at most this."""
    power = 10.0 ** np.floor(np.log10(scale))
    return float(power * max(m for m in (1, 2, 5) if m * power <= scale * (1 + 1e-9)))
