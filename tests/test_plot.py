"""Pictures and summaries of made-up results: every gap and every odd case can be drawn."""

import json
import math

import numpy as np
import pytest
import xarray as xr

from slmm import gallery
from slmm.fem.plate_model import principal_stress
from slmm.plot import plot_initiation, principal_stress_field
from slmm.scene import Scene
from slmm.summary import as_json, by_criticality, verdict

REASON = "leaves the plate"


def made_up(scene: Scene, positions: int = 24, missing: tuple[int, ...] = ()) -> xr.Dataset:
    """A result with Kirsch's stresses and a straight G_inc, the form of `slmm.failure_indices`."""
    outlines = scene.outlines
    material = scene.material
    hole = np.repeat(np.arange(len(outlines)), positions)
    s = np.concatenate([outline.length * np.arange(positions) / positions for outline in outlines])
    xy = np.array([outlines[h].points(at) for h, at in zip(hole, s, strict=True)])
    kappa = np.array([outlines[h].curvatures(at) for h, at in zip(hole, s, strict=True)])
    radius = outlines[0].length / (2 * math.pi)
    theta = s / radius
    FI = np.abs(1.0 - 2.0 * np.cos(2 * theta)) / 2.2
    a = np.linspace(0.0, 1.0, 41) * np.ones((len(s), 1))
    lf, a_c = 1 / FI, np.full(len(s), 0.3)
    sigma_I = FI[:, None] * material.sigma_c * (1 + 2 * a_c[:, None] / radius - 2 * a / radius)
    G_inc = FI[:, None] ** 2 * material.G_c * a / a_c[:, None]
    status = np.full(len(s), "ok", dtype=object)
    for i in missing:
        FI[i] = lf[i] = a_c[i] = sigma_I[i] = G_inc[i] = np.nan
        status[i] = REASON
    one_each = {
        "x": (xy[:, 0], "mm"),
        "y": (xy[:, 1], "mm"),
        "arc_length": (s, "mm"),
        "hole": (hole, "1"),
        "curvature": (kappa, "1/mm"),
        "failure_index": (FI, "1"),
        "load_factor": (lf, "1"),
        "crack_length": (a_c, "mm"),
        "governed_by": (np.where(np.isfinite(FI), "stress and energy", "none"), "1"),
        "status": (status.astype(str), "1"),
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


def panel(figure, name):
    (axes,) = (axes for axes in figure.axes if axes.get_label() == name)
    return axes


@pytest.mark.parametrize(
    ("scene", "missing"),
    [
        (gallery.circular_hole(), ()),
        (gallery.circular_hole(), (3, 4, 5, 20)),
        (gallery.circular_hole(), tuple(range(24))),
        (gallery.circular_hole(radius=0.5), (0,)),
        (two_holes(), (23, 24, 47)),
    ],
    ids=["all", "gaps", "none", "small", "two"],
)
def test_three_panels(scene, missing, tmp_path):
    figure = plot_initiation(scene, made_up(scene, missing=missing))
    assert {axes.get_label() for axes in figure.axes} >= {"notch", "along notch", "criterion"}
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000


@pytest.mark.parametrize("suffix", ["pdf", "svg"])
def test_vector_formats(suffix, tmp_path):
    scene = gallery.circular_hole()
    plot_initiation(scene, made_up(scene)).savefig(tmp_path / f"picture.{suffix}")


def test_reasons_stand_in_the_legend():
    scene = gallery.circular_hole()
    figure = plot_initiation(scene, made_up(scene, missing=(3, 4)))
    texts = [text.get_text() for text in panel(figure, "along notch").get_legend().get_texts()]
    assert f"no value: {REASON} (2)" in texts


def test_curves_meet_at_one():
    scene = gallery.circular_hole()
    axes = panel(plot_initiation(scene, made_up(scene)), "criterion")
    for line in axes.lines[:2]:
        assert np.interp(0.3, *line.get_data()) == pytest.approx(1.0, abs=0.01)


def test_without_curves():
    scene = gallery.circular_hole()
    plot_initiation(scene, made_up(scene).drop_vars(["a", "G_inc", "sigma_I"]))


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
    assert verdict(made_up(scene, missing=tuple(range(24)))) == "No position has a failure index."
    closed = starts.assign(
        failure_index=starts["failure_index"] * 0, load_factor=starts["load_factor"] * np.inf
    )
    assert "however high the load" in verdict(closed)
