"""What a criterion is applied to at some positions, so that it can be applied once more for other materials.

Energy and stress along a path depend on the elasticity and the load alone. Strength and toughness decide which crack
starts; and whether the curves stand for a crack of that length, each source says of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from slmm.criteria.coupled import ENERGY, NONE
from slmm.criteria.criterion import Criterion, judge_each
from slmm.criteria.path_curves import Critical, PathCurves
from slmm.criteria.status import Status
from slmm.mechanics.material import Material


class Stands(NamedTuple):
    """For which cracks the curves of k positions stand.

    The critical crack counts, or the depth that a criterion looks to, where that is longer.

    Attributes
    ----------
    shortest : ndarray (k,)
        Of shorter ones, mm, other curves would be more accurate.
    longest : ndarray (k,)
        From this length on, mm, the curves say nothing,
    beyond : ndarray (k,) of str
        and why; "{}" in it stands for the length.
    any_length : bool
        Where energy alone decides, the longest crack counts that the stress allows at the critical load.
    """

    shortest: np.ndarray
    longest: np.ndarray
    beyond: np.ndarray
    any_length: bool = False

    @classmethod
    def below(cls, longest: np.ndarray, beyond: Sequence[str] | str = "", any_length: bool = False) -> Stands:
        """For cracks below lengths (k,), mm."""
        words = np.full(len(longest), "", dtype=object)
        words[:] = beyond
        return cls(np.zeros(len(longest)), longest, words, any_length)

    @classmethod
    def everywhere(cls, k: int) -> Stands:
        """For all cracks within the curves."""
        return cls.below(np.full(k, np.inf))

    def rows(self, rows: np.ndarray) -> Stands:
        """For some of the positions."""
        return Stands(self.shortest[rows], self.longest[rows], self.beyond[rows], self.any_length)


class Judged(NamedTuple):
    """What a criterion says of k positions for m materials.

    Attributes
    ----------
    critical : Critical
        (m, k)
    status : ndarray (m, k) of str
    length : ndarray (m, k)
        Of the cracks that count, mm.
    """

    critical: Critical
    status: np.ndarray
    length: np.ndarray


@dataclass(frozen=True, eq=False)
class Evidence:
    """Curves of k positions, and what they stand for.

    Attributes
    ----------
    curves : PathCurves
    stands : Stands
    complete : ndarray (k,) of bool
        Which paths go through the whole ligament.
    too_short : str
        The status where the curves end before both conditions meet.
    method : str
        That gave them.
    """

    curves: PathCurves
    stands: Stands
    complete: np.ndarray
    too_short: str
    method: str

    def rows(self, rows: np.ndarray) -> Evidence:
        """Of some of the positions."""
        return Evidence(
            self.curves.rows(rows), self.stands.rows(rows), self.complete[rows], self.too_short, self.method
        )

    def judged(self, criterion: Criterion, materials: Sequence[Material]) -> Judged:
        """Apply a criterion for materials (m,) of the curves' elasticity."""
        found = judge_each(criterion, self.curves, materials, self.complete)
        length = self._counted(found, criterion, materials)
        without = np.isnan(found.load_factor)
        status = np.full(without.shape, Status.OK, dtype=object)
        status[without] = np.where(found.refused[without] == "", self.too_short, found.refused[without])
        refused = np.isfinite(found.load_factor) & (length >= self.stands.longest)
        for k, i in np.argwhere(refused):
            status[k, i] = str(self.stands.beyond[i]).format(f"{length[k, i]:.3g}")
        for values in (found.load_factor, found.crack_length, found.error):
            values[refused] = np.nan
        found.governed_by[refused] = NONE
        return Judged(found, status, length)

    def _counted(self, found: Critical, criterion: Criterion, materials: Sequence[Material]) -> np.ndarray:
        """Lengths (m, k) of the cracks that count, mm; where any is allowed, the largest error of these stands."""
        depth = np.array([criterion.depth(material) for material in materials])
        length = np.maximum(np.nan_to_num(found.crack_length), depth[:, None])
        if self.stands.any_length and "stress" in criterion.needs:
            curves = self.curves
            for k, i in np.argwhere(found.governed_by == ENERGY):
                allowed = curves.sigma_I[i] * found.load_factor[k, i] >= materials[k].sigma_c
                length[k, i] = curves.a[i, allowed].max()
                found.error[k, i] = 0.5 * curves.G_error[i, allowed].max()
        return length


#: by position: pieces of evidence in the order in which they were found, each with the row that it is there
Found = tuple[tuple[Evidence, int], ...]


def nothing_found(n: int) -> np.ndarray:
    """No evidence at n positions."""
    found = np.empty(n, dtype=object)
    found[:] = [()] * n
    return found
