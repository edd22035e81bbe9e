"""What acts on the faces of a crack - pressure, friction, bridges - and what it adds to J and to K_I and K_II.

The traction is taken from the internal forces of the nodes on a face, which are exactly the loads that the program put
there: its density t fulfils  integral of N t dS = f  at each of these nodes, with the elements' own shape functions N.
An integral of t times anything then errs by products of two small errors only, also where the traction jumps. The
stresses of the elements are no good for this: next to a tip they are far from zero on a free face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from slmm.fracture.tip_field import tip_gradients
from slmm.fracture.tips import CrackTip
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults
from slmm.results.boundary_edges import boundary_edges

#: edges at the tip where the strain of finite elements is not that of the singularity; chosen
TIP_EDGES = 3
#: stresses are in balance around a tip when the force on no node inside is more than this share of stress times edge:
#: 1e-4 is the round-off of files with six digits, 0.04 are points of integration that are not the program's, 0.1 are
#: stresses carried from the nodes; chosen between
BALANCED = 5e-3
#: edges at the tip where stresses out of balance make a traction that is not there, of which 1e-4 of the stress at the
#: tip is left then (measured), and those that the traction is inferred from
SPOILT, FIT = 6, 6
#: edges around a tip that are looked at for balance; chosen
NEAR = 3
#: Gauss points per edge: enough for a quadratic traction times a linear strain, and for the tip's singularity
_X, _W = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True)
class LoadedFace:
    """One face of a crack at quadrature points (e, g) of its edges, all vectors in the axes of the tip.

    Parameters
    ----------
    side : int
        1 for the upper face, -1 for the lower one.
    nodes : ndarray (e, k)
        Of the edges.
    shape : ndarray (e, g, k)
        Their shape functions.
    X : ndarray (e, g, 2)
        Places relative to the tip, mm.
    dS : ndarray (e, g)
        Lengths, mm.
    slope : ndarray (e, g, 2)
        Derivative of the displacement along the crack's direction.
    n_1 : ndarray (e, g)
        Component along the crack's direction of the outward normal: 0 unless the faces open.
    traction : ndarray (e, g, 2)
        MPa.
    """

    side: int
    nodes: np.ndarray
    shape: np.ndarray
    X: np.ndarray
    dS: np.ndarray
    slope: np.ndarray
    n_1: np.ndarray
    traction: np.ndarray

    def integral(self, q: np.ndarray, density: np.ndarray) -> np.ndarray:
        """Integral of a weight q (n,), given at all nodes, times a density (e, g, ...)."""
        weights = np.einsum("egk,ek->eg", self.shape, q[self.nodes]) * self.dS
        return np.einsum("eg,eg...->...", weights, density)


def edge_shape(count: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (g, 2 or 3) of an edge's start, end and middle at t (g,) from -1 to 1, and their derivatives."""
    t = t[:, None]
    if count == 2:
        return np.hstack([1 - t, 1 + t]) / 2, np.hstack([0 * t - 0.5, 0 * t + 0.5])
    return (
        np.hstack([t * (t - 1) / 2, t * (t + 1) / 2, 1 - t**2]),
        np.hstack([t - 0.5, t + 0.5, -2 * t]),
    )


def loaded_faces(
    results: ElementResults, tip: CrackTip, internal: np.ndarray
) -> tuple[LoadedFace, LoadedFace]:
    """Upper and lower face of a crack, with what acts on them.

    Parameters
    ----------
    results : ElementResults
    tip : CrackTip
    internal : ndarray (n, 2)
        Internal nodal forces, N.
    """
    force = internal / results.thickness @ tip.axes.T
    spoilt = 0 if _balanced(results, tip, force) else SPOILT
    return (
        _face(results, tip, force, tip.upper, 1, spoilt),
        _face(results, tip, force, tip.lower, -1, spoilt),
    )


def _balanced(results: ElementResults, tip: CrackTip, force: np.ndarray) -> bool:
    """Whether nothing but rounding acts on the nodes inside next to a tip."""
    edge = np.linalg.norm(results.points[tip.upper[0, 1]] - tip.position)
    near = np.linalg.norm(results.points - tip.position, axis=1) < NEAR * edge
    near[tip.nodes] = False
    edges = boundary_edges(results.points, results.cells)
    near[edges[edges >= 0]] = False
    stress = max(
        np.abs(results.stress[name][np.isin(nodes, tip.nodes).any(axis=1)]).max(initial=0.0)
        for name, nodes in results.cells.items()
    )
    return bool(np.abs(force[near]).max(initial=0.0) <= BALANCED * stress * edge)


def _face(
    results: ElementResults, tip: CrackTip, force: np.ndarray, edges: np.ndarray, side: int, spoilt: int
) -> LoadedFace:
    X, u = (results.points[edges] - tip.position) @ tip.axes.T, results.u[edges] @ tip.axes.T
    count = edges.shape[1]
    shape, derivative = (np.repeat(a[None], len(edges), axis=0) for a in edge_shape(count, _X))
    weight = np.repeat(_W[None], len(edges), axis=0)
    # at the tip r = t^2 takes the root out of the integrand
    t = (1 + _X) / 2
    shape[0], derivative[0] = edge_shape(count, 2 * t**2 - 1)
    weight[0] = 2 * t * _W
    outwards = np.einsum("egk,eki->egi", derivative, X)
    length = np.linalg.norm(outwards, axis=-1)
    dS = length * weight
    # outwards from the tip is against the crack's direction
    slope = -np.einsum("egk,eki->egi", derivative, u) / length[..., None]
    traction = _nodal_traction(X, edges, shape, dS, force)
    if spoilt:
        traction[:spoilt] = _inferred(np.linalg.norm(X, axis=-1), traction, spoilt)
    return LoadedFace(
        side,
        edges,
        shape,
        np.einsum("egk,eki->egi", shape, X),
        dS,
        slope,
        -side * outwards[..., 1] / length,
        np.einsum("egk,eki->egi", shape, traction),
    )


