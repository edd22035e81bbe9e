"""A closed notch outline: periodic cubic spline over its arc length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, PPoly
from scipy.optimize import brentq
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

MIN_PIECES, MAX_PIECES = 256, 4000
#: largest angle (rad) by which the outline may turn within one piece; a circle's curvature is then good to
#: 0.02^2/12 = 3e-5 and its position to 2e-9 radii
TURN_PER_PIECE = 0.02
#: beyond this angle even the finest spline does not follow the outline any more: it has a corner
TURN_REFUSED = 0.4


@dataclass(frozen=True, eq=False)
class Outline:
    """Closed outline of a hole, counter-clockwise, parametrised by its arc length s.

    The normal into the material is the tangent turned by -90 degrees, n = (t_y, -t_x). In the local axes
    (xi along the tangent, eta along that normal) the outline is eta = kappa/2 xi^2: a circular hole of radius
    r has kappa = -1/r.

    Parameters
    ----------
    breaks : (m + 1,) array
        Arc lengths of the break points, mm; evenly spaced from 0 to the length of the outline.
    coefficients : (4, m, 2) array
        Coefficients of x and y on each piece, highest power first, as in `scipy.interpolate.PPoly`.

    Examples
    --------
    >>> from slmm.contours.shapes import circle
    >>> outline = Outline.through(circle((50, 50), 20.0))
    >>> round(outline.length, 4), round(float(outline.curvatures(3.0)), 4)
    (125.6637, -0.05)
    """

    breaks: Array
    coefficients: Array

    @classmethod
    def through(cls, points: ArrayLike, smoothing: float = 0.0, wavelength: float = 0.0) -> Outline:
        """Outline through points that go round the hole once, in either sense.

        Parameters
        ----------
        points : (n, 2) array_like
            n >= 8 points, mm. The last one may repeat the first. s = 0 lies at the first point.
        smoothing : float
            Root mean square deviation from the points that noise may have, mm; 0 interpolates.
        wavelength : float
            Undulations shorter than this (mm, along the outline) are smoothed away as well, however large
            they are; 0 sets no limit.

        Raises
        ------
        ValueError
            When there are fewer than 8 points, neighbours coincide, numbers are not finite, or the outline
            has a corner, ie. a radius of curvature too small for its length.
        """
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(f"an outline needs points of shape (n, 2), not {points.shape}")
        if not np.isfinite(points).all():
            raise ValueError("the points of an outline must be finite numbers")
        if np.array_equal(points[0], points[-1]):
            points = points[:-1]
        if len(points) < 8:
            raise ValueError(f"an outline needs at least 8 points, not {len(points)}")
        if _enclosed_area(points) < 0:
            points = np.roll(points[::-1], 1, axis=0)  # the first point stays the first

        spline = _periodic_spline(_chord_lengths(points), points)
        if smoothing > 0 or wavelength > 0:
            spline = _smoothed(spline, 2 * len(points), smoothing, wavelength)

        pieces = _number_of_pieces(spline)
        # The first pass brings the parameter to the arc length of the spline through the given points, the
        # next ones to the arc length of the spline through the equidistant points itself.
        for _ in range(3):
            s, samples = _equidistant(spline, pieces)
            spline = _periodic_spline(s, samples)
        breaks, coefficients = np.ascontiguousarray(spline.x), np.ascontiguousarray(spline.c)
        breaks.setflags(write=False)
        coefficients.setflags(write=False)
        return cls(breaks, coefficients)

    @cached_property
    def _curve(self) -> PPoly:
        return PPoly(self.coefficients, self.breaks, extrapolate="periodic")

    @cached_property
    def _velocity(self) -> PPoly:
        return self._curve.derivative()

    @cached_property
    def _acceleration(self) -> PPoly:
        return self._curve.derivative(2)

    @cached_property
    def _samples(self) -> tuple[Array, cKDTree]:
        s = np.linspace(0.0, self.length, max(2000, 2 * (len(self.breaks) - 1)), endpoint=False)
        return s, cKDTree(self.points(s))

    @property
    def length(self) -> float:
        """Length of the outline, mm."""
        return float(self.breaks[-1])

    def points(self, s: ArrayLike) -> Array:
        """Points (..., 2) at the arc lengths s (mm, taken modulo the length)."""
        return self._curve(s)

    def tangents(self, s: ArrayLike) -> Array:
        """Unit tangents (..., 2), counter-clockwise round the hole."""
        t = self._velocity(s)
        return t / np.linalg.norm(t, axis=-1, keepdims=True)

    def normals(self, s: ArrayLike) -> Array:
        """Unit normals (..., 2) into the material."""
        t = self.tangents(s)
        return np.stack([t[..., 1], -t[..., 0]], axis=-1)

    def curvatures(self, s: ArrayLike) -> Array:
        """Signed curvatures (1/mm): negative where the hole bulges out as a circle does."""
        t, k = self._velocity(s), self._acceleration(s)
        return (t[..., 1] * k[..., 0] - t[..., 0] * k[..., 1]) / np.linalg.norm(t, axis=-1) ** 3

    def project(self, points: ArrayLike) -> Array:
        """Arc lengths s (n,) of the points of the outline that lie nearest to the given points (n, 2)."""
        points = np.asarray(points, dtype=float)
        samples, tree = self._samples
        start = samples[tree.query(points)[1]]
        step = self.length / len(samples)
        s = start.copy()
        for _ in range(20):
            gap, t = self.points(s) - points, self._velocity(s)
            slope = (t * t).sum(-1) + (gap * self._acceleration(s)).sum(-1)
            # At a centre of curvature every point is equally near and the slope vanishes; the step back to
            # steepest descent keeps the direction, the clip keeps to the neighbours of the nearest sample.
            slope = np.where(slope > 0.1, slope, 1.0)
            new = np.clip(s - (gap * t).sum(-1) / slope, start - step, start + step)
            converged = np.abs(new - s).max(initial=0.0) < 1e-13 * self.length
            s = new
            if converged:
                break
        return np.mod(s, self.length)

    def polygon(self, n: int) -> Array:
        """n points (n, 2), equally spaced in arc length from s = 0, counter-clockwise and not repeated."""
        return self.points(np.linspace(0.0, self.length, n, endpoint=False))


def _enclosed_area(points: Array) -> float:
    """Area within the closed polygon, mm^2; positive when it runs counter-clockwise."""
    x, y = (points - points.mean(axis=0)).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _chord_lengths(points: Array) -> Array:
    """Cumulated chord lengths (n + 1,), mm, once round."""
    chords = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    if chords.min() <= 1e-12 * chords.sum():
        k = int(chords.argmin())
        raise ValueError(f"points {k} and {(k + 1) % len(points)} of the outline coincide")
    return np.concatenate([[0.0], np.cumsum(chords)])


def _periodic_spline(parameter: Array, points: Array) -> CubicSpline:
    return CubicSpline(parameter, np.vstack([points, points[:1]]), bc_type="periodic")


def _speed(spline: CubicSpline, u: Array) -> Array:
    return np.linalg.norm(spline(u, 1), axis=-1)


def _equidistant(spline: CubicSpline, n: int) -> tuple[Array, Array]:
    """Arc lengths (n + 1,) and points (n, 2) of the spline, evenly spaced in arc length."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    u, h = spline.x, np.diff(spline.x)
    lengths = 0.5 * h * (_speed(spline, u[:-1, None] + 0.5 * h[:, None] * (nodes + 1)) @ weights)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    s = np.linspace(0.0, arc[-1], n + 1)
    piece = np.clip(np.searchsorted(arc, s[:-1], side="right") - 1, 0, len(h) - 1)
    part = (s[:-1] - arc[piece]) / lengths[piece]
    for _ in range(6):  # Newton for the parameter at which the arc length from the break is the wanted one
        at = u[piece, None] + 0.5 * (h[piece] * part)[:, None] * (nodes + 1)
        reached = 0.5 * h[piece] * part * (_speed(spline, at) @ weights)
        part += (s[:-1] - arc[piece] - reached) / (h[piece] * _speed(spline, u[piece] + h[piece] * part))
        part = np.clip(part, 0.0, 1.0)
    return s, spline(u[piece] + h[piece] * part)


