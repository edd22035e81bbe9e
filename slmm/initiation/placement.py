"""Cells on the notch: local axes, curvature, the largest valid size, and the displacements on the cell's boundary.

Paper A, section 2.3: at a notch point the xi axis runs along the outline and the eta axis into the material. The
outline over the cell's height is fitted by eta = c xi^2; the cell grows until a constraint stops it; then the local
model's displacements on the three straight edges are fitted by the deformation modes. All positions are one numba
pass for each of these steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from slmm.running.threaded import threaded

#: cell height and length in the image space; published (Paper A, Table 1)
CELL_HEIGHT = 2.0
CELL_LENGTH = 2.0

#: growth of the cell from one trial to the next; published (Paper A, Eq. 27)
CELL_GROWTH = 1.1

#: why a cell stopped growing, or why there is none; the order is that of the codes
STOPPED = (
    "leaves the plate",
    "intrudes into a notch",
    "undercut",
    "curvature outside the table",
    "outline is no parabola",
    "large enough",
)


class Constraints(NamedTuple):
    """When a cell is valid (Paper A, section 2.3.5).

    Attributes
    ----------
    samples : int
        Points of the curvature fit, n_fit,c.
    quartic : bool
        Fit eta = c xi^2 + d xi^3 + e xi^4 and keep c, the curvature at the crack's mouth; the paper fits c alone.
    absolute, relative : float
        Delta_abs and Delta_rel of Eq. 26.
    deviation : float
        Largest distance of the outline from the parabola, as a fraction of the cell's height.
    boundary_samples : int
        Points on the three straight edges, n_fit,u.
    inside : int
        How many of them may lie in a notch.
    """

    samples: int
    quartic: bool
    absolute: float
    relative: float
    deviation: float
    boundary_samples: int
    inside: int


@njit(cache=True)
def _piece(breaks, s):
    """Index of the outline's piece at the arc length s, and the arc length within it."""
    s = s % breaks[-1]
    k = min(np.searchsorted(breaks, s, side="right"), len(breaks) - 1) - 1
    return k, s - breaks[k]


@njit(cache=True)
def _outline_point(breaks, coefficients, s):
    k, t = _piece(breaks, s)
    x = ((coefficients[0, k, 0] * t + coefficients[1, k, 0]) * t + coefficients[2, k, 0]) * t
    y = ((coefficients[0, k, 1] * t + coefficients[1, k, 1]) * t + coefficients[2, k, 1]) * t
    return x + coefficients[3, k, 0], y + coefficients[3, k, 1]


@njit(cache=True)
def _frame(breaks, coefficients, s):
    """Notch point and unit tangent; the normal into the material is (t_y, -t_x)."""
    k, t = _piece(breaks, s)
    x, y = _outline_point(breaks, coefficients, s)
    tx = (3 * coefficients[0, k, 0] * t + 2 * coefficients[1, k, 0]) * t + coefficients[2, k, 0]
    ty = (3 * coefficients[0, k, 1] * t + 2 * coefficients[1, k, 1]) * t + coefficients[2, k, 1]
    norm = np.hypot(tx, ty)
    return x, y, tx / norm, ty / norm


@njit(cache=True)
def _curvature(breaks, coefficients, s, height, rule):
    """Fitted c, sqrt(Var(c)), largest deviation from the parabola, and whether there is no undercut."""
    x0, y0, tx, ty = _frame(breaks, coefficients, s)
    n = rule.samples
    xi = np.empty(n)
    eta = np.empty(n)
    for i in range(n):
        x, y = _outline_point(breaks, coefficients, s + height * (i / (n - 1) - 0.5))
        xi[i] = (x - x0) * tx + (y - y0) * ty
        eta[i] = (x - x0) * ty - (y - y0) * tx
    monotone = True
    for i in range(n - 1):
        if xi[i + 1] <= xi[i]:
            monotone = False
    half = 0.5 * height
    if rule.quartic:
        # normal equations of c, d, e in xi/half; the surface at the mouth is what the stress there feels
        A = np.zeros((3, 3))
        b = np.zeros(3)
        for i in range(n):
            z = xi[i] / half
            basis = (z * z, z * z * z, z * z * z * z)
            for j in range(3):
                b[j] += basis[j] * eta[i] / half
                for k in range(3):
                    A[j, k] += basis[j] * basis[k]
        c = np.linalg.solve(A, b)[0] / half if monotone else 0.0
    else:
        c = (eta * xi**2).sum() / (xi**4).sum()
    residual = eta - c * xi**2
    spread = np.sqrt((residual**2).sum() / ((n - 1) * (xi**4).sum()))
    return c, spread, np.abs(residual).max(), monotone


