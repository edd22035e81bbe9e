"""The one force F and the one displacement u that a load is told by, so that F du is its work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slmm.scene.loading import Condition, Loading

#: resultants below this share of what acts are none, as of a pressure all round a hole; round-off
BALANCED = 1e-9


@dataclass(frozen=True)
class WorkConjugate:
    """Force and displacement of the scene's own load: one of them is given, the other follows from the work 2 W = F u.

    Parameters
    ----------
    by_displacement : bool
        Whether displacements are prescribed; else forces.
    value : float
        Largest displacement that is prescribed, mm; or the largest force on any stretch, N.
    """

    by_displacement: bool
    value: float

    def force_and_displacement(self, work: float) -> tuple[float, float]:
        """F, N, and u, mm, under the scene's own load, from twice the stored energy, N mm."""
        if self.by_displacement:
            return work / self.value, self.value
        return self.value, work / self.value


def work_conjugate(loading: Loading, thickness: float) -> WorkConjugate:
    """What F and u of a load are.

    Parameters
    ----------
    loading : Loading
    thickness : float
        mm.

    Raises
    ------
    ValueError
        When nothing moves or loads the part, or displacements and forces act together: their parts of the work do not
        scale alike when a crack grows.

    Examples
    --------
    >>> from slmm.scene.loading import plate_loading
    >>> work_conjugate(plate_loading(80.0, 80.0, displacement=0.5), 1.0)
    WorkConjugate(by_displacement=True, value=0.5)
    >>> work_conjugate(plate_loading(80.0, 80.0, stress=2.0), 3.0)
    WorkConjugate(by_displacement=False, value=480.0)
    """
    moved = max((_moved(condition) for condition in loading), default=0.0)
    forces = [_force(condition) for condition in loading if condition.is_loaded]
    forces += [float(np.hypot(*stiff.force[:2])) for stiff in loading.stiff]
    if any(stiff.force[2] for stiff in loading.stiff):
        raise ValueError(
            "load: a moment acts on a stiff stretch; fracture is simulated under forces or displacements alone"
        )
    force = thickness * max(forces, default=0.0)
    if moved > 0 and force > 0:
        raise ValueError(
            f"load: prescribes displacements (up to {moved:g} mm) and forces (up to {force:g} N) together; fracture is "
            "simulated under one of both, which grows in proportion"
        )
    if moved == 0 and force == 0:
        raise ValueError("load: nothing moves or loads the part; give a displacement, a traction or a force")
    return WorkConjugate(moved > 0, moved if moved > 0 else force)


def _moved(condition: Condition) -> float:
    """Largest displacement that is prescribed on a stretch, mm."""
    ends = condition.rule[0]
    parts = [component(ends) for component in condition.displacement if component is not None]
    return float(np.sqrt(sum(part**2 for part in parts)).max()) if parts else 0.0


def _force(condition: Condition) -> float:
    """Force on a stretch, N for each mm of thickness; of what balances on it the sum of its amounts."""
    _, traction, weight = condition.rule
    amount = float(np.hypot(*traction.T) @ weight)
    resultant = float(np.hypot(*(weight @ traction)))
    return resultant if resultant > BALANCED * amount else amount
