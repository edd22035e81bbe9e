"""T, the stress along a crack that does not grow towards its tip, from a domain around it.

A force f on the tip, along the crack, leaves the faces free and makes the stress -f cos(angle)/(pi r) along each ray.
Its interaction with a field is f T/E': what is singular in that field does not contribute (Cardew, Goldthorpe, Howard
and Kfouri 1985).
"""

from __future__ import annotations

import numpy as np

from slmm.fracture.contour_integrals import interaction
from slmm.fracture.tips import CrackTip
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults


def t_stress(results: ElementResults, tip: CrackTip, radius: float, elasticity: Elasticity) -> float:
    """T, MPa, of a tip whose faces are free of traction.

    Parameters and errors are those of `slmm.fracture.contour_integrals.j_vector`.
    """
    (of_force,) = interaction(results, tip, radius, elasticity, force_gradients)
    return float(elasticity.E_prime * of_force)


def force_gradients(points: np.ndarray, elasticity: Elasticity) -> np.ndarray:
    """Displacement gradients (..., 1, 2, 2) of a force of 1 N/mm on the tip along the crack, at points (..., 2).

    The tip is the origin, the crack lies on the negative x axis.

    Examples
    --------
    >>> steel = Elasticity(210e3, 0.3)
    >>> stress = steel.stress(force_gradients(np.array([[2.0, 0.0], [0.0, 2.0]]), steel))
    >>> bool(np.allclose(stress[:, 0], [[[-1 / (2 * np.pi), 0], [0, 0]], np.zeros((2, 2))], atol=1e-15))
    True
    """
    z = points[..., 0] + 1j * points[..., 1]
    # by phi = A log z and psi = -A log z of Kolosov, A = -1/(4 pi)
    scale = -1 / (8 * np.pi * elasticity.mu)
    by_x = scale * (elasticity.kappa / z + z / z.conj() ** 2)
    by_y = scale * 1j * (elasticity.kappa / z - 2 / z.conj() - z / z.conj() ** 2)
    gradient = np.stack([np.stack([d.real, d.imag], axis=-1) for d in (by_x, by_y)], axis=-1)
    return gradient[..., None, :, :]
