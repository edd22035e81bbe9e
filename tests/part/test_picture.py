import numpy as np
import pytest
from PIL import Image
from scipy import ndimage
from skimage.draw import polygon2mask

from slmm.initiation.outline_error import FARTHEST_OF_BEND
from slmm.part.image import outlines_in_picture
from slmm.part.picture import grey_values
from slmm.scene.scene import SceneError, read_scene


def disc(size=60, center=(30, 30), radius=15):
    x, y = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5)
    return np.hypot(x - center[0], y - center[1]) < radius


def save(path, dark, **options):
    Image.fromarray(np.where(dark, 0, 255).astype(np.uint8)).save(path, **options)
    return path


@pytest.mark.parametrize(
    "dark",
    [~disc(), ~disc(center=(58, 30)), ~(disc(radius=8) | disc(center=(12, 12), radius=6))],
    ids=["hole", "notch", "two holes"],
)
def test_inverted_colours_are_asked_about(tmp_path, dark):
    with pytest.raises(ValueError, match=r"dark = hole: are the colours inverted\?"):
        outlines_in_picture(save(tmp_path / "a.png", dark), 1.0, 60.0, 60.0)


def test_the_inverted_picture_of_the_case_is_refused_with_the_question():
    with pytest.raises(SceneError, match=r'holes\[0\]\.file = "inv.png": .* are the colours inverted\?'):
        read_scene("../shared/cases/21-picture-inverted/a.toml")


@pytest.mark.parametrize(("width", "margin"), [(1, 0), (3, 0), (3, 2)])
def test_a_drawn_frame_is_told_from_inverted_colours(tmp_path, width, margin):
    dark = np.zeros((60, 60), dtype=bool)
    dark[margin : 60 - margin, margin : 60 - margin] = True
    dark[margin + width : 60 - margin - width, margin + width : 60 - margin - width] = False
    with pytest.raises(ValueError, match=f"a dark frame of {width} pixels" if margin == 0 else "inverted"):
        outlines_in_picture(save(tmp_path / "a.png", dark | disc()), 1.0, 60.0, 60.0)


def test_side_notches_that_leave_a_waist_are_no_inverted_picture(tmp_path):
    dark = np.zeros((100, 60), dtype=bool)
    dark[4:96, :15] = dark[4:96, 45:] = True
    assert len(outlines_in_picture(save(tmp_path / "a.png", dark), 1.0, 60.0, 100.0)) == 2


def test_a_piece_within_a_hole_asks_for_the_colours_too(tmp_path):
    dark = disc(radius=25) & ~disc(radius=10)
    with pytest.raises(ValueError, match=r"loose piece of material lies within the hole at .* inverted\?"):
        outlines_in_picture(save(tmp_path / "a.png", dark), 1.0, 60.0, 60.0)


def of_mode(mode):
    grey = Image.fromarray(np.where(disc(), 0, 255).astype(np.uint8))
    if mode == "transparent palette":
        picture = grey.convert("P")
        picture.info["transparency"] = 255
        return picture
    if mode == "I":
        return Image.fromarray(np.asarray(grey).astype(np.int32) * 257)
    if mode == "I;16":
        return Image.fromarray(np.asarray(grey).astype(np.uint16) * 257)
    if mode == "F":
        return Image.fromarray(np.asarray(grey).astype(np.float32) / 255)
    return grey.convert(mode)


@pytest.mark.parametrize(
    ("mode", "suffix"),
    [
        ("P", "gif"),
        ("transparent palette", "png"),
        ("CMYK", "jpg"),
        ("CMYK", "tif"),
        ("RGBA", "png"),
        ("RGBA", "webp"),
        ("LA", "png"),
        ("1", "tif"),
        ("I", "tif"),
        ("I;16", "tif"),
        ("I;16", "png"),
        ("F", "tif"),
        ("YCbCr", "jpg"),
        ("RGB", "bmp"),
        ("L", "pgm"),
    ],
)
def test_pictures_of_every_kind_are_read(tmp_path, mode, suffix):
    path = tmp_path / f"a.{suffix}"
    of_mode(mode).save(path)
    (outline,) = outlines_in_picture(path, 1.0, 60.0, 60.0)
    assert outline.length == pytest.approx(30 * np.pi, rel=0.02)


