"""What densities on panels cause at points: displacement and stress functions of Kolosov and Muskhelishvili.

With w = 2 mu (u + i v) and f the resultant force (df = i (t_x + i t_y) ds), the densities are g = w/(kappa + 1) and
q = f/(kappa + 1) on the boundary, and on a crack g is the jump of w, left less right, over kappa + 1. With

    C1 = int g dtau/(tau - z),  C2 = int g conj(dtau)/conj(tau - z),  C3 = int conj(g) d[(tau - z)/conj(tau - z)]

they cause w = (kappa C1 - C2 + C3)/(2 pi i) and, C of q, w = (kappa (C1 + C2) + C3)/(2 pi i).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from slmm.boundary.moments import chord_log, is_beyond, is_far, line_log, moments

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


@njit(cache=True, error_model="numpy")
def _far_displacement(target, z, dz, C1, C3):
    """C1 and C3 of a panel's points by the plain Gauss rule."""
    for j in range(len(z)):
        x, y = z[j].real - target.real, z[j].imag - target.imag
        step = dz[j]
        r = 1.0 / (x * x + y * y)
        u = complex(x * r, y * r)
        C1[j] = complex((step.real * x + step.imag * y) * r, (step.imag * x - step.real * y) * r)
        # gap over its conjugate
        turn = complex((x * x - y * y) * r, 2 * x * y * r)
        C3[j] = u * (step - step.conjugate() * turn)


@njit(cache=True)
def _straight_displacement(target, on_panel, middle, half, inverse, I, C1, C3):
    """C1 and C3 of a straight panel for a target near or on it."""
    p = len(C1)
    zeta = (target - middle) / half
    log = complex(line_log(zeta.real), np.pi) if on_panel else chord_log(zeta)
    moments(zeta, log, 1, I[:, :p])
    rho = np.conj(half) / half
    delta = 0.0j
    if not on_panel:
        delta = rho * (target - middle) - np.conj(target - middle)
    share = delta / rho
    for j in range(p):
        one, two = 0.0j, 0.0j
        for n in range(p):
            one += I[0, n] * inverse[n, j]
            two += I[1, n] * inverse[n, j]
        C1[j] = one
        C3[j] = share * np.conj(two / half)


@njit(cache=True)
def _along_displacement(target, here, middle, half, log, z, dz, tangent, curvature, inverse, I, C1, C3):
    """C1 and C3 of a panel for a target on the same smooth curve, which may be its point ``here``."""
    p = len(C1)
    moments((target - middle) / half, log, 0, I[:, :p])
    _far_displacement(target, z, dz, C1, C3)
    for j in range(p):
        one = 0.0j
        for n in range(p):
            one += I[0, n] * inverse[n, j]
        C1[j] = one
    if here >= 0:
        direction = tangent[here]
        C3[here] = direction / np.conj(direction) * 1j * curvature[here] * abs(dz[here])


@njit(cache=True)
def _curved_displacement(target, middle, half, log, fine, chi, inverse, up, I, first, second, C1, C3):
    """C1 and C3 of a curved panel for a target beside its curve, by twice as many points."""
    p, q = len(C1), len(fine)
    moments((target - middle) / half, log, 1, I)
    for j in range(q):
        one, two = 0.0j, 0.0j
        for n in range(q):
            one += I[0, n] * inverse[n, j]
            two += I[1, n] * inverse[n, j]
        first[j] = one
        second[j] = chi[j] * one - np.conj(fine[j] - target) * two / half
    for j in range(p):
        one, two = 0.0j, 0.0j
        for n in range(q):
            one += up[n, j] * first[n]
            two += up[n, j] * second[n]
        C1[j] = one
        C3[j] = np.conj(two)


@njit(cache=True, error_model="numpy")
def boundary_displacement(
    targets,
    own,
    curve,
    p,
    z,
    dz,
    tangent,
    curvature,
    ends,
    straight,
    smooth,
    fine,
    chi,
    inverse,
    fine_inverse,
    up,
):
    """Weights of C1 and C3 (t, n) of boundary panels for targets (t,).

    ``own`` (t,) is the number of a target's own node, -1 for none: there it is the limit from inside. ``curve`` (t,) is
    the smooth curve that it lies on, -1 beside the boundary.
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
            of = slice(k * p, (k + 1) * p)
            one, three = C1[i, of], C3[i, of]
            on_panel = own[i] >= 0 and own[i] // p == k
            if is_beyond(target, middle, half):
                _far_displacement(target, z[of], dz[of], one, three)
                continue
            zeta = (target - middle) / half
            if is_far(zeta):
                _far_displacement(target, z[of], dz[of], one, three)
                continue
            if straight[k]:
                _straight_displacement(target, on_panel, middle, half, inverse[k], I, one, three)
                continue
            for j in range(2 * p):
                local[j] = (fine[k, j] - middle) / half
            log = panel_log(zeta, local, on_panel)
            along = curve[i] == smooth[k] and abs(target - middle) < (1 + 2 * ALONG) * abs(half)
            if along or on_panel:
                here = own[i] - k * p if on_panel else -1
                _along_displacement(
                    target,
                    here,
                    middle,
                    half,
                    log,
                    z[of],
                    dz[of],
                    tangent[of],
                    curvature[of],
                    inverse[k],
                    I,
                    one,
                    three,
                )
                continue
            _curved_displacement(
                target, middle, half, log, fine[k], chi[k], fine_inverse[k], up, I, first, second, one, three
            )
    return C1, C3


@njit(cache=True, error_model="numpy")
def displacement_matrix(C1, C3, kappa):
    """Real matrix (2 t, 2 n) from g to w, real and imaginary parts in turn, of weights C1 and C3 (t, n)."""
    t, n = C1.shape
    result = np.empty((2 * t, 2 * n))
    share = 0.5 / np.pi
    for i in range(t):
        for j in range(n):
            a, b = share * (kappa - 1) * C1[i, j].real, share * (kappa + 1) * C1[i, j].imag
            c, d = share * C3[i, j].real, share * C3[i, j].imag
            result[2 * i, 2 * j], result[2 * i, 2 * j + 1] = b + d, a - c
            result[2 * i + 1, 2 * j], result[2 * i + 1, 2 * j + 1] = -a - c, b - d
    return result


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


@njit(cache=True, error_model="numpy")
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
            if is_beyond(target, middle, half) or is_far(zeta):
                for j in range(p):
                    x, y = z[base + j].real - target.real, z[base + j].imag - target.imag
                    r = 1.0 / (x * x + y * y)
                    back = complex(x * r, -y * r)
                    step = dz[base + j]
                    square = back * back
                    P[i, base + j] = step * square
                    Q[i, base + j] = square * (step.conjugate() - 2 * step * complex(x, -y) * back)
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
