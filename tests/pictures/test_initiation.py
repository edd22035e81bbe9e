"""Pictures and summaries of made-up results: every gap and every odd case can be drawn."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from slmm.initiation.failure import failure_indices
from slmm.initiation.positions import find_positions
from slmm.initiation.summary import as_json, by_criticality, index_with_error, method_used, verdict
from slmm.mechanics.stress import principal_stress
from slmm.pictures import stress_field
from slmm.pictures.initiation import CORNER, SMOOTH, TIP, plot_initiation
from slmm.pictures.stress_field import principal_stress_field, stress_in_view
from slmm.scene import gallery
from slmm.scene.scene import Scene

REASON = "leaves the plate"
PLATE = Path(__file__).parents[1] / "data" / "plate.vtu"


def made_up(scene: Scene, positions: int = 24, missing: tuple[int, ...] = ()) -> xr.Dataset:
    """A result with Kirsch's stresses and a straight G_inc, the form of `slmm.failure_indices`."""
    where = find_positions(scene, positions)
    material = scene.material
    n = len(where.s)
    kappa = np.full(n, np.nan)
    for k, outline in enumerate(scene.outlines):
        kappa[where.hole == k] = outline.curvatures(where.s[where.hole == k])
    radius = scene.outlines[0].length / (2 * math.pi) if scene.outlines else 1.0
    # tips have no arc length, and at tips and corners the stress is infinite
    theta = np.nan_to_num(where.s) / radius
    FI = np.abs(1.0 - 2.0 * np.cos(2 * theta)) / 2.2
    a = np.linspace(0.0, 1.0, 41) * np.ones((n, 1))
    lf, a_c = 1 / FI, np.full(n, 0.3)
    sigma_I = FI[:, None] * material.sigma_c * (1 + 2 * a_c[:, None] / radius - 2 * a / radius)
    sigma_I[np.isfinite(where.corner), 0] = np.nan
    G_inc = FI[:, None] ** 2 * material.G_c * a / a_c[:, None]
    status = np.full(n, "ok", dtype=object)
    for i in missing:
        FI[i] = lf[i] = a_c[i] = sigma_I[i] = G_inc[i] = a[i] = np.nan
        status[i] = REASON
    one_each = {
        "x": (where.points[:, 0], "mm"),
        "y": (where.points[:, 1], "mm"),
        "arc_length": (where.s, "mm"),
        "hole": (where.hole, "1"),
        "curvature": (kappa, "1/mm"),
        "failure_index": (FI, "1"),
        "failure_index_error": (np.full(n, np.nan), "1"),
        "load_factor": (lf, "1"),
        "crack_length": (a_c, "mm"),
        "governed_by": (np.where(np.isfinite(FI), "stress and energy", "none"), "1"),
        "status": (status.astype(str), "1"),
        "used_method": (np.full(n, "slmm+ac"), "1"),
        "reason": (np.full(n, ""), "1"),
    }
    curves = {"a": (a, "mm"), "G_inc": (G_inc, "N/mm"), "sigma_I": (sigma_I, "MPa")}
    return xr.Dataset(
        {name: (("position",), values, {"units": units}) for name, (values, units) in one_each.items()}
        | {
            name: (("position", "crack"), values, {"units": units})
            for name, (values, units) in curves.items()
        },
        attrs={"title": scene.title, "method": "slmm+ac", "settings": '{"absolute": Infinity}'},
    )


def two_holes() -> Scene:
    holes = [{"shape": "circle", "center": [x, 50.0], "radius": 10.0} for x in (25.0, 100.0 - 5.0)]
    return gallery.circular_hole(holes=holes)  # the second one cuts the plate's edge


def cracked() -> Scene:
    """A hole and two cracks, the second one kinked."""
    cracks = [[[0.0, 30.0], [12.0, 33.0]], [[20.0, 0.0], [25.0, 8.0], [25.0, 16.0]]]
    return gallery.circular_hole(cracks=[{"points": points} for points in cracks])


def panel(figure, name):
    (axes,) = (axes for axes in figure.axes if axes.get_label() == name)
    return axes


@pytest.fixture
def coarse(monkeypatch):
    """The stress behind the notches on a coarse grid."""
    monkeypatch.setattr(stress_field, "ACROSS", 40)


