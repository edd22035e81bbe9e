"""Kernels of the coarser grids: symmetric 9-point stencils of 2 x 2 blocks, Galerkin products, transfer.

A stencil array is (rows, 19, columns): per node the block of the node itself (xx, xy, yy) and the blocks
(xx, xy, yx, yy) that couple it to its neighbours east, north, north-east and north-west. The other half of
the matrix is the transpose of these. Fields, ``free`` and ``columns`` are laid out as in voxel_kernels.

Coarsening drops every second node but keeps both ends, so Dirichlet edges coincide on all grids. The odd node
2k + 1 lies between the coarse nodes k and k + 1 with the weights w[0, k] and w[1, k]; when the number of
intervals is odd, the last "odd" node is the end itself, w = (0, 1). (No literal 1 - w in here: numba makes an
integer times a float32 a float64.)
"""

from __future__ import annotations

import numpy as np
from numba import prange

from slmm.voxels.kernels import grid_kernel, inlined, residual_row, row_kernel, stencil_row

BLOCK = 16  # coarse rows in sequence per task: fine rows shared by two coarse ones are computed once; chosen


@inlined
def _node_force(j, S, T, xs, xc, xn, ys, yc, yn):
    """Nodal force at column j; S are the stencils of this row, T of the row below."""
    force_x = (
        S[0, j] * xc[j] + S[1, j] * yc[j]
        + S[3, j] * xc[j + 1] + S[4, j] * yc[j + 1] + S[3, j - 1] * xc[j - 1] + S[5, j - 1] * yc[j - 1]
        + S[7, j] * xn[j] + S[8, j] * yn[j] + T[7, j] * xs[j] + T[9, j] * ys[j]
        + S[11, j] * xn[j + 1] + S[12, j] * yn[j + 1] + T[11, j - 1] * xs[j - 1] + T[13, j - 1] * ys[j - 1]
        + S[15, j] * xn[j - 1] + S[16, j] * yn[j - 1] + T[15, j + 1] * xs[j + 1] + T[17, j + 1] * ys[j + 1]
    )  # fmt: skip
    force_y = (
        S[1, j] * xc[j] + S[2, j] * yc[j]
        + S[5, j] * xc[j + 1] + S[6, j] * yc[j + 1] + S[4, j - 1] * xc[j - 1] + S[6, j - 1] * yc[j - 1]
        + S[9, j] * xn[j] + S[10, j] * yn[j] + T[8, j] * xs[j] + T[10, j] * ys[j]
        + S[13, j] * xn[j + 1] + S[14, j] * yn[j + 1] + T[12, j - 1] * xs[j - 1] + T[14, j - 1] * ys[j - 1]
        + S[17, j] * xn[j - 1] + S[18, j] * yn[j - 1] + T[16, j + 1] * xs[j + 1] + T[18, j + 1] * ys[j + 1]
    )  # fmt: skip
    return force_x, force_y


@row_kernel
def _force_row(S, T, xs, xc, xn, ys, yc, yn, ox, oy):
    for j in range(1, len(ox) - 3):
        force_x, force_y = _node_force(j, S, T, xs, xc, xn, ys, yc, yn)
        ox[j] = force_x
        oy[j] = force_y


@grid_kernel
def nodal_forces(stencil, u, out):
    """out = A u."""
    for i in prange(1, u.shape[1] - 3):
        _force_row(
            stencil[i], stencil[i - 1],
            u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1], out[0, i], out[1, i],
        )  # fmt: skip


@row_kernel
def _smooth_row(S, T, xs, xc, xn, ys, yc, yn, bx, by, ox, oy, now, old, step_x, step_y, columns):
    for j in range(1, len(columns) - 3):
        force_x, force_y = _node_force(j, S, T, xs, xc, xn, ys, yc, yn)
        ox[j] = now * xc[j] - old * ox[j] + step_x * columns[j] * (bx[j] - force_x) / S[0, j]
        oy[j] = now * yc[j] - old * oy[j] + step_y * columns[j] * (by[j] - force_y) / S[2, j]


