"""Richardson's extrapolation from a mesh and its uniform refinement."""

from __future__ import annotations

import numpy as np


def extrapolated(coarse: np.ndarray, fine: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Values on an infinitely fine mesh, and by how much they differ from the finer one's.

    Parameters
    ----------
    coarse, fine : ndarray
        From elements of some size, and of half of it.
    order : int
        Of the error in the element size.

    Examples
    --------
    >>> h = np.array([0.1, 0.2])
    >>> value, change = extrapolated(1 + h**2, 1 + (h / 2) ** 2, order=2)
    >>> value, change.round(6)
    (array([1., 1.]), array([-0.0025, -0.01  ]))
    """
    change = (fine - coarse) / (2**order - 1)
    return fine + change, change
