"""What is given at the nodes and integration points of elements, as arrays that fit the elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from slmm.mechanics.element import DEGENERATE, Element


def nodal_arrays(
    element: Element, X_at_nodes: ArrayLike, U_at_nodes: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and displacements (el, n, d) as arrays.

    Raises
    ------
    ValueError
        When the shape is not that of the element, or there are not as many displacements as coordinates.

    Examples
    --------
    >>> from slmm.mechanics.elements import element_named
    >>> X = [[[0, 0], [2, 0], [0, 2]]]
    >>> nodal_arrays(element_named("CPE3"), X, X)[1].shape
    (1, 3, 2)
    """
    n, d = element.nodes.shape
    found = []
    for name, values in (("X_at_nodes", X_at_nodes), ("U_at_nodes", U_at_nodes)):
        array = np.ascontiguousarray(values, dtype=float)
        if array.ndim != 3 or array.shape[1:] != (n, d):
            raise ValueError(f"{name} has the shape {array.shape}: {element.name} needs (elements, {n}, {d})")
        found.append(array)
    X, U = found
    if len(X) != len(U):
        raise ValueError(f"U_at_nodes has {len(U)} elements: X_at_nodes has {len(X)}")
    return X, U


def check_volumes(element: Element, X: np.ndarray) -> None:
    """Refuse elements with nodes X (el, n, d) that are degenerate or inverted.

    Raises
    ------
    ValueError
        With the first of them.
    """
    volume = np.linalg.det(np.einsum("eni,qnj->eqij", X, element.gradient_at_points))
    size = np.ptp(X, axis=1).max(axis=1) ** element.dimension
    worst = (volume / np.maximum(size, 1e-300)[:, None]).min(axis=1, initial=np.inf)
    bad = np.flatnonzero(worst < DEGENERATE)
    if len(bad):
        raise ValueError(
            f"X_at_nodes: element {bad[0]} is degenerate or inverted (det dX/dR = {worst[bad[0]]:.3g} of its size), "
            f"and {len(bad) - 1} others; the nodes of {element.name} must be in Abaqus' order"
        )


def point_array(element: Element, values: ArrayLike, n: int, name: str, order: int) -> np.ndarray:
    """Scalars (order 0) or tensors (order 2) at the integration points of n elements, as an array.

    Raises
    ------
    ValueError
        When the shape is not that of the element.
    """
    array = np.ascontiguousarray(values, dtype=float)
    shape = (n, len(element.points), *(element.dimension,) * order)
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}: {element.name} needs {shape}")
    return array


def check_finite(**arrays: np.ndarray) -> None:
    """Refuse values that are not finite.

    Raises
    ------
    ValueError
        With the first of them, by the name under which its array is given.
    """
    for name, array in arrays.items():
        finite = np.isfinite(array)
        if not finite.all():
            at = tuple(int(i) for i in np.argwhere(~finite)[0])
            raise ValueError(f"{name}{list(at)} = {array[at]}: must be finite")
