"""Flanks of a traced contour: straight or gently curved stretches that a parabola follows.

All lengths are in pixels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: distance between the points of a contour; chosen
STEP = 0.5
#: lengths of flanks that are tried, one after the other, while a parabola follows them; chosen
FLANKS = tuple(4.0 * 1.4**k for k in range(14))
#: the shortest flank on which a parabola means anything; chosen
SHORTEST_PARABOLA = 7.0
#: longest flank at the end of a contour; chosen
AT_END = 8.0
#: by how much a flank may deviate from its parabola, in deviations of the contour; chosen
FOLLOWS = 1.8
#: standard deviations by which the bend of a flank must differ from zero; chosen
BENT = 3.0


class Noise(NamedTuple):
    """Root mean square by which the points of a contour err, and the distance over which they err together."""

    deviation: float
    correlation: float


@dataclass(frozen=True)
class Flank:
    """Parabola v(u) through contour points, u from its first point away from the vertex.

    Attributes
    ----------
    origin, along : ndarray (2,)
        Its first point, and the direction of u.
    coefficients : ndarray (3,)
        Of v, highest power first; the first one is 0 on a straight flank.
    covariance : ndarray (3, 3)
        Of the coefficients.
    length : float
        Of the contour that it follows.
    rest : float
        Root mean square of its distance from the points.
    """

    origin: Array
    along: Array
    coefficients: Array
    covariance: Array
    length: float
    rest: float

    @property
    def is_straight(self) -> bool:
        """Whether its bend is not certain."""
        return bool(self.coefficients[0] == 0.0)

    def points(self, u: Array) -> Array:
        """Points (n, 2) at some u (n,)."""
        across = np.array([-self.along[1], self.along[0]])
        v = np.polyval(self.coefficients, u)
        return self.origin + np.asarray(u)[:, None] * self.along + v[:, None] * across

    def direction(self, u: float) -> Array:
        """Unit tangent (2,) at u, away from the vertex."""
        across = np.array([-self.along[1], self.along[0]])
        t = self.along + np.polyval(np.polyder(self.coefficients), u) * across
        return t / np.hypot(*t)

    def spread(self, u: float) -> tuple[float, float]:
        """Standard deviations of the position and of the angle at u."""
        place, slope = np.array([u * u, u, 1.0]), np.array([2 * u, 1.0, 0.0])
        return float(np.sqrt(place @ self.covariance @ place)), float(
            np.sqrt(slope @ self.covariance @ slope)
        )


def evenly_spaced(points: Array, closed: bool) -> Array:
    """Points (m, 2) about `STEP` apart along a contour through others (n, 2); both ends of an open one are kept."""
    if closed:
        points = np.vstack([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    number = max(round(along[-1] / STEP), 8)
    at = np.linspace(0.0, along[-1], number + 1)
    even = np.column_stack([np.interp(at, along, coordinate) for coordinate in points.T])
    return even[:-1] if closed else even


def straight_flank(points: Array, noise: Noise) -> bool:
    """Whether all of the points (n, 2), `STEP` apart, lie on a straight line but for their deviation."""
    flank = _fitted(points, noise, STEP * (len(points) - 1))
    return flank is not None and flank.is_straight


def flank_at_end(points: Array, noise: Noise) -> Flank:
    """A short flank from the first one of the points (n, 2) on; at least a line through the first few."""
    found = flank_beside(points[: round(AT_END / STEP) + 1], False, 0, 1, 0.0, noise)
    return found if found is not None else _line(points[: max(round(FLANKS[0] / STEP), 2)], noise)


def at_index(index: NDArray[np.int64], n: int, closed: bool) -> NDArray[np.int64]:
    """Numbers of points beside others: round a closed contour, at most the ends of an open one."""
    return index % n if closed else np.clip(index, 0, n - 1)


def flank_beside(points: Array, closed: bool, i: int, side: int, gap: float, noise: Noise) -> Flank | None:
    """The longest flank that a parabola follows, from a gap beside a point on."""
    n = len(points)
    start = i + side * round(gap / STEP)
    room = n // 2 if closed else (n - 1 - start if side > 0 else start)
    best = None
    for length in FLANKS:
        number = round(length / STEP) + 1
        if number > room + 1:
            break
        flank = _fitted(points[at_index(start + side * np.arange(number), n, closed)], noise, length)
        if flank is not None:
            best = flank
        elif length >= SHORTEST_PARABOLA:
            break
    return best


def _fitted(points: Array, noise: Noise, length: float) -> Flank | None:
    """A straight flank when that follows the points, else a parabola, else None."""
    chord = points[-1] - points[0]
    along = chord / max(np.hypot(*chord), 1e-12)
    u, v = (points - points[0]) @ along, (points - points[0]) @ np.array([-along[1], along[0]])
    line_rest = _least_squares(u, v, 1, noise)[2]
    if length >= SHORTEST_PARABOLA:
        parabola, covariance, rest = _least_squares(u, v, 2, noise)
        bent = abs(parabola[0]) > BENT * np.sqrt(covariance[0, 0])
        if bent or line_rest > FOLLOWS * noise.deviation:
            if rest > FOLLOWS * noise.deviation:
                return None
            return Flank(points[0], along, parabola, covariance, length, rest)
    return None if line_rest > FOLLOWS * noise.deviation else _line(points, noise)


def _line(points: Array, noise: Noise) -> Flank:
    chord = points[-1] - points[0]
    length = float(np.hypot(*chord))
    along = chord / max(length, 1e-12)
    u, v = (points - points[0]) @ along, (points - points[0]) @ np.array([-along[1], along[0]])
    line, covariance, rest = _least_squares(u, v, 1, noise)
    return Flank(points[0], along, np.append(0.0, line), np.pad(covariance, ((1, 0), (1, 0))), length, rest)


def _least_squares(u: Array, v: Array, degree: int, noise: Noise) -> tuple[Array, Array, float]:
    """Coefficients, their covariance, and the root mean square of what they leave."""
    powers = np.vander(u, degree + 1)
    inverse = np.asarray(np.linalg.inv(powers.T @ powers), dtype=float)
    fitted = inverse @ (powers.T @ v)
    rest = float(np.sqrt(((v - powers @ fitted) ** 2).mean()))
    return fitted, (noise.correlation / STEP) * max(rest, noise.deviation) ** 2 * inverse, rest


def crossing(one: Flank, other: Flank, gap: float) -> tuple[tuple[float, float], Array] | None:
    """Where two flanks meet when they go on, None where they do not within reach."""
    u = np.array([-gap, -gap])
    for _ in range(30):
        apart = one.points(u[:1])[0] - other.points(u[1:])[0]
        slopes = [
            flank.along
            + np.polyval(np.polyder(flank.coefficients), value) * np.array([-flank.along[1], flank.along[0]])
            for flank, value in zip((one, other), u, strict=True)
        ]
        jacobian = np.column_stack([slopes[0], -slopes[1]])
        if abs(np.linalg.det(jacobian)) < 0.05:
            return None
        step = np.linalg.solve(jacobian, -apart)
        u = u + step
        if np.abs(u).max() > 20 * gap:
            return None
        if np.abs(step).max() < 1e-10:
            break
    # a vertex lies in front of both flanks, not much farther than the contour between them is long
    if not (np.all(u < 0.5) and np.all(u > -2.5 * gap - 2.0)):
        return None
    return (float(u[0]), float(u[1])), one.points(u[:1])[0]
