"""How wrong the curves of a crack cell may be, judged from two cells and two local models.

Both estimates are sums of what was seen to matter, with factors chosen such that at least nineteen errors of twenty lie
below, on random outlines, loads and materials against the method ``dislocations``. validation/fit_cell_errors.py has
beside them those of the narrowest sums that do, validation/estimates.py holds them against full FEA. A sum and not the
largest, because the parts are independent guesses at different sources.
"""

from __future__ import annotations

import numpy as np

from slmm.scene.scene import Scene

#: of the stress: what is always there, as a share of `reference_stress`; the change from a cell of half the size to the
#: cell; the change from voxels twice as large (or from a coarser mesh) to these; chosen
STRESS_FLOOR, STRESS_OF_CELL, STRESS_OF_MODEL = 0.003, 1.25, 0.6
#: of the energy: what is always there, likewise; the changes of the surface stress and of the stress at this depth with
#: the cell, and with the local model; the distance between the held boundary and the unbounded body; the support of
#: the plate's edges; a cell that follows its outline less closely; chosen
ENERGY_FLOOR, ENERGY_OF_SURFACE, ENERGY_OF_CELL, ENERGY_OF_MODEL = 0.006, 1.6, 1.05, 2.5
ENERGY_OF_BRACKET, ENERGY_OF_EDGES, ENERGY_OF_WIDTH = 0.07, 0.08, 0.01


def reference_stress(scene: Scene) -> float:
    """Stress that a circular hole makes of the scene's load, MPa: errors do not fall with a local stress below it."""
    return 3.0 * scene.loading.nominal_stress(scene.material.plane_stress_equivalent[0])


def faded(reference: float, sigma: np.ndarray) -> np.ndarray:
    """The reference stress over stresses of any shape, at least 1: how much larger a relative error it leaves there.

    Without an upper limit, so that an error in MPa stays one where the stress vanishes.

    Examples
    --------
    >>> faded(30.0, np.array([60.0, 3.0, -0.003])).tolist()
    [1.0, 10.0, 10000.0]
    """
    return np.maximum(reference / np.maximum(np.abs(sigma), 1e-300), 1.0)


def relative_change(new: np.ndarray, old: np.ndarray) -> np.ndarray:
    """|old/new - 1|, 0 where both vanish; without an upper limit, likewise."""
    return np.abs(new - old) / np.maximum(np.abs(new), 1e-300)


def stress_error(of_cell: np.ndarray, of_model: np.ndarray, fade: np.ndarray) -> np.ndarray:
    """Relative error of the principal stress from its relative changes, each (n, k).

    ``fade`` (n, k) is the reference stress over that at each depth, at least 1.
    """
    return STRESS_FLOOR * fade + STRESS_OF_CELL * of_cell + STRESS_OF_MODEL * of_model


def energy_error(
    of_cell: np.ndarray,
    of_model: np.ndarray,
    fade: np.ndarray,
    bracket: np.ndarray,
    support: np.ndarray,
    wide: bool,
) -> np.ndarray:
    """Relative error of the incremental energy release rate.

    Parameters
    ----------
    of_cell, of_model : ndarray (n, k)
        Relative changes of the stress at depths from 0 to the crack's length.
    fade : ndarray (n, k)
        The reference stress over that at each depth, at least 1.
    bracket : ndarray (n, k)
        Energy in the unbounded body over that with held boundary, less one.
    support : ndarray (n,)
        Share rho of the held cell's stiffness that the plate's edges give.
    wide : bool
        Whether the cell is one of the wide rule.
    """
    return (
        ENERGY_FLOOR * fade
        + ENERGY_OF_SURFACE * of_cell[:, :1]
        + ENERGY_OF_CELL * of_cell
        + ENERGY_OF_MODEL * of_model
        + ENERGY_OF_BRACKET * np.clip(bracket, 0.0, 5.0)
        + ENERGY_OF_EDGES * np.abs(support)[:, None]
        + ENERGY_OF_WIDTH * wide
    )
