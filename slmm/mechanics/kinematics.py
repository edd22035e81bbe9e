"""Deformation gradients and first Piola-Kirchhoff stresses: loops over elements and integration points."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from slmm.running.threaded import threaded

# a division by zero gives what is not finite, which is looked for afterwards; "contract" lets a product and a sum be
# one instruction
small = njit(cache=True, error_model="numpy", fastmath={"contract"})
over_elements = threaded(cache=True, error_model="numpy", fastmath={"contract"})


@small
def _invert(J, inverse, d):
    """Inverse of the leading (d, d) of a matrix, and its determinant."""
    if d == 2:
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        inverse[0, 0], inverse[0, 1] = J[1, 1] / det, -J[0, 1] / det
        inverse[1, 0], inverse[1, 1] = -J[1, 0] / det, J[0, 0] / det
        return det
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            inverse[m, i] = J[j, p] * J[k, q] - J[j, q] * J[k, p]
    det = J[0, 0] * inverse[0, 0] + J[0, 1] * inverse[1, 0] + J[0, 2] * inverse[2, 0]
    for i in range(3):
        for j in range(3):
            inverse[i, j] /= det
    return det


@small
def _product(a, b, result, n):
    """sum_k a[k, i] b[k, j] over the n rows of a (n, d) and b (n, d)."""
    d = a.shape[1]
    for i in range(d):
        for j in range(d):
            total = 0.0
            for k in range(n):
                total += a[k, i] * b[k, j]
            result[i, j] = total


@small
def _cofactor(F, result, d):
    """det(F) F^-T."""
    if d == 2:
        result[0, 0], result[0, 1] = F[1, 1], -F[1, 0]
        result[1, 0], result[1, 1] = -F[0, 1], F[0, 0]
        return
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            result[i, m] = F[j, p] * F[k, q] - F[j, q] * F[k, p]


@over_elements
def deformation_gradients(X, U, dN):
    """Deformation gradients (el, ips, d, d)."""
    elements, n, d = X.shape
    result = np.empty((elements, len(dN), d, d))
    for e in prange(elements):
        J, inverse, dU = np.empty((d, d)), np.empty((d, d)), np.empty((d, d))
        for q in range(len(dN)):
            _product(X[e], dN[q], J, n)
            _invert(J, inverse, d)
            _product(U[e], dN[q], dU, n)
            for i in range(d):
                for j in range(d):
                    total = 1.0 if i == j else 0.0
                    for k in range(d):
                        total += dU[i, k] * inverse[k, j]
                    result[e, q, i, j] = total
    return result


@over_elements
def piola_stresses(F, S):
    """P = det(F) S F^-T (el, ips, d, d)."""
    elements, points, d, _ = F.shape
    result = np.empty_like(F)
    for e in prange(elements):
        cofactor = np.empty((d, d))
        for q in range(points):
            _cofactor(F[e, q], cofactor, d)
            for i in range(d):
                for j in range(d):
                    total = 0.0
                    for k in range(d):
                        total += S[e, q, i, k] * cofactor[k, j]
                    result[e, q, i, j] = total
    return result