@njit(cache=True)
def boundary_point(i, n, curvature, right_edge):
    """i-th of n points, evenly spaced over the three straight edges of the cell in the image space."""
    half = 0.5 * CELL_HEIGHT
    side = right_edge - curvature * half**2
    q = (i + 0.5) / n * (2 * side + CELL_HEIGHT)
    if q < side:
        return -half, curvature * half**2 + q
    if q < side + CELL_HEIGHT:
        return q - side - half, right_edge
    return half, right_edge - (q - side - CELL_HEIGHT)


@njit(cache=True)
def _in_notch(solid, hx, hy, x, y):
    ny, nx = solid.shape
    return solid[min(max(int(y / hy), 0), ny - 1), min(max(int(x / hx), 0), nx - 1)] < 0.5


@njit(cache=True)
def _check(breaks, coefficients, s, height, rule, c_min, c_max, solid, hx, hy):
    """Code of the first violated constraint, or -1; and the fitted curvature."""
    c, spread, deviation, monotone = _curvature(breaks, coefficients, s, height, rule)
    if not monotone:
        return 2, c
    scale = height / CELL_HEIGHT
    c_image = c * scale
    if not (c_min <= c_image <= c_max):
        return 3, c
    if (
        spread * height > rule.absolute + rule.relative * abs(c * height)
        or deviation > rule.deviation * height
    ):
        return 4, c
    x0, y0, tx, ty = _frame(breaks, coefficients, s)
    width, tall = solid.shape[1] * hx, solid.shape[0] * hy
    right = CELL_LENGTH + c_image
    inside = 0
    tolerance = 1e-9 * (width + tall)
    for i in range(rule.boundary_samples):
        xi, eta = boundary_point(i, rule.boundary_samples, c_image, right)
        x = x0 + scale * (xi * tx + eta * ty)
        y = y0 + scale * (xi * ty - eta * tx)
        if x < -tolerance or y < -tolerance or x > width + tolerance or y > tall + tolerance:
            return 0, c
        if _in_notch(solid, hx, hy, x, y):
            inside += 1
    # corners of the straight edge opposite the notch
    for xi in (-1.0, 1.0):
        x = x0 + scale * (xi * tx + right * ty)
        y = y0 + scale * (xi * ty - right * tx)
        if x < -tolerance or y < -tolerance or x > width + tolerance or y > tall + tolerance:
            return 0, c
    if inside > rule.inside:
        return 1, c
    return -1, c


@threaded(cache=True)
def grow_cells(breaks, coefficients, s, first_height, largest_height, rule, c_min, c_max, solid, hx, hy):
    """Largest valid cell at each position (the loop of Eq. 27).

    Parameters
    ----------
    breaks, coefficients : ndarray (m + 1,), ndarray (4, m, 2)
        Outline.
    s : ndarray (n,)
        Arc lengths of the positions, mm.
    first_height : ndarray (n,)
        Height of the first trial, mm.
    largest_height : float
        Height not to exceed, mm.
    rule : Constraints
        When a cell is valid.
    c_min, c_max : float
        Curvatures that the table holds, 1/mm in the image space.
    solid : ndarray (ny, nx)
        Share of solid in each voxel.
    hx, hy : float
        Voxel size, mm.

    Returns
    -------
    height, curvature : ndarray (n,)
        Of the best cell, mm and 1/mm; NaN where there is none.
    stopped : ndarray (n,)
        Index into `STOPPED`: why the cell is not larger.
    """
    n = len(s)
    height = np.full(n, np.nan)
    curvature = np.full(n, np.nan)
    stopped = np.full(n, len(STOPPED) - 1)
    for k in prange(n):
        trial = first_height[k]
        while trial <= largest_height:
            code, c = _check(breaks, coefficients, s[k], trial, rule, c_min, c_max, solid, hx, hy)
            if code == -1:
                height[k] = trial
                curvature[k] = c
            else:
                stopped[k] = code
                if code != 1:  # an intruding cell may be valid again when it is larger
                    break
            trial *= CELL_GROWTH
    return height, curvature, stopped


