"""Cubic curves over their arc length: through the points of a closed outline, or of one of its pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.cubics import Cubics, closed_through, through

Array = NDArray[np.float64]

MIN_PIECES, MAX_PIECES = 256, 4000  # both chosen
#: largest angle (rad) by which the outline may turn within one piece; a circle's curvature is then good to
#: 0.02^2/12 = 3e-5 and its position to 2e-9 radii; chosen
TURN_PER_PIECE = 0.02
#: beyond this angle even the finest spline does not follow the outline any more: it has a corner; chosen
TURN_REFUSED = 0.4
#: jumps of the curvature over the outline's largest one that count; chosen
JUMP = 0.02
#: Gauss points for the arc length of one piece
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)
#: Newton steps for a point at a given arc length, at most, and the share of a piece that is the last one's: what is
#: left is about its square; both round-off
NEWTON_STEPS, REACHED = 6, 1e-8


def enclosed_area(points: Array) -> float:
    """Area within the closed polygon, mm^2; positive when it runs counter-clockwise."""
    x, y = (points - points.mean(axis=0)).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def chord_lengths(points: Array) -> Array:
    """Cumulated chord lengths (n + 1,), mm, once round."""
    chords = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    if chords.min() <= 1e-12 * chords.sum():
        k = int(chords.argmin())
        raise ValueError(f"points {k} and {(k + 1) % len(points)} of the outline coincide")
    return np.concatenate([[0.0], np.cumsum(chords)])


def checked_pieces(pieces: list[Array]) -> list[Array]:
    """The pieces (n, 2) checked, each ending exactly where the next one begins."""
    if not pieces:
        raise ValueError("an outline needs at least one piece")
    for k, piece in enumerate(pieces):
        if piece.ndim != 2 or piece.shape[1] != 2 or len(piece) < 2:
            raise ValueError(
                f"piece {k} of the outline has shape {piece.shape}: (n, 2) with n >= 2 is needed"
            )
        if not np.isfinite(piece).all():
            raise ValueError(f"piece {k} of the outline: its points must be finite numbers")
    size = float(np.ptp(np.vstack(pieces), axis=0).max())
    for k, piece in enumerate(pieces):
        following = pieces[(k + 1) % len(pieces)]
        if np.linalg.norm(piece[-1] - following[0]) > 1e-9 * size:
            raise ValueError(
                f"piece {k} of the outline ends at ({piece[-1, 0]:.6g}, {piece[-1, 1]:.6g}), but the next one begins"
                f" at ({following[0, 0]:.6g}, {following[0, 1]:.6g}); they must meet"
            )
        piece[-1] = following[0]
        chords = np.diff(piece, axis=0)
        lengths = np.linalg.norm(chords, axis=1)
        if lengths.min() <= 1e-12 * size:
            i = int(lengths.argmin())
            raise ValueError(f"points {i} and {i + 1} of piece {k} of the outline coincide")
        turn = np.abs(angles(chords[:-1], chords[1:]))
        if turn.max(initial=0.0) > TURN_REFUSED:
            x, y = piece[int(turn.argmax()) + 1]
            raise ValueError(f"piece {k} of the outline has a corner at ({x:.6g}, {y:.6g}); let it end there")
    points = np.vstack([piece[:-1] for piece in pieces])
    if len(points) < 3 or abs(enclosed_area(points)) <= 1e-12 * size**2:
        raise ValueError("the pieces of the outline enclose no area")
    return pieces


def open_spline(points: Array) -> Cubics:
    """Curve through the points (n, 2) of one piece, over its arc length from 0; two points are a straight line."""
    parameter = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    curve = through(parameter, points)
    if len(points) > 2:
        for _ in range(2):  # from the chord lengths to the arc lengths
            curve = through(np.concatenate([[0.0], np.cumsum(arc_lengths(curve))]), points)
    return curve


def turns_at(breaks: Array, coefficients: Array, index: NDArray[np.int64]) -> tuple[Array, Array]:
    """Unit tangents (k, 2) with which the curve arrives at some breaks, and the angles (k,) it turns by there."""
    before = (index - 1) % (len(breaks) - 1)
    h = np.diff(breaks)[before, None]
    c = coefficients[:, before]
    arriving = (3 * c[0] * h + 2 * c[1]) * h + c[2]
    return arriving / np.linalg.norm(arriving, axis=1, keepdims=True), angles(
        arriving, coefficients[2, index]
    )


def angles(one: Array, other: Array) -> Array:
    """Angles (n,) from one set of vectors (n, 2) to another, -pi to pi, counter-clockwise positive."""
    cross = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return np.arctan2(cross, (one * other).sum(axis=1))


def turned(vectors: Array, angles: Array) -> Array:
    """Vectors (n, 2) turned counter-clockwise by angles (n,)."""
    (x, y), c, s = vectors.T, np.cos(angles), np.sin(angles)
    return np.column_stack([c * x - s * y, s * x + c * y])


class _Speed:
    """How fast a spline runs within some of its pieces, of coefficients (4, n, 2)."""

    def __init__(self, coefficients: Array) -> None:
        a, b, c, _ = coefficients.transpose(0, 2, 1)
        self._bends, self._slopes, self._first = (
            np.ascontiguousarray(of)[:, None] for of in (3 * a, 2 * b, c)
        )

    def __call__(self, t: Array) -> Array:
        """Its speed (n, k) where the parameter is t (n, k) beyond each piece's beginning."""
        # the pieces last, for they are many
        t = np.ascontiguousarray(t.T)
        velocity = self._bends * t
        velocity += self._slopes
        velocity *= t
        velocity += self._first
        velocity *= velocity
        return np.ascontiguousarray(np.sqrt(velocity[0] + velocity[1]).T)


