"""The failure index along the notches: markers, errors and what has no value."""

import numpy as np
import pytest
from made_up_result import REASON, made_up
from pictured import cracked, panel

from slmm.initiation.positions import find_positions
from slmm.pictures.initiation import plot_initiation
from slmm.pictures.position_marks import CORNER, SMOOTH, TIP
from slmm.scene import gallery


def test_reasons_stand_in_the_legend(coarse):
    scene = gallery.circular_hole()
    figure = plot_initiation(scene, made_up(scene, missing=(3, 4)))
    texts = [text.get_text() for text in panel(figure, "along notch").get_legend().get_texts()]
    assert f"no value: {REASON} (2)" in texts


def markers(figure, marker):
    """Places (n, 2) of a marker along the notch, and its lines' colours."""
    lines = [line for line in panel(figure, "along notch").lines if line.get_marker() == marker]
    # the ring around the most critical position and the legend's own are open
    lines = [line for line in lines if len(line.get_xdata()) and line.get_markerfacecolor() != "none"]
    return np.concatenate([line.get_xydata() for line in lines]) if lines else np.empty((0, 2))


def test_corners_and_tips_have_their_own_markers(coarse):
    scene = gallery.square_hole()
    figure = plot_initiation(scene, made_up(scene, 6))
    np.testing.assert_allclose(np.sort(markers(figure, CORNER)[:, 0]), scene.outlines[0].corners)
    assert len(markers(figure, SMOOTH)) + 4 == len(find_positions(scene, 6).s)
    assert len(markers(figure, TIP)) == 0


def test_tips_follow_after_the_notches(coarse):
    figure = plot_initiation(cracked(), made_up(cracked()))
    places = markers(figure, TIP)[:, 0]
    assert len(places) == 2
    end = cracked().outlines[0].length
    assert np.all(places > end) and np.all(places < panel(figure, "along notch").get_xlim()[1])
    assert "crack tips" in panel(figure, "along notch").get_xlabel()


def test_tips_alone_stand_over_their_crack(coarse):
    cracks = [{"points": [[0.0, y], [10.0, y]]} for y in (20.0, 60.0, 100.0)]
    scene = gallery.edge_crack(cracks=cracks)
    figure = plot_initiation(scene, made_up(scene).isel(position=[2, 0]))
    assert markers(figure, TIP)[:, 0].tolist() == [2, 0]
    assert panel(figure, "along notch").get_xticks().tolist() == [0, 1, 2]


def test_estimated_errors_are_bars(coarse):
    scene = gallery.circular_hole()
    result = made_up(scene)
    without = panel(plot_initiation(scene, result), "along notch")
    assert not any("error" in text.get_text() for text in legend_of(without))
    FI = result["failure_index"].values
    result["failure_index_error"] = ("position", np.where(np.arange(24) == 3, np.nan, 0.1 * FI))
    axes = panel(plot_initiation(scene, result), "along notch")
    assert f"estimated error, at most {0.1 * FI.max():.2g}" in [text.get_text() for text in legend_of(axes)]
    (container,) = axes.containers
    (bars,) = container[2]
    assert len(bars.get_segments()) == 23
    low, high = bars.get_segments()[0][:, 1]
    assert (low, high) == pytest.approx((0.9 * FI[0], 1.1 * FI[0]))


def legend_of(axes):
    return axes.get_legend().get_texts() if axes.get_legend() else []
