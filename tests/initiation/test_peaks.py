"""The largest index along an outline is found, wherever the positions lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import slmm
from slmm.initiation.peaks import LEAST_RISE, find_peaks, positions_at, tops
from slmm.initiation.positions import find_positions, positions_on
from slmm.scene import gallery

CASES = "../shared/cases"


def on_circle(n: int):
    scene = gallery.circular_hole()
    return scene, find_positions(scene, n)


@given(st.integers(30, 80), st.floats(0, 2 * np.pi), st.floats(0.5, 4))
def test_the_parabola_finds_the_rise_of_a_smooth_peak(n, phase, sharpness):
    scene, where = on_circle(n)
    angle = where.s / 20.0
    index = np.exp(-sharpness * (1 - np.cos(angle - phase)))
    peaks = find_peaks(scene, where, index, 0 * index, np.full(n, 100.0))
    missed = 1 - index.max()
    if missed < 7e-4:
        assert all(peak.rise < 2e-3 for peak in peaks)
        return
    (peak, *_) = peaks
    assert peak.row == index.argmax()
    assert peak.rise == pytest.approx(missed, rel=0.3, abs=2e-4)
    nearest = np.abs(np.angle(np.exp(1j * (peak.wanted / 20.0 - phase)))).min()
    assert nearest < 0.2 * 2 * np.pi / n


def test_nothing_is_wanted_where_the_estimate_covers_the_rise():
    scene, where = on_circle(30)
    index = 1 - 0.2 * (1 - np.cos(where.s / 20.0 - 0.1))
    assert find_peaks(scene, where, index, np.full(30, 0.01), np.full(30, 1.0)) == []
    assert len(find_peaks(scene, where, index, np.full(30, 1e-5), np.full(30, 1.0))) == 1
    assert find_peaks(scene, where, 0 * index, 0 * index, np.full(30, np.nan)) == []


def test_small_peaks_beside_a_large_one_do_not_matter():
    scene, where = on_circle(40)
    angle = where.s / 20.0
    index = np.exp(-20 * (1 - np.cos(angle - 0.05))) + 0.3 * np.exp(-20 * (1 - np.cos(angle - 3.0)))
    peaks = find_peaks(scene, where, index, 0 * index, np.full(40, 100.0))
    assert [peak.row for peak in peaks] == [int(index.argmax())]


def test_bends_between_positions_are_looked_at_unless_the_crack_is_longer():
    scene = gallery.circular_hole(
        holes=[
            {
                "shape": "rectangle",
                "center": [50.0, 50.0],
                "size": [40.0, 40.0],
                "corner_radius": 1.0,
            }
        ]
    )
    where = find_positions(scene, 20)
    index = np.where(np.abs(scene.outlines[0].curvatures(where.s)) > 0.5, 1.0, 0.2)
    wanted, s = positions_at(find_peaks(scene, where, index, 0.1 * index, np.full(len(index), 0.1)), where)
    assert len(s) >= 16 and (wanted == 0).all()
    assert (np.abs(scene.outlines[0].curvatures(s)) > 0.3).sum() >= 16
    assert find_peaks(scene, where, index, 9 * index, np.full(len(index), 20.0)) == []


@pytest.mark.parametrize("positions", [8])
def test_the_peak_of_a_fillet_is_found_near_its_tangent_point(positions):
    scene = slmm.read_scene(f"{CASES}/12-bend-sampling/a.toml")
    result = slmm.failure_indices(scene, positions=positions)
    worst = result.isel(position=result.failure_index.argmax("position"))
    # full FEA in steps of 2.3 degrees along the fillet: 1.1124 at most, 1.097 at (30.07, 69.37)
    assert float(worst.failure_index) == pytest.approx(1.1126, abs=float(worst.failure_index_error) + 1e-3)
    assert float(worst.failure_index_error) < 0.01


def test_given_points_and_the_published_way_stay_as_they_are():
    scene = slmm.read_scene(f"{CASES}/12-bend-sampling/a.toml")
    at = scene.with_(analysis={"points": [[30.07, 69.37]], "method": "slmm+ac"})
    assert slmm.failure_indices(at).sizes["position"] == 1
    published = slmm.failure_indices(scene, "slmm+ac", settings="published")
    assert published.sizes["position"] == len(find_positions(scene).s)


def test_positions_stay_in_order_and_tips_behind_them():
    scene = slmm.read_scene(f"{CASES}/12-bend-sampling/a.toml")
    result = slmm.failure_indices(scene, "slmm+ac", positions=12)
    assert result.sizes["position"] > 16
    assert (np.diff(result.arc_length.values) > 0).all()
    outline = scene.outlines[0]
    np.testing.assert_allclose(
        outline.points(result.arc_length.values), np.column_stack([result.x, result.y]), atol=1e-9
    )


def test_a_peak_between_positions_of_unequal_distances_is_looked_for():
    # of a rounded rectangle: the parabola rises by 1e-4, the index by 1e-2
    scene = gallery.circular_hole()
    s = np.array([0.0, 40.0, 41.630, 41.918, 42.893, 90.0])
    where = positions_on(scene, np.zeros(6, int), s, np.full(6, -1))
    index = np.array([0.01, 0.1, 0.6221, 0.6370, 0.4223, 0.1])
    (peak,) = find_peaks(scene, where, index, np.full(6, 0.0036), np.full(6, 0.1))
    assert peak.row == 3
    assert peak.wanted == pytest.approx([42.206], abs=1e-3)
    assert find_peaks(scene, where, index, np.full(6, 0.2), np.full(6, 0.1)) == []
    # a crack longer than the intervals sees no peak in them
    assert find_peaks(scene, where, index, np.full(6, 0.0036), np.full(6, 20.0)) == []


def test_beside_a_corner_that_shear_turns_the_worst_crack_from_positions_are_added():
    # a sharp notch under shear: at the corner, along its bisector, the index is 1.27, on its flank 1.50
    scene = gallery.circular_hole(
        holes=[
            {"shape": "rectangle", "center": [50.0, 50.0], "size": [40.0, 30.0], "corner_radius": 0.0},
        ]
    )
    where = find_positions(scene, 40)
    corner = np.flatnonzero(np.isfinite(where.corner))[1]
    away = (where.s - where.s[corner])[:, None]
    index = np.exp(-np.abs(away[:, 0]) / 3.0) * np.where(away[:, 0] > 0, 1.0, 0.3)
    index[corner] = 0.8
    peaks = find_peaks(scene, where, index, np.full(len(index), 0.01), np.full(len(index), 1.0))
    wanted = np.concatenate([peak.wanted for peak in peaks])
    next_to = where.s[corner + 1] - where.s[corner]
    assert (where.s[corner] + 0.25 * next_to) == pytest.approx(
        wanted[np.abs(wanted - where.s[corner]).argmin()]
    )
    # the other flank is far below, and a crack as long as the distance sees nothing there
    assert (wanted > where.s[corner]).all()
    long = find_peaks(scene, where, index, np.full(len(index), 0.01), np.full(len(index), 60 * next_to))
    assert not any(len(peak.wanted) for peak in long if peak.row == corner + 1)


def test_where_a_notch_leaves_the_plate_the_index_may_rise_to_the_edge():
    scene = gallery.circular_hole(
        holes=[{"shape": "circle", "center": [50.0, 0.0], "radius": 20.0}], load={"strain": [0.0, 0.0, 0.1]}
    )
    where = find_positions(scene, 30)
    height = where.points[:, 1]
    assert 0 < height.min() < 2
    right = where.points[:, 0] > 50
    index = np.where(right, (height + 0.01) ** -0.3, 0.1)
    peaks = find_peaks(scene, where, index, np.zeros(len(index)), np.full(len(index), 0.1))
    wanted = np.concatenate([peak.wanted for peak in peaks])
    (outline,) = scene.outlines
    x, y = outline.points(wanted).T
    # a quarter of the way from the lowest position to the edge
    assert y.min() == pytest.approx(0.25 * height[right].min(), rel=0.05)
    assert x[y.argmin()] > 50
    # none where the crack is far longer than what is left
    long = find_peaks(scene, where, index, np.zeros(len(index)), np.full(len(index), 200.0))
    assert all(
        outline.points(peak.wanted)[:, 1].min() > 0.3 * height.min() for peak in long if len(peak.wanted)
    )


@given(st.floats(0, 1), st.floats(0.8, 3))
def test_a_peak_before_a_steep_fall_is_found(phase, width):
    """As at the end of a bend of random scene 182: the parabola of three positions fits, the peak is 8 % higher."""
    scene, where = on_circle(50)
    step = where.s[1] - where.s[0]
    top = where.s[20] + phase * step

    def at(s):
        u = (top - s) / (width * step)
        return np.exp(1 - u - np.exp(-u)) if np.ndim(u) else float(np.exp(1 - u - np.exp(-u)))

    s = where.s
    for _ in range(8):
        here = positions_on(scene, np.zeros(len(s), int), s, np.full(len(s), -1))
        index = np.array([at(x) for x in s])
        peaks = find_peaks(scene, here, index, 0.01 * index, np.full(len(s), 0.01))
        if not peaks:
            break
        s = np.sort(np.append(s, np.concatenate([peak.wanted for peak in peaks])))
    assert not peaks
    assert len(s) < 62
    assert index.max() > 0.99


def test_values_of_a_random_scene_whose_peak_a_parabola_does_not_see():
    scene = gallery.circular_hole()
    s = 40.0 + np.array([-0.33, -0.165, 0.0, 0.0991, 0.166, 0.4])
    where = positions_on(scene, np.zeros(6, int), s, np.full(6, -1))
    index = np.array([0.511, 0.5618, 0.6240, 0.6016, 0.1851, 0.05])
    (peak,) = find_peaks(scene, where, index, np.full(6, 0.004), np.full(6, 0.01))
    # full FEA: 0.675, 0.047 mm farther
    assert peak.row == 2
    assert np.abs(peak.wanted - 40.047).min() < 0.02
    assert 0.624 + peak.rise == pytest.approx(0.675, abs=0.01)
    assert find_peaks(scene, where, index, np.full(6, 0.004), np.full(6, 1.0)) == []


def test_the_top_between_positions_is_as_high_as_the_least_error_says():
    """Random scene 269: 0.9056 +- 0.0002, and 0.9059 between two positions."""
    result = slmm.failure_indices(gallery.circular_hole(), "full-fea", positions=8)
    top = int(result.failure_index.argmax())
    assert result.failure_index_error[top] >= LEAST_RISE * result.failure_index[top] * (1 - 1e-12)
    scene = gallery.circular_hole()
    where = find_positions(scene, 12)
    index = np.cos(2 * np.arange(12) * 2 * np.pi / 12 + 0.1) + 2
    assert tops(where, index).tolist() == [0, 6]


def test_a_singular_rise_towards_a_held_edge_is_followed_from_far_below_the_largest():
    """Random scene 148: 0.93 at the position next to the edge, 2.93 at the edge, 2.60 elsewhere."""
    scene = gallery.circular_hole(
        holes=[{"shape": "circle", "center": [50.0, 0.0], "radius": 20.0}], load={"strain": [0.0, 0.0, 0.1]}
    )
    where = find_positions(scene, 30)
    height = where.points[:, 1]
    right = where.points[:, 0] > 50
    lowest = height[right].min()
    index = np.where(right, 0.35 * (lowest / height) ** 2, 0.1)
    index[np.argmax(height)] = 1.0
    (outline,) = scene.outlines

    def wanted(crack_length):
        peaks = find_peaks(scene, where, index, np.zeros(len(index)), np.full(len(index), crack_length))
        points = outline.points(np.concatenate([peak.wanted for peak in peaks]))
        return points[(points[:, 0] > 50) & (points[:, 1] < lowest), 1]

    assert wanted(0.1 * lowest).min() < 0.3 * lowest
    # over a length of its own the criterion looks in any case
    assert len(wanted(4 * lowest)) == 0