def arc_lengths(spline: Cubics) -> Array:
    """Arc lengths (m,) of the spline between its breaks."""
    half = 0.5 * np.diff(spline.breaks)
    speed = _Speed(spline.coefficients)(half[:, None] * (GAUSS_POINTS + 1))
    return np.asarray(half * (speed @ GAUSS_WEIGHTS))


def equidistant(spline: Cubics, n: int) -> tuple[Array, Array]:
    """Arc lengths (n + 1,) and points (n, 2) of the spline, evenly spaced in arc length."""
    lengths = arc_lengths(spline)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    s = np.linspace(0.0, arc[-1], n + 1)
    piece = np.clip(np.searchsorted(arc, s[:-1], side="right") - 1, 0, len(lengths) - 1)
    ahead, h, speed = (
        s[:-1] - arc[piece],
        np.diff(spline.breaks)[piece],
        _Speed(spline.coefficients[:, piece]),
    )
    part = ahead / lengths[piece]
    for _ in range(NEWTON_STEPS):
        # for the parameter at which the arc length from the break is the wanted one
        t = h * part
        reached = 0.5 * t * (speed(0.5 * t[:, None] * (GAUSS_POINTS + 1)) @ GAUSS_WEIGHTS)
        step = (ahead - reached) / (h * speed(t[:, None])[:, 0])
        part = np.clip(part + step, 0.0, 1.0)
        if np.abs(step).max() < REACHED:
            break
    return s, spline(spline.breaks[piece] + h * part)


def over_arc_length(spline: Cubics) -> Cubics:
    """A closed spline over its arc length, of as many pieces as its sharpest bend needs."""
    s, samples = equidistant(spline, MAX_PIECES)
    pieces = number_of_pieces(samples, s[1])
    if pieces < MAX_PIECES:
        s, samples = equidistant(spline, pieces)
    # the first pass brings the parameter to the arc length of the spline that was given, the next ones to that of the
    # spline through the equidistant points itself
    for _ in range(2):
        spline = closed_through(s, samples)
        s, samples = equidistant(spline, pieces)
    return closed_through(s, samples)


def number_of_pieces(points: Array, step: float) -> int:
    """As many pieces as the sharpest bend needs of an outline through `MAX_PIECES` points, a step of it apart, mm."""
    # the angle between neighbouring chords: unlike the second derivative, it forgives tiny kinks
    turn = np.abs(turns(points))
    sharpest = int(turn.argmax())
    if turn[sharpest] > TURN_REFUSED:
        x, y = points[(sharpest + 1) % MAX_PIECES]
        radius, allowed = step / turn[sharpest], step / TURN_REFUSED
        raise ValueError(
            f"the outline has a corner at ({x:.6g}, {y:.6g}): its radius of {radius:.3g} mm is too sharp"
            f" for a curvature; round it, with {allowed:.3g} mm or more"
        )
    return int(np.clip(np.ceil(MAX_PIECES * turn[sharpest] / TURN_PER_PIECE), MIN_PIECES, MAX_PIECES))


def turns(points: Array) -> Array:
    """Angles (n,), rad, by which a closed line through points (n, 2) turns at the end of each of its chords."""
    chords = np.roll(points, -1, axis=0) - points
    direction = chords[:, 0] + 1j * chords[:, 1]
    return np.asarray(np.angle(np.roll(direction, -1) / direction))


def smoothed(spline: Cubics, n: int, deviation: float, wavelength: float) -> Cubics:
    """Spline without the undulations that are noise, see `Outline.through`.

    On points evenly spaced in arc length, the penalty on the third derivative of a smoothing spline is the
    filter 1/(1 + (k/k_c)^6) on the k-th harmonic. Harmonics 0 and 1, ie. position and mean radius, are kept:
    smoothing then neither moves nor shrinks a circle.
    """
    arc_lengths, points = equidistant(spline, n)
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
        from scipy.optimize import brentq  # only what is noisy needs it, and it takes long to load

        log_k_c = brentq(excess, least, log_k_c, xtol=1e-6) if excess(least) > 0 else least
    smooth = np.fft.ifft(harmonics - removed(log_k_c))
    points = np.column_stack([smooth.real, smooth.imag])
    return closed_through(chord_lengths(points), points)


def curvature_jumps(breaks: Array, coefficients: Array) -> Array:
    """Arc lengths (k,) where the curvature jumps, as where an arc goes over into a straight side, mm."""
    a, b, c, _ = coefficients
    h = np.diff(breaks)[:, None]

    def bend(slope: Array, second: Array) -> Array:
        return (slope[:, 0] * second[:, 1] - slope[:, 1] * second[:, 0]) / np.linalg.norm(slope, axis=1) ** 3

    starts, ends = bend(c, 2 * b), bend((3 * a * h + 2 * b) * h + c, 6 * a * h + 2 * b)
    jump = np.abs(starts - np.roll(ends, 1))
    return breaks[:-1][jump > JUMP * np.abs(starts).max(initial=1e-300)]


def backwards(breaks: Array, coefficients: Array) -> Array:
    """Coefficients (4, m, 2) of the same pieces from the last one's end to the first one's start."""
    a, b, c, d = coefficients
    h = np.diff(breaks)[:, None]
    turned = [-a, 3 * a * h + b, -((3 * a * h + 2 * b) * h + c), ((a * h + b) * h + c) * h + d]
    return np.array(turned)[:, ::-1]
