"""What holds and loads a part, drawn on its surface."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from slmm.pictures.style import PALETTE
from slmm.scene.loading import Condition
from slmm.scene.scene import Scene

Array = NDArray[np.float64]
#: length of the longest arrow, distance between arrows and of supports' strokes, over the part's size
ARROW, APART, STROKE = 0.07, 0.045, 0.02
HELD, LOADED = PALETTE[2], PALETTE[3]
#: points of the line that is a stiff stretch; chosen
BAR_POINTS = 50


def draw_supports(axes: Axes, scene: Scene) -> None:
    """Strokes where a direction is held, arrows where the surface is moved or pulled, as long as what moves or pulls.

    What is stiff is a bar, with the mean traction of its force as an arrow in the middle.

    A short load on a plate is drawn like conditions on its edges.
    """
    moved, pulled = _largest(scene)
    named: set[str] = set()
    for condition in scene.loading:
        x_y, outward = _along(condition, APART * scene.size)
        held = np.array(condition.is_held)
        if condition.stiff is not None:
            ends = condition.points(np.linspace(0.0, 1.0, BAR_POINTS))
            axes.plot(*ends.T, color=HELD, linewidth=4.0, zorder=6, label=_once("stiff", named))
            held = held & ~np.array(condition.stiff.free[:2])
        if held.any():
            _strokes(axes, x_y, outward, held, STROKE * scene.size, _once("held", named))
            u = np.stack([_values(component, x_y) for component in condition.displacement], axis=1)
            if moved > 0:
                _arrows(axes, x_y, outward, ARROW * scene.size * u / moved, HELD, _once("moved", named))
        if condition.stiff is not None and pulled > 0:
            middle, out = (
                np.array([condition.stiff.middle]),
                condition.outward(x_y).mean(axis=0, keepdims=True),
            )
            force = (
                ARROW
                * scene.size
                * np.array([condition.stiff.force[:2]])
                / (2 * condition.stiff.reach * pulled)
            )
            _arrows(axes, middle, out, force, LOADED, _once("loaded", named))
        if condition.is_loaded and pulled > 0:
            t = condition.tractions(x_y, outward)
            _arrows(axes, x_y, outward, ARROW * scene.size * t / pulled, LOADED, _once("loaded", named))


def room_for_supports(scene: Scene) -> float:
    """How far arrows and strokes may stand out from a part, mm."""
    return 1.1 * ARROW * scene.size


def _largest(scene: Scene) -> tuple[float, float]:
    """Largest displacement, mm, and largest traction, MPa."""
    moved, pulled = 0.0, 0.0
    for condition in scene.loading:
        x_y, outward = _along(condition, APART * scene.size)
        u = [_values(component, x_y) for component in condition.displacement]
        moved = max(moved, float(np.hypot(*u).max()))
        pulled = max(pulled, float(np.hypot(*condition.tractions(x_y, outward).T).max()))
        if condition.stiff is not None:
            pulled = max(pulled, float(np.hypot(*condition.stiff.force[:2])) / (2 * condition.stiff.reach))
    return moved, pulled


def _values(component: object, x_y: Array) -> Array:
    return component(x_y) if callable(component) else np.zeros(len(x_y))


def _along(condition: Condition, apart: float) -> tuple[Array, Array]:
    """Points (n, 2) of a stretch, mm, and the normals (n, 2) out of the body there."""
    n = max(int(condition.length / apart), 1)
    share = (np.arange(n) + 0.5) / n
    x_y = condition.points(share)
    return x_y, condition.outward(x_y)


def _once(name: str, named: set[str]) -> str | None:
    """A name for the legend, the first time."""
    if name in named:
        return None
    named.add(name)
    return name


def _strokes(axes: Axes, x_y: Array, outward: Array, held: Array, size: float, label: str | None) -> None:
    """Short strokes away from the body: slanted ones where all is held, else such as lead where it may slide."""
    along = np.column_stack([-outward[:, 1], outward[:, 0]])
    base = x_y + 0.3 * size * outward
    if held.all():
        ends = base + size * (outward - 0.7 * along), base
    else:
        slides = np.where(held, 0.0, 1.0)
        ends = base - 0.5 * size * slides, base + 0.5 * size * slides
    axes.add_collection(
        LineCollection(list(np.stack(ends, axis=1)), colors=HELD, linewidths=1.2, zorder=6, label=label)
    )


def _arrows(axes: Axes, x_y: Array, outward: Array, arrow: Array, colour: str, label: str | None) -> None:
    """Arrows that push onto the surface, or pull away from it."""
    length = np.hypot(*arrow.T)
    pulls = (arrow * outward).sum(axis=1) >= 0
    for which, pivot in ((~pulls, "tip"), (pulls, "tail")):
        here = which & (length > 0)
        if here.any():
            axes.quiver(
                *x_y[here].T,
                *arrow[here].T,
                angles="xy",
                scale_units="xy",
                scale=1.0,
                width=0.004,
                pivot=pivot,
                color=colour,
                zorder=6,
                label=label,
            )
            label = None
