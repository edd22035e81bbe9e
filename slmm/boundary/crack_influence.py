"""What displacement jumps on straight panels of cracks cause at points: weights of the powers of the distance."""

from __future__ import annotations

import numpy as np
from numba import njit

from slmm.boundary.moments import chord_log, is_beyond, is_far, line_log, moments

TWO_PI_I = 2j * np.pi


@njit(cache=True, error_model="numpy")
def _inverse(gap):
    """1/gap, by products alone."""
    r = 1.0 / (gap.real * gap.real + gap.imag * gap.imag)
    return complex(gap.real * r, -gap.imag * r)


@njit(cache=True)
def crack_weights(targets, on, p, starts, ends, turn, is_tip, x, w, inverse, tip_x, tip_w, tip_inverse):
    """Weights (3, t, n) of 1/(tau - z), 1/(tau - z)^2 and 1/(tau - z)^3 of crack panels for targets (t,).

    And the distance (t, m) of targets from the panels' lines, as tau - z mirrored there less its conjugate.

    ``on`` (t,) is the panel on whose line a target lies, -1 for none: there the finite part counts. A panel with a tip
    ends at it; its density is an odd polynomial in the root of the distance. ``turn`` (m,) is the conjugate of a
    panel's direction over that direction.
    """
    t, m = len(targets), len(starts)
    M = np.empty((3, t, m * p), dtype=np.complex128)
    delta = np.empty((t, m), dtype=np.complex128)
    I = np.empty((3, 2 * p), dtype=np.complex128)
    for i in range(t):
        target = targets[i]
        for k in range(m):
            base = k * p
            along = ends[k] - starts[k]
            away = target - starts[k]
            delta[i, k] = 0.0j if on[i] == k else turn[k] * away - away.conjugate()
            if is_tip[k]:
                zeta = np.sqrt((ends[k] - target) / along)
                if is_far(zeta):
                    for j in range(p):
                        over = _inverse(ends[k] - along * (tip_x[j] * tip_x[j]) - target)
                        one = (2 * tip_x[j] * tip_w[j]) * along * over
                        M[0, i, base + j] = one
                        M[1, i, base + j] = one * over
                        M[2, i, base + j] = one * over * over
                    continue
                if on[i] == k:
                    zeta = complex(zeta.real, 0.0)
                    log = complex(line_log(zeta.real), 0.0)
                else:
                    log = chord_log(zeta)
                moments(zeta, log, 2, I)
                over = 1.0 / (2 * along * zeta)
                slope, bend = -over, -over * over / zeta
                for j in range(p):
                    one, two, three = 0.0j, 0.0j, 0.0j
                    for n in range(p):
                        one += I[0, 2 * n + 1] * tip_inverse[n, j]
                        two += I[1, 2 * n + 1] * tip_inverse[n, j]
                        three += I[2, 2 * n + 1] * tip_inverse[n, j]
                    M[0, i, base + j] = -one
                    M[1, i, base + j] = -two * slope
                    M[2, i, base + j] = -0.5 * (three * slope * slope + two * bend)
                continue
            middle, half = 0.5 * (starts[k] + ends[k]), 0.5 * along
            zeta = (target - middle) / half
            if is_beyond(target, middle, half) or is_far(zeta):
                for j in range(p):
                    over = _inverse(middle + half * x[j] - target)
                    one = w[j] * half * over
                    M[0, i, base + j] = one
                    M[1, i, base + j] = one * over
                    M[2, i, base + j] = one * over * over
                continue
            if on[i] == k:
                zeta = complex(zeta.real, 0.0)
                log = complex(line_log(zeta.real), 0.0)
            else:
                log = chord_log(zeta)
            moments(zeta, log, 2, I[:, :p])
            for j in range(p):
                one, two, three = 0.0j, 0.0j, 0.0j
                for n in range(p):
                    one += I[0, n] * inverse[n, j]
                    two += I[1, n] * inverse[n, j]
                    three += I[2, n] * inverse[n, j]
                M[0, i, base + j] = one
                M[1, i, base + j] = two / half
                M[2, i, base + j] = 0.5 * three / (half * half)
    return M, delta


@njit(cache=True)
def displacement_by_jumps(moments, turn, delta, kappa):
    """Weights (t, n) of jumps and of their conjugates in W, by the weights of `crack_weights`.

    ``turn`` (m,) and ``delta`` (t, m) are those of `crack_weights`.
    """
    _, t, n = moments.shape
    p = n // len(turn)
    one, other = np.empty((t, n), dtype=np.complex128), np.empty((t, n), dtype=np.complex128)
    over = 1.0 / TWO_PI_I
    for i in range(t):
        for k in range(len(turn)):
            factor = delta[i, k] * turn[k].conjugate() * over
            for j in range(k * p, (k + 1) * p):
                first = moments[0, i, j]
                one[i, j] = (kappa * first - first.conjugate()) * over
                other[i, j] = factor * moments[1, i, j].conjugate()
    return one, other


@njit(cache=True)
def stress_by_jumps(moments, turn, delta):
    """Weights (t, n) in P, and in the part of Q that is linear in the jumps; parameters as above."""
    _, t, n = moments.shape
    p = n // len(turn)
    P, Q = np.empty((t, n), dtype=np.complex128), np.empty((t, n), dtype=np.complex128)
    over = 1.0 / TWO_PI_I
    for i in range(t):
        for k in range(len(turn)):
            for j in range(k * p, (k + 1) * p):
                P[i, j] = moments[1, i, j] * over
                Q[i, j] = -turn[k] * P[i, j] - 2 * delta[i, k] * moments[2, i, j] * over
    return P, Q