@grid_kernel
def smooth(stencil, u, b, other, now, old, step, free, columns):
    """other = now * u - old * other + step * D^-1 (b - A u), one Chebyshev step."""
    for i in prange(1, u.shape[1] - 3):
        _smooth_row(
            stencil[i], stencil[i - 1],
            u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1],
            b[0, i], b[1, i], other[0, i], other[1, i], now, old,
            step * free[0, i], step * free[1, i], columns,
        )  # fmt: skip


@row_kernel
def _scale_row(S, bx, by, ox, oy, step_x, step_y, columns):
    for j in range(1, len(columns) - 3):
        ox[j] = step_x * columns[j] * bx[j] / S[0, j]
        oy[j] = step_y * columns[j] * by[j] / S[2, j]


@grid_kernel
def smooth_from_zero(stencil, b, u, step, free, columns):
    """u = step * D^-1 b, the first Chebyshev step when the start is zero."""
    for i in prange(1, u.shape[1] - 3):
        _scale_row(
            stencil[i], b[0, i], b[1, i], u[0, i], u[1, i], step * free[0, i], step * free[1, i], columns
        )


@row_kernel
def _stencil_residual_row(i, stencil, u, b, free, columns, out):
    S, T = stencil[i], stencil[i - 1]
    xs, xc, xn, ys, yc, yn = u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1]
    bx, by, ox, oy = b[0, i], b[1, i], out[0], out[1]
    fx, fy = free[0, i], free[1, i]
    for j in range(1, len(columns) - 3):
        force_x, force_y = _node_force(j, S, T, xs, xc, xn, ys, yc, yn)
        ox[j] = fx * columns[j] * (bx[j] - force_x)
        oy[j] = fy * columns[j] * (by[j] - force_y)


@row_kernel
def _restrict_row(below, at, above, a, c, wx, out):
    """Full weighting of three fine residual rows (below, at, above the coarse row) into one coarse row."""
    summed = np.empty(below.shape[1], below.dtype)
    for component in range(2):
        low, mid, high = below[component], at[component], above[component]
        for j in range(len(summed)):
            summed[j] = a * low[j] + mid[j] + c * high[j]
        target = out[component]
        for k in range(1, wx.shape[1]):
            f = 2 * k - 1
            target[k] = summed[f] + wx[0, k] * summed[f + 1] + wx[1, k - 1] * summed[f - 1]


