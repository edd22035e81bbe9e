"""Physical states of a crack cell, at Kirsch's hole or at a flat side, and how far two cells differ under them."""

from __future__ import annotations

import numpy as np

from precompute.crack_cell import HALF_HEIGHT, right_edge
from precompute.modes import Mode

#: angles between the tension and the tangent at the mouth, degrees; at 60 a hole has no stress there
ANGLES = (0.0, 20.0, 45.0)


def kirsch(
    xi: np.ndarray, eta: np.ndarray, curvature: float, nu: float, angle: float
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement around Kirsch's hole under tension 1, E = 1, the mouth of the crack on its rim."""
    turn = np.radians(angle)
    c, s = np.cos(turn), np.sin(turn)
    R = -0.5 / curvature
    x, y = c * xi + s * (eta + R), -s * xi + c * (eta + R)
    r, t = np.hypot(x, y), np.arctan2(y, x)
    kappa, shear = (3 - nu) / (1 + nu), 0.5 / (1 + nu)
    hole = 2 * (R**2 / r - R**4 / r**3)
    u = (r + 2 * R**2 / r) * (kappa + 1) * np.cos(t) + hole * np.cos(3 * t)
    v = (r * (kappa - 3) + 2 * R**2 / r * (1 - kappa)) * np.sin(t) + hole * np.sin(3 * t)
    return (c * u - s * v) / (8 * shear), (s * u + c * v) / (8 * shear)


def physical_fields(
    xi: np.ndarray, eta: np.ndarray, curvature: float, nu: float
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Displacements that leave the curved side free, where there is such a formula.

    At a hole they are Kirsch's, else tension along the tangent and tension that falls with the depth, which
    are exact for a flat side.
    """
    if curvature < 0:
        return [kirsch(xi, eta, curvature, nu, angle) for angle in ANGLES]
    tension, bending = (xi, -nu * eta), (xi * eta, -(nu * eta**2 + xi**2) / 2)
    return [tension, (tension[0] - 0.5 * bending[0], tension[1] - 0.5 * bending[1])]


def fitted_states(curvature: float, nu: float, modes: list[Mode]) -> np.ndarray:
    """Mode amplitudes (n_states, m) fitted to the fields on the three straight edges."""
    t = np.linspace(-1, 1, 61)
    end = right_edge(curvature)
    sides = [np.stack([np.full(61, xi), curvature + (end - curvature) * (t + 1) / 2]) for xi in (-1.0, 1.0)]
    xi, eta = np.concatenate([*sides, np.stack([t * HALF_HEIGHT, np.full(61, end)])], axis=1)
    basis = np.concatenate(
        [np.stack([(m.direction == d) * m(xi, eta) for m in modes], axis=1) for d in (0, 1)]
    )
    fields = np.stack([np.concatenate(field) for field in physical_fields(xi, eta, curvature, nu)], axis=1)
    return np.linalg.lstsq(basis, fields, rcond=None)[0].T


def released(Psi: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Energy (n_lengths, n_states) released by every crack."""
    return 0.5 * np.einsum("sm,amn,sn->as", states, Psi, states)


def stress_error(ours: np.ndarray, reference: np.ndarray, states: np.ndarray) -> float:
    """Largest difference of any component, relative to the largest stress of the state, over all states."""
    a, b = (np.einsum("sm,mce->sce", states, T) for T in (ours, reference))
    return float(np.max(np.abs(a - b).max(axis=(1, 2)) / np.abs(b).max(axis=(1, 2))))
