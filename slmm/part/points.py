"""Outlines and polygons given as points: reading them from a file, and what is wrong with them."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon
from shapely.validation import explain_validity

from slmm.running.input_file import read_text

Array = NDArray[np.float64]

#: mm, as in scenes: squares and products stay finite; chosen
MAX_COORDINATE = 1e9
MIN_POINTS = 8  # chosen
MAX_POINTS = 100_000  # chosen
MIN_CORNERS = 3
#: of a polygon; more of them draw a smooth outline; chosen
MAX_CORNERS = 1000
#: a polygon that turns by more than this at one point does not describe a smooth outline; chosen
MAX_TURN = 60.0
#: neighbouring points nearer than this share of the outline's size are one: programs write six or seven
#: digits; round-off
SAME = 1e-6
#: bytes of a file of points: the longest outline, every coordinate with 40 characters, and as much in remarks; chosen
MOST = 16_000_000
#: a line that may be quoted without knowing what is in the file
_NUMBERS = re.compile(r"[\d\s.,;+\-eE]*", re.ASCII)
#: characters of a line that are quoted; chosen
QUOTED = 60


def read_points(path: Path) -> Array:
    """Points (n, 2), mm, from a text file with the columns x and y.

    Columns are separated by comma, semicolon, tab or blanks. One header line may come first; empty lines and
    lines that start with # are skipped.

    Raises
    ------
    ValueError
        When the file cannot be read as text, or a line does not hold two finite numbers; names the line.
    """
    lines = read_text(path, MOST, "readable text file").splitlines()
    points: list[tuple[float, float]] = []
    header_allowed = True
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            row = [float(cell) for cell in _cells(line)]
        except csv.Error:  # it has a limit of its own to what stands between two separators
            raise ValueError(f"line {number}: is too long; must hold two numbers, x and y") from None
        except ValueError:
            if header_allowed:
                header_allowed = False
                continue
            raise ValueError(f"{_quoted(number, line, points)}: must hold two numbers, x and y") from None
        header_allowed = False
        if len(row) != 2:
            raise ValueError(f"{_quoted(number, line, points)}: must hold two numbers, x and y")
        if not np.isfinite(row).all():
            raise ValueError(f"{_quoted(number, line, points)}: must be finite numbers")
        if np.abs(row).max() > MAX_COORDINATE:
            says = f"must lie between {-MAX_COORDINATE:g} and {MAX_COORDINATE:g}"
            raise ValueError(f"{_quoted(number, line, points)}: {says}")
        points.append((row[0], row[1]))
    return np.array(points, dtype=float).reshape(-1, 2)


def _quoted(number: int, line: str, points: list[tuple[float, float]]) -> str:
    """A line by its number, and by its text where it is of points: a scene may name any file, also a secret one."""
    text = line.strip()
    of_points = bool(points) or _NUMBERS.fullmatch(text) is not None
    return f"line {number} = {text!r}" if of_points and len(text) <= QUOTED else f"line {number}"


def _cells(line: str) -> list[str]:
    for separator in ";,\t":
        if separator in line:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    return line.split()


def point_problems(points: Array) -> list[str]:
    """What keeps the points (n, 2) from being a closed, smooth outline; empty when nothing does."""
    problems = _ring_problems(points, MIN_POINTS, MAX_POINTS, "round the outline")
    if problems:
        return problems
    kept = without_repetition(points)
    steps = np.roll(kept, -1, axis=0) - kept
    direction = steps[:, 0] + 1j * steps[:, 1]
    turn = np.abs(np.degrees(np.angle(direction / np.roll(direction, 1))))
    sharpest = int(turn.argmax())
    if turn[sharpest] > MAX_TURN:
        x, y = kept[sharpest]
        number = int(np.argmax((points == kept[sharpest]).all(axis=1)))
        return [
            f"the outline turns by {turn[sharpest]:.0f} degrees at point {number}, ({x:.6g}, {y:.6g}):"
            f" a corner has no curvature; round it, with at most {MAX_TURN:.0f} degrees at each point,"
            ' or draw straight sides between corners with shape = "polygon"'
        ]
    return []


def polygon_problems(points: Array) -> list[str]:
    """What keeps the points (n, 2) from being the corners of a polygon; empty when nothing does."""
    return _ring_problems(points, MIN_CORNERS, MAX_CORNERS, "as corners of a polygon")


def without_repetition(points: Array) -> Array:
    """The points (n, 2) without those that are the one before again but for rounding; the last one may be the first.

    Examples
    --------
    >>> without_repetition(np.array([[0, 0], [4, 0], [4, 1e-7], [0, 3], [1e-7, 0]])).tolist()
    [[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]
    """
    same = SAME * float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    kept: list[int] = []
    for k, point in enumerate(points):
        # from the last one kept: many small steps are a distance, too
        if not kept or np.hypot(*(point - points[kept[-1]])) > same:
            kept.append(k)
    while len(kept) > 1 and np.hypot(*(points[kept[-1]] - points[0])) <= same:
        kept.pop()
    return points[kept]


def _ring_problems(points: Array, fewest: int, most: int, where: str) -> list[str]:
    """What keeps the points (n, 2) from going round once."""
    if not np.isfinite(points).all():
        return [f"point {int(np.argmin(np.isfinite(points).all(axis=1)))} is not finite"]
    points = without_repetition(points)
    n = len(points)
    if not fewest <= n <= most:
        return [f"has {n} different points: must have between {fewest} and {most:,} {where}"]

    polygon = Polygon(points)
    if not polygon.is_valid:
        return [f"the outline crosses or touches itself: {explain_validity(polygon)}"]
    return []
