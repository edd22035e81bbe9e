"""Notches coloured by failure index, on the principal stress in the plate, with the critical crack."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from slmm.initiation.summary import by_criticality
from slmm.pictures.position_marks import SMOOTH, joined, kinds_of_positions, tip_at
from slmm.pictures.stress_field import StressField, View, stress_in_view
from slmm.pictures.style import CRITICAL, STRESS_COLOURS
from slmm.pictures.supports import draw_supports, room_for_supports
from slmm.scene.scene import Scene

Array = NDArray[np.float64]
#: perceptually uniform and safe for the colour-blind, legible on the grey of the stresses
FI_COLOURS = "plasma"


def draw_notch(
    axes: Axes, bars: tuple[Axes, Axes], scene: Scene, result: xr.Dataset, displacements: Any = None
) -> None:
    """The notches coloured by failure index, on the principal stress in the plate, with the critical crack.

    ``bars`` take the colour bars of the failure index and of the stress.
    """
    x0, x1, y0, y1 = view = _view(scene)
    if displacements is None and "displacements" in result.attrs:
        bars[1].set_axis_off()
    else:
        _draw_stress(axes, bars[1], stress_in_view(scene, view, displacements), scene, view)
    axes.add_patch(Polygon(scene.part.outer, fill=False, ec="0.35", lw=1.0, zorder=1.5))
    for outline in scene.part.holes:
        axes.add_patch(Polygon(outline.polygon(720), fc="white", ec="none", zorder=2))
        rim = axes.add_patch(Polygon(outline.polygon(720), fill=False, ec="0.35", lw=1.0, zorder=3))
        _clip_to_plate(rim, axes, scene)
    for k, crack in enumerate(scene.part.cracks):
        label = "initial crack" if k == 0 else None
        axes.plot(*crack.points.T, color="black", lw=1.8, zorder=3.5, label=label)

    if scene.load is None:
        draw_supports(axes, scene)
    FI, hole, s = (result[name].values for name in ("failure_index", "hole", "arc_length"))
    found = np.isfinite(FI)
    scale = Normalize(0.0, float(FI[found].max(initial=0.0)) or 1.0)
    for h, outline in enumerate(scene.outlines):
        on_hole = np.flatnonzero(hole == h)
        for (s_0, FI_0), (s_1, FI_1) in joined(s[on_hole], FI[on_hole], outline.length):
            points = outline.points(np.linspace(s_0, s_1, 9))
            pieces = LineCollection(
                list(np.stack([points[:-1], points[1:]], axis=1)),
                array=FI_0 + (FI_1 - FI_0) * (np.arange(8) + 0.5) / 8,
                cmap=FI_COLOURS,
                norm=scale,
                linewidths=5,
                capstyle="round",
                zorder=4,
            )
            _clip_to_plate(axes.add_collection(pieces), axes, scene)
    x, y = result["x"].values, result["y"].values
    for marker, of_kind in kinds_of_positions(scene, result).items():
        here = found & of_kind
        size, rim_colour = (20, "none") if marker == SMOOTH else (45, "black")
        dots = axes.scatter(
            x[here],
            y[here],
            c=FI[here],
            cmap=FI_COLOURS,
            norm=scale,
            marker=marker,
            s=size,
            edgecolors=rim_colour,
            linewidths=0.8,
            zorder=5,
        )
        _clip_to_plate(dots, axes, scene)
    bars[0].figure.colorbar(ScalarMappable(scale, FI_COLOURS), cax=bars[0], label="failure index FI")
    if not found.all():
        crosses = axes.plot(x[~found], y[~found], "x", color="0.35", ms=5, zorder=5, label="no value")
        _clip_to_plate(crosses[0], axes, scene)

    ranked = by_criticality(result)
    if ranked:
        _draw_crack(axes, scene, result, ranked[0], 0.06 * max(x1 - x0, y1 - y0))
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xlabel="x in mm", ylabel="y in mm")
    axes.locator_params(nbins=6)
    if axes.get_legend_handles_labels()[0]:
        # above the colour bar, too, however flat the plate
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.05, 0.87),
            bbox_transform=axes.figure.transFigure,
            ncols=3,
            frameon=False,
            borderaxespad=0.1,
            columnspacing=1.2,
            handletextpad=0.5,
        )


def _draw_stress(axes: Axes, bar: Axes, field: StressField, scene: Scene, view: View) -> None:
    ratio = field.sigma_I / scene.material.sigma_c
    ny, nx = ratio.shape
    left, right, bottom, top = field.extent
    if not np.isfinite(ratio).any():  # of pieces that the load carries away
        bar.set_axis_off()
        return
    rows, columns = (
        slice(
            max(int((low - start) / (end - start) * n), 0),
            max(int((high - start) / (end - start) * n), 0) + 1,
        )
        for low, high, start, end, n in ((*view[2:], bottom, top, ny), (*view[:2], left, right, nx))
    )
    image = axes.imshow(
        ratio,
        origin="lower",
        extent=field.extent,
        cmap=STRESS_COLOURS,
        vmin=0.0,
        # the few voxels on the rim, which are partly void, must not set the scale, nor must the tip of a crack
        vmax=max(float(np.nanquantile(ratio[rows, columns], 0.99)), 1e-9),
        interpolation="bilinear",
        zorder=1,
    )
    without = "" if field.cracked else " and without crack"
    label = rf"principal stress under the given load{without}, $\sigma_I / \sigma_c$"
    bar.figure.colorbar(image, cax=bar, label=label, orientation="horizontal", extend="max")


def _draw_crack(axes: Axes, scene: Scene, result: xr.Dataset, i: int, visible: float) -> None:
    point = np.array([result["x"].values[i], result["y"].values[i]])
    axes.plot(*point, "o", ms=14, mfc="none", mec=CRITICAL, mew=2, zorder=7, label="most critical")
    a_c = float(result["crack_length"].values[i])
    if not a_c > 0:
        return
    times = _enlargement(visible / a_c)
    direction = _direction(scene, result, i)
    label = f"crack, $a_c$ = {a_c:.3g} mm" + (f", drawn {times:g} times as long" if times > 1 else "")
    ends = np.stack([point, point + direction * a_c * times])
    axes.plot(*ends.T, color=CRITICAL, lw=3, zorder=6, solid_capstyle="butt", label=label)


def _direction(scene: Scene, result: xr.Dataset, i: int) -> Array:
    """Unit vector along which a crack starts at position i."""
    hole = int(result["hole"].values[i])
    if hole >= 0:
        return scene.outlines[hole].normals(result["arc_length"].values[i])
    before, tip = scene.part.tips[tip_at(scene, result, i)][-2:]
    return (tip - before) / np.linalg.norm(tip - before)


def _enlargement(wanted: float) -> float:
    """The round factor (1, 2, 5, 10, ...) next above the wanted one, at least 1."""
    if wanted <= 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * next(step for step in (1, 2, 5, 10) if step * power >= wanted * (1 - 1e-9)))


def _view(scene: Scene) -> View:
    """The notches and cracks with a margin, not beyond the part: x0, x1, y0, y1; or all that is held and loaded."""
    lower, upper = scene.box
    if scene.load is None:
        room = room_for_supports(scene)
        (x0, y0), (x1, y1) = lower - room, upper + room
        return float(x0), float(x1), float(y0), float(y1)
    points = np.concatenate(
        [
            *(outline.polygon(720) for outline in scene.outlines),
            *(crack.points for crack in scene.part.cracks),
        ]
    )
    # a notch that cuts the plate's edge goes on beyond it
    points = points[((points >= lower) & (points <= upper)).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.6 * float((high - low).max())
    rim = 0.02 * scene.size
    x0, y0 = np.maximum(low - margin, lower - rim)
    x1, y1 = np.minimum(high + margin, upper + rim)
    return float(x0), float(x1), float(y0), float(y1)


def _clip_to_plate(artist: Any, axes: Axes, scene: Scene) -> None:
    """A notch may cut the part's edge; what of its outline lies outside is no surface."""
    artist.set_clip_path(Polygon(scene.part.outer, transform=axes.transData))
