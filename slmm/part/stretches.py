"""Stretches of a traced contour between its marks: their points, and what the picture leaves open about them.

All lengths are in pixels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import hilbert

from slmm.mechanics.cubics import closed_through, through
from slmm.part.flanks import STEP, Flank, Noise, evenly_spaced, straight_flank
from slmm.part.smoothing import HELD_WEIGHT, curvatures, smoothed, wavelengths
from slmm.part.vertices import SMALLEST_TURN, Vertex

Array = NDArray[np.float64]

#: angle (rad) and distance between the points of a smooth stretch; all chosen
TURN_PER_POINT, FARTHEST, NEAREST = 0.03, 4.0, 0.2
#: second smoothing: so many times the wavelength; what it changes is taken for the error of the first; chosen
SECOND = 1.4
#: a bend that is followed point by point with less than so many blurs as its radius is known to so many of
#: them; both chosen
TIGHT, KNOWN = 6.0, 2.0
#: longest waves that a straight stretch may hide; chosen
HIDDEN = 60.0
#: pixels over which the noise that is left in an outline hangs together; chosen
CORRELATION = 2.0


class Contour(NamedTuple):
    """What is known of a traced contour.

    Attributes
    ----------
    points : (n, 2) array
        Of the closed contour.
    noise : Noise
        By which they err.
    blur : float
        Standard deviation of the picture's blur.
    per_root : float
        Wavelength below which undulations are noise, over the root of the radius of curvature.
    offset : float
        By which the whole contour may lie too far inside or outside.
    """

    points: Array
    noise: Noise
    blur: float
    per_root: float
    offset: float

    @property
    def radius(self) -> float:
        """Of a circle as long as the contour."""
        steps = np.roll(self.points, -1, axis=0) - self.points
        return float(np.hypot(*steps.T).sum() / (2 * np.pi))


class Mark(NamedTuple):
    """Where stretches of a contour end.

    Attributes
    ----------
    number : int
        Along the contour, in points.
    gap : float
        Distance from there to where the contour tells the stretch and no longer the mark.
    point : (2,) array
        Where the stretch ends.
    before, behind : Flank, optional
        What leads there.
    vertex : Vertex, optional
        None where the contour leaves the plate.
    """

    number: int
    gap: float
    point: Array
    before: Flank | None
    behind: Flank | None
    vertex: Vertex | None = None


class Bend(NamedTuple):
    """A corner or tight bend as it is in an outline: its root, its turn, and its radius with the bounds of that."""

    root: Array
    turn: float
    spread: float
    radius: float
    least: float
    largest: float


class Stretch(NamedTuple):
    """A smooth stretch: its points, two when it is straight.

    Further samples of what waves may do to the stress there, and its tight bends.
    """

    points: Array
    samples: Array
    stress: Array
    wavelength: Array
    bends: tuple[Bend, ...] = ()


def stretch_between(points: Array, closed: bool, one: Mark, other: Mark, contour: Contour) -> Stretch:
    """The stretch of a contour from one mark to another."""
    n = len(points)
    steps = other.number - one.number
    if closed and steps <= 0:
        steps += n
    start, end = round(one.gap / STEP), steps - round(other.gap / STEP)
    if end - start < 2:
        return straight_stretch(one.point, other.point, contour)
    inner = points[(one.number + np.arange(start, end + 1)) % n]
    if one.vertex is not other.vertex and straight_flank(inner, contour.noise):
        return straight_stretch(one.point, other.point, contour)
    assert one.behind is not None and other.before is not None
    head, tail = _lead(one.point, one.behind), _lead(other.point, other.before)
    even = evenly_spaced(np.concatenate([head, inner, tail[::-1]]), closed=False)
    weights = np.ones(len(even))
    weights[[0, -1]] = HELD_WEIGHT
    along = STEP * np.arange(len(even))
    straight = np.zeros(len(even), dtype=bool)
    for flank, distance in ((one.behind, along), (other.before, along[::-1])):
        if flank.is_straight:
            straight |= distance < min(flank.length, 0.4 * along[-1])
    wanted = wavelengths(even, weights, straight, contour.per_root, contour.radius, STEP, False)
    smooth = smoothed(even, weights, straight, wanted, STEP, False)
    again = smoothed(even, weights, straight, SECOND * wanted, STEP, False)
    smooth[0], smooth[-1] = one.point, other.point  # exactly, so that the stretches meet
    stress = stress_of_waves(smooth, again, wanted, contour.noise.deviation, False)
    bends = tight_bends(smooth, contour.blur, False)
    return Stretch(thinned(smooth, False), smooth[::2], stress[::2], wanted[::2], bends)


def straight_stretch(start: Array, end: Array, contour: Contour) -> Stretch:
    """A straight stretch; waves of twice its length may have passed for straight."""
    length = float(np.hypot(*(end - start)))
    samples = start + np.linspace(0, 1, max(int(length), 1) + 1)[:, None] * (end - start)
    wavelength = np.full(len(samples), np.clip(2 * length, 4 * CORRELATION, HIDDEN))
    return Stretch(
        np.array([start, end]), samples, 2 * _slope(contour.noise.deviation, wavelength), wavelength
    )


def _lead(point: Array, flank: Flank) -> Array:
    """Points (n, 2) from where a stretch ends along its flank to where the contour takes over, that one excluded."""
    u = (point - flank.origin) @ flank.along
    inner = np.linspace(u, 0.0, max(int(-u / STEP), 1) + 1)[1:-1]
    return np.concatenate([point[None], flank.points(inner)])


def thinned(points: Array, closed: bool) -> Array:
    """Points (k, 2) of a smooth stretch, dense where it bends; the first one is repeated when it is closed."""
    bend = np.abs(curvatures(points, STEP, closed))
    if closed:
        points, bend = np.vstack([points, points[:1]]), np.append(bend, bend[0])
    distance = np.clip(TURN_PER_POINT / np.maximum(bend, 1e-12), NEAREST, FARTHEST)
    along = STEP * np.arange(len(points), dtype=np.float64)
    number = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (1 / distance[1:] + 1 / distance[:-1]))])
    count = max(int(np.ceil(number[-1])), 4)
    at = np.interp(np.linspace(0, number[-1], count + 1), number, along)
    spline = closed_through(along, points[:-1]) if closed else through(along, points)
    thin: Array = spline(at)
    thin[0], thin[-1] = points[0], points[-1]
    return thin


def _slope(deviation: float, wavelength: Array) -> Array:
    """Root mean square slope (n,) of the waves that noise leaves above a wavelength.

    Noise of one deviation and a length over which its points err together is white up to the wave number of that
    length.
    """
    return deviation * np.sqrt((2 * np.pi / wavelength) ** 3 * CORRELATION / (3 * np.pi))


def stress_of_waves(smooth: Array, again: Array, wavelength: Array, deviation: float, closed: bool) -> Array:
    """Relative error (n,) of the stress along a surface, from the noise left and from what smoothing takes out.

    To first order, waves of a free surface change the stress along it by twice the Hilbert transform of their slope.
    """
    tangent = np.gradient(smooth, axis=0)
    tangent /= np.maximum(np.hypot(*tangent.T), 1e-12)[:, None]
    gap = again - smooth
    across = gap[:, 0] * tangent[:, 1] - gap[:, 1] * tangent[:, 0]
    slope = np.gradient(across, STEP)
    if not closed:
        slope = np.concatenate([slope, np.zeros(len(slope))])
    envelope = np.abs(hilbert(slope))[: len(across)]
    result: Array = 2 * np.hypot(_slope(deviation, wavelength), envelope)
    return result


def tight_bends(smooth: Array, blur: float, closed: bool) -> tuple[Bend, ...]:
    """Bends of a smooth stretch into the material that the picture tells little about."""
    bend = curvatures(smooth, STEP, closed)
    tight = bend > 1 / (TIGHT * blur)
    if tight.all():
        return ()
    first = int(np.argmin(tight))  # an open stretch begins with a flank
    order = np.roll(np.arange(len(smooth)), -first if closed else 0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], tight[order], [False]]).astype(int)))
    found = []
    for start, end in edges.reshape(-1, 2):
        inside = order[start:end]
        root = inside[bend[inside].argmax()]
        radius = float(1 / bend[root])
        turn = min(float(bend[inside].sum() * STEP), np.pi)
        if turn < SMALLEST_TURN:
            continue  # a wave of the contour
        bounds = max(radius - KNOWN * blur, 0.0), radius + KNOWN * blur
        found.append(Bend(smooth[root], turn, 0.0, radius, *bounds))
    return tuple(found)