@pytest.mark.parametrize(
    ("scene", "missing"),
    [
        (gallery.circular_hole(), ()),
        (gallery.circular_hole(), (3, 4, 5, 20)),
        (gallery.circular_hole(), tuple(range(24))),
        (gallery.circular_hole(radius=0.5), (0,)),
        (two_holes(), (23, 24, 47)),
        (gallery.square_hole(), ()),
        (gallery.square_hole(), (0,)),
        (gallery.v_notch(60.0), ()),
        (gallery.edge_crack(), ()),
        (gallery.edge_crack(), (0,)),
        (cracked(), ()),
        (cracked(), (24,)),
    ],
    ids=[
        "all",
        "gaps",
        "none",
        "small",
        "two",
        "corners",
        "corner missing",
        "edge notch",
        "crack",
        "crack missing",
        "hole and cracks",
        "tip missing",
    ],
)
def test_three_panels(scene, missing, tmp_path, coarse):
    figure = plot_initiation(scene, made_up(scene, missing=missing))
    assert {axes.get_label() for axes in figure.axes} >= {"notch", "along notch", "criterion"}
    figure.savefig(tmp_path / "picture.png", dpi=40)
    assert (tmp_path / "picture.png").stat().st_size > 5_000


@pytest.mark.parametrize("suffix", ["pdf", "svg"])
def test_vector_formats(suffix, tmp_path, coarse):
    scene = gallery.circular_hole()
    plot_initiation(scene, made_up(scene)).savefig(tmp_path / f"picture.{suffix}")


def test_reasons_stand_in_the_legend(coarse):
    scene = gallery.circular_hole()
    figure = plot_initiation(scene, made_up(scene, missing=(3, 4)))
    texts = [text.get_text() for text in panel(figure, "along notch").get_legend().get_texts()]
    assert f"no value: {REASON} (2)" in texts


def test_curves_meet_at_one(coarse):
    scene = gallery.circular_hole()
    axes = panel(plot_initiation(scene, made_up(scene)), "criterion")
    for line in axes.lines[:2]:
        assert np.interp(0.3, *line.get_data()) == pytest.approx(1.0, abs=0.01)


def test_without_curves(coarse):
    scene = gallery.circular_hole()
    plot_initiation(scene, made_up(scene).drop_vars(["a", "G_inc", "sigma_I"]))


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


def test_cracks_are_drawn_and_new_ones_go_straight_on(coarse):
    scene = cracked()
    result = made_up(scene)
    result["failure_index"][-1] = 5.0  # the tip of the kinked one
    axes = panel(plot_initiation(scene, result), "notch")
    drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
    np.testing.assert_array_equal(drawn["initial crack"], scene.cracks[0].points)
    (new,) = (xy for label, xy in drawn.items() if label.startswith("crack, "))
    np.testing.assert_allclose(new[0], [25.0, 16.0])
    np.testing.assert_allclose((new[1] - new[0]) / np.linalg.norm(new[1] - new[0]), [0.0, 1.0], atol=1e-12)


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


def test_the_title_tells_which_method_gave_the_value(coarse):
    scene = gallery.circular_hole()
    result = made_up(scene)
    result.attrs["method"] = "auto"
    assert "(auto: slmm+ac)" in plot_initiation(scene, result).get_suptitle()


def test_a_crack_s_faces_are_free_of_stress():
    """At 0.1 a above the face of an edge crack, next to nothing is left of the tension; without it, all."""
    scene = gallery.edge_crack(10.0)
    view = (2.0, 6.0, 60.5, 61.5)
    field = stress_in_view(scene, view)
    assert field.cracked
    assert field.extent == view
    assert np.all(np.abs(field.sigma_I) < 0.25 * 10.0)
    whole = gallery.edge_crack(
        10.0, cracks=[], holes=[{"shape": "circle", "center": [30, 20], "radius": 0.1}]
    )
    assert np.median(stress_in_view(whole, view).sigma_I) == pytest.approx(10.0, rel=0.01)


def test_around_a_crack_tip_the_stress_is_that_of_its_stress_intensity():
    """K_I of an edge crack in a strip; straight ahead, sigma_I = K_I/sqrt(2 pi r) (1 + O(r/a))."""
    scene = gallery.edge_crack(10.0)
    ratio = 10.0 / 40.0
    factor = 1.122 - 0.231 * ratio + 10.55 * ratio**2 - 21.71 * ratio**3 + 30.382 * ratio**4
    K = 10.0 * math.sqrt(math.pi * 10.0) * factor
    field = stress_in_view(scene, (10.0, 11.0, 59.5, 60.5))
    r = (np.arange(field.sigma_I.shape[1]) + 0.5) / field.sigma_I.shape[1]
    ahead = field.sigma_I[[99, 100]].mean(axis=0)
    near = (r > 0.2) & (r < 0.4)
    np.testing.assert_allclose(ahead[near], K / np.sqrt(2 * np.pi * r[near]), rtol=0.08)


def test_without_the_mesher_the_stress_is_that_without_cracks(monkeypatch):
    monkeypatch.setitem(sys.modules, "netgen", None)
    monkeypatch.setitem(sys.modules, "netgen.geom2d", None)
    scene = gallery.edge_crack()
    field = stress_in_view(scene, (0.0, 20.0, 50.0, 70.0))
    assert not field.cracked
    np.testing.assert_allclose(field.sigma_I, 10.0, rtol=1e-2)
    labels = [axes.get_xlabel() for axes in plot_initiation(scene, made_up(scene)).axes]
    assert any("without crack" in label for label in labels)


