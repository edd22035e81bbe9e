"""Configurational forces of finite element results (Paper B; thesis 3.2.4.3).

The configurational force on a node is the derivative of the body's energy by the node's place in the undeformed
material: an interface's says how the energy changes when it moves, and around a crack tip their sum is the energy
release rate, turned round (thesis Eq. 3.15). From the results of any finite element program

    CF = sum over integration points of  CS . dN/dX . w det(dX/dR),

with the shape functions N of the node and the configurational stress CS = e I - F^T P (Eshelby's, "mbf": motion
based) or e I - H^T P ("dbf": displacement based); F = I + H is the deformation gradient, P the first Piola-Kirchhoff
stress and e the energy density per undeformed volume. "dbf" moves a node with its displacement kept, "mbf" with its
place in the deformed body kept. Their difference is the internal nodal force, zero at free nodes in balance.

The names and shapes of arguments are those that Paper B published. Elements, their nodes and integration points are
those of `slmm.fem.elements`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit, prange
from numpy.typing import ArrayLike

from slmm.fem.elements import Element, element_named

METHODS = ("mbf", "dbf")

#: an element's least det dX/dR over its largest side to the power of the dimension
DEGENERATE = 1e-10
#: and over its largest derivative to that power: no element above this is degenerate
SUSPECT = 1e-6


def compute_F(X_at_nodes: ArrayLike, U_at_nodes: ArrayLike, element_type: str) -> np.ndarray:
    """Deformation gradients (el, ips, d, d) at the integration points.

    Parameters
    ----------
    X_at_nodes, U_at_nodes : array_like (el, n, d)
        Undeformed coordinates and displacements of each element's nodes, mm.
    element_type : str
        One of `slmm.fem.elements.ELEMENTS`, or an alias.

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
    X, U = _nodal(element, X_at_nodes, U_at_nodes)
    _check_finite(X_at_nodes=X, U_at_nodes=U)
    _check_volumes(element, X)
    return _gradients(X, U, element.gradient_at_points)


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
    X, U = _nodal(element, X_at_nodes, U_at_nodes)
    S = _at_points(element, S_at_int_points, len(X), "S_at_int_points", 2)
    _check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S)
    _check_volumes(element, X)
    return _piola(_gradients(X, U, element.gradient_at_points), S)


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
    method : {"mbf", "dbf"}
        Motion based (Eshelby's stress) or displacement based.

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
    _check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S, e_at_int_points=e)
    _check_volumes(element, X)
    F = _gradients(X, U, element.gradient_at_points)
    return _configurational_stresses(F, _piola(F, S), e, method == "dbf")


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
    kernel = _forces_2d if element.dimension == 2 else _forces_3d
    forces, least = kernel(X, U, S, e, element.gradient_at_points, element.weights, method == "dbf")
    # whatever is wrong shows here: the input is searched for it only then
    with np.errstate(invalid="ignore"):
        finite = np.isfinite(forces.sum())
    if not (finite and (least > 0).all()):
        _check_finite(X_at_nodes=X, U_at_nodes=U, S_at_int_points=S, e_at_int_points=e)
    if not (least > SUSPECT).all():
        _check_volumes(element, X)
    return forces


