"""What a criterion is, and all of them by their names; one more is one file and a line here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.distances import CriticalDistance
from slmm.criteria.griffith import Griffith
from slmm.criteria.path_curves import Critical, PathCurves
from slmm.criteria.surface import Strength
from slmm.mechanics.material import Material


class Criterion(Protocol):
    """At which load a crack starts, from energy and stress along its path."""

    @property
    def needs(self) -> frozenset[str]:
        """Of "stress", "energy" and "equivalent stress", what a source has to give."""
        ...

    @property
    def bounded_by(self) -> str:
        """Where the largest principal stress over the strength bounds the index: "surface", "path" or "nothing"."""
        ...

    def depth(self, material: Material) -> float:
        """How deep it looks whatever the crack, mm."""
        ...

    def judge(self, curves: PathCurves, material: Material, complete: np.ndarray | None = None) -> Critical:
        """Load factors and their errors at every position that has curves.

        Parameters
        ----------
        curves : PathCurves
            Of n positions.
        material : Material
        complete : ndarray (n,) of bool, optional
            Which paths go through the whole ligament: no crack can be longer.
        """
        ...


@runtime_checkable
class OfManyMaterials(Protocol):
    """A criterion that has a quicker way for many materials than one after the other."""

    def judge_each(
        self, curves: PathCurves, materials: Sequence[Material], complete: np.ndarray | None = None
    ) -> Critical:
        """Load factors and their errors (m, n)."""
        ...


def judge_each(
    criterion: Criterion,
    curves: PathCurves,
    materials: Sequence[Material],
    complete: np.ndarray | None = None,
) -> Critical:
    """A criterion applied to n positions for m materials of one elasticity, (m, n)."""
    if isinstance(criterion, OfManyMaterials):
        return criterion.judge_each(curves, materials, complete)
    return Critical.stacked([criterion.judge(curves, material, complete) for material in materials])


CRITERIA: dict[str, Criterion] = {
    "coupled": Coupled(),
    "rankine": Strength(),
    "mises": Strength(mises=True),
    "point": CriticalDistance(),
    "line": CriticalDistance(line=True),
    "griffith": Griffith(),
}
