"""What a finite element program leaves behind, in the form that configurational forces and crack tips take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.elements import element_named
from slmm.mechanics.kinematics import deformation_gradients

#: how stress and energy belong together: Eshelby's, motion based; displacement based; small strains
METHODS = ("mbf", "dbf", "linear")


@dataclass(frozen=True)
class ElementResults:
    """Displacements, stresses and energies of a model of any elements.

    Parameters
    ----------
    points, u : ndarray (n, d)
        Undeformed nodes and their displacements, mm.
    cells : mapping of str to ndarray (el, k)
        Nodes of the elements of each type of `slmm.mechanics.elements`.
    stress : mapping of str to ndarray (el, ips, d, d)
        Cauchy stresses at the integration points, MPa.
    energy : mapping of str to ndarray (el, ips)
        Energy densities per undeformed volume, MPa.
    method : {"linear", "mbf", "dbf"}
        The configurational stress that fits the kinematics of the model, see `slmm.fracture.configurational_forces`.
    elasticity : sequence of Elasticity
        Materials, when they are linear elastic and known.
    region : mapping of str to ndarray (el,) of int
        Which material each element is of, also where nothing else is known of it.
    thickness : float
        Of plane elements, mm.
    source : str
        Where the stresses come from, in words.
    """

    points: np.ndarray
    u: np.ndarray
    cells: Mapping[str, np.ndarray]
    stress: Mapping[str, np.ndarray]
    energy: Mapping[str, np.ndarray]
    region: Mapping[str, np.ndarray]
    method: str = "linear"
    elasticity: Sequence[Elasticity] = field(default=())
    thickness: float = 1.0
    source: str = ""

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.points.shape[1]


def linear_elastic(
    points: np.ndarray,
    cells: Mapping[str, np.ndarray],
    u: np.ndarray,
    elasticity: Elasticity | Sequence[Elasticity],
    region: Mapping[str, np.ndarray] | None = None,
    thickness: float = 1.0,
) -> ElementResults:
    """Stresses and energies at the integration points from the displacements, for small strains.

    Parameters
    ----------
    points, cells, u, thickness
        See `ElementResults`.
    elasticity : Elasticity or sequence of Elasticity
        One material, or several.
    region : mapping of str to array_like (el,) of int, optional
        Which of them each element is of.

    Raises
    ------
    ValueError
        For an unknown element type, when there are several materials and no word on who is of which, and for a region
        without material.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> cells = {"CPE4R": np.array([[0, 1, 2, 3]])}
    >>> result = linear_elastic(square, cells, 1e-3 * square * [1, 0], Elasticity(100e3, 0.0))
    >>> result.stress["CPE4R"].round(9).tolist(), result.energy["CPE4R"].round(9).tolist()
    ([[[[100.0, 0.0], [0.0, 0.0]]]], [[0.05]])
    """
    materials = (elasticity,) if isinstance(elasticity, Elasticity) else tuple(elasticity)
    if region is None:
        if len(materials) > 1:
            raise ValueError(f"elasticity has {len(materials)} materials: region must say where they are")
        region = {name: np.zeros(len(nodes), dtype=int) for name, nodes in cells.items()}
    points, u = np.asarray(points, dtype=float), np.asarray(u, dtype=float)
    stress, energy = {}, {}
    for name, nodes in cells.items():
        gradient = element_named(name).gradient_at_points
        H = deformation_gradients(points[nodes], u[nodes], gradient) - np.eye(points.shape[1])
        number = np.asarray(region[name])
        if number.shape != H.shape[:1] or not np.isin(number, range(len(materials))).all():
            raise ValueError(
                f"region[{name!r}]: must have a number from 0 to {len(materials) - 1} for each of {len(H)} elements"
            )
        stress[name] = np.empty_like(H)
        for k, material in enumerate(materials):
            here = number == k
            stress[name][here] = material.stress(H[here])
        energy[name] = 0.5 * np.einsum("eqij,eqij->eq", stress[name], H)
    return ElementResults(
        points,
        u,
        cells,
        stress,
        energy,
        region,
        "linear",
        materials,
        thickness,
        "displacements and elasticity",
    )