@grid_kernel
def restrict_from_voxels(density, u, b, c, free, columns, wx, wy, coarse):
    """coarse = P^T (b - A u) from the voxels; the fine residual never exists as a whole."""
    rows, last = wy.shape[1] - 1, u.shape[1] - 4
    for block in prange((rows + BLOCK - 1) // BLOCK):
        r = np.zeros((3, 2, u.shape[2]), b.dtype)
        first = 1 + block * BLOCK
        for i in range(first, min(first + BLOCK, rows + 1)):
            f = 2 * i - 1
            r[0] = r[2]
            if i == first and f > 1:
                residual_row(f - 1, density, u, b, c, free, columns, r[0])
            for above in range(2):
                if f + above <= last:
                    residual_row(f + above, density, u, b, c, free, columns, r[1 + above])
                else:
                    r[1 + above] = 0
            _restrict_row(r[0], r[1], r[2], wy[1, i - 1], wy[0, i], wx, coarse[:, i])


@grid_kernel
def restrict_from_stencil(stencil, u, b, free, columns, wx, wy, coarse):
    """coarse = P^T (b - A u) from stencils."""
    rows, last = wy.shape[1] - 1, u.shape[1] - 4
    for block in prange((rows + BLOCK - 1) // BLOCK):
        r = np.zeros((3, 2, u.shape[2]), b.dtype)
        first = 1 + block * BLOCK
        for i in range(first, min(first + BLOCK, rows + 1)):
            f = 2 * i - 1
            r[0] = r[2]
            if i == first and f > 1:
                _stencil_residual_row(f - 1, stencil, u, b, free, columns, r[0])
            for above in range(2):
                if f + above <= last:
                    _stencil_residual_row(f + above, stencil, u, b, free, columns, r[1 + above])
                else:
                    r[1 + above] = 0
            _restrict_row(r[0], r[1], r[2], wy[1, i - 1], wy[0, i], wx, coarse[:, i])


@row_kernel
def _prolong_row(below, above, lower, upper, wx, target, last):
    """Add to one fine row what lies between two coarse rows, with their weights ``lower`` and ``upper``."""
    coarse = np.empty(len(below), below.dtype)
    for k in range(len(below)):
        coarse[k] = lower * below[k] + upper * above[k]
    for k in range(1, (last + 1) // 2 + 1):
        target[2 * k - 1] += coarse[k]
    for k in range(1, last // 2 + 1):
        target[2 * k] += wx[0, k] * coarse[k] + wx[1, k] * coarse[k + 1]


@grid_kernel
def prolong(coarse, u, wx, wy):
    """u += P coarse."""
    last = u.shape[2] - 4
    for i in prange(1, u.shape[1] - 3):
        k = (i + 1) // 2
        lower, upper = (wy[0, k], wy[1, k]) if i % 2 == 0 else (np.float32(1), np.float32(0))
        for component in range(2):
            _prolong_row(
                coarse[component, k], coarse[component, k + 1], lower, upper, wx, u[component, i], last
            )


@row_kernel
def _coarsen_columns(fine, wx, out):
    """Px^T A Px for one row of stencils: three tridiagonal operators, to this row and to the row above."""
    for k in range(1, wx.shape[1]):
        f = 2 * k - 1
        a, c, t = wx[1, k - 1], wx[0, k], wx[1, k]
        cc, aa, ct = c * c, a * a, c * t
        out[0, k] = (
            fine[0, f] + c * (fine[3, f] + fine[3, f]) + a * (fine[3, f - 1] + fine[3, f - 1])
            + cc * fine[0, f + 1] + aa * fine[0, f - 1]
        )  # fmt: skip
        out[2, k] = (
            fine[2, f] + c * (fine[6, f] + fine[6, f]) + a * (fine[6, f - 1] + fine[6, f - 1])
            + cc * fine[2, f + 1] + aa * fine[2, f - 1]
        )  # fmt: skip
        out[1, k] = (
            fine[1, f] + c * (fine[4, f] + fine[5, f]) + a * (fine[5, f - 1] + fine[4, f - 1])
            + cc * fine[1, f + 1] + aa * fine[1, f - 1]
        )  # fmt: skip
        out[3, k] = t * fine[3, f] + ct * fine[0, f + 1] + c * fine[3, f + 1]
        out[4, k] = t * fine[4, f] + ct * fine[1, f + 1] + c * fine[4, f + 1]
        out[5, k] = t * fine[5, f] + ct * fine[1, f + 1] + c * fine[5, f + 1]
        out[6, k] = t * fine[6, f] + ct * fine[2, f + 1] + c * fine[6, f + 1]
    for q in range(4):
        north, east, west = fine[7 + q], fine[11 + q], fine[15 + q]
        out_north, out_east, out_west = out[7 + q], out[11 + q], out[15 + q]
        for k in range(1, wx.shape[1]):
            f = 2 * k - 1
            a, b, c, t = wx[1, k - 1], wx[0, k - 1], wx[0, k], wx[1, k]
            out_north[k] = (
                north[f] + c * (east[f] + west[f + 1]) + a * (west[f] + east[f - 1])
                + c * c * north[f + 1] + a * a * north[f - 1]
            )  # fmt: skip
            out_east[k] = t * east[f] + c * t * north[f + 1] + c * east[f + 1]
            out_west[k] = b * west[f] + a * b * north[f - 1] + a * west[f - 1]


@row_kernel
def _coarsen_rows(below, at, above, a, c, t, out):
    """Py^T A Py: the coarse stencils of one row from column-coarsened ones of the rows around it."""
    last = out.shape[1] - 1
    for k in range(1, last):
        for q in range(3):
            out[q, k] = at[q, k] + c * c * above[q, k] + a * a * below[q, k]
        # towards the row above and back: the operator plus its transpose
        out[0, k] += c * (at[7, k] + at[7, k]) + a * (below[7, k] + below[7, k])
        out[1, k] += c * (at[8, k] + at[9, k]) + a * (below[8, k] + below[9, k])
        out[2, k] += c * (at[10, k] + at[10, k]) + a * (below[10, k] + below[10, k])
    for q in range(4):
        transposed = (0, 2, 1, 3)[q]
        for k in range(1, last):
            out[3 + q, k] = (
                at[3 + q, k] + c * c * above[3 + q, k] + a * a * below[3 + q, k]
                + c * (at[11 + q, k] + at[15 + transposed, k + 1])
                + a * (below[11 + q, k] + below[15 + transposed, k + 1])
            )  # fmt: skip
    for q in range(4):
        same = (0, 1, 1, 2)[q]
        transposed = (0, 2, 1, 3)[q]
        for k in range(1, last):
            out[7 + q, k] = t * at[7 + q, k] + c * t * above[same, k] + c * above[7 + q, k]
            out[11 + q, k] = t * at[11 + q, k] + c * t * above[3 + q, k] + c * above[11 + q, k]
            out[15 + q, k] = t * at[15 + q, k] + c * t * above[3 + transposed, k - 1] + c * above[15 + q, k]


@grid_kernel
def coarsen(density, c, stencil, wx, wy, out):
    """Galerkin product P^T A P of a stencil or, where it has no rows, of the voxel model.

    One kernel for both: its code is long, and every start has to load it.
    """
    from_voxels = len(stencil) == 0
    rows, last = wy.shape[1] - 1, (len(density) if from_voxels else len(stencil)) - 4
    for block in prange((rows + BLOCK - 1) // BLOCK):
        of_voxels = np.empty((19, density.shape[1]), out.dtype)
        narrow = np.zeros((3, 19, out.shape[2]), out.dtype)
        first = 1 + block * BLOCK
        for i in range(first, min(first + BLOCK, rows + 1)):
            f = 2 * i - 1
            narrow[0] = narrow[2]
            for offset in range(-1 if i == first else 0, 2):
                if 1 <= f + offset <= last:
                    if from_voxels:
                        stencil_row(f + offset, density, c, of_voxels)
                        fine = of_voxels
                    else:
                        fine = stencil[f + offset]
                    _coarsen_columns(fine, wx, narrow[1 + offset])
                else:
                    narrow[1 + offset] = 0
            _coarsen_rows(narrow[0], narrow[1], narrow[2], wy[1, i - 1], wy[0, i], wy[1, i], out[i])


@row_kernel
def _bound_row(S, T, xs, xc, xn, ys, yc, yn, fx, fy, columns):
    largest = np.float32(0)
    for j in range(1, len(columns) - 3):
        sum_x, sum_y = _node_force(j, S, T, xs, xc, xn, ys, yc, yn)
        largest = max(largest, max(fx * xc[j] * sum_x, fy * yc[j] * sum_y))
    return largest


@grid_kernel
def row_sum_bound(stencil, scale, free, columns, bounds):
    """Gershgorin: per row the largest sum of |a_ij| / sqrt(a_ii a_jj); bounds the eigenvalues of D^-1 A.

    ``scale`` holds 1/sqrt(a_ii) of the free unknowns and zeros elsewhere.
    """
    for i in prange(1, scale.shape[1] - 3):
        bounds[i] = _bound_row(
            np.abs(stencil[i]), np.abs(stencil[i - 1]),
            scale[0, i - 1], scale[0, i], scale[0, i + 1], scale[1, i - 1], scale[1, i], scale[1, i + 1],
            free[0, i], free[1, i], columns,
        )  # fmt: skip
