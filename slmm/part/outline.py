"""A closed notch outline, cubic over its arc length: smooth all round, or of pieces that meet at corners."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slmm.mechanics.cubics import Cubics, closed_through
from slmm.mechanics.nearest import Nearest
from slmm.part.accuracy import Accuracy
from slmm.part.outline_splines import (
    backwards,
    checked_pieces,
    chord_lengths,
    enclosed_area,
    open_spline,
    over_arc_length,
    smoothed,
    turned,
    turns_at,
)

Array = NDArray[np.float64]

#: pieces that meet at less than this angle (rad) meet smoothly: over six decades of distance, the stress at so
#: flat a corner (r to the power of -2/pi times the angle) rises by less than 1 %; chosen
SMALLEST_TURN = 1e-3
#: arc lengths nearer to a corner than this share of the outline are the corner; round-off
AT_CORNER = 1e-9
#: of so many samples next to a point, one lies by its nearest point, be it on the other side of a sharp corner; chosen
NEIGHBOURS = 8


@dataclass(frozen=True, eq=False)
class Outline:
    """Closed outline of a hole, counter-clockwise, or of a part, clockwise, parametrised by its arc length s.

    It is smooth (`through`), or made of smooth pieces that may meet at corners (`of_pieces`).

    The normal into the material is the tangent turned by -90 degrees, n = (t_y, -t_x). In the local axes
    (xi along the tangent, eta along that normal) the outline is eta = kappa/2 xi^2: a circular hole of radius
    r has kappa = -1/r. At a corner the normal is the bisector into the material, and the tangent is
    perpendicular to it.

    Parameters
    ----------
    breaks : (m + 1,) array
        Arc lengths of the break points, mm, from 0 to the length of the outline; evenly spaced on an outline
        `through` points, and near each other where one of `graded_outline` bends.
    coefficients : (4, m, 2) array
        Coefficients of x and y between the breaks, highest power first, as in `slmm.mechanics.cubics`.
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
    corners: Array = field(default_factory=lambda: read_only(np.empty(0)))
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
        if enclosed_area(points) < 0:
            points = np.roll(points[::-1], 1, axis=0)  # the first point stays the first

        spline = closed_through(chord_lengths(points), points)
        if smoothing > 0 or wavelength > 0:
            spline = smoothed(spline, 2 * len(points), smoothing, wavelength)

        spline = over_arc_length(spline)
        return cls(read_only(spline.breaks), read_only(spline.coefficients))

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
        joined = checked_pieces([np.array(piece, dtype=float) for piece in pieces])
        if enclosed_area(np.vstack([piece[:-1] for piece in joined])) < 0:
            joined = [piece[::-1] for piece in reversed(joined)]
        splines = [open_spline(piece) for piece in joined]
        starts = np.concatenate([[0.0], np.cumsum([spline.breaks[-1] for spline in splines])])
        breaks = np.concatenate(
            [
                *(start + spline.breaks[:-1] for start, spline in zip(starts, splines, strict=False)),
                starts[-1:],
            ]
        )
        coefficients = np.concatenate([spline.coefficients for spline in splines], axis=1)
        first = np.concatenate([[0], np.cumsum([len(spline.breaks) - 1 for spline in splines])[:-1]])
        turns = turns_at(breaks, coefficients, first)[1]
        if (np.abs(turns) > np.pi - SMALLEST_TURN).any():
            x, y = coefficients[3, first[int(np.abs(turns).argmax())]]
            raise ValueError(
                f"the outline turns back on itself at ({x:.6g}, {y:.6g}): a corner needs an opening"
            )
        corners = breaks[first[np.abs(turns) >= SMALLEST_TURN]]
        return cls(read_only(breaks), read_only(coefficients), read_only(corners))

    def with_accuracy(self, accuracy: Accuracy) -> Outline:
        """The same outline, with what is open about it."""
        return replace(self, accuracy=accuracy)

    def reversed(self) -> Outline:
        """The same curve the other way round, from the same point: the outside of a part as if it were a hole.

        Examples
        --------
        >>> square = Outline.of_pieces([[(0, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 1)], [(0, 1), (0, 0)]])
        >>> square.reversed().normals([0.5]).round(6).tolist(), square.reversed().corner_angles.round(6).tolist()
        ([[1.0, -0.0]], [4.712389, 4.712389, 4.712389, 4.712389])
        """
        breaks, coefficients = self.length - self.breaks[::-1], backwards(self.breaks, self.coefficients)
        corners = np.sort((self.length - self.corners) % self.length)
        return Outline(read_only(breaks), read_only(coefficients), read_only(corners), self.accuracy)

    def _derivatives(self, s: ArrayLike, *orders: int) -> list[Array]:
        return Cubics(self.breaks, self.coefficients).derivatives(np.mod(s, self.length), *orders)

    @cached_property
    def _is_even(self) -> bool:
        steps = np.diff(self.breaks)
        return not len(self.corners) and bool(np.ptp(steps) <= 1e-9 * steps.mean())

    @cached_property
    def _corner_turns(self) -> tuple[Array, Array]:
        return turns_at(self.breaks, self.coefficients, np.searchsorted(self.breaks, self.corners))

    @cached_property
    def _samples(self) -> tuple[Array, Array, Array]:
        """Arc lengths, and how far down and up from each a nearest point is sought."""
        s = self.arc_lengths(max(2000, 2 * (len(self.breaks) - 1)))
        if self._is_even:
            step = self.length / len(s)
            return s, s - step, s + step
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
        return s, below, above

    @cached_property
    def _sampled(self) -> Nearest:
        return Nearest(self.points(self._samples[0]))

    @property
    def length(self) -> float:
        """Length of the outline, mm."""
        return float(self.breaks[-1])

    @cached_property
    def box(self) -> Array:
        """Lower left and upper right corner (2, 2) of a rectangle around it, mm: of its points, and a little more."""
        points = self._sampled.points
        gap = 0.5 * self.length / len(points)
        return np.array([points.min(axis=0) - gap, points.max(axis=0) + gap])

    @property
    def corner_angles(self) -> Array:
        """Angles (k,) inside the hole at the corners, rad.

        Below pi it is the opening angle of a V-notch; above, the material pokes into the hole.
        """
        return np.pi - self._corner_turns[1]

    def points(self, s: ArrayLike) -> Array:
        """Points (..., 2) at the arc lengths s (mm, taken modulo the length)."""
        return self._derivatives(s, 0)[0]

    def tangents(self, s: ArrayLike) -> Array:
        """Unit tangents (..., 2), counter-clockwise round the hole; half way between the two of a corner."""
        (t,) = self._derivatives(s, 1)
        t = t / np.linalg.norm(t, axis=-1, keepdims=True)
        corner = self.corner_at(s)
        if (at := corner >= 0).any():
            arriving, turns = self._corner_turns
            t[at] = turned(arriving, 0.5 * turns)[corner[at]]
        return t

    def normals(self, s: ArrayLike) -> Array:
        """Unit normals (..., 2) into the material; at a corner its bisector."""
        t = self.tangents(s)
        return np.stack([t[..., 1], -t[..., 0]], axis=-1)

    def curvatures(self, s: ArrayLike) -> Array:
        """Signed curvatures (1/mm): negative where the hole bulges out as a circle does.

        Where pieces meet it is that of the piece which begins there.
        """
        t, k = self._derivatives(s, 1, 2)
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
        s, below, above = self._samples
        # without corners the nearest sample leads to the nearest point
        nearest = self._sampled.numbers(points, NEIGHBOURS if len(self.corners) else 1)
        s, below, above, points = s[nearest], below[nearest], above[nearest], points[..., None, :]
        for _ in range(20):
            at, t, bend = self._derivatives(s, 0, 1, 2)
            gap = at - points
            slope = (t * t).sum(-1) + (gap * bend).sum(-1)
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
        return self.points(self.arc_lengths(n))

    def arc_lengths(self, n: int) -> Array:
        """Arc lengths (n,) of the points of a `polygon`, ascending, mm."""
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


def read_only(values: Array) -> Array:
    """An array that nobody changes any more."""
    values = np.ascontiguousarray(values)
    values.setflags(write=False)
    return values
