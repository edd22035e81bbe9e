"""Pictures of results, ready to print."""

from __future__ import annotations

from textwrap import shorten
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from slmm.initiation.summary import by_criticality, index_with_error, method_used, status_counts
from slmm.pictures.stress_field import StressField, View, stress_in_view
from slmm.scene.scene import Scene

Array = NDArray[np.float64]

STYLE = {
    "font.size": 11,
    "axes.labelsize": 12,
    "axes.titlesize": 12,
    "figure.titlesize": 13,
    "legend.fontsize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.fonttype": "none",  # text stays text
    "pdf.fonttype": 42,
}
#: perceptually uniform and safe for the colour-blind, legible on the grey of the stresses
FI_COLOURS = "plasma"
#: the light half of the greys, on which the colours stand out
STRESS_COLOURS = ListedColormap(matplotlib.colormaps["Greys"](np.linspace(0.0, 0.6, 256)))
#: Okabe and Ito's palette, safe for the colour-blind
PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
CRITICAL = "#D55E00"
#: positions farther apart than this share of the outline are not joined by a line
JOINED = 1 / 6
#: markers of positions on a smooth outline, at its corners and at the tips of cracks, and of those without value
SMOOTH, CORNER, TIP = "o", "D", "s"
NO_VALUE = "xv^+1*"


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
    width, height = scene.plate.width, scene.plate.height
    axes.add_patch(Rectangle((0, 0), width, height, fill=False, ec="0.35", lw=1.0, zorder=1.5))
    for outline in scene.outlines:
        axes.add_patch(Polygon(outline.polygon(720), fc="white", ec="none", zorder=2))
        rim = axes.add_patch(Polygon(outline.polygon(720), fill=False, ec="0.35", lw=1.0, zorder=3))
        _clip_to_plate(rim, axes, scene)
    for k, crack in enumerate(scene.part.cracks):
        label = "initial crack" if k == 0 else None
        axes.plot(*crack.points.T, color="black", lw=1.8, zorder=3.5, label=label)

    FI, hole, s = (result[name].values for name in ("failure_index", "hole", "arc_length"))
    found = np.isfinite(FI)
    scale = Normalize(0.0, float(FI[found].max(initial=0.0)) or 1.0)
    for h, outline in enumerate(scene.outlines):
        on_hole = np.flatnonzero(hole == h)
        for (s_0, FI_0), (s_1, FI_1) in _joined(s[on_hole], FI[on_hole], outline.length):
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
    for marker, of_kind in _kinds(scene, result).items():
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