@pytest.mark.parametrize(
    "kind", [b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n", b"\x01\x00\x09\x00\x00\x03"]
)
def test_formats_that_are_programs_are_none(tmp_path, kind):
    (tmp_path / "a.png").write_bytes(kind + bytes(100))
    with pytest.raises(ValueError, match="not a readable picture"):
        outlines_in_picture(tmp_path / "a.png", 1.0, 60.0, 60.0)


def test_transparent_is_white(tmp_path):
    alpha = np.where(disc(), 255, 0).astype(np.uint8)
    Image.merge("LA", [Image.new("L", (60, 60), 0), Image.fromarray(alpha)]).save(tmp_path / "a.png")
    np.testing.assert_array_equal(grey_values(tmp_path / "a.png") < 0.5, disc())


def test_a_photograph_lies_as_it_is_looked_at(tmp_path):
    dark = np.zeros((40, 60), dtype=bool)
    dark[5:17, 8:30] = True  # upper left
    exif = Image.Exif()
    exif[0x0112] = 6  # to be turned by a quarter to the right
    save(tmp_path / "a.jpg", dark, exif=exif, quality=95)
    (outline,) = outlines_in_picture(tmp_path / "a.jpg", 1.0, 40.0, 60.0)
    np.testing.assert_allclose(outline.polygon(400).mean(axis=0), (40 - 11, 60 - 19), atol=0.5)


def test_real_numbers_beyond_one_are_refused(tmp_path):
    Image.fromarray(np.where(disc(), 0, 255).astype(np.float32)).save(tmp_path / "a.tif")
    with pytest.raises(ValueError, match="must be finite and lie between 0 and 1"):
        outlines_in_picture(tmp_path / "a.tif", 1.0, 60.0, 60.0)


def narrow_notch(opening, turned, tip=(60.3, 60.7), length=50.0):
    """Darkness (120, 120) of a V-notch, its axis turned, degrees, its tip at (x, y) from the lower left."""
    half, axis, fine = np.radians(opening / 2), np.radians(turned), 8
    along = [np.array([np.cos(axis + side * half), np.sin(axis + side * half)]) for side in (-1, 1)]
    x, y = np.array([tip, *(np.array(tip) + length * one for one in along)]).T
    dark = polygon2mask((120 * fine, 120 * fine), np.column_stack([(120 - y) * fine - 0.5, x * fine - 0.5]))
    return dark.reshape(120, fine, 120, fine).mean(axis=(1, 3))


@pytest.mark.parametrize("turned", [20.0, 77.0, 215.0])
@pytest.mark.parametrize("opening", [8.0, 11.0, 14.0, 25.0])
def test_a_narrow_notch_ends_where_its_flanks_meet(tmp_path, opening, turned):
    # of 8 degrees, the last seven pixels are thinner than one
    grey = np.round(255 * (1 - narrow_notch(opening, turned))).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "a.png")
    (outline,) = outlines_in_picture(tmp_path / "a.png", 1.0, 120.0, 120.0)
    corner = np.hypot(*(outline.points(outline.corners) - [60.3, 60.7]).T).argmin()
    assert outline.points(outline.corners)[corner] == pytest.approx([60.3, 60.7], abs=0.8)
    assert np.degrees(outline.corner_angles[corner]) == pytest.approx(opening, abs=1.0)


@pytest.mark.parametrize("turned", [0.0, 33.0, 120.0, 250.0])
@pytest.mark.parametrize("opening", [4.0, 5.0, 6.0])
def test_a_slit_is_no_reason_to_refuse_a_picture(tmp_path, opening, turned):
    dark = narrow_notch(opening, turned, length=80.0)
    pieces = ndimage.label(dark > 0.5)[0]
    sizes = np.bincount(pieces.ravel())[1:]
    dark[(pieces > 0) & (pieces != 1 + sizes.argmax())] = 0.4  # what is thinner than a pixel may fall apart
    Image.fromarray(np.round(255 * (1 - dark)).astype(np.uint8)).save(tmp_path / "a.png")
    (outline,) = outlines_in_picture(tmp_path / "a.png", 1.0, 120.0, 120.0)
    accuracy = outline.accuracy
    missing = np.hypot(*(accuracy.tips - [60.3, 60.7]).T)
    tip = int(missing.argmin())
    # what the picture does not show, the estimate knows of
    assert missing[tip] < max(1.0, FARTHEST_OF_BEND * accuracy.radii[tip, 2])
