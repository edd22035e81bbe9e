"""Cracks as a border to a factorised body: what their panels do to it and feel of it, kept while cracks grow.

With the body's unknowns x and the jumps c on cracks, A x + B c = b and R x + D c = -t, so that
(D - R A^-1 B) c = -t - R A^-1 b. When cracks grow, most of their panels stay, and with them their rows and columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from slmm.boundary.crack_panels import CrackPanels
from slmm.boundary.densities import of_cracks, parts, stress_of_boundary, stress_of_jumps, traction_of
from slmm.boundary.rules import Array

if TYPE_CHECKING:
    from slmm.boundary.body import Body

#: where a panel of a crack is: start, end, and whether that is a tip
Key = tuple[complex, complex, bool]


class Border(NamedTuple):
    """Rows and columns of cracks, panel by panel, real and imaginary parts in turn.

    Attributes
    ----------
    keys : list of Key
        The panels.
    columns : ndarray, shape (m, unknowns of the body)
        A^-1 B, transposed.
    rows : ndarray, shape (m, unknowns of the body)
        R.
    traction : ndarray, shape (m,)
        What the body without cracks causes on them: t + R A^-1 b.
    matrix : ndarray, shape (m, m)
        D - R A^-1 B.
    """

    keys: list[Key]
    columns: Array
    rows: Array
    traction: Array
    matrix: Array

    @classmethod
    def none(cls, unknowns: int) -> Border:
        """Of a body without cracks."""
        empty = np.empty((0, unknowns))
        return cls([], empty, empty, np.empty(0), np.empty((0, 0)))


def keys_of(cracks: CrackPanels) -> list[Key]:
    """Where the panels are."""
    return list(zip(cracks.starts.tolist(), cracks.ends.tolist(), cracks.is_tip.tolist(), strict=True))


def bordered(body: Body, cracks: CrackPanels, known: Border) -> Border:
    """The border of a body for cracks, of which some panels are known."""
    keys, width = keys_of(cracks), 2 * cracks.p
    place = {key: k for k, key in enumerate(known.keys)}
    kept = np.array([k for k, key in enumerate(keys) if key in place], dtype=int)
    from_known = np.array([place[keys[k]] for k in kept.tolist()], dtype=int)
    new = np.array([k for k, key in enumerate(keys) if key not in place], dtype=int)
    m, n = width * len(keys), known.columns.shape[1]
    to, of, fresh = (_spread(which, width) for which in (kept, from_known, new))
    columns, rows, traction, matrix = np.empty((m, n)), np.empty((m, n)), np.empty(m), np.empty((m, m))
    columns[to], rows[to], traction[to] = known.columns[of], known.rows[of], known.traction[of]
    matrix[np.ix_(to, to)] = known.matrix[np.ix_(of, of)]
    if len(new):
        panels = _chosen(cracks, new)
        columns[fresh], rows[fresh], traction[fresh] = _of_new(body, panels)
        e, p = np.repeat(cracks.direction, cracks.p), cracks.p
        own = of_cracks(cracks, panels.z, np.repeat(new, p))
        felt = traction_of(own.P, own.Q, -1.0, np.repeat(panels.direction, p)).real()
        matrix[fresh] = felt - rows[fresh] @ columns.T
        if len(kept):
            points = _spread(kept, p)
            done = of_cracks(panels, cracks.z[points], np.full(len(points), -1))
            caused = traction_of(done.P, done.Q, -1.0, e[points]).real()
            matrix[np.ix_(to, fresh)] = caused - rows[to] @ columns[fresh].T
    return Border(keys, columns, rows, traction, matrix)


def jumps(border: Border) -> Array:
    """The jumps (m,) on the cracks."""
    lu = la.lu_factor(border.matrix, check_finite=False)
    return np.asarray(la.lu_solve(lu, -border.traction, check_finite=False))


def _spread(which: NDArray[np.int64], width: int) -> NDArray[np.int64]:
    """Numbers of rows from those of panels."""
    return np.asarray((which[:, None] * width + np.arange(width)).ravel())


def _chosen(cracks: CrackPanels, which: NDArray[np.int64]) -> CrackPanels:
    z = cracks.z.reshape(-1, cracks.p)[which].ravel()
    return CrackPanels(
        cracks.p, cracks.starts[which], cracks.ends[which], cracks.is_tip[which], cracks.tip[which], z
    )


def _of_new(body: Body, cracks: CrackPanels) -> tuple[Array, Array, Array]:
    """Columns, rows and tractions of panels."""
    z, e = cracks.z, np.repeat(cracks.direction, cracks.p)
    caused = of_cracks(cracks, body.panels.z, np.full(body.panels.n, -1)).displacement(body.kappa).real()
    # cracks add nothing to the resultants on rigid bodies
    columns = body.system.solve(np.pad(caused, ((0, body.rigid.shape[1]), (0, 0)))).T
    P, Q = stress_of_boundary(body.panels, z)
    by_g, by_q = (traction_of(P, Q, S, e) for S in (-1.0, body.kappa))
    by_jumps = traction_of(*stress_of_jumps(body.begins, z), body.kappa, e)
    rows = body.in_unknowns(by_g, body.by_tractions(by_q, by_jumps))
    rows = np.column_stack([rows, *(parts(by_g(motion)) for motion in body.rigid.T)])
    known = parts(by_g(body.known_g) + by_q(body.known_q) + by_jumps(body.known_jumps))
    return columns, rows, known + rows @ body.solution
