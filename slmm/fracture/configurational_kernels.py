"""Kernels of configurational forces: loops over elements and integration points, in parallel over the elements.

What is only a step on the way has arrays of its own (`slmm.mechanics.kinematics`, `configurational_stresses`); the
forces themselves keep everything between in registers, the matrices of solids as tuples of nine numbers by rows.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from slmm.mechanics.kinematics import over_elements, small

#: det dX/dR over its largest entry to the power of the dimension: no element above this is degenerate; chosen
SUSPECT = 1e-6


@over_elements
def configurational_stresses(F, P, energy, displacement_based):
    """e I - F^T P, or e I - (F - I)^T P (el, ips, d, d)."""
    elements, points, d, _ = F.shape
    result = np.empty_like(F)
    for e in prange(elements):
        for q in range(points):
            for i in range(d):
                for j in range(d):
                    total = energy[e, q] if i == j else 0.0
                    for k in range(d):
                        total -= F[e, q, k, i] * P[e, q, k, j]
                    if displacement_based:
                        total += P[e, q, i, j]
                    result[e, q, i, j] = total
    return result


@over_elements
def forces_2d(X, U, S, energy, dN, weights, displacement_based, linear):
    """Configurational forces (el, n, 2), how many points may be degenerate, and a sum that shows what is not finite."""
    elements, n, _ = X.shape
    result = np.empty((elements, n, 2))
    minus = 1.0 if displacement_based else 0.0
    suspects, total = 0, 0.0
    for e in prange(elements):
        for q in range(len(dN)):
            a = b = c = d = s = t = v = w = 0.0
            for k in range(n):
                r0, r1 = dN[q, k, 0], dN[q, k, 1]
                x, y, ux, uy = X[e, k, 0], X[e, k, 1], U[e, k, 0], U[e, k, 1]
                a, b, c, d = a + x * r0, b + x * r1, c + y * r0, d + y * r1
                s, t, v, w = s + ux * r0, t + ux * r1, v + uy * r0, w + uy * r1
            det = a * d - b * c
            size = max(abs(a), abs(b), abs(c), abs(d))
            suspects += not det > SUSPECT * size * size
            inverse = 1.0 / det
            i00, i01, i10, i11 = d * inverse, -b * inverse, -c * inverse, a * inverse
            f00, f01 = 1.0 + s * i00 + t * i10, s * i01 + t * i11
            f10, f11 = v * i00 + w * i10, 1.0 + v * i01 + w * i11
            s00, s01, s10, s11 = S[e, q, 0, 0], S[e, q, 0, 1], S[e, q, 1, 0], S[e, q, 1, 1]
            if linear:
                p00, p01, p10, p11 = s00, s01, s10, s11
            else:
                p00, p01 = s00 * f11 - s01 * f01, s01 * f00 - s00 * f10
                p10, p11 = s10 * f11 - s11 * f01, s11 * f00 - s10 * f10
            f00, f11 = f00 - minus, f11 - minus
            c00, c01 = energy[e, q] - f00 * p00 - f10 * p10, -f00 * p01 - f10 * p11
            c10, c11 = -f01 * p00 - f11 * p10, energy[e, q] - f01 * p01 - f11 * p11
            volume = weights[q] * det
            g00, g01 = (c00 * i00 + c01 * i01) * volume, (c00 * i10 + c01 * i11) * volume
            g10, g11 = (c10 * i00 + c11 * i01) * volume, (c10 * i10 + c11 * i11) * volume
            total += g00 + g01 + g10 + g11
            for k in range(n):
                r0, r1 = dN[q, k, 0], dN[q, k, 1]
                if q == 0:
                    result[e, k, 0], result[e, k, 1] = g00 * r0 + g01 * r1, g10 * r0 + g11 * r1
                else:
                    result[e, k, 0] += g00 * r0 + g01 * r1
                    result[e, k, 1] += g10 * r0 + g11 * r1
    return result, suspects, total


@small
def _cofactors(m):
    """Cofactors of a 3 x 3 matrix, as the nine numbers of its rows."""
    a, b, c, d, e, f, g, h, i = m
    return (
        e * i - f * h,
        f * g - d * i,
        d * h - e * g,
        c * h - b * i,
        a * i - c * g,
        b * g - a * h,
        b * f - c * e,
        c * d - a * f,
        a * e - b * d,
    )


@small
def _with_outer(m, x, y, z, p, q, r):
    """M and the outer product of two vectors."""
    a, b, c, d, e, f, g, h, i = m
    return (
        a + x * p,
        b + x * q,
        c + x * r,
        d + y * p,
        e + y * q,
        f + y * r,
        g + z * p,
        h + z * q,
        i + z * r,
    )


@small
def _times(m, k, diagonal):
    """M K^T of two 3 x 3 matrices, and a number on the diagonal."""
    a, b, c, d, e, f, g, h, i = m
    p, q, r, s, t, u, v, w, x = k
    return (
        a * p + b * q + c * r + diagonal,
        a * s + b * t + c * u,
        a * v + b * w + c * x,
        d * p + e * q + f * r,
        d * s + e * t + f * u + diagonal,
        d * v + e * w + f * x,
        g * p + h * q + i * r,
        g * s + h * t + i * u,
        g * v + h * w + i * x + diagonal,
    )


@small
def _transposed(m):
    a, b, c, d, e, f, g, h, i = m
    return a, d, g, b, e, h, c, f, i


@small
def _scaled(m, factor):
    a, b, c, d, e, f, g, h, i = m
    return (
        a * factor,
        b * factor,
        c * factor,
        d * factor,
        e * factor,
        f * factor,
        g * factor,
        h * factor,
        i * factor,
    )


@over_elements
def forces_3d(X, U, S, energy, dN, weights, displacement_based, linear):
    """Configurational forces (el, n, 3), and what `forces_2d` gives with them."""
    elements, n, _ = X.shape
    result = np.empty((elements, n, 3))
    minus = 1.0 if displacement_based else 0.0
    suspects, total = 0, 0.0
    for e in prange(elements):
        for q in range(len(dN)):
            J = dU = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            for k in range(n):
                r0, r1, r2 = dN[q, k, 0], dN[q, k, 1], dN[q, k, 2]
                J = _with_outer(J, X[e, k, 0], X[e, k, 1], X[e, k, 2], r0, r1, r2)
                dU = _with_outer(dU, U[e, k, 0], U[e, k, 1], U[e, k, 2], r0, r1, r2)
            cofactors = _cofactors(J)
            det = J[0] * cofactors[0] + J[1] * cofactors[1] + J[2] * cofactors[2]
            size = 0.0
            for number in J:
                size = max(size, abs(number))
            suspects += not det > SUSPECT * size * size * size
            # of dX/dR the inverse's transpose
            inverse = _scaled(cofactors, 1.0 / det)
            F = _times(dU, inverse, 1.0)
            s = S[e, q]
            P = (s[0, 0], s[0, 1], s[0, 2], s[1, 0], s[1, 1], s[1, 2], s[2, 0], s[2, 1], s[2, 2])
            if not linear:
                P = _times(P, _transposed(_cofactors(F)), 0.0)
            H = (F[0] - minus, F[1], F[2], F[3], F[4] - minus, F[5], F[6], F[7], F[8] - minus)
            product = _scaled(_times(_transposed(H), _transposed(P), -energy[e, q]), -weights[q] * det)
            G = _times(product, _transposed(inverse), 0.0)
            for number in G:
                total += number
            for k in range(n):
                r0, r1, r2 = dN[q, k, 0], dN[q, k, 1], dN[q, k, 2]
                if q == 0:
                    result[e, k, 0] = G[0] * r0 + G[1] * r1 + G[2] * r2
                    result[e, k, 1] = G[3] * r0 + G[4] * r1 + G[5] * r2
                    result[e, k, 2] = G[6] * r0 + G[7] * r1 + G[8] * r2
                else:
                    result[e, k, 0] += G[0] * r0 + G[1] * r1 + G[2] * r2
                    result[e, k, 1] += G[3] * r0 + G[4] * r1 + G[5] * r2
                    result[e, k, 2] += G[6] * r0 + G[7] * r1 + G[8] * r2
    return result, suspects, total
