import numpy as np
import pytest
from PIL import Image

from slmm.part.image import MIN_PIXELS_ACROSS, outlines_in_picture


def picture(path, hole, columns, rows, antialiased=True, dark=0, light=255):
    """Picture of the region where hole(x, y) < 0, in pixels from the lower left corner."""
    sub = 8 if antialiased else 1
    x = (np.arange(columns * sub) + 0.5) / sub
    y = rows - (np.arange(rows * sub) + 0.5) / sub
    covered = (hole(x[None, :], y[:, None]) < 0).reshape(rows, sub, columns, sub).mean(axis=(1, 3))
    Image.fromarray(np.round(light + (dark - light) * covered).astype(np.uint8)).save(path)
    return path


def disc(cx, cy, r):
    return lambda x, y: np.hypot(x - cx, y - cy) - r


def radius_and_curvature_error(outline, center, radius):
    s = np.linspace(0.0, outline.length, 3000)
    radii = np.hypot(*(outline.points(s) - center).T)
    return abs(radii.mean() - radius), np.abs(-radius * outline.curvatures(s) - 1).max()


@pytest.mark.parametrize(
    ("antialiased", "radius_error", "curvature_error"), [(True, 0.03, 0.01), (False, 0.1, 0.1)]
)
@pytest.mark.parametrize("center", [(30.0, 31.0), (30.3, 29.6), (29.2, 30.37)])
def test_circle_of_20_pixels(tmp_path, center, antialiased, radius_error, curvature_error):
    path = picture(tmp_path / "a.png", disc(*center, 20.0), 60, 62, antialiased)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 62.0)
    errors = radius_and_curvature_error(outline, center, 20.0)
    assert errors[0] < radius_error and errors[1] < curvature_error


def test_grain_of_a_scan_is_smoothed_away(tmp_path):
    path = picture(tmp_path / "a.png", disc(30.3, 29.6, 20.0), 60, 60)
    with Image.open(path) as clean:
        grey = np.asarray(clean) + np.random.default_rng(0).normal(0.0, 0.05 * 255, (60, 60))
    Image.fromarray(np.clip(grey, 0, 255).astype(np.uint8)).save(path)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 60.0)
    assert radius_and_curvature_error(outline, (30.3, 29.6), 20.0)[1] < 0.1


def test_pixel_size_scales_the_outline(tmp_path):
    path = picture(tmp_path / "a.png", disc(30, 20, 12.0), 60, 50)
    (one,) = outlines_in_picture(path, 1.0, 60.0, 50.0)
    (tenth,) = outlines_in_picture(path, 0.1, 6.0, 5.0)
    np.testing.assert_allclose(tenth.polygon(50), one.polygon(50) / 10, atol=1e-6)


def test_top_row_is_the_top_of_the_plate(tmp_path):
    path = picture(tmp_path / "a.png", disc(15, 40, 8.0), 60, 50)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 50.0)
    np.testing.assert_allclose(outline.polygon(100).mean(axis=0), (15, 40), atol=0.02)


def test_grey_levels_need_not_be_black_and_white_and_colours_are_read(tmp_path):
    path = picture(tmp_path / "a.png", disc(30, 30, 20.0), 60, 60, dark=70, light=200)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 60.0)
    assert radius_and_curvature_error(outline, (30, 30), 20.0)[0] < 0.03
    for mode in ("RGB", "RGBA", "LA", "P", "1", "I;16"):
        with Image.open(path) as grey:
            coloured = (
                Image.fromarray(np.asarray(grey).astype(np.uint16) * 257)
                if mode == "I;16"
                else grey.convert(mode, dither=Image.Dither.NONE)
            )
            coloured.save(tmp_path / "b.png")
        (outline,) = outlines_in_picture(tmp_path / "b.png", 1.0, 60.0, 60.0)
        assert radius_and_curvature_error(outline, (30, 30), 20.0)[0] < 0.1, mode


def test_dark_area_at_the_border_is_a_notch_that_leaves_the_plate(tmp_path):
    path = picture(tmp_path / "a.png", disc(0, 30, 15.0), 60, 60)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 60.0)
    points = outline.polygon(2000)
    assert points[:, 0].min() < -5
    inside = points[points[:, 0] > 2]
    np.testing.assert_allclose(np.hypot(*(inside - (0, 30)).T), 15.0, atol=0.15)


def test_several_holes_give_several_outlines(tmp_path):
    path = picture(
        tmp_path / "a.png", lambda x, y: np.minimum(disc(15, 15, 8)(x, y), disc(40, 40, 10)(x, y)), 60, 60
    )
    lengths = sorted(outline.length for outline in outlines_in_picture(path, 1.0, 60.0, 60.0))
    np.testing.assert_allclose(lengths, [16 * np.pi, 20 * np.pi], rtol=0.01)


@pytest.mark.parametrize(
    ("hole", "says"),
    [
        (lambda x, y: np.ones_like(x + y), "no hole"),
        (lambda x, y: -np.ones_like(x + y), "nothing but hole"),
        (
            lambda x, y: np.minimum(disc(30, 30, 15)(x, y), disc(5, 50, 2)(x, y)),
            r"\(5, 50\) mm.*pixels across",
        ),
        (lambda x, y: np.maximum(disc(30, 30, 25)(x, y), -disc(30, 30, 10)(x, y)), "loose piece"),
    ],
    ids=["no hole", "only hole", "speck", "island"],
)
def test_pictures_without_a_plausible_hole_are_refused(tmp_path, hole, says):
    with pytest.raises(ValueError, match=says):
        outlines_in_picture(picture(tmp_path / "a.png", hole, 60, 60), 1.0, 60.0, 60.0)
    assert MIN_PIXELS_ACROSS == 8


def test_size_of_plate_and_picture_must_agree(tmp_path):
    path = picture(tmp_path / "a.png", disc(30, 30, 10.0), 60, 60)
    with pytest.raises(ValueError, match=r"6 x 6 mm, but plate.height = 5"):
        outlines_in_picture(path, 0.1, 6.0, 5.0)


def test_huge_pictures_are_refused_by_their_header(tmp_path):
    path = tmp_path / "huge.png"
    for side in (8_000, 20_000):  # the second one is Pillow's decompression bomb
        Image.new("1", (8, 8)).save(path)
        data = bytearray(path.read_bytes())
        data[16:24] = side.to_bytes(4, "big") * 2
        path.write_bytes(_with_header_checksum(data))
        with pytest.raises(ValueError, match="50,000,000"):
            outlines_in_picture(path, 1.0, float(side), float(side))


def _with_header_checksum(png):
    import zlib

    png[29:33] = zlib.crc32(png[12:29]).to_bytes(4, "big")
    return bytes(png)


def test_what_is_no_picture_or_is_cut_off_is_refused(tmp_path):
    (tmp_path / "a.png").write_text("x, y")
    with pytest.raises(ValueError, match="not a readable picture"):
        outlines_in_picture(tmp_path / "a.png", 1.0, 60.0, 60.0)
    path = picture(tmp_path / "b.png", disc(30, 30, 10.0), 60, 60)
    path.write_bytes(path.read_bytes()[:-150])
    with pytest.raises(ValueError, match=r"decoded|readable"):
        outlines_in_picture(path, 1.0, 60.0, 60.0)
    frames = [Image.new("L", (60, 60), grey) for grey in (0, 255)]
    frames[0].save(tmp_path / "c.gif", save_all=True, append_images=frames[1:])
    with pytest.raises(ValueError, match="2 pages or frames"):
        outlines_in_picture(tmp_path / "c.gif", 1.0, 60.0, 60.0)