def nodal_configurational_forces(
    points: ArrayLike,
    cells: Mapping[str, ArrayLike],
    u: ArrayLike,
    stress: Mapping[str, ArrayLike],
    energy: Mapping[str, ArrayLike],
    method: str = "mbf",
    thickness: float = 1.0,
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
    method : {"mbf", "dbf"}
        See `compute_CS`.
    thickness : float
        Of plane elements, mm.

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
    total = np.zeros_like(points)
    for element_type, nodes in cells.items():
        nodes = np.asarray(nodes)
        for name, given in (("stress", stress), ("energy", energy)):
            if element_type not in given:
                raise ValueError(
                    f"{name} has no values of {element_type}, of which there are {len(nodes)} elements"
                )
        if nodes.size and not (nodes.min() >= 0 and nodes.max() < len(points)):
            raise ValueError(f"cells[{element_type!r}] names node {nodes.max()}: there are {len(points)}")
        forces = compute_CF(
            points[nodes], u[nodes], stress[element_type], energy[element_type], element_type, method
        )
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


def _checked(X_at_nodes, U_at_nodes, S_at_int_points, e_at_int_points, element_type, method):
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: must be one of {', '.join(METHODS)}")
    element = element_named(element_type)
    X, U = _nodal(element, X_at_nodes, U_at_nodes)
    S = _at_points(element, S_at_int_points, len(X), "S_at_int_points", 2)
    e = _at_points(element, e_at_int_points, len(X), "e_at_int_points", 0)
    return element, X, U, S, e


def _nodal(element: Element, X_at_nodes: ArrayLike, U_at_nodes: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and displacements as arrays."""
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


def _check_volumes(element: Element, X: np.ndarray) -> None:
    """Refuse elements that are degenerate or inverted."""
    volume = np.linalg.det(np.einsum("eni,qnj->eqij", X, element.gradient_at_points))
    size = np.ptp(X, axis=1).max(axis=1) ** element.dimension
    worst = (volume / np.maximum(size, 1e-300)[:, None]).min(axis=1, initial=np.inf)
    bad = np.flatnonzero(worst < DEGENERATE)
    if len(bad):
        raise ValueError(
            f"X_at_nodes: element {bad[0]} is degenerate or inverted (det dX/dR = {worst[bad[0]]:.3g} of its size), "
            f"and {len(bad) - 1} others; the nodes of {element.name} must be in Abaqus' order"
        )


def _at_points(element: Element, values: ArrayLike, n: int, name: str, order: int) -> np.ndarray:
    """Scalars or tensors at the integration points as an array."""
    array = np.ascontiguousarray(values, dtype=float)
    shape = (n, len(element.points), *(element.dimension,) * order)
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}: {element.name} needs {shape}")
    return array


def _check_finite(**arrays: np.ndarray) -> None:
    """Refuse values that are not finite."""
    for name, array in arrays.items():
        finite = np.isfinite(array)
        if not finite.all():
            at = tuple(int(i) for i in np.argwhere(~finite)[0])
            raise ValueError(f"{name}{list(at)} = {array[at]}: must be finite")


@njit(cache=True, error_model="numpy")
def _invert(J, inverse, d):
    """Inverse of the leading (d, d) of a matrix, and its determinant."""
    if d == 2:
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        inverse[0, 0], inverse[0, 1] = J[1, 1] / det, -J[0, 1] / det
        inverse[1, 0], inverse[1, 1] = -J[1, 0] / det, J[0, 0] / det
        return det
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            inverse[m, i] = J[j, p] * J[k, q] - J[j, q] * J[k, p]
    det = J[0, 0] * inverse[0, 0] + J[0, 1] * inverse[1, 0] + J[0, 2] * inverse[2, 0]
    for i in range(3):
        for j in range(3):
            inverse[i, j] /= det
    return det


@njit(cache=True, error_model="numpy")
def _product(a, b, result, n):
    """sum_k a[k, i] b[k, j] over the n rows of a (n, d) and b (n, d)."""
    d = a.shape[1]
    for i in range(d):
        for j in range(d):
            total = 0.0
            for k in range(n):
                total += a[k, i] * b[k, j]
            result[i, j] = total


@njit(cache=True, error_model="numpy")
def _cofactor(F, result, d):
    """det(F) F^-T."""
    if d == 2:
        result[0, 0], result[0, 1] = F[1, 1], -F[1, 0]
        result[1, 0], result[1, 1] = -F[0, 1], F[0, 0]
        return
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            result[i, m] = F[j, p] * F[k, q] - F[j, q] * F[k, p]


@njit(parallel=True, cache=True, error_model="numpy")
def _gradients(X, U, dN):
    """Deformation gradients (el, ips, d, d)."""
    elements, n, d = X.shape
    result = np.empty((elements, len(dN), d, d))
    for e in prange(elements):
        J, inverse, dU = np.empty((d, d)), np.empty((d, d)), np.empty((d, d))
        for q in range(len(dN)):
            _product(X[e], dN[q], J, n)
            _invert(J, inverse, d)
            _product(U[e], dN[q], dU, n)
            for i in range(d):
                for j in range(d):
                    total = 1.0 if i == j else 0.0
                    for k in range(d):
                        total += dU[i, k] * inverse[k, j]
                    result[e, q, i, j] = total
    return result


@njit(parallel=True, cache=True, error_model="numpy")
def _piola(F, S):
    """P = det(F) S F^-T (el, ips, d, d)."""
    elements, points, d, _ = F.shape
    result = np.empty_like(F)
    for e in prange(elements):
        cofactor = np.empty((d, d))
        for q in range(points):
            _cofactor(F[e, q], cofactor, d)
            for i in range(d):
                for j in range(d):
                    total = 0.0
                    for k in range(d):
                        total += S[e, q, i, k] * cofactor[k, j]
                    result[e, q, i, j] = total
    return result


@njit(parallel=True, cache=True, error_model="numpy")
def _configurational_stresses(F, P, energy, displacement_based):
    """e I - F^T P, or e I - (F - I)^T P (el, ips, d, d)."""
    elements, points, d, _ = F.shape
    result = np.empty_like(F)
    for e in prange(elements):
        for q in range(points):
            for i in range(d):
                for j in range(d):
                    total = energy[e, q] if i == j else 0.0
                    for k in range(d):
                        total -= F[e, q, k, i] * P[e, q, k, j]
                    if displacement_based:
                        total += P[e, q, i, j]
                    result[e, q, i, j] = total
    return result


@njit(parallel=True, cache=True, error_model="numpy")
def _forces_2d(X, U, S, energy, dN, weights, displacement_based):
    """Configurational forces (el, n, 2), and the least det dX/dR over its largest entry's power (el,)."""
    elements, n, _ = X.shape
    result, least = np.zeros((elements, n, 2)), np.empty(elements)
    minus = 1.0 if displacement_based else 0.0
    for e in prange(elements):
        smallest = np.inf
        for q in range(len(dN)):
            a = b = c = d = s = t = v = w = 0.0
            for k in range(n):
                r0, r1 = dN[q, k, 0], dN[q, k, 1]
                x, y, ux, uy = X[e, k, 0], X[e, k, 1], U[e, k, 0], U[e, k, 1]
                a, b, c, d = a + x * r0, b + x * r1, c + y * r0, d + y * r1
                s, t, v, w = s + ux * r0, t + ux * r1, v + uy * r0, w + uy * r1
            det = a * d - b * c
            size = max(abs(a), abs(b), abs(c), abs(d))
            smallest = min(smallest, det / (size * size))
            i00, i01, i10, i11 = d / det, -b / det, -c / det, a / det
            f00, f01 = 1.0 + s * i00 + t * i10, s * i01 + t * i11
            f10, f11 = v * i00 + w * i10, 1.0 + v * i01 + w * i11
            s00, s01, s10, s11 = S[e, q, 0, 0], S[e, q, 0, 1], S[e, q, 1, 0], S[e, q, 1, 1]
            p00, p01 = s00 * f11 - s01 * f01, s01 * f00 - s00 * f10
            p10, p11 = s10 * f11 - s11 * f01, s11 * f00 - s10 * f10
            f00, f11 = f00 - minus, f11 - minus
            c00, c01 = energy[e, q] - f00 * p00 - f10 * p10, -f00 * p01 - f10 * p11
            c10, c11 = -f01 * p00 - f11 * p10, energy[e, q] - f01 * p01 - f11 * p11
            volume = weights[q] * det
            g00, g01 = (c00 * i00 + c01 * i01) * volume, (c00 * i10 + c01 * i11) * volume
            g10, g11 = (c10 * i00 + c11 * i01) * volume, (c10 * i10 + c11 * i11) * volume
            for k in range(n):
                r0, r1 = dN[q, k, 0], dN[q, k, 1]
                result[e, k, 0] += g00 * r0 + g01 * r1
                result[e, k, 1] += g10 * r0 + g11 * r1
        least[e] = smallest
    return result, least


@njit(cache=True, error_model="numpy")
def _cofactors(m):
    """Cofactors of a 3 x 3 matrix, as the nine numbers of its rows."""
    a, b, c, d, e, f, g, h, i = m
    return (
        e * i - f * h,
        f * g - d * i,
        d * h - e * g,
        c * h - b * i,
        a * i - c * g,
        b * g - a * h,
        b * f - c * e,
        c * d - a * f,
        a * e - b * d,
    )


@njit(cache=True, error_model="numpy")
def _with_outer(m, x, y, z, p, q, r):
    """M and the outer product of two vectors."""
    a, b, c, d, e, f, g, h, i = m
    return (
        a + x * p,
        b + x * q,
        c + x * r,
        d + y * p,
        e + y * q,
        f + y * r,
        g + z * p,
        h + z * q,
        i + z * r,
    )


@njit(cache=True, error_model="numpy")
def _times(m, k, diagonal):
    """M K^T of two 3 x 3 matrices, and a number on the diagonal."""
    a, b, c, d, e, f, g, h, i = m
    p, q, r, s, t, u, v, w, x = k
    return (
        a * p + b * q + c * r + diagonal,
        a * s + b * t + c * u,
        a * v + b * w + c * x,
        d * p + e * q + f * r,
        d * s + e * t + f * u + diagonal,
        d * v + e * w + f * x,
        g * p + h * q + i * r,
        g * s + h * t + i * u,
        g * v + h * w + i * x + diagonal,
    )


@njit(cache=True, error_model="numpy")
def _transposed(m):
    a, b, c, d, e, f, g, h, i = m
    return a, d, g, b, e, h, c, f, i


@njit(cache=True, error_model="numpy")
def _scaled(m, factor):
    a, b, c, d, e, f, g, h, i = m
    return (
        a * factor,
        b * factor,
        c * factor,
        d * factor,
        e * factor,
        f * factor,
        g * factor,
        h * factor,
        i * factor,
    )


@njit(parallel=True, cache=True, error_model="numpy")
def _forces_3d(X, U, S, energy, dN, weights, displacement_based):
    """Configurational forces (el, n, 3), and the least det dX/dR over its largest entry's power (el,)."""
    elements, n, _ = X.shape
    result, least = np.zeros((elements, n, 3)), np.empty(elements)
    minus = 1.0 if displacement_based else 0.0
    for e in prange(elements):
        smallest = np.inf
        for q in range(len(dN)):
            J = dU = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            for k in range(n):
                r0, r1, r2 = dN[q, k, 0], dN[q, k, 1], dN[q, k, 2]
                J = _with_outer(J, X[e, k, 0], X[e, k, 1], X[e, k, 2], r0, r1, r2)
                dU = _with_outer(dU, U[e, k, 0], U[e, k, 1], U[e, k, 2], r0, r1, r2)
            cofactors = _cofactors(J)
            det = J[0] * cofactors[0] + J[1] * cofactors[1] + J[2] * cofactors[2]
            size = 0.0
            for number in J:
                size = max(size, abs(number))
            smallest = min(smallest, det / (size * size * size))
            # of dX/dR the inverse's transpose
            inverse = _scaled(cofactors, 1.0 / det)
            F = _times(dU, inverse, 1.0)
            stress = S[e, q]
            P = _times(
                (
                    stress[0, 0],
                    stress[0, 1],
                    stress[0, 2],
                    stress[1, 0],
                    stress[1, 1],
                    stress[1, 2],
                    stress[2, 0],
                    stress[2, 1],
                    stress[2, 2],
                ),
                _transposed(_cofactors(F)),
                0.0,
            )
            H = (F[0] - minus, F[1], F[2], F[3], F[4] - minus, F[5], F[6], F[7], F[8] - minus)
            product = _scaled(_times(_transposed(H), _transposed(P), -energy[e, q]), -weights[q] * det)
            G = _times(product, _transposed(inverse), 0.0)
            for k in range(n):
                r0, r1, r2 = dN[q, k, 0], dN[q, k, 1], dN[q, k, 2]
                result[e, k, 0] += G[0] * r0 + G[1] * r1 + G[2] * r2
                result[e, k, 1] += G[3] * r0 + G[4] * r1 + G[5] * r2
                result[e, k, 2] += G[6] * r0 + G[7] * r1 + G[8] * r2
        least[e] = smallest
    return result, least
