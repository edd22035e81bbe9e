"""Pictures of made-up results: every gap and every odd case can be drawn."""

import pytest
from made_up_result import made_up
from pictured import cracked

from slmm.pictures.initiation import plot_initiation
from slmm.scene import gallery
from slmm.scene.scene import Scene


def two_holes() -> Scene:
    holes = [{"shape": "circle", "center": [x, 50.0], "radius": 10.0} for x in (25.0, 100.0 - 5.0)]
    return gallery.circular_hole(holes=holes)  # the second one cuts the plate's edge


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


def test_the_title_tells_which_method_gave_the_value(coarse):
    scene = gallery.circular_hole()
    result = made_up(scene)
    result.attrs["method"] = "auto"
    assert "(auto: slmm+ac)" in plot_initiation(scene, result).get_suptitle()
