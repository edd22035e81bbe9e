"""The failure index over the arc length of the notches, then at the crack tips."""

from __future__ import annotations

from textwrap import shorten

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from slmm.initiation.summary import by_criticality, status_counts
from slmm.pictures.position_marks import CORNER, SMOOTH, TIP, joined, kinds_of_positions, tip_at
from slmm.pictures.style import CRITICAL, PALETTE
from slmm.scene.scene import Scene

Array = NDArray[np.float64]
#: markers of positions without value, by their reasons
NO_VALUE = "xv^+1*"


def draw_along_notch(axes: Axes, scene: Scene, result: xr.Dataset) -> None:
    """Failure index over arc length, one line per hole, then the crack tips; gaps without value, with the reasons."""
    FI, hole, s, status = (result[name].values for name in ("failure_index", "hole", "arc_length", "status"))
    found = np.isfinite(FI)
    kinds = kinds_of_positions(scene, result)
    holes, longest = np.unique(hole[hole >= 0]), 0.0
    colours = np.full(len(FI), "black", dtype=object)
    for h in holes:
        on_hole = np.flatnonzero(hole == h)
        colours[on_hole] = PALETTE[int(h) % len(PALETTE)]
        lines = joined(s[on_hole], FI[on_hole], scene.outlines[int(h)].length)
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
        place[tips] = [tip_at(scene, result, i) for i in tips.tolist()]
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
