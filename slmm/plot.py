"""Pictures of results, ready to print."""

from __future__ import annotations

from textwrap import shorten
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from slmm.fem.voxel_element import plane_stress
from slmm.initiation.local_model import solve_local_model
from slmm.scene import Scene
from slmm.summary import by_criticality, status_counts

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
#: voxels across the picture of the stresses
BACKGROUND_VOXELS = 200


def plot_initiation(scene: Scene, result: xr.Dataset) -> Figure:
    """The notch, the failure index along it, and the coupled criterion at the most critical position.

    Parameters
    ----------
    scene : Scene
        What was computed.
    result : Dataset
        From `slmm.failure_indices`; the third panel needs ``curves=True``.

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
        along = figure.add_axes((0.60, 0.58, 0.38, 0.31), label="along notch")
        criterion = figure.add_axes((0.60, 0.09, 0.38, 0.33), label="criterion")
        draw_notch(notch, bars, scene, result)
        draw_along_notch(along, scene, result)
        draw_criterion(criterion, scene, result)
        ranked = by_criticality(result)
        FI = f"FI = {result['failure_index'].values[ranked[0]]:.3f}" if ranked else "no failure index"
        method = result.attrs.get("method", scene.analysis.method)
        figure.suptitle(f"{scene.title or 'Crack initiation'}: {FI} ({method})")
    return figure


def draw_notch(axes: Axes, bars: tuple[Axes, Axes], scene: Scene, result: xr.Dataset) -> None:
    """The notches coloured by failure index, on the principal stress in the plate, with the critical crack.

    ``bars`` take the colour bars of the failure index and of the stress.
    """
    x0, x1, y0, y1 = view = _view(scene)
    _draw_stress(axes, bars[1], scene, view)
    width, height = scene.plate.width, scene.plate.height
    axes.add_patch(Rectangle((0, 0), width, height, fill=False, ec="0.35", lw=1.0, zorder=1.5))
    for outline in scene.outlines:
        axes.add_patch(Polygon(outline.polygon(720), fc="white", ec="none", zorder=2))
        rim = axes.add_patch(Polygon(outline.polygon(720), fill=False, ec="0.35", lw=1.0, zorder=3))
        _clip_to_plate(rim, axes, scene)

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
    dots = axes.scatter(x[found], y[found], c=FI[found], cmap=FI_COLOURS, norm=scale, s=20, zorder=5)
    _clip_to_plate(dots, axes, scene)
    bars[0].figure.colorbar(dots, cax=bars[0], label="failure index FI")
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
    """Failure index over arc length, one line per hole; gaps where there is no value, with the reasons."""
    FI, hole, s, status = (result[name].values for name in ("failure_index", "hole", "arc_length", "status"))
    found = np.isfinite(FI)
    holes, longest = np.unique(hole), 1e-9
    for h in holes:
        colour = PALETTE[int(h) % len(PALETTE)]
        on_hole = np.flatnonzero(hole == h)
        lines = _joined(s[on_hole], FI[on_hole], scene.outlines[int(h)].length)
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=1.5))
        longest = max([longest, *s[on_hole], *(end for _, (end, _) in lines)])
        named = len(holes) > 1 and h < len(PALETTE)
        shown = on_hole[found[on_hole]]
        axes.plot(s[shown], FI[shown], "o", ms=4, color=colour, label=f"outline {h}" if named else None)
    reasons = status_counts(result.isel(position=~found))
    for marker, (reason, n) in zip("xv^sd*", reasons.items(), strict=False):
        here = ~found & (status == reason)
        label = f"no value: {shorten(reason, 50)} ({n})"
        axes.plot(s[here], np.zeros(n), marker, color="0.35", clip_on=False, label=label)
    ranked = by_criticality(result)
    if ranked:
        axes.plot(s[ranked[0]], FI[ranked[0]], "o", ms=10, mfc="none", mec=CRITICAL, mew=2)

    top = float(FI[found].max(initial=0.0)) or 1.0
    if top > 0.6:  # below, the line would only press the values down
        top = max(top, 1.0)
        axes.axhline(1.0, color="0.35", ls="--", lw=1.2)
        behind = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0}
        axes.text(longest, 1.0, "FI = 1", ha="right", va="center", color="0.35", bbox=behind)
    entries = len(axes.get_legend_handles_labels()[0])
    columns = 1 if reasons else 3
    room = min(0.55, 0.1 + 0.095 * -(-entries // columns))  # of the height, for the legend
    axes.set(xlim=(0, longest), ylim=(0, top / (1 - room)))
    axes.set(xlabel="arc length s in mm", ylabel="failure index FI")
    if entries:
        axes.legend(loc="upper left", ncols=columns, frameon=False, borderaxespad=0.1)


def draw_criterion(axes: Axes, scene: Scene, result: xr.Dataset) -> None:
    """Energy and stress at the most critical position under the critical load: they meet at 1 and a_c."""
    axes.set(xlabel="crack length a, depth η in mm", ylabel="share of critical value")
    ranked = by_criticality(result)
    critical = result.isel(position=ranked[0]) if ranked else None
    if critical is None or "G_inc" not in critical or not np.isfinite(critical["load_factor"]):
        reason = "no curves in the result" if "G_inc" not in result else "no crack starts at any position"
        axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
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
    axes.legend(loc="upper left", ncols=2, frameon=False, borderaxespad=0.1)


def principal_stress_field(scene: Scene, voxels: int) -> Array:
    """Maximum principal stress (ny, nx) in the middle of each voxel, MPa; row 0 lies at y = 0."""
    model = solve_local_model(scene, voxels, tol=1e-4)
    lower, upper = model.u[:-1], model.u[1:]
    along_x = (lower[:, 1:] + upper[:, 1:] - lower[:, :-1] - upper[:, :-1]) / (2 * model.hx)
    along_y = (upper[:, 1:] + upper[:, :-1] - lower[:, 1:] - lower[:, :-1]) / (2 * model.hy)
    E, nu = scene.material.plane_stress_equivalent
    direct, coupling, shear = (E * factor for factor in plane_stress(nu))
    s_xx = direct * along_x[..., 0] + coupling * along_y[..., 1]
    s_yy = coupling * along_x[..., 0] + direct * along_y[..., 1]
    s_xy = shear * (along_x[..., 1] + along_y[..., 0])
    return 0.5 * (s_xx + s_yy) + np.hypot(0.5 * (s_xx - s_yy), s_xy)


def _draw_stress(axes: Axes, bar: Axes, scene: Scene, view: tuple[float, float, float, float]) -> None:
    x0, x1, y0, y1 = view
    width, height = scene.plate.width, scene.plate.height
    fineness = BACKGROUND_VOXELS / max(x1 - x0, y1 - y0)
    ratio = principal_stress_field(scene, int(np.clip(width * height * fineness**2, 10_000, 1_000_000)))
    ratio /= scene.material.sigma_c
    ny, nx = ratio.shape
    rows, columns = (
        slice(max(int(low / side * n), 0), max(int(high / side * n), 0) + 1)
        for low, high, side, n in ((y0, y1, height, ny), (x0, x1, width, nx))
    )
    image = axes.imshow(
        ratio,
        origin="lower",
        extent=(0, width, 0, height),
        cmap=STRESS_COLOURS,
        vmin=0.0,
        # the few voxels on the rim, which are partly void, must not set the scale
        vmax=max(float(np.quantile(ratio[rows, columns], 0.99)), 1e-9),
        interpolation="bilinear",
        zorder=1,
    )
    label = r"principal stress under the given load, $\sigma_I / \sigma_c$"
    bar.figure.colorbar(image, cax=bar, label=label, orientation="horizontal", extend="max")


def _draw_crack(axes: Axes, scene: Scene, result: xr.Dataset, i: int, visible: float) -> None:
    point = np.array([result["x"].values[i], result["y"].values[i]])
    axes.plot(*point, "o", ms=14, mfc="none", mec=CRITICAL, mew=2, zorder=7, label="most critical")
    a_c = float(result["crack_length"].values[i])
    if not a_c > 0:
        return
    outline = scene.outlines[int(result["hole"].values[i])]
    tip = point + outline.normals(result["arc_length"].values[i]) * a_c * (
        times := _enlargement(visible / a_c)
    )
    label = f"crack, $a_c$ = {a_c:.3g} mm" + (f", drawn {times:g} times as long" if times > 1 else "")
    axes.plot(*np.stack([point, tip]).T, color=CRITICAL, lw=3, zorder=6, solid_capstyle="butt", label=label)


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


def _view(scene: Scene) -> tuple[float, float, float, float]:
    """The notches with a margin, not beyond the plate: x0, x1, y0, y1."""
    width, height = scene.plate.width, scene.plate.height
    points = np.concatenate([outline.polygon(200) for outline in scene.outlines])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.6 * float((high - low).max())
    rim = 0.02 * max(width, height)
    x0, y0 = np.maximum(low - margin, -rim)
    x1, y1 = np.minimum(high + margin, np.array([width, height]) + rim)
    return float(x0), float(x1), float(y0), float(y1)


def _clip_to_plate(artist: Any, axes: Axes, scene: Scene) -> None:
    """A notch may cut the plate's edge; what of its outline lies outside is no surface."""
    artist.set_clip_path(Rectangle((0, 0), scene.plate.width, scene.plate.height, transform=axes.transData))
