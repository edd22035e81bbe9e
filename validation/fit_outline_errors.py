"""Numbers with which traced outlines are made and judged (slmm.part, slmm.initiation.outline_error), found again.

Computed: the radius of the arc that cuts off as much of a sharp corner as a Gaussian blur does (BLURRED_RADIUS), and by
how much noise moves a blurred edge (0.8 pixels, from which GRAIN_TO_EDGE is taken half as large again).

Measured on drawn shapes whose truth is known: what the chords of a contour cut off at a corner beside the blur, and how
much that varies (CHORDS, CHORDS_SPREAD: mean and standard deviation over sharp corners of polygons; those of round ones
are told); by how much a contour errs, antialiased and black and white (Edges.deviation: the root mean square distance
from circles and straight edges, of the shape where it is largest); and how far the tip of a narrow notch lies from
where it is in the outline, in largest radii (FARTHEST_OF_BEND: what nineteen of twenty lie below; FARTHEST_OF_CORNER
has to cover them).

Writes validation/results/fit_outline_errors.csv, one line for each drawn shape or corner; half a minute, ``--quick``
draws some of them and writes nothing.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from unittest import mock

import numpy as np
from checks import Check, run, save, show
from fitting import to_its_digits
from PIL import Image
from scipy.ndimage import label
from scipy.optimize import brentq
from scipy.special import ndtr

from slmm.initiation.outline_error import FARTHEST_OF_BEND, FARTHEST_OF_CORNER
from slmm.part import shapes
from slmm.part.coverage import area_fraction
from slmm.part.flanks import crossing, evenly_spaced
from slmm.part.image import ANTIALIASED, GRAIN_TO_EDGE, STAIRS, outlines_in_picture
from slmm.part.stretches import Contour
from slmm.part.traced import traced_outline
from slmm.part.vertices import (
    BLURRED_RADIUS,
    BLURRED_TURN,
    CHORDS,
    CHORDS_SPREAD,
    area_cut_off,
    find_vertices,
)

SIDE = 200
#: how dark a speck is that is none
LIGHT = 0.4
CENTRE = (100.3, 99.6)
#: angles, degrees, by which drawn polygons are turned; and with ``--quick``
TURNED, QUICK_TURNED = (0.0, 3.0, 9.0, 17.0, 31.0, 45.0), (17.0,)
#: of squares, pixels, and of what is left out at their corners
HALF_DIAGONAL, BESIDE_CORNER = 80.0, 5.0
RADII = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
#: of circles, pixels
CIRCLES, QUICK_CIRCLES = (8.0, 12.0, 20.0, 35.0, 60.0, 85.0), (12.0, 35.0)
#: openings, degrees, of narrow notches; and how their axes are turned
OPENINGS = (3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 14.0, 25.0)
AXES, QUICK_AXES = (0.0, 20.0, 33.0, 77.0, 120.0, 215.0, 250.0), (33.0,)

#: turn, degrees, up to which the table has its digits, but for one of the last: narrower corners have too little there
TABLE_HOLDS, TABLE_OFF = 130.0, 0.008
#: deviations of the blur up to which it is integrated, and along a flank up to where the contour lies on that
FAR, OUTERMOST = 9.0, 6.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)

Array = np.ndarray
Row = dict[str, object]


def blurred_radius(turn: float) -> float:
    """Radius, times tan(turn/2), of the arc that cuts off as much of a corner as a blur of deviation 1; turn in rad."""
    half = 0.5 * (np.pi - turn)  # between a flank and the axis, which goes from the corner into the wedge

    def blurred(x: float, y: float) -> float:
        """The wedge after the blur."""
        first = max(-x, -FAR)
        u = first + 0.5 * (FAR - first) * (NODES + 1)
        wide = (x + u) * np.tan(half)
        share = np.exp(-0.5 * u * u) / np.sqrt(2 * np.pi) * (ndtr(wide - y) - ndtr(-wide - y))
        return float(0.5 * (FAR - first) * WEIGHTS @ share)

    def gap(y: float) -> float:
        """From the flank to the contour of half grey, along the axis."""
        flank = y / np.tan(half)
        return float(brentq(lambda x: blurred(x, y) - 0.5, flank - 1.0, flank + 40.0)) - flank

    y = 0.5 * OUTERMOST * (NODES + 1)
    area = OUTERMOST * float(WEIGHTS @ [gap(value) for value in y])  # of both sides
    return float(np.sqrt(area / (np.tan(turn / 2) - turn / 2)) * np.tan(turn / 2))


def edge_moved(blur: float) -> float:
    """Pixels by which noise of the whole contrast moves an edge after a blur: noise left over slope."""
    of_edge = np.hypot(blur, np.sqrt(1 / 12))  # a pixel that is partly covered is a blur, too
    noise, slope = 1 / (2 * np.sqrt(np.pi) * blur), 1 / (np.sqrt(2 * np.pi) * of_edge)
    return float(noise / slope)


def contours(polygon: Array, black_and_white: bool = False, side: int = SIDE) -> list[Contour]:
    """Contours of a drawn polygon (n, 2), pixels; what falls apart from the largest piece is light."""
    covered = area_fraction([polygon], float(side), float(side), side, side)[::-1]
    pieces, _ = label(covered > 0.5)
    largest = 1 + int(np.bincount(pieces.ravel())[1:].argmax())
    covered = np.where((pieces > 0) & (pieces != largest), LIGHT, covered)
    grey = (covered < 0.5).astype(float) if black_and_white else 1 - covered
    found: list[Contour] = []

    def note(contour: Contour, *rest):
        found.append(contour)
        return traced_outline(contour, *rest)

    with tempfile.TemporaryDirectory() as folder, mock.patch("slmm.part.image.traced_outline", note):
        file = Path(folder) / "a.png"
        Image.fromarray(np.round(255 * grey).astype(np.uint8)).save(file)
        outlines_in_picture(file, 1.0, float(side), float(side))
    return found


def turned(points: Array, angle: float) -> Array:
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.asarray(points) @ [[c, s], [-s, c]] + CENTRE


def regular(n: int, radius: float) -> Array:
    t = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def cut_off_by_chords(angles: Iterable[float]) -> list[Row]:
    """Areas that contours of polygons cut off at each corner beside the blur and the arc, square pixels."""
    rows: list[Row] = []
    for n in (3, 4, 5):
        for radius in RADII:
            for angle in angles:
                pieces = shapes.polygon(regular(n, 70.0), radius)
                true = turned(np.concatenate([piece[:-1] for piece in pieces]), angle)
                (contour,) = contours(true)
                points = evenly_spaced(contour.points, closed=True)
                areas = []
                for vertex in find_vertices(points, True, contour.noise, contour.blur):
                    met = crossing(*vertex.flanks, vertex.gap)
                    assert met is not None
                    area = area_cut_off(
                        points, True, vertex.index, vertex.gap, vertex.flanks, met[0], vertex.turn
                    )
                    half = np.tan(abs(vertex.turn) / 2)
                    of_blur = contour.blur * np.interp(
                        np.degrees(abs(vertex.turn)), BLURRED_TURN, BLURRED_RADIUS
                    )
                    areas.append(area - (half - abs(vertex.turn) / 2) * (radius**2 + (of_blur / half) ** 2))
                what = "round corner" if radius else "sharp corner"
                name = f"{n} corners, r = {radius:g}, turned by {angle:g}"
                rows += [{"what": what, "shape": name, "value": float(area)} for area in areas]
    return rows


def deviations(radii: Iterable[float], angles: Iterable[float], black_and_white: bool) -> list[Row]:
    """Root mean square distances of contours from the circles and from the sides of squares that were drawn, pixels.

    Of a circle but for its mean radius, of a side but for its mean and without the pixels next to a corner.
    """
    rows: list[Row] = []
    what = "black and white" if black_and_white else "antialiased"
    for radius in radii:
        side = round(2 * radius + 30)
        for shift in np.random.default_rng(1).uniform(-0.5, 0.5, (4, 2)):
            centre = side / 2 + shift
            circle = centre + radius * regular(2000, 1.0)
            (contour,) = contours(circle, black_and_white, side)
            distance = np.hypot(*(evenly_spaced(contour.points, closed=True) - centre).T)
            rows.append({"what": what, "shape": f"r = {radius:g}", "value": float(distance.std())})
    for angle in angles:
        square = turned(regular(4, HALF_DIAGONAL), angle)
        (contour,) = contours(square, black_and_white)
        points = evenly_spaced(contour.points, closed=True)
        for start, end in zip(square, np.roll(square, -1, axis=0), strict=True):
            along = (end - start) / np.hypot(*(end - start))
            u, v = (points - start) @ along, (points - start) @ np.array([-along[1], along[0]])
            away = v[
                (np.abs(v) < BESIDE_CORNER)
                & (u > BESIDE_CORNER)
                & (u < np.hypot(*(end - start)) - BESIDE_CORNER)
            ]
            name = f"side of a square, turned by {angle:g}"
            rows.append({"what": what, "shape": name, "value": float(away.std())})
    return rows


def tips_missed(openings: Iterable[float], axes: Iterable[float]) -> list[Row]:
    """How far the tips of narrow V-notches lie from those in the outlines, in largest radii."""
    rows: list[Row] = []
    tip, length = np.array([60.3, 60.7]), 80.0
    for opening in openings:
        for axis in axes:
            along = np.radians([axis - opening / 2, axis + opening / 2])
            ends = tip + length * np.column_stack([np.cos(along), np.sin(along)])
            try:
                (contour,) = contours(np.array([tip, *ends]), side=120)
            except ValueError:  # specks next to a slit are refused
                continue
            accuracy = traced_outline(contour, 120.0, 120.0, 1.0).accuracy
            assert accuracy is not None
            away = np.hypot(*(accuracy.tips - tip).T)
            nearest = int(away.argmin())
            value = float(away[nearest] / accuracy.radii[nearest, 2])
            kind = "corner" if accuracy.spreads[nearest] > 0 else "bend"
            rows.append({"what": kind, "shape": f"{opening:g} degrees, axis at {axis:g}", "value": value})
    return rows


def values(rows: Iterable[Row], what: str) -> Array:
    return np.array([row["value"] for row in rows if row["what"] == what], dtype=float)


def root_mean_square(numbers: Array) -> float:
    return float(np.sqrt(np.mean(numbers**2)))


def judged(rows: list[Row]) -> list[Check]:
    """Constants beside what is measured and computed."""
    checks = []
    for turn, constant in zip(BLURRED_TURN, BLURRED_RADIUS, strict=True):
        case, found = f"corner that turns by {turn:g} degrees", blurred_radius(np.radians(turn))
        rule = "equal" if turn <= TABLE_HOLDS else "told"
        checks.append(Check(case, "BLURRED_RADIUS, computed", constant, found, TABLE_OFF, rule=rule))
    moved = edge_moved(ANTIALIASED.blur)
    checks.append(
        to_its_digits("noise over slope", "GRAIN_TO_EDGE / 1.5", GRAIN_TO_EDGE / 1.5, moved, digit=0.1)
    )
    sharp, rounded = (values(rows, what) for what in ("sharp corner", "round corner"))
    case, beside = f"{len(sharp)} sharp corners", f"{len(rounded)} round corners"
    checks += [
        to_its_digits(case, "CHORDS", CHORDS, float(sharp.mean()), digit=0.1),
        to_its_digits(case, "CHORDS_SPREAD", CHORDS_SPREAD, float(sharp.std()), digit=0.1),
        Check(beside, "CHORDS", CHORDS, float(rounded.mean()), rule="told"),
        Check(beside, "CHORDS_SPREAD", CHORDS_SPREAD, float(rounded.std()), rule="told"),
    ]
    for what, edges in (("antialiased", ANTIALIASED), ("black and white", STAIRS)):
        by_shape = {str(row["shape"]) for row in rows if row["what"] == what}
        largest = max(
            root_mean_square(values([row for row in rows if row["shape"] == shape], what))
            for shape in by_shape
        )
        case = f"{len(by_shape)} edges, {what}"
        checks.append(to_its_digits(case, "deviation", edges.deviation, largest, digit=0.01))
    bends, corners = (values(rows, what) for what in ("bend", "corner"))
    case = f"{len(bends)} narrow tips that the outline has as bends"
    nineteen_of_twenty = float(np.quantile(bends, 0.95))
    checks += [
        to_its_digits(case, "FARTHEST_OF_BEND", FARTHEST_OF_BEND, nineteen_of_twenty, digit=1.0),
        Check(case, "the farthest", FARTHEST_OF_BEND, float(bends.max()), rule="told"),
    ]
    case = f"{len(corners)} narrow tips that it has as corners"
    nineteen_of_twenty = float(np.quantile(corners, 0.95))
    checks += [
        Check(case, "FARTHEST_OF_CORNER", FARTHEST_OF_CORNER, nineteen_of_twenty, rule="at most"),
        Check(case, "the farthest", FARTHEST_OF_CORNER, float(corners.max()), rule="told"),
    ]
    return checks


def main(quick: bool = False) -> list[Check]:
    angles, circles, axes = (QUICK_TURNED, QUICK_CIRCLES, QUICK_AXES) if quick else (TURNED, CIRCLES, AXES)
    rows = [
        *cut_off_by_chords(angles),
        *deviations(circles, angles, False),
        *deviations(circles, angles, True),
        *tips_missed(OPENINGS, axes),
    ]
    checks = judged(rows)
    show("Numbers of traced outlines", checks)
    if not quick:
        save("fit_outline_errors", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
