"""A displacement that is known at places along a span of a surface, as results of other programs tell it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slmm.part.span import Span

if TYPE_CHECKING:
    from scipy.interpolate import Akima1DInterpolator

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sampled:
    """A displacement component that is known at places along a span, and smooth between them.

    Parameters
    ----------
    span : Span
    share : ndarray (n,)
        Of its length, ascending from 0 to 1.
    values : ndarray (n,)
        mm.

    Examples
    --------
    >>> from slmm.part.outline import Outline
    >>> from slmm.part.shapes import circle
    >>> hole = Outline.through(circle((0, 0), 10.0))
    >>> moved = Sampled(Span(hole, hole.length / 2, 0.0), np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.1, 0.2]))
    >>> moved(np.array([[0.0, 10.0], [10.0, 0.0]])).round(6).tolist()
    [0.1, 0.2]
    """

    span: Span
    share: Array
    values: Array

    def __call__(self, points: Array) -> Array:
        """Values (n,) at points (n, 2) of the span, mm."""
        return np.asarray(self._curve(self.span.share(points)))

    @cached_property
    def _curve(self) -> Akima1DInterpolator:
        from scipy.interpolate import Akima1DInterpolator  # results alone need it, and it takes long to load

        return Akima1DInterpolator(self.share, self.values, method="makima")

    @property
    def at(self) -> float:
        """Its mean over the places, mm."""
        return float(self.values.mean())
