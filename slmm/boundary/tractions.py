"""What tractions on some panels cause: by their resultant along each panel, and the force that is left behind it.

The resultant q of a panel's tractions grows along the panel from nothing. Behind the panel it stays, and what constant
q causes follows from its ends alone: so each panel with tractions acts by itself, however others are divided.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from slmm.boundary.densities import (
    Targets,
    displacement_of_highest,
    displacement_of_jumps,
    stress_of_boundary,
    stress_of_jumps,
    traction_of,
)
from slmm.boundary.linear import Linear
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, highest, integration


@dataclass(frozen=True, eq=False)
class Tractions:
    """Panels on which tractions act.

    Parameters
    ----------
    panels : Panels
        Of h points.
    kappa : float
    size : float
        Of the body, mm; it decides a rigid motion alone.
    """

    panels: Panels
    kappa: float
    size: float

    @cached_property
    def _half(self) -> Array:
        return 0.5 * self.panels.length[:, None]

    @property
    def behind(self) -> Complex:
        """Where the panels end."""
        return self.panels.ends[:, 1]

    def resultants(self, t: Complex) -> tuple[Complex, Complex]:
        """The resultants (h,) over kappa + 1 along each panel, and those (m,) of whole panels, of tractions (h,)."""
        p = self.panels.p
        local = integration(p)
        forces = self._half * t.reshape(-1, p) * 1j / (self.kappa + 1)
        return (forces @ local[:p].T).ravel(), forces @ local[p]

    def unseen(self, t: Complex) -> Complex:
        """What q (m,) has of P_p on each panel, by tractions (h,)."""
        p = self.panels.p
        weights = self._half * highest(p) * 1j / (self.kappa + 1)
        return np.asarray((weights * t.reshape(-1, p)).sum(axis=1))

    def displacement(self, at: Targets, by_q: Linear) -> Linear:
        """W at targets (t,) by tractions (h,), from the weights of q.

        With what q has of P_p, which shows at none of a panel's points: it would else be free to grow. q jumps where a
        held stretch ends; such jumps are forces at corners, which hardly any point feels.
        """
        behind = displacement_of_jumps(self.kappa, self.behind, self.size, at.z)
        return self._by_values(by_q, behind, displacement_of_highest(self.panels, self.kappa, at))

    def caused(self, at: Targets, t: Complex, by_q: Linear) -> Complex:
        """The same (t,) of given tractions."""
        q, behind = self.resultants(t)
        by_behind = displacement_of_jumps(self.kappa, self.behind, self.size, at.z)
        by_highest = displacement_of_highest(self.panels, self.kappa, at)
        return by_q(q) + by_behind(behind) + by_highest(self.unseen(t))

    def along(self, z: Complex, e: Complex) -> Linear:
        """Change of the resultant force along directions e (t,) at points z (t,), by tractions (h,)."""
        return self.along_by(*stress_of_boundary(self.panels, z), z, e)

    def along_by(self, P: Complex, Q: Complex, z: Complex, e: Complex) -> Linear:
        """The same by what `slmm.boundary.densities.stress_of_boundary` gives of the panels at these points."""
        behind = traction_of(*stress_of_jumps(self.behind, z), self.kappa, e)
        return self._by_values(traction_of(P, Q, self.kappa, e), behind)

    def _by_values(self, by_q: Linear, behind: Linear, by_highest: Linear | None = None) -> Linear:
        """In place of weights of q and of whole resultants those of the tractions."""
        p = self.panels.p
        local = integration(p)
        unit = 1j / (self.kappa + 1)
        found = []
        for k, factor in enumerate((unit, np.conj(unit))):
            # one product of all panels
            at = (by_q[k].reshape(-1, p) @ local[:p]).reshape(len(by_q[k]), len(self._half), p)
            at += behind[k][:, :, None] * local[p]
            if by_highest is not None:
                at += by_highest[k][:, :, None] * highest(p)
            found.append((factor * self._half * at).reshape(len(at), self.panels.n))
        return Linear(*found)
