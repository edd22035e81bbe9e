"""What near panels cause beyond the plain Gauss rule, as sparse matrices."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from slmm.boundary.densities import Targets, weights_of_boundary
from slmm.boundary.moments import FAR
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Complex

#: panels that are taken together (chosen)
TOGETHER = 16


def near_field(panels: Panels) -> tuple[sp.csr_array, sp.csr_array]:
    """Weights (n, n) of C1 and C3 at the points of panels, less those of the plain rule where that does not serve."""
    n, p = panels.n, panels.p
    tree = cKDTree(np.column_stack([panels.z.real, panels.z.imag]))
    middle, half = panels.ends.mean(axis=1), 0.5 * np.abs(np.diff(panels.ends, axis=1))[:, 0]
    around = tree.query_ball_point(np.column_stack([middle.real, middle.imag]), FAR * half)
    rows, columns, C1, C3 = [], [], [], []
    starts = np.flatnonzero(np.diff(panels.smooth, prepend=-1))
    for curve in np.split(np.arange(len(half)), starts[1:]):
        for run in np.array_split(curve, -(-len(curve) // TOGETHER)):
            targets = np.unique(np.concatenate([around[k] for k in run]).astype(int))
            one, three = _weights(panels, run, targets)
            near = _is_near(panels, run, panels.z[targets])
            i, j = np.nonzero(np.repeat(near, p, axis=1))
            points = (run[:, None] * p + np.arange(p)).ravel()
            plain_one, plain_three = _plain(panels, targets[i], points[j])
            rows.append(targets[i])
            columns.append(points[j])
            C1.append(one[i, j] - plain_one)
            C3.append(three[i, j] - plain_three)
    place = np.concatenate(rows), np.concatenate(columns)
    return (
        sp.csr_array((np.concatenate(C1), place), shape=(n, n)),
        sp.csr_array((np.concatenate(C3), place), shape=(n, n)),
    )


def _weights(panels: Panels, run: NDArray[np.int64], targets: NDArray[np.int64]) -> tuple[Complex, Complex]:
    """Weights (t, k) of C1 and C3 of a run of panels at points (t,)."""
    p = panels.p
    of_target = targets // p
    at = Targets(panels.z[targets], targets, panels.smooth[of_target])
    return weights_of_boundary(panels.chosen(run), at.of(run, p))


def _is_near(panels: Panels, run: NDArray[np.int64], z: Complex) -> NDArray[np.bool_]:
    """Whether the plain rule does not serve for targets (t,) and panels (k,); see `slmm.boundary.moments.is_far`."""
    a, b = panels.ends[run].T
    return np.abs(z[:, None] - a) + np.abs(z[:, None] - b) <= FAR * np.abs(b - a)


def _plain(panels: Panels, targets: NDArray[np.int64], points: NDArray[np.int64]) -> tuple[Complex, Complex]:
    """Weights (k,) of C1 and C3 by the plain rule, for pairs of points; none of a point on itself."""
    apart = targets != points
    gap = np.where(apart, panels.z[points] - panels.z[targets], 1.0)
    step = np.where(apart, panels.dz[points], 0.0)
    return step / gap, step / gap.conj() - gap * step.conj() / gap.conj() ** 2
