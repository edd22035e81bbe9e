"""Integrals of Legendre polynomials over powers of the distance to a point, in the complex plane.

Of a panel from -1 to 1 and a target zeta: I_n = int P_n(s)/(s - zeta) ds and its first two derivatives by zeta, by
three-term recursion from the logarithm (Helsing and Ojala, J. Comput. Phys. 227 (2008) 2899-2921). The recursion loses
digits with the distance, where plain Gauss rules do as well.
"""

from __future__ import annotations

import numpy as np
from numba import njit

#: half the sum of the distances to a panel's ends, in half panels, beyond which the plain Gauss rule serves: about 2
#: (chosen), and so much more that the middle of a neighbour of the same length, at 2 but for rounding, is always near
FAR = 2.0 * (1 + 1e-6)


@njit(cache=True)
def is_far(zeta):
    """Whether the plain Gauss rule serves for a target at zeta."""
    return 0.5 * (abs(zeta - 1.0) + abs(zeta + 1.0)) > FAR


@njit(cache=True)
def is_beyond(target, middle, half):
    """Whether it serves by the distance from the middle of a panel alone, which takes no roots."""
    x, y = target.real - middle.real, target.imag - middle.imag
    return x * x + y * y > FAR * FAR * (half.real * half.real + half.imag * half.imag)


@njit(cache=True)
def moments(zeta, log, order, out):
    """Fill ``out`` (3, n) with I, I' and I'' up to an order of derivative; ``log`` is I_0."""
    n = out.shape[1]
    out[0, 0] = log
    if n > 1:
        out[0, 1] = 2.0 + zeta * log
    for k in range(1, n - 1):
        out[0, k + 1] = ((2 * k + 1) * zeta * out[0, k] - k * out[0, k - 1]) / (k + 1)
    if order >= 1:
        out[1, 0] = -1.0 / (1.0 - zeta) - 1.0 / (1.0 + zeta)
        if n > 1:
            out[1, 1] = log + zeta * out[1, 0]
        for k in range(1, n - 1):
            out[1, k + 1] = out[1, k - 1] + (2 * k + 1) * out[0, k]
    if order >= 2:
        out[2, 0] = -1.0 / (1.0 - zeta) ** 2 + 1.0 / (1.0 + zeta) ** 2
        if n > 1:
            out[2, 1] = 2.0 * out[1, 0] + zeta * out[2, 0]
        for k in range(1, n - 1):
            out[2, k + 1] = out[2, k - 1] + (2 * k + 1) * out[1, k]


@njit(cache=True)
def chord_log(zeta):
    """I_0 of a target beside the straight way from -1 to 1."""
    return np.log((1.0 - zeta) / (-1.0 - zeta))


@njit(cache=True)
def line_log(x):
    """Finite part of I_0 for a target on the line itself."""
    return np.log(abs((1.0 - x) / (-1.0 - x)))
