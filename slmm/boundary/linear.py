"""Complex quantities that are linear in a density and in its conjugate, as real matrices."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from slmm.boundary.rules import Array, Complex


class Linear(NamedTuple):
    """A complex quantity that is linear in a density: ``one`` times it and ``other`` times its conjugate."""

    one: Complex
    other: Complex

    def __call__(self, density: Any) -> Complex:
        """The quantity (t,) for a density (n,)."""
        return self.one @ density + self.other @ density.conj()

    def plus(self, more: Linear) -> Linear:
        """Both together."""
        return Linear(self.one + more.one, self.other + more.other)

    def real(self) -> Array:
        """Real matrix (2 t, 2 n) from real and imaginary parts to such."""
        return np.asarray(real_matrix(self.one, self.other))


@njit(cache=True)
def real_matrix(one, other):
    """Real matrix (2 t, 2 n) of what is linear in a density and its conjugate, (t, n); real and imaginary in turn."""
    t, n = one.shape
    result = np.empty((2 * t, 2 * n))
    for i in range(t):
        for j in range(n):
            plus, minus = one[i, j] + other[i, j], one[i, j] - other[i, j]
            result[2 * i, 2 * j], result[2 * i, 2 * j + 1] = plus.real, -minus.imag
            result[2 * i + 1, 2 * j], result[2 * i + 1, 2 * j + 1] = plus.imag, minus.real
    return result


@njit(cache=True)
def along_directions(P, Q, S, e):
    """Weights (t, n) of a density and its conjugate in the change of the force along directions e (t,).

    ``P`` and ``Q`` (t, n) are those in the stress functions; in Q the conjugate of the density has P times S.
    """
    t, n = P.shape
    one, other = np.empty((t, n), dtype=np.complex128), np.empty((t, n), dtype=np.complex128)
    for i in range(t):
        ahead, back = e[i], e[i].conjugate()
        for j in range(n):
            p = P[i, j].conjugate()
            one[i, j] = ahead * P[i, j] + S * (back * p)
            other[i, j] = ahead * p + back * Q[i, j].conjugate()
    return one, other