def _number_of_pieces(spline: CubicSpline) -> int:
    """As many pieces as the sharpest bend needs."""
    s, points = _equidistant(spline, MAX_PIECES)
    step = s[1]
    # the angle between neighbouring chords: unlike the second derivative, it forgives tiny kinks
    chords = np.roll(points, -1, axis=0) - points
    direction = chords[:, 0] + 1j * chords[:, 1]
    turn = np.abs(np.angle(np.roll(direction, -1) / direction))
    sharpest = int(turn.argmax())
    if turn[sharpest] > TURN_REFUSED:
        x, y = points[(sharpest + 1) % MAX_PIECES]
        radius, allowed = step / turn[sharpest], step / TURN_REFUSED
        raise ValueError(
            f"the outline has a corner at ({x:.6g}, {y:.6g}): its radius of {radius:.3g} mm is too sharp"
            f" for a curvature; round it, with {allowed:.3g} mm or more"
        )
    return int(np.clip(np.ceil(MAX_PIECES * turn[sharpest] / TURN_PER_PIECE), MIN_PIECES, MAX_PIECES))


def _smoothed(spline: CubicSpline, n: int, deviation: float, wavelength: float) -> CubicSpline:
    """Spline without the undulations that are noise, see `Outline.through`.

    On points evenly spaced in arc length, the penalty on the third derivative of a smoothing spline is the
    filter 1/(1 + (k/k_c)^6) on the k-th harmonic. Harmonics 0 and 1, ie. position and mean radius, are kept:
    smoothing then neither moves nor shrinks a circle.
    """
    arc_lengths, points = _equidistant(spline, n)
    harmonics = np.fft.fft(points[:, 0] + 1j * points[:, 1])
    k = np.abs(np.fft.fftfreq(n, 1.0 / n))

    def removed(log_k_c: float) -> NDArray[np.complex128]:
        ratio = (k / np.exp(log_k_c)) ** 6
        return harmonics * np.where(k <= 1, 0.0, ratio / (1 + ratio))

    def excess(log_k_c: float) -> float:
        return float(np.linalg.norm(removed(log_k_c))) / n - deviation  # Parseval

    least, most = np.log(0.1), np.log(10.0 * n)
    log_k_c = np.log(arc_lengths[-1] / wavelength) if wavelength > 0 else most
    if deviation > 0 and excess(log_k_c) < 0:
        log_k_c = brentq(excess, least, log_k_c, xtol=1e-6) if excess(least) > 0 else least
    smooth = np.fft.ifft(harmonics - removed(log_k_c))
    points = np.column_stack([smooth.real, smooth.imag])
    return _periodic_spline(_chord_lengths(points), points)
