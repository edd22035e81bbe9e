"""What densities on panels cause at points: displacement and stress functions of Kolosov and Muskhelishvili.

With w = 2 mu (u + i v) and f the resultant force (df = i (t_x + i t_y) ds), the densities are g = w/(kappa + 1) and
q = f/(kappa + 1) on the boundary, and on a crack g is the jump of w, left less right, over kappa + 1. With

    C1 = int g dtau/(tau - z),  C2 = int g conj(dtau)/conj(tau - z),  C3 = int conj(g) d[(tau - z)/conj(tau - z)]

they cause w = (kappa C1 - C2 + C3)/(2 pi i) and, C of q, w = (kappa (C1 + C2) + C3)/(2 pi i).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from slmm.boundary.moments import chord_log, is_far, line_log, moments

TWO_PI_I = 2j * np.pi
#: neighbouring panels of one smooth curve so near, in panel lengths, see each other through a smooth kernel
ALONG = 1.5


@njit(cache=True)
def _arc(x, fine):
    """Height of an arc over its chord at x, by the polynomial through the six points (of ``fine``) next to it."""
    n = len(fine)
    width = min(6, n)
    first = min(max(np.searchsorted(fine.real, x) - width // 2, 0), n - width)
    height = 0.0
    for k in range(first, first + width):
        weight = 1.0
        for l in range(first, first + width):
            if l != k:
                weight *= (x - fine[l].real) / (fine[k].real - fine[l].real)
        height += weight * fine[k].imag
    return height


@njit(cache=True)
def _between(zeta, fine):
    """1 where a target lies between a chord and its arc, left of that; -1 right of it; 0 elsewhere."""
    x, y = zeta.real, zeta.imag
    if abs(x) >= 1.0:
        return 0
    arc = _arc(x, fine)
    if arc < y < 0.0:
        return 1
    if 0.0 < y < arc:
        return -1
    return 0


@njit(cache=True)
def panel_log(zeta, fine, on_panel):
    """I_0 of a target on a panel, as the limit from its left, or beside it; ``fine`` (k,) are points of it."""
    log = chord_log(zeta)
    if on_panel:
        return complex(log.real, log.imag if log.imag > 0 else log.imag + 2 * np.pi)
    return log + 2j * np.pi * _between(zeta, fine)


@njit(cache=True)
def boundary_displacement(
    targets, own, p, z, dz, tangent, curvature, ends, straight, smooth, fine, chi, inverse, fine_inverse, up
):
    """Weights of C1 and C3 (t, n) of boundary panels for targets (t,).

    ``own`` (t,) is the number of a target's own node, -1 beside the boundary; of a node it is the limit from inside.
    """
    t, m = len(targets), len(ends)
    C1 = np.empty((t, m * p), dtype=np.complex128)
    C3 = np.empty((t, m * p), dtype=np.complex128)
    I = np.empty((3, 2 * p), dtype=np.complex128)
    local = np.empty(2 * p, dtype=np.complex128)
    first, second = np.empty(2 * p, dtype=np.complex128), np.empty(2 * p, dtype=np.complex128)
    for i in range(t):
        target = targets[i]
        for k in range(m):
            middle, half = 0.5 * (ends[k, 0] + ends[k, 1]), 0.5 * (ends[k, 1] - ends[k, 0])
            zeta = (target - middle) / half
            base = k * p
            on_panel = own[i] // p == k and own[i] >= 0
            along = own[i] >= 0 and smooth[own[i] // p] == smooth[k] and not straight[k]
            if along and not on_panel:
                reach = ALONG * max(abs(ends[k, 1] - ends[k, 0]), 0.0)
                along = abs(target - middle) < 0.5 * abs(ends[k, 1] - ends[k, 0]) + reach
            if is_far(zeta):
                for j in range(p):
                    gap = z[base + j] - target
                    back = np.conj(gap)
                    step = dz[base + j]
                    C1[i, base + j] = step / gap
                    C3[i, base + j] = step / back - gap * np.conj(step) / (back * back)
                continue
            if straight[k]:
                log = complex(line_log(zeta.real), np.pi) if on_panel else chord_log(zeta)
                moments(zeta, log, 1, I[:, :p])
                rho = np.conj(half) / half
                delta = 0.0j
                if not on_panel:
                    delta = rho * (target - middle) - np.conj(target - middle)
                for j in range(p):
                    one, two = 0.0j, 0.0j
                    for n in range(p):
                        one += I[0, n] * inverse[k, n, j]
                        two += I[1, n] * inverse[k, n, j]
                    C1[i, base + j] = one
                    C3[i, base + j] = delta / rho * np.conj(two / half)
                continue
            for j in range(2 * p):
                local[j] = (fine[k, j] - middle) / half
            log = panel_log(zeta, local, on_panel)
            if along:
                moments(zeta, log, 0, I[:, :p])
                for j in range(p):
                    one = 0.0j
                    for n in range(p):
                        one += I[0, n] * inverse[k, n, j]
                    C1[i, base + j] = one
                    step = dz[base + j]
                    if base + j == own[i]:
                        direction = tangent[base + j]
                        C3[i, base + j] = (
                            direction / np.conj(direction) * 1j * curvature[base + j] * abs(step)
                        )
                    else:
                        gap = z[base + j] - target
                        back = np.conj(gap)
                        C3[i, base + j] = step / back - gap * np.conj(step) / (back * back)
                continue
            moments(zeta, log, 1, I)
            for j in range(2 * p):
                one, two = 0.0j, 0.0j
                for n in range(2 * p):
                    one += I[0, n] * fine_inverse[k, n, j]
                    two += I[1, n] * fine_inverse[k, n, j]
                first[j] = one
                second[j] = chi[k, j] * one - np.conj(fine[k, j] - target) * two / half
            for j in range(p):
                one, two = 0.0j, 0.0j
                for n in range(2 * p):
                    one += up[n, j] * first[n]
                    two += up[n, j] * second[n]
                C1[i, base + j] = one
                C3[i, base + j] = np.conj(two)
    return C1, C3


@njit(cache=True)
def of_highest(targets, own, p, ends, straight, fine, fine_tangent, length, fine_inverse, value, w):
    """C1 and C3 (t, m) of Legendre's P_p, which vanishes at all points, on panels, for targets (t,).

    ``own`` (t,) is the panel that a target lies on, -1 for none; ``value`` (2 p,) is P_p at the ``fine`` points, ``w``
    the weights of their rule.
    """
    t, m, q = len(targets), len(ends), 2 * p
    C1 = np.zeros((t, m), dtype=np.complex128)
    C3 = np.zeros((t, m), dtype=np.complex128)
    I = np.empty((3, q), dtype=np.complex128)
    local = np.empty(q, dtype=np.complex128)
    for i in range(t):
        target = targets[i]
        for k in range(m):
            middle, half = 0.5 * (ends[k, 0] + ends[k, 1]), 0.5 * (ends[k, 1] - ends[k, 0])
            zeta = (target - middle) / half
            far, on_panel = is_far(zeta), own[i] == k
            if far or (on_panel and not straight[k]):
                for j in range(q):
                    gap = fine[k, j] - target
                    back = np.conj(gap)
                    step = 0.5 * length[k] * fine_tangent[k, j] * w[j] * value[j]
                    if far:
                        C1[i, k] += step / gap
                    C3[i, k] += step / back - gap * np.conj(step) / (back * back)
                if far:
                    continue
            if straight[k]:
                log = complex(line_log(zeta.real), np.pi) if on_panel else chord_log(zeta)
                moments(zeta, log, 0 if on_panel else 1, I[:, : p + 1])
                C1[i, k] = I[0, p]
                if not on_panel:
                    rho = np.conj(half) / half
                    delta = rho * (target - middle) - np.conj(target - middle)
                    C3[i, k] = delta / rho * np.conj(I[1, p] / half)
                continue
            for j in range(q):
                local[j] = (fine[k, j] - middle) / half
            moments(zeta, panel_log(zeta, local, on_panel), 1, I)
            other = 0.0j
            for j in range(q):
                one, two = 0.0j, 0.0j
                for n in range(q):
                    one += I[0, n] * fine_inverse[k, n, j]
                    two += I[1, n] * fine_inverse[k, n, j]
                chi = np.conj(fine_tangent[k, j]) / fine_tangent[k, j]
                C1[i, k] += one * value[j]
                other += (chi * one - np.conj(fine[k, j] - target) * two / half) * value[j]
            if not on_panel:
                C3[i, k] = np.conj(other)
    return C1, C3


@njit(cache=True)
def boundary_stress(targets, p, z, dz, ends, straight, fine, chi, inverse, fine_inverse, up):
    """Weights (t, n) of boundary panels in P and in the part of Q that is linear in a density, times 2 pi i."""
    t, m = len(targets), len(ends)
    P = np.empty((t, m * p), dtype=np.complex128)
    Q = np.empty((t, m * p), dtype=np.complex128)
    I = np.empty((3, 2 * p), dtype=np.complex128)
    local = np.empty(2 * p, dtype=np.complex128)
    first, second = np.empty(2 * p, dtype=np.complex128), np.empty(2 * p, dtype=np.complex128)
    for i in range(t):
        target = targets[i]
        for k in range(m):
            middle, half = 0.5 * (ends[k, 0] + ends[k, 1]), 0.5 * (ends[k, 1] - ends[k, 0])
            zeta = (target - middle) / half
            base = k * p
            if is_far(zeta):
                for j in range(p):
                    gap = z[base + j] - target
                    step = dz[base + j]
                    P[i, base + j] = step / gap**2
                    Q[i, base + j] = np.conj(step) / gap**2 - 2 * np.conj(gap) * step / gap**3
                continue
            if straight[k]:
                moments(zeta, chord_log(zeta), 2, I[:, :p])
                rho = np.conj(half) / half
                delta = rho * (target - middle) - np.conj(target - middle)
                for j in range(p):
                    two, three = 0.0j, 0.0j
                    for n in range(p):
                        two += I[1, n] * inverse[k, n, j]
                        three += I[2, n] * inverse[k, n, j]
                    P[i, base + j] = two / half
                    Q[i, base + j] = -rho * two / half - delta * three / half**2
                continue
            for j in range(2 * p):
                local[j] = (fine[k, j] - middle) / half
            moments(zeta, panel_log(zeta, local, False), 2, I)
            for j in range(2 * p):
                two, three = 0.0j, 0.0j
                for n in range(2 * p):
                    two += I[1, n] * fine_inverse[k, n, j]
                    three += I[2, n] * fine_inverse[k, n, j]
                first[j] = two / half
                second[j] = chi[k, j] * two / half - np.conj(fine[k, j] - target) * three / half**2
            for j in range(p):
                two, three = 0.0j, 0.0j
                for n in range(2 * p):
                    two += up[n, j] * first[n]
                    three += up[n, j] * second[n]
                P[i, base + j] = two
                Q[i, base + j] = three
    return P, Q


@njit(cache=True)
def crack_weights(targets, on, p, starts, ends, is_tip, x, w, inverse, tip_x, tip_w, tip_inverse):
    """Weights (3, t, n) of 1/(tau - z), 1/(tau - z)^2 and 1/(tau - z)^3 of crack panels for targets (t,).

    ``on`` (t,) is the panel on whose line a target lies, -1 for none: there the finite part counts. A panel with a tip
    ends at it; its density is an odd polynomial in the root of the distance.
    """
    t, m = len(targets), len(starts)
    M = np.empty((3, t, m * p), dtype=np.complex128)
    I = np.empty((3, 2 * p), dtype=np.complex128)
    for i in range(t):
        target = targets[i]
        for k in range(m):
            base = k * p
            along = ends[k] - starts[k]
            if is_tip[k]:
                zeta = np.sqrt((ends[k] - target) / along)
                if is_far(zeta):
                    for j in range(p):
                        gap = ends[k] - along * tip_x[j] ** 2 - target
                        step = 2 * along * tip_x[j] * tip_w[j]
                        M[0, i, base + j] = step / gap
                        M[1, i, base + j] = step / gap**2
                        M[2, i, base + j] = step / gap**3
                    continue
                if on[i] == k:
                    zeta = complex(zeta.real, 0.0)
                    log = complex(line_log(zeta.real), 0.0)
                else:
                    log = chord_log(zeta)
                moments(zeta, log, 2, I)
                slope = -1.0 / (2 * along * zeta)
                bend = -1.0 / (4 * along**2 * zeta**3)
                for j in range(p):
                    one, two, three = 0.0j, 0.0j, 0.0j
                    for n in range(p):
                        one += I[0, 2 * n + 1] * tip_inverse[n, j]
                        two += I[1, 2 * n + 1] * tip_inverse[n, j]
                        three += I[2, 2 * n + 1] * tip_inverse[n, j]
                    M[0, i, base + j] = -one
                    M[1, i, base + j] = -two * slope
                    M[2, i, base + j] = -0.5 * (three * slope**2 + two * bend)
                continue
            middle, half = 0.5 * (starts[k] + ends[k]), 0.5 * along
            zeta = (target - middle) / half
            if is_far(zeta):
                for j in range(p):
                    gap = middle + half * x[j] - target
                    step = half * w[j]
                    M[0, i, base + j] = step / gap
                    M[1, i, base + j] = step / gap**2
                    M[2, i, base + j] = step / gap**3
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
                M[2, i, base + j] = 0.5 * three / half**2
    return M