def plate_of_the_data() -> Scene:
    holes = [{"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}]
    plate = {"width": 20.0, "height": 20.0}
    return gallery.circular_hole(plate=plate, holes=holes, load={"strain": [0.0, 0.01, 0.0]})


def test_the_stress_of_given_displacements_is_theirs():
    scene = plate_of_the_data()
    view = (5.0, 15.0, 5.0, 15.0)
    field = stress_in_view(scene.with_(load={"stress": 1.0}), view, PLATE)
    own = stress_in_view(scene, view)
    # the same cells, of 0.05 mm; the finite element model's own are ten times as large at the hole
    assert field.sigma_I.shape == (200, 200) and own.sigma_I.shape == (400, 400)
    middle = 5.0 + (np.arange(200) + 0.5) / 20
    outside = np.hypot(*np.meshgrid(middle - 10, middle - 10)) > 2.2
    difference = np.abs(field.sigma_I - own.sigma_I[100:300, 100:300])[outside]
    assert np.median(difference) < 0.005 * 29.6
    assert np.max(difference) < 0.1 * 3 * 29.6
    assert np.isnan(field.sigma_I[100, 100])  # in the hole


def test_a_result_on_given_displacements_is_not_drawn_on_another_stress(coarse):
    scene = plate_of_the_data()
    result = failure_indices(scene, "slmm+ac", 8, curves=True, displacements=PLATE)
    assert not panel(plot_initiation(scene, result), "notch").images
    assert panel(plot_initiation(scene, result, PLATE), "notch").images


def test_plain_plate_has_the_stress_of_hooke():
    scene = gallery.circular_hole(radius=0.1, load={"stress": 10.0})
    field = principal_stress_field(scene, 2500)
    assert np.median(field) == pytest.approx(10.0, rel=2e-3)
    assert field[0, 0] == pytest.approx(principal_stress(np.array([[0.0, 10.0, 0.0]]))[0], rel=2e-3)


def test_json_is_strict_and_complete():
    scene = gallery.circular_hole()
    result = made_up(scene, missing=(1,))
    result["load_factor"][2] = np.inf
    content = json.loads(as_json(result), parse_constant=pytest.fail)
    assert content["settings"] == {"absolute": None}
    assert len(content["positions"]) == 24
    assert content["positions"][1]["failure_index"] is None
    assert content["positions"][1]["status"] == REASON
    assert content["positions"][2]["load_factor"] is None
    assert content["most_critical"]["position"] == by_criticality(result)[0]
    assert content["status_counts"] == {"ok": 23, REASON: 1}


def test_verdicts():
    scene = gallery.circular_hole()
    starts = made_up(scene)
    assert "A crack starts there under this load" in verdict(starts)
    holds = starts.assign(failure_index=starts["failure_index"] / 2, load_factor=starts["load_factor"] * 2)
    assert "No crack starts under this load" in verdict(holds)
    nothing = verdict(made_up(scene, missing=tuple(range(24))))
    assert nothing.startswith("No position has a failure index. No verdict: 24 positions of 24 have no value")
    closed = starts.assign(
        failure_index=starts["failure_index"] * 0, load_factor=starts["load_factor"] * np.inf
    )
    assert "however high the load" in verdict(closed)


def test_the_verdict_of_a_crack_tip_and_of_an_estimated_error():
    scene = gallery.edge_crack()
    result = made_up(scene)
    result["failure_index"][0], result["load_factor"][0], result["crack_length"][0] = 1.25, 0.8, 0.0
    result["failure_index_error"][0] = 0.0123
    says = verdict(result)
    assert "position 0, a crack tip, at (10.00, 60.00) mm, failure index 1.250 ± 0.012, load" in says
    assert "The crack goes on there" in says
    assert "critical crack length" not in says  # Griffith's criterion knows none
    content = json.loads(as_json(result), parse_constant=pytest.fail)
    assert content["most_critical"]["arc_length"] is None
    assert content["most_critical"]["reason"] == ""


@pytest.mark.parametrize(
    ("error", "text"), [(np.nan, "0.818"), (0.2, "0.818 ± 0.200"), (0.0002, "0.8182 ± 0.0002")]
)
def test_an_index_has_the_digits_that_its_error_leaves(error, text):
    result = made_up(gallery.circular_hole()).isel(position=[1])
    result["failure_index"][0], result["failure_index_error"][0] = 0.81818, error
    assert index_with_error(result, 0) == text


def test_the_method_that_was_used_is_named_where_it_is_another_one():
    result = made_up(gallery.circular_hole())
    assert method_used(result, 0) == "slmm+ac"
    result.attrs["method"] = "auto"
    assert method_used(result, 0) == "auto: slmm+ac"
