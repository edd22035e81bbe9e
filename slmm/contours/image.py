"""Picture of a plate -> outlines of its holes, with sub-pixel accuracy from the grey values."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import binary_dilation
from skimage.color import rgb2gray, rgba2rgb
from skimage.filters import gaussian, threshold_otsu
from skimage.io import imread
from skimage.measure import find_contours

from slmm.contours.outline import Outline

Array = NDArray[np.float64]

MAX_PIXELS = 50_000_000
#: an outline smaller than this says nothing about curvature; it is more likely dirt than a hole
MIN_PIXELS_ACROSS = 8
#: difference between dark and light, as a share of the range of grey values
MIN_CONTRAST = 0.2
#: the picture goes on by this many pixels beyond its border, so that notches end outside the plate
FRAME = 40


@dataclass(frozen=True)
class Edges:
    """What the edges in a picture need to become smooth outlines; lengths in pixels.

    Measured on circles and lobed holes with mean radii of 8 to 150 pixels, see tests/contours/test_image.py.
    A blur moves the outline of a hole of radius r by blur^2/(2 r) towards its centre.
    """

    blur: float  #: standard deviation of the Gaussian blur
    deviation: float  #: root mean square of the waves that remain on a straight or round edge
    wavelength: float  #: of such waves on a circle of radius 1; grows with the root of the radius


ANTIALIASED = Edges(blur=0.7, deviation=0.03, wavelength=2.0)
STAIRS = Edges(blur=1.0, deviation=0.15, wavelength=4.0)
#: pixels by which noise of the whole contrast would move an edge after the blur (0.8), and half as much again
#: because noise that is clipped at black and white looks smaller than it is on the grey edge
GRAIN_TO_EDGE = 1.2


def outlines_in_picture(path: Path, pixel_size: float, width: float, height: float) -> list[Outline]:
    """Outlines of the dark areas of a picture that covers the plate.

    The outline lies at half grey between the dark and the light level. Row 0 of the picture is the top of the
    plate, y = height. Dark areas at the border are notches: they go straight on beyond the plate's edge
    and are closed there.

    Parameters
    ----------
    path : Path
        PNG, JPEG, TIFF, BMP and whatever else Pillow reads; colours are turned to grey, transparent is white.
    pixel_size : float
        Side of a pixel, mm.
    width, height : float
        Size of the plate, mm; must be that of the picture.

    Raises
    ------
    ValueError
        When the picture is unreadable, larger than 50 million pixels, or of another size than the plate; when
        it shows no hole, or nothing else; when an outline is less than 8 pixels across, or a hole holds a
        loose piece.
    """
    columns, rows = _size_in_header(path)
    for name, side, pixels in (("width", width, columns), ("height", height, rows)):
        if abs(side - pixels * pixel_size) > 1e-3 * pixel_size:
            raise ValueError(
                f"the picture has {columns} x {rows} pixels of {pixel_size:g} mm,"
                f" {columns * pixel_size:g} x {rows * pixel_size:g} mm,"
                f" but plate.{name} = {side:g}; the picture must cover the plate"
            )
    grey = _grey_values(path)
    dark, light = _levels(grey)
    edges = STAIRS if _is_black_and_white(grey, dark, light) else ANTIALIASED
    deviation = np.hypot(edges.deviation, GRAIN_TO_EDGE * _grain(grey, dark, light))
    grey = gaussian(np.pad(grey, FRAME, mode="edge"), edges.blur, mode="nearest")
    grey = np.pad(_round_off_ends(grey, light), 1, constant_values=light)

    outlines = []
    for contour in find_contours(grey, 0.5 * (dark + light)):
        row, column = contour[:-1].T - (FRAME + 1)
        points = np.column_stack([(column + 0.5) * pixel_size, height - (row + 0.5) * pixel_size])
        if _wholly_outside(points, width, height):
            continue  # an end that rounding off has split from its notch
        x, y = points.mean(axis=0)
        across = np.ptp(points, axis=0) / pixel_size
        if across.max() < MIN_PIXELS_ACROSS:
            raise ValueError(
                f"an outline at ({x:.4g}, {y:.4g}) mm, picture column {x / pixel_size:.0f},"
                f" row {(height - y) / pixel_size:.0f}, is only {across.max():.1f} pixels across;"
                f" remove the speck, or use a finer picture (at least {MIN_PIXELS_ACROSS} pixels)"
            )
        if _runs_round_light(points):
            raise ValueError(f"a loose piece of material lies within the hole at ({x:.4g}, {y:.4g}) mm")
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        wavelength = edges.wavelength * np.sqrt(length / (2 * np.pi) * pixel_size)
        outlines.append(Outline.through(points, deviation * pixel_size, wavelength))
    if not outlines:
        raise ValueError("the picture shows no hole (dark = hole)")
    return outlines


def _size_in_header(path: Path) -> tuple[int, int]:
    """Columns and rows, before anything is decoded."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own limit is tighter
            with Image.open(path) as picture:
                columns, rows = picture.size
                frames = getattr(picture, "n_frames", 1)
    except Image.DecompressionBombError as error:
        raise ValueError(f"the picture is too large, at most {MAX_PIXELS:,} pixels are read") from error
    except (OSError, SyntaxError, ValueError) as error:
        raise ValueError("not a readable picture (PNG, JPEG, TIFF or BMP)") from error
    if columns * rows > MAX_PIXELS:
        raise ValueError(f"the picture has {columns} x {rows} pixels, at most {MAX_PIXELS:,} are read")
    if frames > 1:
        raise ValueError(f"the picture holds {frames} pages or frames; it must hold one")
    return columns, rows


