"""Matrix-free kernels on the voxels themselves: the stiffness is one density per voxel.

Layout. A field is an array (2, rows, columns), u_x and u_y apart so that loops run over contiguous numbers.
It carries a ring of zeros: node (i, j) is at [i + 1, j + 1], and voxel (i, j), between nodes (i, j) and
(i + 1, j + 1), is at density[i + 1, j + 1]. The ring's densities are zero, so no edge is a special case.

Ones and zeros say which unknowns there are: ``free[0, i]`` and ``free[1, i]`` for u_x and u_y in row i of the
array, ``columns[j]`` for both in column j. That describes all three loads.

All loops run from the literal 1 over full rows: only then can LLVM exclude negative indices, which numba
wraps around, and vectorise.

Sums are kept per row and added afterwards, so they do not depend on the number of threads.
"""

from __future__ import annotations

from typing import Any

from numba import njit, prange

from slmm.running.threaded import threaded

REASSOCIATE = {"reassoc", "contract", "nsz", "arcp"}  # but keep NaN and infinity: they must not pass unseen
# "numpy": a division must not be able to raise, or the loop around it stays scalar
OPTIONS: dict[str, Any] = {
    "cache": True,
    "fastmath": REASSOCIATE,
    "boundscheck": False,
    "error_model": "numpy",
}
row_kernel = njit(**OPTIONS)
grid_kernel = threaded(**OPTIONS)
inlined = njit(inline="always", **OPTIONS)  # LLVM alone finds these bodies too long, and a call stops it too


@inlined
def node_force(j, low, high, xs, xc, xn, ys, yc, yn, c):
    """Nodal force at column j from the rows below (s), at (c) and above (n) and the two rows of voxels."""
    one = c[10]  # in the precision of the coefficients: sums of float32 densities would be rounded
    ll, lr, ul, ur = one * low[j - 1], one * low[j], one * high[j - 1], one * high[j]
    total, left, right, down, up = ll + lr + ul + ur, ll + ul, lr + ur, ll + lr, ul + ur
    force_x = (
        c[0] * total * xc[j]
        + c[1] * (left * xc[j - 1] + right * xc[j + 1])
        + c[2] * (down * xs[j] + up * xn[j])
        + c[3] * (ll * xs[j - 1] + lr * xs[j + 1] + ul * xn[j - 1] + ur * xn[j + 1])
    )
    force_y = (
        c[4] * total * yc[j]
        + c[5] * (left * yc[j - 1] + right * yc[j + 1])
        + c[6] * (down * ys[j] + up * yn[j])
        + c[7] * (ll * ys[j - 1] + lr * ys[j + 1] + ul * yn[j - 1] + ur * yn[j + 1])
    )
    twist = ll - lr - ul + ur
    force_x += c[8] * (twist * yc[j] - ll * ys[j - 1] + lr * ys[j + 1] + ul * yn[j - 1] - ur * yn[j + 1]) + c[
        9
    ] * ((ll - ul) * yc[j - 1] + (ur - lr) * yc[j + 1] + (lr - ll) * ys[j] + (ul - ur) * yn[j])
    force_y += c[8] * (twist * xc[j] - ll * xs[j - 1] + lr * xs[j + 1] + ul * xn[j - 1] - ur * xn[j + 1]) - c[
        9
    ] * ((ll - ul) * xc[j - 1] + (ur - lr) * xc[j + 1] + (lr - ll) * xs[j] + (ul - ur) * xn[j])
    return force_x, force_y


@row_kernel
def _smooth_row(low, high, xs, xc, xn, ys, yc, yn, bx, by, ox, oy, c, now, old, step, fx, fy, columns):
    product = 0.0
    step_x, step_y = fx * step / c[0], fy * step / c[4]
    for j in range(1, len(columns) - 3):
        force_x, force_y = node_force(j, low, high, xs, xc, xn, ys, yc, yn, c)
        total = low[j - 1] + low[j] + high[j - 1] + high[j]
        new_x = now * xc[j] - old * ox[j] + step_x * columns[j] * (bx[j] - force_x) / total
        new_y = now * yc[j] - old * oy[j] + step_y * columns[j] * (by[j] - force_y) / total
        ox[j] = new_x
        oy[j] = new_y
        product += new_x * bx[j] + new_y * by[j]
    return product


