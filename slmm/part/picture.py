"""Reading a picture of a plate: grey values, the levels of hole and material, and what its edges are like."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps
from scipy.ndimage import binary_dilation
from skimage.filters import threshold_otsu

Array = NDArray[np.float64]

#: pixel formats that are decoded here; others, as EPS, start a program of their own or hold no picture of a plate
FORMATS = (
    "PNG",
    "JPEG",
    "JPEG2000",
    "TIFF",
    "GIF",
    "BMP",
    "DIB",
    "WEBP",
    "AVIF",
    "PPM",
    "PCX",
    "TGA",
    "SGI",
    "QOI",
)
MAX_PIXELS = 50_000_000  # chosen
#: difference between dark and light, as a share of the range of grey values; chosen
MIN_CONTRAST = 0.2
#: a side of the picture is dark when this share of it is, and so many dark sides are no notches; both chosen
DARK_SIDE, DARK_SIDES = 0.9, 3
#: a dark border no wider than this share of the picture is a frame that somebody drew; chosen
WIDEST_FRAME = 0.1

INVERTED = "dark = hole: are the colours inverted?"


class _TooLargeError(ValueError):
    """A picture with more pixels than are read."""


def size_in_header(path: Path) -> tuple[int, int]:
    """Columns and rows as the picture is looked at, before anything is decoded.

    Raises
    ------
    ValueError
        When it is no picture, has more than 50 million pixels or more than one frame.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own limit is tighter
            with Image.open(path, formats=FORMATS) as picture:
                columns, rows = picture.size
                if columns * rows > MAX_PIXELS:
                    raise _TooLargeError(
                        f"the picture has {columns} x {rows} pixels, at most {MAX_PIXELS:,} are read"
                    )
                frames = getattr(picture, "n_frames", 1)
                # the tag by which cameras say that they were held upright: 5 to 8 are turned by a quarter
                turned = picture.getexif().get(0x0112, 1) in (5, 6, 7, 8)
    except _TooLargeError:
        raise
    except Image.DecompressionBombError as error:
        raise ValueError(f"the picture is too large, at most {MAX_PIXELS:,} pixels are read") from error
    except Exception as error:  # every decoder raises its own kind
        raise ValueError("not a readable picture (PNG, JPEG, TIFF, GIF, BMP or the like)") from error
    if frames > 1:
        raise ValueError(f"the picture holds {frames} pages or frames; it must hold one")
    return (rows, columns) if turned else (columns, rows)


def grey_values(path: Path) -> Array:
    """Grey values (rows, columns) between 0 and 1 of a picture of any kind; what is transparent is white.

    Raises
    ------
    ValueError
        When the picture cannot be decoded, or its values are not finite or not between 0 and 1.
    """
    try:
        with Image.open(path, formats=FORMATS) as opened:
            opened.load()
            picture = ImageOps.exif_transpose(opened)
            return _to_grey(picture)
    except Exception as error:  # every decoder raises its own kind
        raise ValueError(f"the picture cannot be decoded: {error}") from error


def _to_grey(picture: Image.Image) -> Array:
    if picture.mode == "F":
        values = np.asarray(picture, dtype=float)
        if not (np.isfinite(values).all() and values.min() >= 0 and values.max() <= 1):
            raise ValueError("grey values that are real numbers must be finite and lie between 0 and 1")
        return values
    if picture.mode.startswith("I"):  # 16 bits, also where they come in 32
        values = np.asarray(picture, dtype=float)
        if not (values.min() >= 0 and values.max() <= 65535):
            raise ValueError("grey values of more than 16 bits are not read; save it with 8 or 16")
        return values / 65535
    if picture.mode == "P" or "transparency" in picture.info:
        picture = picture.convert("RGBA")
    if picture.mode in ("LA", "La", "PA", "RGBa"):
        picture = picture.convert("RGBA")
    if picture.mode == "RGBA":
        colours, alpha = np.split(np.asarray(picture, dtype=float) / 255, [3], axis=2)
        colours = alpha * colours + (1 - alpha)
    elif picture.mode in ("1", "L"):
        return np.asarray(picture.convert("L"), dtype=float) / 255
    else:  # CMYK and what else there is
        colours = np.asarray(picture.convert("RGB"), dtype=float) / 255
    return colours @ np.array([0.2125, 0.7154, 0.0721])  # luminance, ITU-R BT.709


def levels(grey: Array) -> tuple[float, float]:
    """Grey level of the holes and of the material.

    Raises
    ------
    ValueError
        When there is no hole, or nothing else.
    """
    if np.ptp(grey) >= MIN_CONTRAST:
        threshold = threshold_otsu(grey)
        dark, light = np.median(grey[grey <= threshold]), np.median(grey[grey > threshold])
        if light - dark >= MIN_CONTRAST:
            return float(dark), float(light)
    shows = "nothing but hole" if np.median(grey) < 0.5 else "no hole"
    raise ValueError(
        f"the picture shows {shows}: its grey values (0 to 1) lie between {grey.min():.3g} and"
        f" {grey.max():.3g}; dark = hole, light = material, at least {MIN_CONTRAST} apart"
    )


def check_border(hole: NDArray[np.bool_]) -> None:
    """Refuse a picture (rows, columns) whose border is dark all round: a drawn frame, or inverted colours.

    Three dark sides are enough: an inverted notch may be in the fourth.
    """
    sides = [hole[0], hole[-1], hole[:, 0], hole[:, -1]]
    if sum(side.mean() >= DARK_SIDE for side in sides) < DARK_SIDES:
        return
    rows, columns = np.nonzero(~hole)
    margins = rows.min(), hole.shape[0] - 1 - rows.max(), columns.min(), hole.shape[1] - 1 - columns.max()
    width = int(max(margins))
    inner = hole[margins[0] : rows.max() + 1, margins[2] : columns.max() + 1]
    ring = [inner[0], inner[-1], inner[:, 0], inner[:, -1]]
    framed = width <= WIDEST_FRAME * min(hole.shape) and all(side.mean() < DARK_SIDE for side in ring)
    if framed and inner.mean() < 0.5:
        raise ValueError(
            f"a dark frame of {width} pixels runs round the picture; cut it off, the picture must end where the"
            f" plate does ({INVERTED})"
        )
    raise ValueError(f"the picture's border is dark, so no material is left at the plate's edges; {INVERTED}")


def is_black_and_white(grey: Array, dark: float, light: float) -> bool:
    """Whether the edges are stairs: hardly any pixel along them has a grey in between."""
    share = (grey - dark) / (light - dark)
    edge = np.count_nonzero(np.diff(share > 0.5, axis=0)) + np.count_nonzero(np.diff(share > 0.5, axis=1))
    between = np.count_nonzero((share > 0.1) & (share < 0.9))
    return bool(between < 0.2 * edge)


def grain(grey: Array, dark: float, light: float) -> float:
    """Noise of the grey values away from all edges, as a share of the contrast."""
    hole = grey < 0.5 * (dark + light)
    flat = ~(binary_dilation(hole, iterations=3) & binary_dilation(~hole, iterations=3))
    steps = np.diff(grey, axis=1)[flat[:, 1:] & flat[:, :-1]]
    return float(np.sqrt((steps**2).mean() / 2)) / (light - dark) if steps.size else 0.0
