"""A closed notch outline, cubic over its arc length: smooth all round, or of pieces that meet at corners."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, PPoly
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from slmm.part.accuracy import Accuracy

Array = NDArray[np.float64]

MIN_PIECES, MAX_PIECES = 256, 4000
#: largest angle (rad) by which the outline may turn within one piece; a circle's curvature is then good to
#: 0.02^2/12 = 3e-5 and its position to 2e-9 radii
TURN_PER_PIECE = 0.02
#: beyond this angle even the finest spline does not follow the outline any more: it has a corner
TURN_REFUSED = 0.4
#: pieces that meet at less than this angle (rad) meet smoothly: over six decades of distance, the stress at so
#: flat a corner (r to the power of -2/pi times the angle) rises by less than 1 %
SMALLEST_TURN = 1e-3
#: where stretches of other outlines touch, the point is known to about a millionth of them, and the angle to its root
TOUCHING_TURN = 0.01
#: arc lengths nearer to a corner than this share of the outline are the corner
AT_CORNER = 1e-9
#: Gauss points for the arc length of one piece
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)
#: Newton steps for a point at a given arc length, at most, and the share of a piece at which they end
NEWTON_STEPS, REACHED = 6, 1e-15
#: of so many samples next to a point, one lies by its nearest point, be it on the other side of a sharp corner
NEIGHBOURS = 8


@dataclass(frozen=True, eq=False)
class Outline:
    """Closed outline of a hole, counter-clockwise, parametrised by its arc length s.

    It is smooth (`through`), or made of smooth pieces that may meet at corners (`of_pieces`).

    The normal into the material is the tangent turned by -90 degrees, n = (t_y, -t_x). In the local axes
    (xi along the tangent, eta along that normal) the outline is eta = kappa/2 xi^2: a circular hole of radius
    r has kappa = -1/r. At a corner the normal is the bisector into the material, and the tangent is
    perpendicular to it.

    Parameters
    ----------
    breaks : (m + 1,) array
        Arc lengths of the break points, mm, from 0 to the length of the outline; evenly spaced on an outline
        `through` points.
    coefficients : (4, m, 2) array
        Coefficients of x and y between the breaks, highest power first, as in `scipy.interpolate.PPoly`.
    corners : (k,) array
        Arc lengths of the corners, mm, ascending; each is one of the breaks. Empty on a smooth outline.
    accuracy : Accuracy, optional
        What is open about it when it was traced in a picture; None when it is exact.

    Examples
    --------
    >>> from slmm.part.shapes import circle
    >>> outline = Outline.through(circle((50, 50), 20.0))
    >>> round(outline.length, 4), round(float(outline.curvatures(3.0)), 4)
    (125.6637, -0.05)
    >>> triangle = Outline.of_pieces([[(0, 0), (4, 0)], [(4, 0), (0, 3)], [(0, 3), (0, 0)]])
    >>> triangle.corners.tolist(), np.degrees(triangle.corner_angles).round(2).tolist()
    ([0.0, 4.0, 9.0], [90.0, 36.87, 53.13])
    """

    breaks: Array
    coefficients: Array
    corners: Array = field(default_factory=lambda: _read_only(np.empty(0)))
    accuracy: Accuracy | None = None

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
        return cls(_read_only(spline.x), _read_only(spline.c))

    @classmethod
    def of_pieces(cls, pieces: Sequence[ArrayLike]) -> Outline:
        """Outline of smooth pieces that go round the hole once, in either sense, and may meet at corners.

        Parameters
        ----------
        pieces : sequence of (n, 2) array_like
            Points of each piece, mm, n >= 2: its first point is the last one of the piece before. Two points are
            a straight line, more of them a spline of its own that passes through them. An arc is good to the
            square of the angle between its points: 0.005 rad give a curvature that is good to 3e-5.
            s = 0 lies at the first point of the first piece. Where two pieces meet at less than 0.001 rad, the
            outline is smooth.

        Raises
        ------
        ValueError
            When a piece has another shape or no length, numbers are not finite, neighbours coincide, pieces do
            not meet, a piece has a corner inside, or the outline encloses nothing or turns back on itself.
        """
        joined = _joined([np.array(piece, dtype=float) for piece in pieces])
        if _enclosed_area(np.vstack([piece[:-1] for piece in joined])) < 0:
            joined = [piece[::-1] for piece in reversed(joined)]
        splines = [_open_spline(piece) for piece in joined]
        starts = np.concatenate([[0.0], np.cumsum([spline.x[-1] for spline in splines])])
        breaks = np.concatenate(
            [*(start + spline.x[:-1] for start, spline in zip(starts, splines, strict=False)), starts[-1:]]
        )
        coefficients = np.concatenate([spline.c for spline in splines], axis=1)
        first = np.concatenate([[0], np.cumsum([len(spline.x) - 1 for spline in splines])[:-1]])
        turns = _turns_at(breaks, coefficients, first)[1]
        if (np.abs(turns) > np.pi - SMALLEST_TURN).any():
            x, y = coefficients[3, first[int(np.abs(turns).argmax())]]
            raise ValueError(
                f"the outline turns back on itself at ({x:.6g}, {y:.6g}): a corner needs an opening"
            )
        corners = breaks[first[np.abs(turns) >= SMALLEST_TURN]]
        return cls(_read_only(breaks), _read_only(coefficients), _read_only(corners))

    @classmethod
    def of_parts(cls, parts: Sequence[tuple[Outline, float, float]]) -> Outline:
        """Outline of stretches of others, counter-clockwise, on their exact curves.

        Parameters
        ----------
        parts : sequence of (Outline, float, float)
            An outline and the arc lengths from which and up to which it is followed, mm. Each stretch ends where the
            next one begins; what rounding leaves between them is made up for along the stretch. Two that meet at
            less than 0.01 rad touch there, without a corner.
        """
        steps, coefficients, corners, first = [], [], [], []
        reached, number = 0.0, 0
        for k, (outline, start, end) in enumerate(parts):
            following, beginning, _ = parts[(k + 1) % len(parts)]
            missing = following.points(beginning) - outline.points(end)
            own_steps, own = _cut(outline, start, end)
            along = np.concatenate([[0.0], np.cumsum(own_steps)])
            own[3] += missing * (along[:-1] / along[-1])[:, None]
            own[2] += missing / along[-1]
            inner = (outline.corners - start) % outline.length
            nearest = AT_CORNER * outline.length
            inner = np.sort(inner[(inner > nearest) & (inner < along[-1] - nearest)])
            corners.append(along[np.abs(along[:, None] - inner).argmin(axis=0)] + reached)
            first.append(number)
            steps.append(own_steps)
            coefficients.append(own)
            reached, number = reached + along[-1], number + len(own_steps)
        breaks = np.concatenate([[0.0], np.cumsum(np.concatenate(steps))])
        joined = np.concatenate(coefficients, axis=1)
        turns = np.abs(_turns_at(breaks, joined, np.array(first))[1])
        at = np.concatenate([*corners, breaks[np.array(first)[turns >= TOUCHING_TURN]]])
        # sums in another order differ by rounding: each corner is one of the breaks
        at = breaks[np.unique(np.abs(breaks[:-1, None] - at).argmin(axis=0))] if len(at) else at
        known = [outline.accuracy for outline in dict.fromkeys(part[0] for part in parts)]
        traced = [accuracy for accuracy in known if accuracy is not None]
        return cls(
            _read_only(breaks),
            _read_only(joined),
            _read_only(at),
            Accuracy.of_all(traced) if traced else None,
        )

    def with_accuracy(self, accuracy: Accuracy) -> Outline:
        """The same outline, with what is open about it."""
        return replace(self, accuracy=accuracy)

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
    def _is_even(self) -> bool:
        steps = np.diff(self.breaks)
        return not len(self.corners) and bool(np.ptp(steps) <= 1e-9 * steps.mean())

    @cached_property
    def _corner_turns(self) -> tuple[Array, Array]:
        return _turns_at(self.breaks, self.coefficients, np.searchsorted(self.breaks, self.corners))

    @cached_property
    def _samples(self) -> tuple[Array, Array, Array, cKDTree]:
        """Arc lengths, how far down and up from each a nearest point is sought, and the tree of their points."""
        s = self._along(max(2000, 2 * (len(self.breaks) - 1)))
        if self._is_even:
            step = self.length / len(s)
            return s, s - step, s + step, cKDTree(self.points(s))
        below = np.roll(s, 1)
        below[0] -= self.length
        above = np.roll(s, -1)
        above[-1] += self.length
        # A corner is two samples, one for either side; the last number before it still belongs to the piece
        # that ends there.
        is_corner = np.isin(s, self.corners)
        before_corner = np.roll(is_corner, -1)
        above[before_corner] = np.nextafter(above[before_corner], 0.0)
        ending = above[before_corner]
        s, below, above = (
            np.concatenate([s, ending]),
            np.concatenate([np.where(is_corner, s, below), s[before_corner]]),
            np.concatenate([above, ending]),
        )
        return s, below, above, cKDTree(self.points(s))

    @property
    def length(self) -> float:
        """Length of the outline, mm."""
        return float(self.breaks[-1])

    @property
    def corner_angles(self) -> Array:
        """Angles (k,) inside the hole at the corners, rad.

        Below pi it is the opening angle of a V-notch; above, the material pokes into the hole.
        """
        return np.pi - self._corner_turns[1]

    def points(self, s: ArrayLike) -> Array:
        """Points (..., 2) at the arc lengths s (mm, taken modulo the length)."""
        return self._curve(s)

    def tangents(self, s: ArrayLike) -> Array:
        """Unit tangents (..., 2), counter-clockwise round the hole; half way between the two of a corner."""
        t = self._velocity(s)
        t = t / np.linalg.norm(t, axis=-1, keepdims=True)
        corner = self.corner_at(s)
        if (at := corner >= 0).any():
            arriving, turns = self._corner_turns
            t[at] = _turned(arriving, 0.5 * turns)[corner[at]]
        return t

    def normals(self, s: ArrayLike) -> Array:
        """Unit normals (..., 2) into the material; at a corner its bisector."""
        t = self.tangents(s)
        return np.stack([t[..., 1], -t[..., 0]], axis=-1)

    def curvatures(self, s: ArrayLike) -> Array:
        """Signed curvatures (1/mm): negative where the hole bulges out as a circle does.

        Where pieces meet it is that of the piece which begins there.
        """
        t, k = self._velocity(s), self._acceleration(s)
        return (t[..., 1] * k[..., 0] - t[..., 0] * k[..., 1]) / np.linalg.norm(t, axis=-1) ** 3

    def corner_at(self, s: ArrayLike, within: float | None = None) -> NDArray[np.int64]:
        """Index (...) of the corner at the arc lengths s, -1 where there is none.

        Parameters
        ----------
        s : (...) array_like
            Arc lengths, mm, taken modulo the length.
        within : float, optional
            How near along the outline, mm; by default only what is the same but for rounding.
        """
        s = np.mod(s, self.length)
        index = np.full(np.shape(s), -1)
        if not len(self.corners):
            return index
        within = AT_CORNER * self.length if within is None else within
        behind = np.searchsorted(self.corners, s)
        for neighbour in (behind - 1) % len(self.corners), behind % len(self.corners):
            gap = np.abs(s - self.corners[neighbour])
            index = np.where(np.minimum(gap, self.length - gap) <= within, neighbour, index)
        return index

    def project(self, points: ArrayLike) -> Array:
        """Arc lengths s (n,) of the points of the outline that lie nearest to the given points (n, 2)."""
        points = np.asarray(points, dtype=float)
        s, below, above, tree = self._samples
        # without corners the nearest sample leads to the nearest point
        candidates = np.arange(1, NEIGHBOURS + 1) if len(self.corners) else [1]
        nearest = tree.query(points, k=candidates)[1]
        s, below, above, points = s[nearest], below[nearest], above[nearest], points[..., None, :]
        for _ in range(20):
            gap, t = self.points(s) - points, self._velocity(s)
            slope = (t * t).sum(-1) + (gap * self._acceleration(s)).sum(-1)
            # At a centre of curvature every point is equally near and the slope vanishes; the step back to
            # steepest descent keeps the direction, the clip keeps to the neighbours of the nearest sample.
            slope = np.where(slope > 0.1, slope, 1.0)
            new = np.clip(s - (gap * t).sum(-1) / slope, below, above)
            converged = np.abs(new - s).max(initial=0.0) < 1e-13 * self.length
            s = new
            if converged:
                break
        if not len(self.corners):
            return np.mod(s[..., 0], self.length)
        best = np.linalg.norm(self.points(s) - points, axis=-1).argmin(axis=-1)
        s = np.mod(np.take_along_axis(s, best[..., None], axis=-1)[..., 0], self.length)
        corner = self.corner_at(s)
        return np.where(corner >= 0, self.corners[corner], s)

    def polygon(self, n: int) -> Array:
        """Points (n, 2) round the outline, counter-clockwise and not repeated.

        On an outline `through` points they are equally spaced in arc length from s = 0. On one of pieces every
        corner is one of them (there are more than n points only if there are more than n corners); the others
        follow half the length and half the bends, so that a small arc between long sides has its share.
        """
        return self.points(self._along(n))

    def _along(self, n: int) -> Array:
        """Arc lengths (n,) of the points of a polygon, ascending."""
        if self._is_even:
            return np.linspace(0.0, self.length, n, endpoint=False)
        # the breaks are dense where the outline bends
        share = 0.5 * self.breaks / self.length + np.linspace(0.0, 0.5, len(self.breaks))
        starts = np.interp(self.corners if len(self.corners) else [0.0], self.breaks, share)
        stretch = np.diff(starts, append=starts[0] + 1.0)
        spare = max(n - len(starts), 0) * stretch
        count = 1 + spare.astype(int)
        missing = max(n - int(count.sum()), 0)
        count[np.argsort(count - 1 - spare, kind="stable")[:missing]] += 1
        steps = [
            start + extent * np.arange(k) / k for start, extent, k in zip(starts, stretch, count, strict=True)
        ]
        return np.sort(np.interp(np.concatenate(steps) % 1.0, share, self.breaks))


def _read_only(values: Array) -> Array:
    values = np.ascontiguousarray(values)
    values.setflags(write=False)
    return values


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


def _joined(pieces: list[Array]) -> list[Array]:
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
        turn = np.abs(_angles(chords[:-1], chords[1:]))
        if turn.max(initial=0.0) > TURN_REFUSED:
            x, y = piece[int(turn.argmax()) + 1]
            raise ValueError(f"piece {k} of the outline has a corner at ({x:.6g}, {y:.6g}); let it end there")
    points = np.vstack([piece[:-1] for piece in pieces])
    if len(points) < 3 or abs(_enclosed_area(points)) <= 1e-12 * size**2:
        raise ValueError("the pieces of the outline enclose no area")
    return pieces


def _open_spline(points: Array) -> PPoly:
    """Curve through the points (n, 2) of one piece, over its arc length from 0; two points are a straight line."""
    parameter = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if len(points) == 2:
        direction = (points[1] - points[0]) / parameter[1]
        return PPoly(np.array([[0 * direction], [0 * direction], [direction], [points[0]]]), parameter)
    for _ in range(3):  # from the chord lengths to the arc lengths
        spline = CubicSpline(parameter, points)
        parameter = np.concatenate([[0.0], np.cumsum(_lengths(spline))])
    return spline


def _cut(outline: Outline, start: float, end: float) -> tuple[Array, Array]:
    """Steps (m,) and coefficients (4, m, 2) of an outline from one arc length on to another."""
    length = outline.length
    extent = (end - start) % length or length
    inner = np.sort((outline.breaks[:-1] - start) % length)
    inner = inner[(inner > AT_CORNER * length) & (inner < extent - AT_CORNER * length)]
    offsets = np.concatenate([[0.0], inner])
    # the middle of a stretch tells its piece, whatever rounding does at its ends
    steps = np.diff(np.append(offsets, extent))
    middle = (start + offsets + 0.5 * steps) % length
    piece = np.clip(np.searchsorted(outline.breaks, middle, side="right") - 1, 0, len(outline.breaks) - 2)
    t = (middle - 0.5 * steps - outline.breaks[piece])[:, None]
    a, b, c, d = outline.coefficients[:, piece]
    return steps, np.array([a, 3 * a * t + b, (3 * a * t + 2 * b) * t + c, ((a * t + b) * t + c) * t + d])


def _turns_at(breaks: Array, coefficients: Array, index: NDArray[np.int64]) -> tuple[Array, Array]:
    """Unit tangents (k, 2) with which the curve arrives at some breaks, and the angles (k,) it turns by there."""
    before = (index - 1) % (len(breaks) - 1)
    h = np.diff(breaks)[before, None]
    c = coefficients[:, before]
    arriving = (3 * c[0] * h + 2 * c[1]) * h + c[2]
    return arriving / np.linalg.norm(arriving, axis=1, keepdims=True), _angles(
        arriving, coefficients[2, index]
    )


def _angles(one: Array, other: Array) -> Array:
    """Angles (n,) from one set of vectors (n, 2) to another, -pi to pi, counter-clockwise positive."""
    cross = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return np.arctan2(cross, (one * other).sum(axis=1))


def _turned(vectors: Array, angles: Array) -> Array:
    """Vectors (n, 2) turned counter-clockwise by angles (n,)."""
    (x, y), c, s = vectors.T, np.cos(angles), np.sin(angles)
    return np.column_stack([c * x - s * y, s * x + c * y])


def _periodic_spline(parameter: Array, points: Array) -> CubicSpline:
    return CubicSpline(parameter, np.vstack([points, points[:1]]), bc_type="periodic")


def _speed(spline: CubicSpline, u: Array) -> Array:
    x, y = np.moveaxis(spline(u, 1), -1, 0)
    return np.hypot(x, y)


def _lengths(spline: CubicSpline) -> Array:
    """Arc lengths (m,) of the spline between its breaks."""
    u, h = spline.x, np.diff(spline.x)
    at = u[:-1, None] + 0.5 * h[:, None] * (GAUSS_POINTS + 1)
    return 0.5 * h * (_speed(spline, at) @ GAUSS_WEIGHTS)


def _equidistant(spline: CubicSpline, n: int) -> tuple[Array, Array]:
    """Arc lengths (n + 1,) and points (n, 2) of the spline, evenly spaced in arc length."""
    u, h = spline.x, np.diff(spline.x)
    lengths = _lengths(spline)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    s = np.linspace(0.0, arc[-1], n + 1)
    piece = np.clip(np.searchsorted(arc, s[:-1], side="right") - 1, 0, len(h) - 1)
    part = (s[:-1] - arc[piece]) / lengths[piece]
    for _ in range(
        NEWTON_STEPS
    ):  # for the parameter at which the arc length from the break is the wanted one
        at = u[piece, None] + 0.5 * (h[piece] * part)[:, None] * (GAUSS_POINTS + 1)
        reached = 0.5 * h[piece] * part * (_speed(spline, at) @ GAUSS_WEIGHTS)
        step = (s[:-1] - arc[piece] - reached) / (h[piece] * _speed(spline, u[piece] + h[piece] * part))
        part = np.clip(part + step, 0.0, 1.0)
        if np.abs(step).max() < REACHED:
            break
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