@grid_kernel
def smooth(density, u, b, other, c, now, old, step, free, columns, products):
    """other = now * u - old * other + step * D^-1 (b - A u), a Chebyshev step; products: b . other by row."""
    for i in prange(1, u.shape[1] - 3):
        products[i] = _smooth_row(
            density[i - 1], density[i], u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1],
            b[0, i], b[1, i], other[0, i], other[1, i], c, now, old, step, free[0, i], free[1, i], columns,
        )  # fmt: skip


@row_kernel
def _scale_row(low, high, bx, by, ox, oy, step_x, step_y, columns):
    for j in range(1, len(columns) - 3):
        total = low[j - 1] + low[j] + high[j - 1] + high[j]
        ox[j] = step_x * columns[j] * bx[j] / total
        oy[j] = step_y * columns[j] * by[j] / total


@grid_kernel
def smooth_from_zero(density, b, u, c, step, free, columns):
    """u = step * D^-1 b, the first Chebyshev step when the start is zero."""
    for i in prange(1, u.shape[1] - 3):
        _scale_row(
            density[i - 1], density[i], b[0, i], b[1, i], u[0, i], u[1, i],
            step * free[0, i] / c[0], step * free[1, i] / c[4], columns,
        )  # fmt: skip


@row_kernel
def residual_row(i, density, u, b, c, free, columns, out):
    """out (2, columns) = (b - A u) in row i."""
    low, high = density[i - 1], density[i]
    xs, xc, xn, ys, yc, yn = u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1]
    bx, by, ox, oy = b[0, i], b[1, i], out[0], out[1]
    fx, fy = free[0, i], free[1, i]
    for j in range(1, len(columns) - 3):
        force_x, force_y = node_force(j, low, high, xs, xc, xn, ys, yc, yn, c)
        ox[j] = fx * columns[j] * (bx[j] - force_x)
        oy[j] = fy * columns[j] * (by[j] - force_y)


@row_kernel
def stencil_row(i, density, c, out):
    """The 19 numbers per node of row i (see stencil) that these densities amount to."""
    low, high = density[i - 1], density[i]
    P, M, one = c[8], c[9], c[10]  # sums of densities in the precision of the coefficients, as above
    out[:, 0] = 0
    out[:, -1] = 0
    for j in range(1, out.shape[1] - 1):
        ll, lr, ul, ur = one * low[j - 1], one * low[j], one * high[j - 1], one * high[j]
        out[0, j] = c[0] * (ll + lr + ul + ur)
        out[1, j] = P * (ll - lr - ul + ur)
        out[2, j] = c[4] * (ll + lr + ul + ur)
        # to the east: as the corner of the voxels below (upper left) and above (lower left) right of the node
        out[3, j] = c[1] * (lr + ur)
        out[4, j] = M * (ur - lr)
        out[5, j] = M * (lr - ur)
        out[6, j] = c[5] * (lr + ur)
        out[7, j] = c[2] * (ul + ur)
        out[8, j] = M * (ul - ur)
        out[9, j] = M * (ur - ul)
        out[10, j] = c[6] * (ul + ur)
        out[11, j] = c[3] * ur
        out[12, j] = -P * ur
        out[13, j] = -P * ur
        out[14, j] = c[7] * ur
        out[15, j] = c[3] * ul
        out[16, j] = P * ul
        out[17, j] = P * ul
        out[18, j] = c[7] * ul


