"""How the surroundings of a cell yield when its crack opens (Paper A, section 2.4).

Displacement control holds the cell's boundary and releases too little energy. Force control lets every deformation
mode of the cell go and releases too much; so does a body that extends without supports. Auto control mixes the
lower with one of the upper bounds such that two cells of different size agree.
"""

from __future__ import annotations

import numpy as np


def displacement_controlled(Psi: np.ndarray, modes: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """G'_inc (n, n_a) of cells whose boundary is held, N/mm (Eq. 9).

    The paper's Eq. 8 and 9 print the energy without the factor 1/2; with it, it is the elastic energy.
    """
    return 0.5 * np.einsum("nm,namk,nk->na", modes, Psi, modes, optimize=True) / lengths


def force_controlled_modes(K0: np.ndarray, Psi: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """Amplitudes u'_RP,FC (n, n_a, m) when the reaction forces of the uncracked cell stay (Eq. 28).

    Rigid motions and modes that repeat one another need no force; the smallest solution leaves them at rest.
    """
    forces = np.einsum("nmk,nk->nm", K0, modes)
    K = K0[:, None] - Psi
    return np.einsum("namk,nk->nam", np.linalg.pinv(K, rcond=1e-7, hermitian=True), forces)


def mixed_release(Psi: np.ndarray, held: np.ndarray, released: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Coefficients of G'_inc = q0 + q1 w + q2 w^2 (3, n, n_a) for u = (1 - w) u_RP + w u_RP,FC.

    Parameters
    ----------
    Psi : ndarray (n, n_a, m, m)
        Loss of stiffness, N/mm.
    held : ndarray (n, m)
        u_RP.
    released : ndarray (n, n_a, m)
        u_RP,FC.
    lengths : ndarray (n_a,)
        Crack lengths, mm.
    """
    step = released - held[:, None]
    q0 = np.einsum("nm,namk,nk->na", held, Psi, held, optimize=True)
    q1 = 2 * np.einsum("nm,namk,nak->na", held, Psi, step, optimize=True)
    q2 = np.einsum("nam,namk,nak->na", step, Psi, step, optimize=True)
    return 0.5 * np.stack([q0, q1, q2]) / lengths


def auto_weight(small: np.ndarray, large: np.ndarray) -> np.ndarray:
    """Weight w in [0, 1] at which two cells release most nearly the same (Eq. 30).

    Parameters
    ----------
    small, large : ndarray (3, n)
        Coefficients of w^0, w^1, w^2 of G_inc for both cells at the longest crack of the smaller one.

    Returns
    -------
    ndarray (n,)
    """
    c0, c1, c2 = small - large
    n = len(c0)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(c1**2 - 4 * c2 * c0)
        # the form that does not cancel; where c2 vanishes it is the root of the straight line
        q = -0.5 * (c1 + np.where(c1 >= 0, root, -root))
        candidates = np.stack([np.zeros(n), np.ones(n), c0 / q, q / c2, -0.5 * c1 / c2])
    candidates = np.where((candidates >= 0) & (candidates <= 1), candidates, 0.0)
    difference = np.abs(c0 + candidates * (c1 + candidates * c2))
    weight = candidates[
        np.argmin(np.where(np.isfinite(difference), difference, np.inf), axis=0), np.arange(n)
    ]
    return np.where(np.isfinite(c0 + c1 + c2), weight, np.nan)
