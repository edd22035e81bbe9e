"""Holes where a smooth function is large: it interpolates support points on a grid by Gaussian kernels (Paper D, 2.3).

The kernel is separable, and so are the weights: two small products with the inverse of a matrix along one axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from skimage.measure import find_contours

from slmm.part.followed_contour import CornerError, followed
from slmm.part.graded_outline import graded_outline
from slmm.part.outline import Outline
from slmm.part.outline_splines import turns

Array = NDArray[np.float64]

#: samples between two support points in which contours are traced, and points of an outline; both chosen: contours that
#: touch are parted by the saddles' own test, not by the samples
SAMPLES, POINTS = 24, 40
#: largest angle, rad, by which a contour turns between two even points: beyond, it is followed; chosen
EVEN_TURN = 0.5
#: the same within three chords of a line that is traced on samples; chosen
TRACED_TURN = 0.9
#: Newton steps onto the contour, or a saddle, at most, and the step, in spacings, at which they end; round-off
STEPS, REACHED = 30, 1e-13
#: a saddle is sought up to so many spacings from where the search began; chosen
NEAR = 0.75


class IslandError(ValueError):
    """A contour has material within a hole.

    Attributes
    ----------
    at : (float, float)
        Near which place, mm.
    """

    at: tuple[float, float] = (math.nan, math.nan)


@dataclass(frozen=True, eq=False)
class LevelSet:
    """Support points on a square grid, 1 for a hole and 0 for material, and the function through them.

    Parameters
    ----------
    values : ndarray, shape (n, n)
        At the support points, row 0 at the top; those around them are 0.
    centre : (float, float)
        Of the grid, mm.
    spacing : float
        Between two support points, 2d in the paper, mm.
    length_scale : float
        Of the kernel, over half the spacing; published: 2.5.
    threshold : float
        Above which there is a hole; published: 0.5.

    Examples
    --------
    >>> one = LevelSet(np.array([[1.0]]), (40.0, 40.0), 16.0)
    >>> (outline,) = one.outlines()
    >>> bool(np.abs(one(outline.points(np.linspace(0, outline.length, 50))) - 0.5).max() < 1e-6)
    True
    """

    values: Array
    centre: tuple[float, float]
    spacing: float
    length_scale: float = 2.5
    threshold: float = 0.5

    @cached_property
    def axis(self) -> Array:
        """Places of the support points along one axis (m,), in spacings from the middle; the outer two are fixed."""
        m = len(self.values) + 2
        return np.asarray(np.arange(m) - (m - 1) / 2, dtype=np.float64)

    @cached_property
    def weights(self) -> Array:
        """Of the kernels (m, m), by y and x; y upwards."""
        supports = np.zeros((len(self.axis), len(self.axis)))
        supports[1:-1, 1:-1] = self.values[::-1]
        inverse = np.linalg.inv(self._kernel(self.axis, 0))
        return np.asarray(inverse @ supports @ inverse, dtype=np.float64)

    def _kernel(self, at: Array, order: int) -> Array:
        """Kernels of all supports (n, m) along one axis at places (n,), in spacings, or their derivatives."""
        # the length scale is in half spacings
        rate = (2 / self.length_scale) ** 2
        gap = at[:, None] - self.axis
        value = np.exp(-rate * gap**2)
        if order == 0:
            return np.asarray(value, dtype=np.float64)
        factor = -2 * rate * gap if order == 1 else 4 * rate**2 * gap**2 - 2 * rate
        return np.asarray(factor * value, dtype=np.float64)

    def _derivative(self, places: Array, along_x: int, along_y: int) -> Array:
        """A derivative (n,) at places (n, 2), in spacings."""
        x, y = places.T
        return np.einsum("ni,ni->n", self._kernel(y, along_y) @ self.weights, self._kernel(x, along_x))

    def __call__(self, points: Array) -> Array:
        """The function (n,) at points (n, 2), mm."""
        return self._derivative((points - self.centre) / self.spacing, 0, 0)

    def outlines(self) -> list[Outline]:
        """Outlines of the holes, from below to above.

        Raises
        ------
        IslandError
            When there is material within a hole.
        """
        outlines, centre = [], np.array(self.centre)
        for line in self.contours():
            at = self._beside(line)
            if self._turning(at) <= EVEN_TURN:
                outlines.append(Outline.through(centre + self.spacing * at))
            else:
                followed = self._followed(at)
                # the body is on the right of lines
                outlines += [graded_outline(centre + self.spacing * ring[::-1]) for ring in followed]
        return sorted(outlines, key=lambda outline: tuple(outline.box[0][::-1]))

    def contours(self) -> list[Array]:
        """Lines (n, 2) around the holes, in spacings from the middle: traced on samples, with the saddles as they are.

        Raises
        ------
        IslandError
            When there is material within a hole.
        """
        if not self.values.any():
            return []
        side = np.linspace(self.axis[0], self.axis[-1], SAMPLES * (len(self.axis) - 1) + 1)
        along = self._kernel(side, 0)
        field = along @ self.weights @ along.T
        traced = find_contours(field, self.threshold, positive_orientation="high")
        # what has three points is a peak that hardly reaches the threshold
        lines = [side[0] + line[:-1, ::-1] * (side[1] - side[0]) for line in traced if len(line) > 4]
        if sharp := [line for line in lines if _is_sharp(line)]:
            # samples may connect otherwise than the contour where a saddle lies near the threshold
            followed = self._followed(np.vstack([self._beside(line) for line in sharp]))
            lines = [line for line in lines if not _is_sharp(line)] + followed
        for line in lines:
            x, y = line.T
            # the lines have what is high on one and the same side
            if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0:
                x, y = (self.centre + self.spacing * line.mean(axis=0)).tolist()
                island = IslandError(f"the pattern has an island of material near ({x:.4g}, {y:.4g})")
                island.at = x, y
                raise island
        return lines

    def _beside(self, places: Array) -> Array:
        """Points (k, 2), in spacings, evenly spaced along a closed line (n, 2) and then exactly on the contour."""
        ring = np.vstack([places, places[:1]])
        way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
        count = max(int(np.ceil(POINTS * way[-1])), 4 * POINTS)
        even = way[-1] * np.arange(count) / count
        return self._onto(np.column_stack([np.interp(even, way, ring[:, k]) for k in (0, 1)]))

    def _turning(self, at: Array) -> float:
        """The largest angle, rad, by which a contour turns between two of its points (n, 2)."""
        step = np.hypot(*(np.roll(at, -1, axis=0) - at).T)
        return float(max(np.abs(turns(at)).max(), (step * np.abs(self._bends(at))).max()))

    def _followed(self, places: Array) -> list[Array]:
        """Points (k, 2) of each contour that passes by some places (n, 2) on them, none of them left out.

        Raises
        ------
        ValueError
            Where it bends too sharply to be followed.
        """
        found, rate = [], (2 / self.length_scale) ** 2
        while len(places):
            start = places[int(np.abs(self._bends(places)).argmin())]
            try:
                ring = followed(self.axis, self.weights, rate, self.threshold, start, 1.0 / POINTS)
            except CornerError as error:
                x, y = (self.centre + self.spacing * error.at).tolist()
                raise ValueError(
                    f"the pattern has a corner near ({x:.6g}, {y:.6g}): its saddle lies {self.margin():.1g} from the"
                    " threshold, where holes neither meet nor part"
                ) from None
            found.append(ring)
            passed, _ = cKDTree(ring).query(places)
            places = places[passed > 1.0 / SAMPLES]
        return found

    def _onto(self, at: Array) -> Array:
        """The points of the contour (n, 2) to which the function's slope leads from places (n, 2)."""
        for _ in range(STEPS):
            slope = self._slopes(at)
            off = self._derivative(at, 0, 0) - self.threshold
            step = (off / (slope**2).sum(axis=1))[:, None] * slope
            at = at - step
            if np.abs(step).max() < REACHED:
                break
        return at

    def _slopes(self, at: Array) -> Array:
        """How the function rises along x and y (n, 2) at places (n, 2)."""
        return np.column_stack([self._derivative(at, 1, 0), self._derivative(at, 0, 1)])

    def _bends(self, at: Array) -> Array:
        """Curvatures (n,) of contours at places (n, 2), over spacings."""
        x, y = self._slopes(at).T
        xx, yy, xy = self._second(at)
        return np.asarray((xx * y**2 - 2 * xy * x * y + yy * x**2) / np.hypot(x, y) ** 3)

    def _second(self, at: Array) -> tuple[Array, Array, Array]:
        """Second derivatives (n,) by x, by y and by both at places (n, 2)."""
        xx, yy, xy = (self._derivative(at, *order) for order in ((2, 0), (0, 2), (1, 1)))
        return xx, yy, xy

    def margin(self) -> float:
        """How far the nearest saddle of the function is from the threshold: less, and the holes connect otherwise.

        Infinite where there is no saddle.
        """
        _, values = self.saddles()
        return float(np.abs(values - self.threshold).min(initial=np.inf))

    def saddles(self) -> tuple[Array, Array]:
        """Saddles of the function: places (k, 2), mm, and values (k,), the nearest to the threshold first.

        Where a saddle lies above the threshold two holes are one, where it lies below there is a ligament.

        Examples
        --------
        >>> diagonal = LevelSet(np.array([[1.0, 0.0], [0.0, 1.0]]), (40.0, 40.0), 16.0)
        >>> places, values = diagonal.saddles()
        >>> places[0].round(6).tolist(), round(float(values[0]), 3), len(diagonal.outlines())
        ([40.0, 40.0], 0.744, 1)
        """
        if not self.values.any():
            return np.empty((0, 2)), np.empty(0)
        half = np.arange(2 * len(self.axis) - 1) / 2 + self.axis[0]
        start = np.stack(np.meshgrid(half, half), axis=-1).reshape(-1, 2)
        at = start.copy()
        for _ in range(STEPS):
            slope = self._slopes(at)
            xx, yy, xy = self._second(at)
            determinant = xx * yy - xy**2
            determinant = np.where(np.abs(determinant) > 1e-12, determinant, np.inf)
            step = (
                np.column_stack([yy * slope[:, 0] - xy * slope[:, 1], xx * slope[:, 1] - xy * slope[:, 0]])
                / determinant[:, None]
            )
            at = at - np.clip(step, -NEAR, NEAR)
        xx, yy, xy = self._second(at)
        slope = self._slopes(at)
        is_saddle = (
            (xx * yy < xy**2) & (np.abs(slope).max(axis=1) < 1e-9) & (np.abs(at - start).max(axis=1) < NEAR)
        )
        is_saddle &= np.abs(at).max(axis=1) <= self.axis[-1] + 1e-6  # where holes are traced
        # several starts end at one saddle
        _, once = np.unique(at[is_saddle].round(6), axis=0, return_index=True)
        at = at[is_saddle][once]
        values = self._derivative(at, 0, 0)
        order = np.argsort(np.abs(values - self.threshold), kind="stable")
        return self.centre + self.spacing * at[order], values[order]


def _is_sharp(line: Array) -> bool:
    """Whether a traced line (n, 2) turns so much within three chords that samples do not tell how."""
    turn = turns(line)
    return bool(np.abs(turn + np.roll(turn, 1) + np.roll(turn, 2)).max() > TRACED_TURN)