@row_kernel
def _energy_row(rho, x0, x1, y0, y1, k):
    energy = 0.0
    for j in range(1, len(rho) - 3):
        a, b, c, d = x0[j], x0[j + 1], x1[j], x1[j + 1]
        x_x, x_y, x_h = b - a + d - c, c - a + d - b, a - b - c + d
        a, b, c, d = y0[j], y0[j + 1], y1[j], y1[j + 1]
        y_x, y_y, y_h = b - a + d - c, c - a + d - b, a - b - c + d
        energy += rho[j] * (
            k[0] * (x_x * x_x + k[5] * x_h * x_h)
            + k[1] * (y_y * y_y + k[5] * y_h * y_h)
            + k[2] * x_x * y_y
            + k[3] * (x_y * x_y + k[5] * x_h * x_h)
            + k[4] * (y_x * y_x + k[5] * y_h * y_h)
            + k[6] * x_y * y_x
        )
    return energy


@grid_kernel
def energy(density, u, k, energies):
    """energies[i] = u . A u of the voxels above node row i, from differences: no cancellation in float32."""
    for i in prange(1, u.shape[1] - 4):
        energies[i] = _energy_row(density[i], u[0, i], u[0, i + 1], u[1, i], u[1, i + 1], k)


@row_kernel
def _advance_row(low, high, xs, xc, xn, ys, yc, yn, ux, uy, rx, ry, zx, zy, c, alpha, fx, fy, columns):
    square = 0.0
    for j in range(1, len(columns) - 3):
        force_x, force_y = node_force(j, low, high, xs, xc, xn, ys, yc, yn, c)
        new_x = rx[j] - alpha * (fx * columns[j]) * force_x
        new_y = ry[j] - alpha * (fy * columns[j]) * force_y
        ux[j] += alpha * xc[j]
        uy[j] += alpha * yc[j]
        rx[j] = new_x
        ry[j] = new_y
        zx[j] = new_x
        zy[j] = new_y
        square += new_x * new_x + new_y * new_y
    return square


@grid_kernel
def advance(density, p, u, r, r_single, c, alpha, free, columns, squares):
    """u += alpha p, r -= alpha A p in double precision, for a direction p in single; squares: r . r by row.

    Forming A p here and nowhere else keeps r the residual of u, however p and alpha were rounded.
    """
    for i in prange(1, u.shape[1] - 3):
        squares[i] = _advance_row(
            density[i - 1], density[i], p[0, i - 1], p[0, i], p[0, i + 1], p[1, i - 1], p[1, i], p[1, i + 1],
            u[0, i], u[1, i], r[0, i], r[1, i], r_single[0, i], r_single[1, i],
            c, alpha, free[0, i], free[1, i], columns,
        )  # fmt: skip


@row_kernel
def _subtract_row(low, high, xs, xc, xn, ys, yc, yn, rx, ry, zx, zy, c, fx, fy, columns):
    square = 0.0
    for j in range(1, len(columns) - 3):
        force_x, force_y = node_force(j, low, high, xs, xc, xn, ys, yc, yn, c)
        new_x = fx * columns[j] * (rx[j] - force_x)
        new_y = fy * columns[j] * (ry[j] - force_y)
        rx[j] = new_x
        ry[j] = new_y
        zx[j] = new_x
        zy[j] = new_y
        square += new_x * new_x + new_y * new_y
    return square


@grid_kernel
def subtract_force(density, u, r, r_single, c, free, columns, squares):
    """r = r - A u: the residual, when r comes in as the nodal loads."""
    for i in prange(1, u.shape[1] - 3):
        squares[i] = _subtract_row(
            density[i - 1], density[i], u[0, i - 1], u[0, i], u[0, i + 1], u[1, i - 1], u[1, i], u[1, i + 1],
            r[0, i], r[1, i], r_single[0, i], r_single[1, i], c, free[0, i], free[1, i], columns,
        )  # fmt: skip


@row_kernel
def _combine_row(z, p, beta):
    for j in range(len(p)):
        p[j] = z[j] + beta * p[j]


@grid_kernel
def combine(z, p, beta):
    """p = z + beta * p, the next conjugate direction."""
    for i in prange(1, p.shape[1] - 3):
        _combine_row(z[0, i], p[0, i], beta)
        _combine_row(z[1, i], p[1, i], beta)
