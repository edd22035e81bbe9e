"""What an input file of CalculiX or Abaqus says about elements, their sections and materials."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from slmm.mechanics.elasticity import Elasticity


class Section(NamedTuple):
    """A *SOLID SECTION: elements, sorted by their numbers, their material, and the thickness that the line states."""

    elements: np.ndarray
    material: str
    thickness: float | None


@dataclass(frozen=True)
class InpModel:
    """What an input file says about solid and plane elements; names are in capitals.

    Parameters
    ----------
    path : Path
    node_ids, nodes : ndarray (n,), (n, 3)
        Numbers and coordinates of the nodes.
    cell_ids : dict of str to ndarray (el,)
        Numbers of the elements of each type, such as CPE8R.
    cells : dict of str to ndarray (el, k)
        Numbers of their nodes, for the types of `slmm.mechanics.elements`.
    sections : tuple of Section
    materials : dict of str to Elasticity or None
        None where a material is not isotropic and linear elastic.
    reasons : dict of str to str
        Why, for these materials.
    nlgeom : bool
        Whether any step is geometrically nonlinear: by NLGEOM, or by *MPC.
    unlike : tuple of str
        Why results are not those of these elements, or not in the directions of the axes.
    """

    path: Path
    node_ids: np.ndarray
    nodes: np.ndarray
    cell_ids: dict[str, np.ndarray]
    cells: dict[str, np.ndarray]
    sections: tuple[Section, ...]
    materials: dict[str, Elasticity | None]
    reasons: dict[str, str]
    nlgeom: bool
    unlike: tuple[str, ...]

    def types_of(self, ids: np.ndarray) -> np.ndarray:
        """Element types (el,) by the elements' numbers.

        Raises
        ------
        ValueError
            When there is no such element.
        """
        number, kind = self._types
        ids = np.asarray(ids)
        at = np.minimum(np.searchsorted(number, ids), max(len(number) - 1, 0))
        missing = ids[number[at] != ids] if len(number) else ids
        if len(missing):
            raise ValueError(
                f"{self.path}: has no element {missing[0]} ({len(missing)} of {len(ids)} such elements)"
            )
        return kind[at]

    def section_of(self, ids: np.ndarray) -> np.ndarray:
        """Places (el,) in ``sections`` by the elements' numbers; the last section that names an element is its own.

        Raises
        ------
        ValueError
            When an element has no section.
        """
        ids = np.asarray(ids)
        place = np.full(len(ids), -1)
        for k, section in enumerate(self.sections):
            place[np.isin(ids, section.elements)] = k
        missing = ids[place < 0]
        if len(missing):
            raise ValueError(
                f"{self.path}: element {missing[0]} has no *SOLID SECTION ({len(missing)} of {len(ids)} such elements)"
            )
        return place

    @cached_property
    def _types(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of all elements, sorted, and their types."""
        number = np.concatenate([np.zeros(0, int), *self.cell_ids.values()])
        kind = np.repeat(np.array([*self.cell_ids], dtype=str), [len(ids) for ids in self.cell_ids.values()])
        order = np.argsort(number)
        return number[order], kind[order]
