"""What densities on the boundary and on cracks cause at some places, as matrices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.crack_influence import crack_weights, displacement_by_jumps, stress_by_jumps
from slmm.boundary.crack_panels import CrackPanels, straight_rule, tip_rule
from slmm.boundary.influence import (
    TWO_PI_I,
    boundary_displacement,
    boundary_stress,
    displacement_matrix,
    of_highest,
)
from slmm.boundary.linear import Linear, along_directions
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, highest_rule, refinement

OVER = 1 / TWO_PI_I


class Targets(NamedTuple):
    """Where something is caused.

    Attributes
    ----------
    z : ndarray, shape (t,)
        mm.
    own : ndarray, shape (t,) of int
        Number of a target's own point among those of the panels that cause it, -1 for none.
    curve : ndarray, shape (t,) of int
        The smooth curve that it lies on, -1 beside the boundary.
    """

    z: Complex
    own: NDArray[np.int64]
    curve: NDArray[np.int64]

    @classmethod
    def beside(cls, z: Complex) -> Targets:
        """Points (t,) that are none of the boundary."""
        nowhere = np.full(len(z), -1)
        return cls(z, nowhere, nowhere)

    @classmethod
    def on(cls, panels: Panels) -> Targets:
        """All points of panels, by what these cause themselves."""
        return cls(panels.z, np.arange(panels.n), np.repeat(panels.smooth, panels.p))

    def chosen(self, which: NDArray[np.int64]) -> Targets:
        """Some of them."""
        return Targets(*(values[which] for values in self))

    def of(self, rows: NDArray[np.int64], p: int) -> Targets:
        """The same by what some panels alone cause, with p points on each."""
        place = np.full(max(int(self.own.max(initial=-1)) // p, int(rows.max(initial=-1))) + 2, -1)
        place[rows] = np.arange(len(rows))
        on = place[self.own // p]  # of -1 the last one
        return Targets(self.z, np.where(on < 0, -1, on * p + self.own % p), self.curve)


def weights_of_boundary(panels: Panels, at: Targets) -> tuple[Complex, Complex]:
    """Weights (t, n) in C1 and C3."""
    C1, C3 = boundary_displacement(
        *at,
        panels.p,
        panels.z,
        panels.dz,
        panels.tangent,
        panels.curvature,
        panels.ends,
        panels.straight,
        panels.smooth,
        panels.fine,
        panels.fine_chi,
        panels.inverse,
        panels.fine_inverse,
        refinement(panels.p),
    )
    return C1, C3


def displacement_by_g(panels: Panels, kappa: float, at: Targets) -> Array:
    """W at targets by the boundary's g as a real matrix (2 t, 2 n), see `Linear.real`."""
    return np.asarray(displacement_matrix(*weights_of_boundary(panels, at), kappa))


def displacement_of_boundary(panels: Panels, kappa: float, at: Targets) -> tuple[Linear, Linear]:
    """W at targets (t,) by the boundary's g, and by its q."""
    C1, C3 = weights_of_boundary(panels, at)
    by_q = displacement_by_q(C1, C3, kappa)
    return Linear((kappa * C1 - C1.conj()) * OVER, by_q.other), by_q


def displacement_by_q(C1: Complex, C3: Complex, kappa: float) -> Linear:
    """W by the boundary's q, from its weights (t, n) in C1 and C3."""
    return Linear(2 * kappa * OVER * C1.real, C3 * OVER)


def displacement_of_highest(panels: Panels, kappa: float, at: Targets) -> Linear:
    """W at targets (t,) by a q that is P_p on each panel; (t, m)."""
    C1, C3 = of_highest(
        at.z,
        at.own // panels.p,
        panels.p,
        panels.ends,
        panels.straight,
        panels.fine,
        panels.fine_tangent,
        panels.length,
        panels.fine_inverse,
        *highest_rule(panels.p),
    )
    return Linear(2 * kappa * C1.real / TWO_PI_I, C3 / TWO_PI_I)


def displacement_of_jumps(kappa: float, at: Complex, size: float, targets: Complex) -> Linear:
    """W at targets (t,) by what q is short of behind each place ``at`` (c,): the force before it.

    A rigid motion aside, which ``size`` decides, and which has no part in forces that balance.
    """
    gap = at - targets[:, None]
    return Linear(-2 * kappa * np.log(np.abs(gap) / size) / TWO_PI_I, -gap / np.conj(gap) / TWO_PI_I)


def stress_of_jumps(at: Complex, targets: Complex) -> tuple[Complex, Complex]:
    """The same as weights (t, c) in P, and in the part of Q that is linear in the jumps."""
    gap = at - targets[:, None]
    return 1 / (TWO_PI_I * gap), -np.conj(gap) / (TWO_PI_I * gap**2)


def stress_of_boundary(panels: Panels, targets: Complex) -> tuple[Complex, Complex]:
    """Weights (t, n) of the boundary in P, and in the part of Q that is linear in a density."""
    P, Q = boundary_stress(
        targets,
        panels.p,
        panels.z,
        panels.dz,
        panels.ends,
        panels.straight,
        panels.fine,
        panels.fine_chi,
        panels.inverse,
        panels.fine_inverse,
        refinement(panels.p),
    )
    P *= OVER
    Q *= OVER
    return P, Q


class OfCracks(NamedTuple):
    """What the jumps on cracks of m points cause at targets (t,).

    Attributes
    ----------
    moments : ndarray, shape (3, t, m)
        Weights of 1/(tau - z), 1/(tau - z)^2 and 1/(tau - z)^3.
    turn : ndarray, shape (k,)
        Conjugate of a panel's direction over that direction.
    delta : ndarray, shape (t, k)
        Distance of a target from a panel's line, as tau - z mirrored there less its conjugate, mm.
    """

    moments: Complex
    turn: Complex
    delta: Complex

    def displacement(self, kappa: float) -> Linear:
        """W by the jumps."""
        return Linear(*displacement_by_jumps(self.moments, self.turn, self.delta, kappa))

    def stress(self) -> tuple[Complex, Complex]:
        """Weights (t, m) in P, and in the part of Q that is linear in the jumps."""
        P, Q = stress_by_jumps(self.moments, self.turn, self.delta)
        return P, Q

    @property
    def P(self) -> Complex:
        """Weights (t, m) in P."""
        return self.moments[1] * OVER

    @property
    def Q(self) -> Complex:
        """Weights (t, m) in the part of Q that is linear in the jump."""
        return self.stress()[1]


def of_cracks(cracks: CrackPanels, targets: Complex, on: NDArray[np.int64]) -> OfCracks:
    """Influence of cracks on targets (t,); ``on`` (t,) is the panel that one lies on, -1 for none."""
    turn = cracks.direction.conj() / cracks.direction
    moments, delta = crack_weights(
        targets,
        on,
        cracks.p,
        cracks.starts,
        cracks.ends,
        turn,
        cracks.is_tip,
        *straight_rule(cracks.p),
        *tip_rule(cracks.p),
    )
    return OfCracks(moments, turn, delta)


def traction_of(P: Complex, Q: Complex, S: float, e: Complex) -> Linear:
    """Change of the resultant force along directions e (t,), by a density whose conjugate enters Q with P times S."""
    return Linear(*along_directions(P, Q, S, e))


def parts(values: Complex) -> Array:
    """Real and imaginary parts (2 n,) in turn."""
    return np.column_stack([values.real, values.imag]).ravel()