def _grey_values(path: Path) -> Array:
    """Grey values between 0 and 1."""
    try:
        picture = imread(path)
    except Exception as error:  # every decoder raises its own kind
        raise ValueError(f"the picture cannot be decoded: {error}") from error
    if picture.dtype == bool:
        picture = picture.astype(float)
    elif np.issubdtype(picture.dtype, np.integer):
        picture = picture / (255.0 if picture.dtype == np.uint8 else 65535.0)
    if picture.ndim == 3 and picture.shape[2] == 2:  # grey with transparency
        picture = picture[..., 0] * picture[..., 1] + (1 - picture[..., 1])
    elif picture.ndim == 3 and picture.shape[2] == 4:
        picture = rgb2gray(rgba2rgb(picture))
    elif picture.ndim == 3 and picture.shape[2] == 3:
        picture = rgb2gray(picture)
    if picture.ndim != 2 or not np.isfinite(picture).all():
        raise ValueError(f"the picture must hold finite grey or colour values, not an array {picture.shape}")
    return picture.astype(float)


def _levels(grey: Array) -> tuple[float, float]:
    """Grey level of the holes and of the material."""
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


def _is_black_and_white(grey: Array, dark: float, light: float) -> bool:
    """Whether the edges are stairs: hardly any pixel along them has a grey in between."""
    share = (grey - dark) / (light - dark)
    edge = np.count_nonzero(np.diff(share > 0.5, axis=0)) + np.count_nonzero(np.diff(share > 0.5, axis=1))
    between = np.count_nonzero((share > 0.1) & (share < 0.9))
    return bool(between < 0.2 * edge)


def _grain(grey: Array, dark: float, light: float) -> float:
    """Noise of the grey values away from all edges, as a share of the contrast."""
    hole = grey < 0.5 * (dark + light)
    flat = ~(binary_dilation(hole, iterations=3) & binary_dilation(~hole, iterations=3))
    steps = np.diff(grey, axis=1)[flat[:, 1:] & flat[:, :-1]]
    return float(np.sqrt((steps**2).mean() / 2)) / (light - dark) if steps.size else 0.0


def _round_off_ends(padded: Array, light: float) -> Array:
    """Close the notches in the frame, with round corners: a strong blur that sets in away from the plate."""
    rows, columns = padded.shape
    row, column = np.arange(rows), np.arange(columns)
    outside_rows = np.maximum(FRAME - row, row - (rows - 1 - FRAME))
    outside_columns = np.maximum(FRAME - column, column - (columns - 1 - FRAME))
    outside = np.maximum(outside_rows[:, None], outside_columns[None, :])
    ended = gaussian(np.where(outside < 0.75 * FRAME, padded, light), 4.0, mode="nearest")
    share = np.clip(outside / (0.25 * FRAME) - 1.0, 0.0, 1.0)
    return (1 - share) * padded + share * ended


def _wholly_outside(points: Array, width: float, height: float) -> bool:
    x, y = points.T
    return not np.any((x > 0) & (x < width) & (y > 0) & (y < height))


def _runs_round_light(points: Array) -> bool:
    x, y = (points - points.mean(axis=0)).T
    return bool(x @ np.roll(y, -1) - y @ np.roll(x, -1) < 0)
