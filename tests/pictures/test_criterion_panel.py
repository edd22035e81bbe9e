"""Energy and stress at the most critical position, or why there are none."""

import numpy as np
import pytest
from made_up_result import made_up
from pictured import panel

from slmm.pictures.initiation import plot_initiation
from slmm.scene import gallery


def test_curves_meet_at_one(coarse):
    scene = gallery.circular_hole()
    axes = panel(plot_initiation(scene, made_up(scene)), "criterion")
    for line in axes.lines[:2]:
        assert np.interp(0.3, *line.get_data()) == pytest.approx(1.0, abs=0.01)


def test_without_curves(coarse):
    scene = gallery.circular_hole()
    plot_initiation(scene, made_up(scene).drop_vars(["a", "G_inc", "sigma_I"]))


def test_stress_that_is_infinite_at_the_mouth_is_drawn_from_there(coarse):
    scene = gallery.square_hole()
    line = panel(plot_initiation(scene, made_up(scene, 6)), "criterion").lines[1]
    assert np.isnan(line.get_ydata()[0]) and np.isfinite(line.get_ydata()[-1])


@pytest.mark.parametrize("method", ["rankine", "griffith"])
def test_methods_without_curves_say_so(method, coarse):
    scene = gallery.circular_hole()
    result = made_up(scene)
    for name in ("a", "G_inc", "sigma_I"):
        result[name] = result[name] * np.nan
    result["used_method"] = ("position", np.full(24, method))
    (text,) = panel(plot_initiation(scene, result), "criterion").texts
    assert text.get_text() == f"method {method} has no curves along a crack path"
