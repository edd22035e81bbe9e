"""Which nodes of a mesh of any elements lie next to others: contours around a tip, interfaces between materials."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike


def rings(cells: Mapping[str, ArrayLike], tip: ArrayLike, n: int) -> list[np.ndarray]:
    """Node numbers within the first n contours around a tip, as Abaqus counts them.

    The first contour is the tip itself; each further one adds all nodes of the elements that touch the one before.
    Both faces of a crack are followed, since their elements meet at the tip.

    Parameters
    ----------
    cells : mapping of str to array_like (el, k) of int
        Nodes of the elements of each type.
    tip : array_like (m,) of int
        Nodes at the tip; several where elements are collapsed there, or along a crack front.
    n : int
        Number of contours.

    Returns
    -------
    list of ndarray of int
        Sorted; each contains those before.

    Raises
    ------
    ValueError
        When n is less than 1, there is no tip, or no element has one of its nodes.

    Examples
    --------
    Four bilinear elements in a row.

    >>> cells = {"CPE4": [[0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 8, 7], [3, 4, 9, 8]]}
    >>> [ring.tolist() for ring in rings(cells, [0], 3)]
    [[0], [0, 1, 5, 6], [0, 1, 2, 5, 6, 7]]
    """
    elements = _elements(cells)
    tip = np.atleast_1d(np.asarray(tip, dtype=int))
    if n < 1:
        raise ValueError(f"n = {n}: must be at least 1 contour")
    if not tip.size:
        raise ValueError("tip has no nodes: must be at least one")
    known = np.unique(np.concatenate([nodes.ravel() for nodes in elements.values()]))
    if len(strange := np.setdiff1d(tip, known)):
        raise ValueError(f"tip names node {strange[0]}: no element has it")
    inside = np.zeros(known[-1] + 1, dtype=bool)
    inside[tip] = True
    found = [np.flatnonzero(inside)]
    for _ in range(n - 1):
        touching = [nodes[inside[nodes].any(axis=1)] for nodes in elements.values()]
        for nodes in touching:
            inside[nodes] = True
        found.append(np.flatnonzero(inside))
    return found


def interface_nodes(cells: Mapping[str, ArrayLike], region: Mapping[str, ArrayLike]) -> np.ndarray:
    """Node numbers, sorted, that elements of different regions share.

    Parameters
    ----------
    cells : mapping of str to array_like (el, k) of int
        Nodes of the elements of each type.
    region : mapping of str to array_like (el,) of int
        Which material each element is of.

    Raises
    ------
    ValueError
        When region says nothing of a type, or has another number of elements.

    Examples
    --------
    What drives an interface is the sum of the configurational forces on its nodes: the two-phase bar of Paper B, twice
    as stiff on its left and 0.1 mm longer, gains 35/3 N mm for each mm by which the interface moves to the right.

    >>> from slmm.fracture.configurational_forces import nodal_configurational_forces
    >>> points = np.array([[x, y] for y in (0, 10) for x in (0, 10, 20)], dtype=float)
    >>> cells, region = {"CPE4R": [[0, 1, 4, 3], [1, 2, 5, 4]]}, {"CPE4R": [0, 1]}
    >>> u = np.tile([[0, 0], [1 / 30, 0], [0.1, 0]], (2, 1))
    >>> stress, energy = np.zeros((2, 1, 2, 2)), np.array([[7 / 6], [7 / 3]])
    >>> stress[..., 0, 0] = 700.0
    >>> forces = nodal_configurational_forces(
    ...     points, cells, u, {"CPE4R": stress}, {"CPE4R": energy}, method="linear"
    ... )
    >>> interface = interface_nodes(cells, region)
    >>> interface.tolist(), forces[interface].sum(axis=0).round(9).tolist()
    ([1, 4], [11.666666667, 0.0])
    """
    elements = _elements(cells)
    last = max(nodes.max(initial=-1) for nodes in elements.values())
    lowest = np.full(last + 1, np.iinfo(int).max)
    highest = np.full(last + 1, np.iinfo(int).min)
    for name, nodes in elements.items():
        if name not in region:
            raise ValueError(f"region has no values of {name}, of which there are {len(nodes)} elements")
        of_element = np.asarray(region[name], dtype=int)
        if of_element.shape != nodes.shape[:1]:
            raise ValueError(
                f"region[{name!r}] has the shape {of_element.shape}: there are {len(nodes)} elements"
            )
        np.minimum.at(lowest, nodes, of_element[:, None])
        np.maximum.at(highest, nodes, of_element[:, None])
    return np.flatnonzero(lowest < highest)


def _elements(cells: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """Node numbers (el, k) as arrays."""
    elements = {name: np.asarray(nodes, dtype=int) for name, nodes in cells.items()}
    if not any(nodes.size for nodes in elements.values()):
        raise ValueError("cells has no elements")
    for name, nodes in elements.items():
        if nodes.ndim != 2 or nodes.min(initial=0) < 0:
            raise ValueError(
                f"cells[{name!r}] has the shape {nodes.shape} and numbers from {nodes.min(initial=0)}: must be "
                "(elements, nodes) and not negative"
            )
    return elements
