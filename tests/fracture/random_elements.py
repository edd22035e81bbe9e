"""Distorted elements with random data, and a solid whose energy is known at large strains."""

import numpy as np

from slmm.mechanics.elements import ELEMENTS

DISTORTION = 0.08


def random_elements(name, count, seed=0):
    """Distorted elements with random displacements, stresses and energies."""
    element, rng = ELEMENTS[name], np.random.default_rng(seed)
    n, d = element.nodes.shape
    X = element.nodes * rng.uniform(0.5, 3.0, (count, 1, 1)) + rng.uniform(-1, 1, (count, n, d)) * DISTORTION
    U = rng.uniform(-1, 1, (count, n, d)) * DISTORTION
    S = rng.normal(size=(count, len(element.points), d, d))
    return X, U, S + S.swapaxes(-1, -2), rng.normal(size=S.shape[:2])


def neo_hooke(F):
    """Energy density and Cauchy stress of a compressible neo-Hookean solid, plane strain in 2D."""
    mu, lame = 1.3, 2.1
    J = np.linalg.det(F)[..., None, None]
    B = F @ F.swapaxes(-1, -2)
    one = np.eye(F.shape[-1])
    log = np.log(J)
    # out of the plane nothing stretches: its 1 and the -3 leave the trace less the dimension
    trace = np.trace(B, axis1=-2, axis2=-1) - F.shape[-1]
    energy = mu / 2 * (trace - 2 * log[..., 0, 0]) + lame / 2 * log[..., 0, 0] ** 2
    return energy, (mu * (B - one) + lame * log * one) / J
