"""Picture of a plate -> outlines of its holes, with sub-pixel accuracy from the grey values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.special import ndtri
from skimage.filters import gaussian
from skimage.measure import find_contours

from slmm.part.flanks import Noise
from slmm.part.outline import Outline
from slmm.part.picture import (
    INVERTED,
    check_border,
    grain,
    grey_values,
    is_black_and_white,
    levels,
    size_in_header,
)
from slmm.part.stretches import Contour
from slmm.part.traced import traced_outline

Array = NDArray[np.float64]

#: an outline smaller than this says nothing about curvature; it is more likely dirt than a hole; chosen
MIN_PIXELS_ACROSS = 8
#: the picture goes on by this many pixels beyond its border, so that notches end outside the plate; chosen
FRAME = 40


@dataclass(frozen=True)
class Edges:
    """What the edges in a picture need to become smooth outlines; lengths in pixels.

    Measured on circles and lobed holes with mean radii of 8 to 150 pixels, see tests/part/test_image.py.
    A blur moves the outline of a hole of radius r by blur^2/(2 r) towards its centre.
    """

    blur: float  #: standard deviation of the Gaussian blur
    deviation: float  #: root mean square of the waves that remain on a straight or round edge
    correlation: float  #: over which the points of an edge err together: stairs, as long as they are
    wavelength: float  #: of such waves on a circle of radius 1; grows with the root of the radius
    offset: float  #: by which a whole edge may be off: of stairs, a pixel may have gone to either side


#: deviations fitted to drawn circles and squares (validation/fit_outline_errors.py), the rest chosen
ANTIALIASED = Edges(blur=0.7, deviation=0.03, correlation=2.0, wavelength=2.0, offset=0.1)
STAIRS = Edges(blur=1.0, deviation=0.15, correlation=5.0, wavelength=4.0, offset=0.5)
#: pixels by which noise of the whole contrast would move an edge after the blur (0.8, computed), and half as much
#: again (chosen), because noise that is clipped at black and white looks smaller than it is on the grey edge
GRAIN_TO_EDGE = 1.2
#: the wavelength over a deviation to this power is the same for both kinds of edges; noise lies between
WAVELENGTH_EXPONENT = np.log(STAIRS.wavelength / ANTIALIASED.wavelength) / np.log(
    STAIRS.deviation / ANTIALIASED.deviation
)


def outlines_in_picture(path: Path, pixel_size: float, width: float, height: float) -> list[Outline]:
    """Outlines of the dark areas of a picture that covers the plate.

    The outline lies at half grey between the dark and the light level. Where it turns within a pixel or two it has
    a corner; what the picture leaves open about the outline is its ``accuracy``. Row 0 of the picture is the top of
    the plate, y = height. Dark areas at the border are notches: they go straight on beyond the plate's edge and are
    closed there.

    Parameters
    ----------
    path : Path
        PNG, JPEG, TIFF, GIF, BMP and whatever else Pillow reads; colours are turned to grey, transparent is white.
    pixel_size : float
        Side of a pixel, mm.
    width, height : float
        Size of the plate, mm; must be that of the picture.

    Raises
    ------
    ValueError
        When the picture is unreadable, larger than 50 million pixels, or of another size than the plate; when
        it shows no hole, or nothing else, or is dark all round; when an outline is less than 8 pixels across, or a
        hole holds a loose piece.
    """
    columns, rows = size_in_header(path)
    for name, side, pixels in (("width", width, columns), ("height", height, rows)):
        if abs(side - pixels * pixel_size) > 1e-3 * pixel_size:
            raise ValueError(
                f"the picture has {columns} x {rows} pixels of {pixel_size:g} mm,"
                f" {columns * pixel_size:g} x {rows * pixel_size:g} mm,"
                f" but plate.{name} = {side:g}; the picture must cover the plate"
            )
    grey = grey_values(path)
    dark, light = levels(grey)
    half = 0.5 * (dark + light)
    check_border(grey < half)
    edges = STAIRS if is_black_and_white(grey, dark, light) else ANTIALIASED
    deviation = float(np.hypot(edges.deviation, GRAIN_TO_EDGE * grain(grey, dark, light)))
    per_root = edges.wavelength * (deviation / edges.deviation) ** WAVELENGTH_EXPONENT
    padded = gaussian(np.pad(grey, FRAME, mode="edge"), edges.blur, mode="nearest")
    grey = np.pad(_round_off_ends(padded, light), 1, constant_values=light)

    outlines = []
    for contour in find_contours(grey, half):
        blur = _blur_at(grey, contour, light - dark, edges.blur)
        row, column = contour[:-1].T - (FRAME + 1)
        points = np.column_stack([column + 0.5, rows - (row + 0.5)])
        if _wholly_outside(points, columns, rows):
            continue  # an end that rounding off has split from its notch
        x, y = points.mean(axis=0)
        at = f"({x * pixel_size:.4g}, {y * pixel_size:.4g}) mm"
        across = np.ptp(points, axis=0)
        if across.max() < MIN_PIXELS_ACROSS:
            raise ValueError(
                f"an outline at {at}, picture column {x:.0f}, row {rows - y:.0f}, is only"
                f" {across.max():.1f} pixels across; remove the speck, or use a finer picture"
                f" (at least {MIN_PIXELS_ACROSS} pixels)"
            )
        if _runs_round_light(points):
            raise ValueError(f"a loose piece of material lies within the hole at {at}; {INVERTED}")
        known = Contour(points, Noise(deviation, edges.correlation), blur, per_root, edges.offset)
        outlines.append(traced_outline(known, columns, rows, pixel_size))
    if not outlines:
        raise ValueError("the picture shows no hole (dark = hole)")
    return outlines


def _blur_at(grey: Array, contour: Array, contrast: float, least: float) -> float:
    """Standard deviation of the blur of the edge along a contour: what it was drawn with and what was added."""
    row, column = contour.T
    slopes = [
        0.5
        * (
            map_coordinates(grey, [row + dr, column + dc], order=1)
            - map_coordinates(grey, [row - dr, column - dc], order=1)
        )
        for dr, dc in ((1, 0), (0, 1))
    ]
    # a Gaussian edge changes from -1 to 1 pixel by this share of its contrast
    share = min(float(np.median(np.hypot(*slopes))) / contrast + 0.5, 1 - 1e-9)
    return max(1 / float(ndtri(share)), least) if share > 0.5 else least


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
