"""Moving pictures of a fracture process: as many frames as steps, and formats that can be written."""

import shutil
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from slmm.fracture import simulate
from slmm.pictures import fracture_animation
from slmm.pictures.fracture_animation import LAST, PER_SECOND, animate_fracture
from slmm.scene.gallery import tensile_plate


@pytest.fixture(scope="module")
def one_hole():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    return scene, simulate(scene, increment=16.0, errors=False)


@pytest.mark.parametrize("magnified", [0.0, 20.0])
def test_a_frame_for_each_step_and_one_that_stands(one_hole, tmp_path, magnified):
    scene, result = one_hole
    told = []
    animate_fracture(scene, result, tmp_path / "run.gif", magnified, lambda share, text: told.append(text))
    with Image.open(tmp_path / "run.gif") as moving:
        durations, frames = [], []
        for k in range(moving.n_frames):
            moving.seek(k)
            durations.append(moving.info["duration"])
            frames.append(np.asarray(moving.convert("RGB")))
    steps = result.sizes["step"]
    # frames that are the same are one that stands longer
    assert sum(durations) == (steps + LAST) * 1000 / PER_SECOND
    assert len(frames) == len(told) == steps + 1
    assert all((one != other).any() for one, other in pairwise(frames))
    assert [path.name for path in tmp_path.iterdir()] == ["run.gif"]


def test_other_formats_are_refused_before_anything_is_drawn(one_hole, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(ValueError, match=r"must end with \.gif or \.mp4"):
        animate_fracture(*one_hole, tmp_path / "run.png")
    with pytest.raises(ValueError, match=r"run\.mp4: ffmpeg, which writes \.mp4, is not installed"):
        animate_fracture(*one_hole, tmp_path / "run.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="needs ffmpeg")
def test_ffmpeg_writes_films(one_hole, tmp_path):
    animate_fracture(*one_hole, tmp_path / "run.mp4")
    assert (tmp_path / "run.mp4").read_bytes()[4:8] == b"ftyp"


def test_the_curve_comes_as_far_as_the_part_is_loaded(one_hole):
    """Up to the first step a straight line; after it with the drop on which the part stands."""
    _, result = one_hole
    figure = fracture_animation.Figure()
    for k, wanted in ((0, 2), (1, 3)):
        axes = figure.add_subplot()
        fracture_animation._draw_curve(axes, result, k)
        curve = axes.lines[-1].get_xydata()
        assert len(curve) == wanted
        assert curve[-1].tolist() == [float(result.u_load[k]), float(result.stiffness[k] * result.u_load[k])]
        assert curve[1].tolist() == pytest.approx([float(result.u[1]), float(result.F[1])])
