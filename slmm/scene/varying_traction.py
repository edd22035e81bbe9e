"""A traction that changes smoothly along a span of a surface, as nodal forces of other programs tell it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from slmm.part.span import Span

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class VaryingTraction:
    """A traction that is a polynomial in the share of the length of a span.

    Parameters
    ----------
    span : Span
    coefficients : ndarray (k, 2)
        Of Legendre's polynomials in twice the share less 1, for each component, MPa.

    Examples
    --------
    >>> from slmm.part.outline import Outline
    >>> from slmm.part.shapes import circle
    >>> hole = Outline.through(circle((0, 0), 10.0))
    >>> rising = VaryingTraction(Span(hole, hole.length / 2, 0.0), np.array([[1.0, 0.0], [1.0, 0.0]]))
    >>> rising(np.array([[0.0, 10.0], [10.0, 0.0]])).round(6).tolist()
    [[1.0, 0.0], [2.0, 0.0]]
    """

    span: Span
    coefficients: Array

    def __call__(self, points: Array) -> Array:
        """Tractions (n, 2) at points (n, 2) of the span, MPa."""
        return np.asarray(legendre.legval(2 * self.span.share(points) - 1, self.coefficients), dtype=float).T
