"""Configurational forces of finite element results (Paper B; thesis 3.2.4.3).

The configurational force on a node is the derivative of the body's energy by the node's place in the undeformed
material: an interface's says how the energy changes when it moves, and around a crack tip their sum is the energy
release rate, turned round (thesis Eq. 3.15). From the results of any finite element program

    CF = sum over integration points of  CS . dN/dX . w det(dX/dR),

with the shape functions N of the node and the configurational stress CS = e I - F^T P (Eshelby's, "mbf": motion
based) or e I - H^T P ("dbf": displacement based); F = I + H is the deformation gradient, P the first Piola-Kirchhoff
stress and e the energy density per undeformed volume. "dbf" moves a node with its displacement kept, "mbf" with its
place in the deformed body kept. Their difference is the internal nodal force, zero at free nodes in balance. Where
strains are small and the program was geometrically linear, P is the stress itself: "linear" is e I - H^T sigma, the
derivative at kept displacements of what such a program minimises.

The names and shapes of arguments are those that Paper B published. Elements, their nodes and integration points are
those of `slmm.mechanics.elements`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from slmm.fracture.configurational_kernels import configurational_stresses, forces_2d, forces_3d
from slmm.fracture.element_arrays import check_finite, check_volumes, nodal_arrays, point_array
from slmm.mechanics.element_results import METHODS
from slmm.mechanics.elements import element_named
from slmm.mechanics.kinematics import deformation_gradients, piola_stresses
from slmm.results.neighbourhood import rings


def compute_F(X_at_nodes: ArrayLike, U_at_nodes: ArrayLike, element_type: str) -> np.ndarray:
    """Deformation gradients (el, ips, d, d) at the integration points.

    Parameters
    ----------
    X_at_nodes, U_at_nodes : array_like (el, n, d)
        Undeformed coordinates and displacements of each element's nodes, mm.
    element_type : str
        One of `slmm.mechanics.elements.ELEMENTS`, or an alias.

    Raises
    ------
    ValueError
        For an unknown element, arrays of another shape, values that are not finite, and degenerate or inverted
        elements.

    Examples
    --------
    >>> X = [[[0, 0], [2, 0], [2, 2], [0, 2]]]
    >>> U = np.array(X) @ [[0.1, 0.0], [0.0, -0.1]]
    >>> compute_F(X, U, "CPE4R").round(12).tolist()
    [[[[1.1, 0.0], [0.0, 0.9]]]]
    """
    element = element_named(element_type)
    X, U = nodal_arrays(element, X_at_nodes, U_at_nodes)
    check_finite(X_at_nodes=X, U_at_nodes=U)
    check_volumes(element, X)
    return deformation_gradients(X, U, element.gradient_at_points)


def compute_P(
    X_at_nodes: ArrayLike, U_at_nodes: ArrayLike, S_at_int_points: ArrayLike, element_type: str
) -> np.ndarray:
    """First Piola-Kirchhoff stresses (el, ips, d, d), MPa, from Cauchy stresses.

    Parameters
    ----------
    X_at_nodes, U_at_nodes, element_type
        See `compute_F`.
    S_at_int_points : array_like (el, ips, d, d)
        Full Cauchy stress tensors, MPa.

    Raises
    ------
    ValueError
        See `compute_F`.

    Examples
    --------
    >>> X = [[[0, 0], [2, 0], [2, 2], [0, 2]]]
    >>> U = np.array(X) @ [[0.1, 0.0], [0.0, -0.1]]
    >>> compute_P(X, U, [[[[200, 0], [0, 0]]]], "CPE4R").round(9).tolist()
    [[[[180.0, 0.0], [0.0, 0.0]]]]
    """
    element = element_named(element_type)
    X, U = nodal_arrays(element, X_at_nodes, U_at_nodes)
    S = point_array(element, S_at_int_points, len(X), "S_at_int_points", 2)
    check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S)
    check_volumes(element, X)
    return piola_stresses(deformation_gradients(X, U, element.gradient_at_points), S)


def compute_CS(
    X_at_nodes: ArrayLike,
    U_at_nodes: ArrayLike,
    S_at_int_points: ArrayLike,
    e_at_int_points: ArrayLike,
    element_type: str,
    method: str = "mbf",
) -> np.ndarray:
    """Configurational stresses (el, ips, d, d), MPa.

    Parameters
    ----------
    X_at_nodes, U_at_nodes, S_at_int_points, element_type
        See `compute_P`.
    e_at_int_points : array_like (el, ips)
        Energy densities per undeformed volume, MPa.
    method : {"mbf", "dbf", "linear"}
        Motion based (Eshelby's stress), displacement based, or displacement based with small strains.

    Raises
    ------
    ValueError
        See `compute_F`.

    Examples
    --------
    >>> X = [[[0, 0], [2, 0], [2, 2], [0, 2]]]
    >>> U = np.array(X) @ [[0.1, 0.0], [0.0, -0.1]]
    >>> (compute_CS(X, U, [[[[200, 0], [0, 0]]]], [[20]], "CPE4R", "mbf") + 0.0).round(9).tolist()
    [[[[-178.0, 0.0], [0.0, 20.0]]]]
    """
    element, X, U, S, e = _checked(
        X_at_nodes, U_at_nodes, S_at_int_points, e_at_int_points, element_type, method
    )
    check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S, e_at_int_points=e)
    check_volumes(element, X)
    F = deformation_gradients(X, U, element.gradient_at_points)
    P = S if method == "linear" else piola_stresses(F, S)
    return configurational_stresses(F, P, e, method != "mbf")


def compute_CF(
    X_at_nodes: ArrayLike,
    U_at_nodes: ArrayLike,
    S_at_int_points: ArrayLike,
    e_at_int_points: ArrayLike,
    element_type: str,
    method: str = "mbf",
) -> np.ndarray:
    """Configurational forces (el, n, d) of each element on its nodes, N (per mm of thickness in 2D: N/mm).

    Parameters
    ----------
    X_at_nodes, U_at_nodes, S_at_int_points, e_at_int_points, element_type, method
        See `compute_CS`.

    Raises
    ------
    ValueError
        See `compute_F`.

    Examples
    --------
    >>> X = [[[0, 0], [2, 0], [2, 2], [0, 2]]]
    >>> U = np.array(X) @ [[0.1, 0.0], [0.0, -0.1]]
    >>> compute_CF(X, U, [[[[200, 0], [0, 0]]]], [[20]], "CPE4R", "mbf").round(9).tolist()
    [[[178.0, -20.0], [-178.0, -20.0], [-178.0, 20.0], [178.0, 20.0]]]
    """
    element, X, U, S, e = _checked(
        X_at_nodes, U_at_nodes, S_at_int_points, e_at_int_points, element_type, method
    )
    kernel = forces_2d if element.dimension == 2 else forces_3d
    forces, suspects, total = kernel(
        X, U, S, e, element.gradient_at_points, element.weights, method != "mbf", method == "linear"
    )
    # whatever is wrong shows here: the input is searched for it only then
    if suspects or not np.isfinite(total):
        check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S, e_at_int_points=e)
        check_volumes(element, X)
    return forces


def nodal_configurational_forces(
    points: ArrayLike,
    cells: Mapping[str, ArrayLike],
    u: ArrayLike,
    stress: Mapping[str, ArrayLike],
    energy: Mapping[str, ArrayLike],
    method: str = "mbf",
    thickness: float = 1.0,
    stretch: Mapping[str, ArrayLike] | None = None,
) -> np.ndarray:
    """Configurational forces (n, d) on the nodes of a mesh of any elements, N.

    Parameters
    ----------
    points, u : array_like (n, d)
        Undeformed coordinates and displacements of the nodes, mm.
    cells : mapping of str to array_like (el, k) of int
        Nodes of the elements of each type.
    stress : mapping of str to array_like (el, ips, d, d)
        Cauchy stresses at the integration points of each type, MPa.
    energy : mapping of str to array_like (el, ips)
        Energy densities per undeformed volume, MPa.
    method : {"mbf", "dbf", "linear"}
        See `compute_CS`.
    thickness : float
        Of undeformed plane elements, mm.
    stretch : mapping of str to array_like (el, ips), optional
        Of plane stress with large strains: how many times thicker the plate is at each point, F_zz. Without it,
        nothing stretches out of the plane; with small strains ("linear") it does not matter.

    Raises
    ------
    ValueError
        When stress or energy of a type are missing, a cell names a node that is not there, and as in `compute_CF`.

    Examples
    --------
    Two elements of a homogeneous, uniformly stretched strip: nothing drives the node between them.

    >>> points = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]], dtype=float)
    >>> cells = {"CPE4R": [[0, 1, 4, 5], [1, 2, 3, 4]]}
    >>> S, e = np.diag([100.0, 0.0]), 0.5
    >>> stress, energy = {"CPE4R": np.full((2, 1, 2, 2), S)}, {"CPE4R": np.full((2, 1), e)}
    >>> forces = nodal_configurational_forces(points, cells, 0.01 * points * [1, 0], stress, energy)
    >>> bool(np.abs(forces[[1, 4], 0]).max() < 1e-12)
    True
    """
    points, u = np.asarray(points, dtype=float), np.asarray(u, dtype=float)
    if points.ndim != 2 or points.shape != u.shape:
        raise ValueError(f"u has the shape {u.shape}: points have {points.shape}")
    if stretch is not None and (method == "linear" or points.shape[1] != 2):
        raise ValueError(
            "stretch belongs to large strains of plane elements: leave it out with method 'linear' and in 3D"
        )
    total = np.zeros_like(points)
    for element_type, nodes in cells.items():
        nodes = np.asarray(nodes)
        for name, given in (("stress", stress), ("energy", energy), ("stretch", stretch)):
            if given is not None and element_type not in given:
                raise ValueError(
                    f"{name} has no values of {element_type}, of which there are {len(nodes)} elements"
                )
        unknown = nodes[(nodes < 0) | (nodes >= len(points))]
        if unknown.size:
            raise ValueError(f"cells[{element_type!r}] names node {unknown[0]}: there are {len(points)}")
        S = np.asarray(stress[element_type], dtype=float)
        if stretch is not None:
            # of P = det F sigma F^-T the determinant has the third stretch as a factor
            S = S * np.asarray(stretch[element_type], dtype=float)[..., None, None]
        forces = compute_CF(points[nodes], u[nodes], S, energy[element_type], element_type, method)
        for i in range(points.shape[1]):
            total[:, i] += np.bincount(nodes.ravel(), forces[..., i].ravel(), len(points))
    return thickness * total


def forces_within(points: ArrayLike, forces: ArrayLike, centre: ArrayLike, radii: ArrayLike) -> np.ndarray:
    """Sums (k, d) of nodal forces within radii (k,) around a point, N.

    Around a crack tip the negative sum over the thickness is the J-integral's vector (thesis Eq. 3.15). It depends
    little on the radius once the tip's own elements are inside: that is what several radii are for.

    Parameters
    ----------
    points, forces : array_like (n, d)
        Nodes, mm, and the forces on them.
    centre : array_like (d,)
        mm.
    radii : array_like (k,)
        mm.

    Raises
    ------
    ValueError
        When no node lies within the smallest radius.

    Examples
    --------
    >>> forces_within([[0, 0], [1, 0], [3, 0]], [[1, 0], [2, 0], [4, 0]], [0, 0], [0.5, 2]).tolist()
    [[1.0, 0.0], [3.0, 0.0]]
    """
    points, forces = np.asarray(points, dtype=float), np.asarray(forces, dtype=float)
    radii = np.atleast_1d(np.asarray(radii, dtype=float))
    distance = np.linalg.norm(points - np.asarray(centre, dtype=float), axis=1)
    if not distance.min() <= radii.min():
        raise ValueError(f"radii = {radii.tolist()} mm: the nearest node lies {distance.min():.6g} mm away")
    return np.array([forces[distance <= radius].sum(axis=0) for radius in radii])


def forces_in_rings(cells: Mapping[str, ArrayLike], forces: ArrayLike, tip: ArrayLike, n: int) -> np.ndarray:
    """Sums (n, d) of nodal forces within the first n contours around a tip, N.

    As `forces_within`, with the contours that Abaqus counts (`slmm.results.neighbourhood.rings`) in place of radii: the
    first is the tip alone, each further one has a layer of elements more.

    Parameters
    ----------
    cells : mapping of str to array_like (el, k) of int
        Nodes of the elements of each type.
    forces : array_like (m, d)
        On all nodes, see `nodal_configurational_forces`.
    tip : array_like of int
        Nodes at the tip.
    n : int
        Number of contours.

    Raises
    ------
    ValueError
        As `slmm.results.neighbourhood.rings`, and when a contour has a node without a force.

    Examples
    --------
    >>> cells = {"CPE4": [[0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 8, 7], [3, 4, 9, 8]]}
    >>> forces_in_rings(cells, np.ones((10, 2)), [0], 3).tolist()
    [[1.0, 1.0], [4.0, 4.0], [6.0, 6.0]]
    """
    forces = np.asarray(forces, dtype=float)
    contours = rings(cells, tip, n)
    if contours[-1][-1] >= len(forces):
        raise ValueError(f"forces has {len(forces)} nodes: cells names node {contours[-1][-1]}")
    return np.array([forces[contour].sum(axis=0) for contour in contours])


def _checked(X_at_nodes, U_at_nodes, S_at_int_points, e_at_int_points, element_type, method):
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: must be one of {', '.join(METHODS)}")
    element = element_named(element_type)
    X, U = nodal_arrays(element, X_at_nodes, U_at_nodes)
    S = point_array(element, S_at_int_points, len(X), "S_at_int_points", 2)
    e = point_array(element, e_at_int_points, len(X), "e_at_int_points", 0)
    return element, X, U, S, e
