"""A part with its cracks, coloured by the step that made them: closed, or open as at a critical load."""

from __future__ import annotations

import matplotlib
import numpy as np
import shapely
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from slmm.fracture.critical_state import CriticalState
from slmm.pictures.style import CRITICAL
from slmm.pictures.supports import draw_supports, room_for_supports
from slmm.scene.scene import Scene

Array = NDArray[np.float64]

#: perceptually uniform and safe for the colour-blind
STEP_COLOURS = "viridis"
#: room around the part over its size, the light grey of the material and the dark one of its edges
MARGIN, MATERIAL, EDGE = 0.03, "0.92", "0.35"
#: places as near, over their coordinates, are one
ROUND_OFF = 1e-9


def step_scale(result: xr.Dataset) -> Normalize:
    """Colours of the steps, numbered from 1."""
    return Normalize(1, max(result.sizes["step"], 2))


def draw_part(axes: Axes, scene: Scene) -> None:
    """Material, holes, what holds and loads it."""
    axes.add_patch(Polygon(scene.part.outer, fc=MATERIAL, ec=EDGE, lw=1.0, zorder=1))
    for outline in scene.part.holes:
        axes.add_patch(Polygon(outline.polygon(720), fc="white", ec=EDGE, lw=1.0, zorder=2))
    draw_supports(axes, scene)
    _set_limits(axes, scene, 0.0)


def draw_cracks(axes: Axes, result: xr.Dataset, steps: int) -> None:
    """Cracks after so many steps: initial ones black, increments by their step."""
    for x, y, made in zip(
        result.crack_x.values, result.crack_y.values, result.crack_step.values, strict=True
    ):
        known = made < steps  # false of NaN, too
        pieces, step = _pieces(np.column_stack([x, y])[known], made[known])
        _draw_lines(axes, list(pieces), step, result)


def draw_open_part(
    axes: Axes, scene: Scene, result: xr.Dataset, state: CriticalState, magnified: float
) -> None:
    """The part with its displacements so many times as large, and its cracks open."""
    surfaces = [places + magnified * u for places, u in state.surfaces]
    contour = state.model.panels.contour
    for k, number in enumerate(np.unique(contour)):
        around = np.concatenate([surfaces[panel] for panel in np.flatnonzero(contour == number)])
        axes.add_patch(Polygon(around, fc="white" if k else MATERIAL, ec="none", zorder=2 if k else 1))
    axes.add_collection(LineCollection(surfaces, colors=EDGE, linewidths=1.0, zorder=3))
    tree, made = _made(result)
    for faces in state.faces:
        left, right = faces.points + magnified * faces.left, faces.points + magnified * faces.right
        axes.add_patch(Polygon(np.concatenate([left, right[::-1]]), fc="white", ec="none", zorder=3))
        middles = shapely.points(0.5 * (faces.points[:-1] + faces.points[1:]))
        step = made[tree.nearest(middles)]
        for face in (left, right):
            _draw_lines(axes, list(np.stack([face[:-1], face[1:]], axis=1)), step, result)
    _set_limits(axes, scene, magnified * float(result.u.max()))


def draw_numbers(
    axes: Axes, result: xr.Dataset, state: CriticalState | None = None, magnified: float = 0.0
) -> None:
    """Numbers of the cracks that move, where they begin to; in an open part between their faces."""
    for k in first_steps(result):
        crack, at = int(result.tip[k]), np.array(_begin(result, k))
        # cracks that went with a loose piece have no faces: the place tells whose they are
        for faces in [] if state is None else state.faces:
            away = np.linalg.norm(faces.points - at, axis=1)
            if away.min() <= ROUND_OFF * np.abs(at).max():
                at = at + magnified * 0.5 * (faces.left + faces.right)[away.argmin()]
                break
        axes.annotate(
            str(crack),
            tuple(at),
            xytext=(3, 4),
            textcoords="offset points",
            color=CRITICAL,
            weight="bold",
            zorder=6,
        )


def first_steps(result: xr.Dataset) -> list[int]:
    """The first step of each crack that moves."""
    return np.sort(np.unique(result.tip.values, return_index=True)[1]).tolist()


def _begin(result: xr.Dataset, step: int) -> tuple[float, float]:
    """Where a crack stood before it moved."""
    here = result.candidate_step.values == step
    u_c = np.where(here, result.candidate_u_c.values, np.inf)
    crack = -1 if result.event.values[step] == "start" else int(result.tip[step])
    k = np.where(result.candidate_tip.values == crack, u_c, np.inf).argmin()
    return float(result.candidate_x[k]), float(result.candidate_y[k])


def _pieces(points: Array, made: Array) -> tuple[Array, Array]:
    """Pieces (n, 2, 2) of a crack, and the steps (n,) that made them."""
    # an increment leads from one point to the next, whichever end of the crack grew
    return np.stack([points[:-1], points[1:]], axis=1), np.maximum(made[:-1], made[1:])


def _made(result: xr.Dataset) -> tuple[shapely.STRtree, Array]:
    """All pieces of cracks, and the steps that made them."""
    pieces, steps = [], []
    for x, y, made in zip(
        result.crack_x.values, result.crack_y.values, result.crack_step.values, strict=True
    ):
        known = np.isfinite(x)
        own, step = _pieces(np.column_stack([x, y])[known], made[known])
        pieces += list(shapely.linestrings(own))
        steps.append(step)
    return shapely.STRtree(pieces), np.concatenate(steps)


def _draw_lines(axes: Axes, lines: list[Array], step: Array, result: xr.Dataset) -> None:
    """Lines in the colours of their steps, black where they were there before."""
    colours = matplotlib.colormaps[STEP_COLOURS](step_scale(result)(step + 1))
    colours[step < 0] = (0.0, 0.0, 0.0, 1.0)
    axes.add_collection(LineCollection(lines, colors=list(colours), linewidths=2.2, zorder=4))


def _set_limits(axes: Axes, scene: Scene, more: float) -> None:
    (x0, y0), (x1, y1) = scene.box
    room = max(MARGIN * scene.size, room_for_supports(scene)) + more
    axes.set(xlim=(x0 - room, x1 + room), ylim=(y0 - room, y1 + room), aspect="equal")
    axes.set(xlabel="x in mm", ylabel="y in mm")