def _nodal_traction(
    X: np.ndarray, edges: np.ndarray, shape: np.ndarray, dS: np.ndarray, force: np.ndarray
) -> np.ndarray:
    """Tractions (e, k, 2) whose consistent nodal forces are those of a face.

    The forces on the two ends of the face are those of the other face and of the part beyond, too: there the traction
    goes on straight from the two nodes before.
    """
    step = edges.shape[1] - 1
    # along the face: corner, middle, corner, ...
    place = step * np.arange(len(edges))[:, None] + np.array([0, step, 1])[: edges.shape[1]]
    n = step * len(edges) + 1
    if n < 4:
        return np.zeros(X.shape)  # of so few nodes the ends are all: no contour fits around such a tip
    mass = np.einsum("egk,egm,eg->ekm", shape, shape, dS)
    row, column = np.broadcast_arrays(place[:, :, None], place[:, None, :])
    M = sp.coo_array((mass.ravel(), (row.ravel(), column.ravel())), shape=(n, n)).tolil()
    node, distance = np.empty(n, dtype=int), np.empty(n)
    node[place], distance[place] = edges, np.linalg.norm(X, axis=-1)
    rhs = force[node]
    for end, near, far in ((0, 1, 2), (n - 1, n - 2, n - 3)):
        share = (distance[end] - distance[near]) / (distance[near] - distance[far])
        M[end, :] = 0.0
        M[end, [end, near, far]] = 1.0, -1.0 - share, share
        rhs[end] = 0.0
    return spsolve(M.tocsc(), rhs).reshape(n, 2)[place]


def _inferred(distance: np.ndarray, traction: np.ndarray, spoilt: int) -> np.ndarray:
    """Tractions on the first edges (spoilt, k, 2), straight on from those on the next ones."""
    fit = slice(spoilt, min(spoilt + FIT, len(traction) - 1))
    if len(traction[fit]) < 2:
        return np.zeros(traction[:spoilt].shape)  # what is left out shows: contours differ
    line = np.polynomial.polynomial.polyfit(distance[fit].ravel(), traction[fit].reshape(-1, 2), 1)
    return np.moveaxis(np.polynomial.polynomial.polyval(distance[:spoilt], line), 0, -1)


def traction_in_j(
    faces: tuple[LoadedFace, LoadedFace], q: np.ndarray, elasticity: Elasticity | None, moves: bool = False
) -> np.ndarray:
    """What the traction, and faces that open, add to J (2,) along the crack and left of it, N/mm.

    Parameters
    ----------
    faces : pair of LoadedFace
    q : ndarray (n,)
        The weight at all nodes.
    elasticity : Elasticity or None
        Without it the second component is not known: NaN.
    moves : bool
        Whether the nodal configurational forces are those at kept places in the deformed body ("mbf"): then the
        traction works on the weight itself, too.

    Notes
    -----
    To  - integral of q t . du/dX_k dS  the second component has the energy added that the traction leaves in the
    material next to the face; that of the strain along the face is `face_term`'s.
    """
    J = np.zeros(2)
    for face in faces:
        t = face.traction
        J[0] -= face.integral(q, (t * face.slope).sum(axis=-1))
        if moves:
            J -= face.integral(q, t)
        if elasticity is None:
            J[1] = np.nan
            continue
        (stiff, _), (_, lame) = elasticity.stress(np.diag([1.0, 0.0]))
        # n = (0, -side): the material of the upper face is above it
        shear, normal = -face.side * t[..., 0], -face.side * t[..., 1]
        across = np.stack(
            [shear / elasticity.mu - face.slope[..., 1], (normal - lame * face.slope[..., 0]) / stiff],
            axis=-1,
        )
        energy = (normal**2 / stiff + shear**2 / elasticity.mu) / 2
        of_strain = elasticity.E_prime * face.slope[..., 0] ** 2 / 2
        # edges at the tip that open, as those that close a gap, are part of it
        opens = face.n_1 * (np.arange(len(face.nodes)) >= TIP_EDGES)[:, None]
        J[0] += face.integral(q, opens * (energy + of_strain))
        J[1] -= face.integral(q, (t * across).sum(axis=-1) + face.side * energy)
    return J


def traction_in_interaction(
    faces: tuple[LoadedFace, LoadedFace], q: np.ndarray, elasticity: Elasticity
) -> np.ndarray:
    """What the traction adds to the interaction (2,) with the fields of K_I = 1 and of K_II = 1, N/mm."""
    total = np.zeros(2)
    for face in faces:
        X = face.X.copy()
        # on the crack itself the sign of y says which face it is, -0 the lower one
        X[..., 1] = face.side * np.maximum(face.side * X[..., 1], 0.0)
        H_tip = tip_gradients(X, elasticity)
        total -= face.integral(q, np.einsum("egi,egmi->egm", face.traction, H_tip[..., 0]))
    return total