@threaded(cache=True)
def boundary_points(breaks, coefficients, s, height, rule):
    """Fitted curvatures and the points on the three straight edges of cells of given height.

    Parameters
    ----------
    breaks, coefficients, s, rule
        As in `grow_cells`.
    height : ndarray (n,)
        Cell heights, mm; where they are NaN, so are the results.

    Returns
    -------
    curvature : ndarray (n,)
        Fitted c, 1/mm.
    points : ndarray (n, rule.boundary_samples, 2)
        Where the displacements are wanted, mm.
    """
    n, samples = len(s), rule.boundary_samples
    curvature = np.full(n, np.nan)
    points = np.full((n, samples, 2), np.nan)
    for k in prange(n):
        if not np.isfinite(height[k]):
            continue
        scale = height[k] / CELL_HEIGHT
        c = _curvature(breaks, coefficients, s[k], height[k], rule)[0]
        x0, y0, tx, ty = _frame(breaks, coefficients, s[k])
        for i in range(samples):
            xi, eta = boundary_point(i, samples, c * scale, CELL_LENGTH + c * scale)
            points[k, i, 0] = x0 + scale * (xi * tx + eta * ty)
            points[k, i, 1] = y0 + scale * (xi * ty - eta * tx)
        curvature[k] = c
    return curvature, points


@threaded(cache=True)
def fit_cells(breaks, coefficients, s, height, curvature, powers_xi, powers_eta, u):
    """Reference point displacements of cells of given height (Eq. 24), in the image space.

    Parameters
    ----------
    breaks, coefficients, s
        As in `grow_cells`.
    height, curvature : ndarray (n,)
        Cell heights, mm, and fitted curvatures, 1/mm; NaN is passed over.
    powers_xi, powers_eta : ndarray (m, 2)
        Powers p, q of the modes xi^p eta^q for the displacements along xi and along eta.
    u : ndarray (n, samples, 2)
        Displacements of the local model at the `boundary_points`, mm.

    Returns
    -------
    modes : ndarray (n, m_xi + m_eta)
        Amplitudes u'_RP, first those along xi.
    misfit : ndarray (n,)
        Norm of what the modes leave over the norm of the displacements, both without their mean.
    """
    n, points = len(s), u.shape[1]
    m_xi, m_eta = len(powers_xi), len(powers_eta)
    modes = np.full((n, m_xi + m_eta), np.nan)
    misfit = np.full(n, np.nan)
    for k in prange(n):
        if not np.isfinite(height[k]):
            continue
        scale = height[k] / CELL_HEIGHT
        c = curvature[k]
        _, _, tx, ty = _frame(breaks, coefficients, s[k])
        A_xi = np.ones((points, m_xi + 1))
        A_eta = np.ones((points, m_eta + 1))
        b = np.empty((2, points))
        for i in range(points):
            xi, eta = boundary_point(i, points, c * scale, CELL_LENGTH + c * scale)
            ux, uy = u[k, i, 0], u[k, i, 1]
            b[0, i] = (ux * tx + uy * ty) / scale
            b[1, i] = (ux * ty - uy * tx) / scale
            for j in range(m_xi):
                A_xi[i, j] = xi ** powers_xi[j, 0] * eta ** powers_xi[j, 1]
            for j in range(m_eta):
                A_eta[i, j] = xi ** powers_eta[j, 0] * eta ** powers_eta[j, 1]
        # the last column is the offset u_off; the smallest solution where modes repeat one another
        fit_xi = np.linalg.lstsq(A_xi, b[0], 1e-10)[0]
        fit_eta = np.linalg.lstsq(A_eta, b[1], 1e-10)[0]
        left = ((A_xi @ fit_xi - b[0]) ** 2).sum() + ((A_eta @ fit_eta - b[1]) ** 2).sum()
        whole = ((b[0] - b[0].mean()) ** 2).sum() + ((b[1] - b[1].mean()) ** 2).sum()
        misfit[k] = np.sqrt(left / whole) if whole > 0 else 0.0
        modes[k, :m_xi] = fit_xi[:m_xi]
        modes[k, m_xi:] = fit_eta[:m_eta]
    return modes, misfit