def draw_along_notch(axes: Axes, scene: Scene, result: xr.Dataset) -> None:
    """Failure index over arc length, one line per hole, then the crack tips; gaps without value, with the reasons."""
    FI, hole, s, status = (result[name].values for name in ("failure_index", "hole", "arc_length", "status"))
    found = np.isfinite(FI)
    kinds = _kinds(scene, result)
    holes, longest = np.unique(hole[hole >= 0]), 0.0
    colours = np.full(len(FI), "black", dtype=object)
    for h in holes:
        on_hole = np.flatnonzero(hole == h)
        colours[on_hole] = PALETTE[int(h) % len(PALETTE)]
        lines = _joined(s[on_hole], FI[on_hole], scene.outlines[int(h)].length)
        axes.add_collection(LineCollection(lines, colors=colours[on_hole[0]], linewidths=1.5))
        longest = max([longest, *s[on_hole], *(end for _, (end, _) in lines)])
    place = _places(axes, scene, result, longest)
    top = max(float(FI[found].max(initial=0.0)), _draw_errors(axes, result, place)) or 1.0
    for h in [*holes, -1]:
        for marker, of_kind in kinds.items():
            here = found & of_kind & (hole == h)
            if here.any():
                named = len(holes) > 1 and 0 <= h < len(PALETTE) and marker == SMOOTH
                label = f"outline {h}" if named else None
                ms = 4 if marker == SMOOTH else 6
                axes.plot(
                    place[here], FI[here], marker, ms=ms, color=colours[here][0], label=label, clip_on=False
                )
    for marker, word in ((CORNER, "corner"), (TIP, "crack tip")):
        # on an axis of their own the tips need no name
        if (found & kinds[marker]).any() and longest > 0:
            axes.plot([], [], marker, ms=6, color="0.35", mfc="none", label=word)
    reasons = status_counts(result.isel(position=~found))
    for marker, (reason, n) in zip(NO_VALUE, reasons.items(), strict=False):
        here = ~found & (status == reason)
        label = f"no value: {shorten(reason, 50)} ({n})"
        axes.plot(place[here], np.zeros(n), marker, color="0.35", clip_on=False, label=label)
    ranked = by_criticality(result)
    if ranked:
        at = place[ranked[0]], FI[ranked[0]]
        axes.plot(*at, "o", ms=10, mfc="none", mec=CRITICAL, mew=2, clip_on=False, zorder=4)
    if top > 0.6:  # below, the line would only press the values down
        top = max(top, 1.0)
        axes.axhline(1.0, color="0.35", ls="--", lw=1.2)
        beside = axes.get_yaxis_transform()
        axes.text(1.01, 1.0, "FI = 1", transform=beside, ha="left", va="center", color="0.35")
    entries = len(axes.get_legend_handles_labels()[0])
    columns = 1 if reasons else 3
    room = min(0.55, 0.1 + 0.095 * -(-entries // columns))  # of the height, for the legend
    axes.set(ylim=(0, top / (1 - room)), ylabel="failure index FI")
    if entries:
        axes.legend(loc="upper left", ncols=columns, frameon=False, borderaxespad=0.1)


def _places(axes: Axes, scene: Scene, result: xr.Dataset, longest: float) -> Array:
    """Where the positions stand on the axis along the notch: tips follow after the outlines, or are alone."""
    place = result["arc_length"].values.copy()
    tips = np.flatnonzero(result["hole"].values < 0)
    if not longest > 0:
        place[tips] = [_tip_at(scene, result, i) for i in tips.tolist()]
        n = max(len(scene.part.tips), 1)
        axes.set(xlim=(-0.5, n - 0.5), xlabel="crack tip", xticks=np.arange(0, n, -(-n // 20)))
        return place
    place[tips] = longest * (1.05 + 0.04 * np.arange(len(tips)))
    axes.set(xlim=(0, max([longest, *(place[tips] + 0.03 * longest)])))
    axes.set_xlabel("arc length s in mm" + (", then the crack tips" if len(tips) else ""))
    if len(tips):
        axes.axvline(1.02 * longest, ymax=0.78, color="0.35", lw=0.8)  # the legend stands above
        axes.set_xticks([tick for tick in axes.get_xticks() if 0 <= tick <= longest])
    return place


def _draw_errors(axes: Axes, result: xr.Dataset, place: Array) -> float:
    """Bars of the estimated errors; their upper end, 0 where there are none."""
    FI, error = result["failure_index"].values, result["failure_index_error"].values
    known = np.isfinite(FI) & np.isfinite(error)
    if not known.any():
        return 0.0
    label = f"estimated error, at most {error[known].max():.2g}"
    axes.errorbar(
        place[known],
        FI[known],
        error[known],
        fmt="none",
        ecolor="0.35",
        elinewidth=1.0,
        capsize=2.5,
        label=label,
    )
    return float(np.max(FI[known] + error[known]))


def draw_criterion(axes: Axes, scene: Scene, result: xr.Dataset) -> None:
    """Energy and stress at the most critical position under the critical load: they meet at 1 and a_c."""
    axes.set(xlabel="crack length a, depth η in mm", ylabel="share of critical value")
    ranked = by_criticality(result)
    critical = result.isel(position=ranked[0]) if ranked else None
    reason = _no_curves(result, critical)
    if critical is None or reason:
        axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
        axes.set_axis_off()
        return
    lf, a_c = float(critical["load_factor"]), float(critical["crack_length"])
    a, G_inc, sigma_I = (critical[name].values for name in ("a", "G_inc", "sigma_I"))
    material = scene.material
    # energy grows with the square of the load, stress with the load
    energy, stress = lf**2 * G_inc / material.G_c, lf * sigma_I / material.sigma_c
    longest = float(np.nanmax(a))
    end = min(longest, 4 * a_c) if a_c > 0 else longest
    at = np.linspace(0.0, end, 400)
    shown = []
    for values, label, colour, dashes in (
        (energy, r"energy, $lf^2\, G_{inc}(a) / G_c$", PALETTE[0], "-"),
        (stress, r"stress, $lf\, \sigma_I(\eta) / \sigma_c$", PALETTE[2], "--"),
    ):
        known = np.isfinite(a) & np.isfinite(values)
        if known.any():
            curve = np.interp(at, a[known], values[known], left=np.nan, right=np.nan)
            axes.plot(at, curve, dashes, color=colour, lw=1.8, label=label)
            shown.append(curve)
    axes.axhline(1.0, color="0.35", lw=0.8)
    if np.isfinite(a_c):
        axes.plot([a_c, a_c], [0.0, 1.0], color=CRITICAL, lw=1.0, ls=":")
        axes.plot(a_c, 1.0, "o", ms=10, mfc="none", mec=CRITICAL, mew=2, label=f"$a_c$ = {a_c:.3g} mm")
    top = float(np.clip(np.nanmax(shown), 1.5, 3.0))
    axes.set(xlim=(0, end), ylim=(0, 1.4 * top))
    axes.set_title(f"load factor {lf:.3f}, governed by {critical['governed_by'].values}", loc="left")
    axes.legend(loc="upper right", ncols=2, frameon=False, borderaxespad=0.1)


def _no_curves(result: xr.Dataset, critical: xr.Dataset | None) -> str:
    """Why there are no curves to show; empty where there are."""
    if "G_inc" not in result:
        return "no curves in the result"
    if critical is None or not np.isfinite(critical["load_factor"]):
        return "no crack starts at any position"
    if not np.isfinite(critical["a"]).any():
        return f"method {critical['used_method'].values} has no curves along a crack path"
    return ""


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


def _kinds(scene: Scene, result: xr.Dataset) -> dict[str, NDArray[np.bool_]]:
    """By their markers, which positions are on a smooth outline, at a corner or at the tip of a crack."""
    hole, s = result["hole"].values, result["arc_length"].values
    corner = np.zeros(len(s), dtype=bool)
    for h, outline in enumerate(scene.outlines):
        corner[hole == h] = outline.corner_at(s[hole == h]) >= 0
    tip = hole < 0
    return {SMOOTH: ~corner & ~tip, CORNER: corner, TIP: tip}


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
    before, tip = scene.part.tips[_tip_at(scene, result, i)][-2:]
    return (tip - before) / np.linalg.norm(tip - before)


def _tip_at(scene: Scene, result: xr.Dataset, i: int) -> int:
    """The crack tip that is position i."""
    tips = np.array([line[-1] for line in scene.part.tips])
    return int(np.linalg.norm(tips - [result["x"].values[i], result["y"].values[i]], axis=1).argmin())


def _enlargement(wanted: float) -> float:
    """The round factor (1, 2, 5, 10, ...) next above the wanted one, at least 1."""
    if wanted <= 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * next(step for step in (1, 2, 5, 10) if step * power >= wanted * (1 - 1e-9)))


def _joined(s: Array, values: Array, length: float) -> list[list[tuple[float, float]]]:
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


def _view(scene: Scene) -> View:
    """The notches and cracks with a margin, not beyond the plate: x0, x1, y0, y1."""
    plate = np.array([scene.plate.width, scene.plate.height])
    points = np.concatenate(
        [
            *(outline.polygon(720) for outline in scene.outlines),
            *(crack.points for crack in scene.part.cracks),
        ]
    )
    # a notch that cuts the plate's edge goes on beyond it
    points = points[((points >= 0) & (points <= plate)).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.6 * float((high - low).max())
    rim = 0.02 * float(plate.max())
    x0, y0 = np.maximum(low - margin, -rim)
    x1, y1 = np.minimum(high + margin, plate + rim)
    return float(x0), float(x1), float(y0), float(y1)


def _clip_to_plate(artist: Any, axes: Axes, scene: Scene) -> None:
    """A notch may cut the plate's edge; what of its outline lies outside is no surface."""
    artist.set_clip_path(Rectangle((0, 0), scene.plate.width, scene.plate.height, transform=axes.transData))
