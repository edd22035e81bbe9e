"""Every crack length of a straight crack path from one Cholesky factor.

Along the path all nodes are kept as unknowns and the rest of the body is eliminated. Order them from the mouth
inwards; then freeing a longer crack means solving with a longer *leading block* of one small matrix S. A leading
block's Cholesky factor is the leading block of the factor, so with S = L L^T and y = L^-1 f the energy released
when the first n unknowns are freed is 1/2 sum_{i<=n} y_i^2, for every n at once; it cannot be negative and cannot
fall with the crack length.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg as la


def crack_factor(S: np.ndarray, f: np.ndarray) -> np.ndarray:
    """Factor of the energy released along a crack path.

    Parameters
    ----------
    S : ndarray, shape (n, n)
        Stiffness condensed to the unknowns that the crack frees, ordered from the mouth inwards, N/mm.
    f : ndarray, shape (n, m)
        Forces that hold these unknowns in the uncracked body, one column for each of m load cases, N.

    Returns
    -------
    y : ndarray, shape (n, m)
        The energy released when the first k unknowns are freed under the loads c (m,) is
        ``0.5 * np.sum((y[:k] @ c)**2)``, in N mm.

    Raises
    ------
    scipy.linalg.LinAlgError
        When S is not positive definite, i.e. the freed body could move without energy.

    Examples
    --------
    >>> y = crack_factor(np.array([[4.0, 0.0], [0.0, 1.0]]), np.array([[2.0], [1.0]]))
    >>> 0.5 * np.cumsum(np.sum(y**2, axis=1))
    array([0.5, 1. ])
    """
    L = la.cholesky(S, lower=True)
    return la.solve_triangular(L, f, lower=True)
