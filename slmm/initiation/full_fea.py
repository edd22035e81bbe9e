"""Full FEA of a notched plate: energy release and stress along a straight crack path (Paper A, 2.2.1).

The thesis solves one model for every crack length and subtracts potential energies. Here the path is one
slit whose faces are held together; what releases energy is letting them go, from the mouth inwards. All crack
lengths follow from one factorisation (slmm.fem.crack_line) and no two large numbers are subtracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, ElementTriP2, ElementVector, MeshTri, MeshTri2
from skfem.models.elasticity import lame_parameters, linear_elasticity

from slmm.fem.crack_line import crack_factor
from slmm.fem.mesh import PlateMesh, plate_mesh

#: from one path element to the next at most; also the mesher follows steps up to 1.5 alone
GROWTH = 1.25
#: a mesh and its uniform refinements
LEVELS = 3
#: reference coordinates of the six nodes of a quadratic triangle
NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], dtype=float)


@dataclass(frozen=True)
class FullFEA:
    """Curves along a trial crack path.

    Parameters
    ----------
    a : ndarray, shape (n,)
        Crack lengths, mm.
    G_inc : ndarray, shape (n,)
        Incremental energy release rate, released energy per crack area, N/mm.
    G_inc_error : ndarray, shape (n,)
        Estimate of its error, N/mm: a quarter of what the last refinement changed in the extrapolated value.
    eta : ndarray, shape (m,)
        Depth along the path, mm.
    sigma : ndarray, shape (m, 3)
        Stress xx, yy, xy of the uncracked body in the axes of the plate, MPa.
    sigma_I : ndarray, shape (m,)
        Its maximum principal value, MPa.
    sigma_I_error : ndarray, shape (m,)
        Estimate of its error, MPa, likewise.
    start, direction : ndarray, shape (2,)
        The crack's mouth, mm, and the unit vector along the path.
    """

    a: np.ndarray
    G_inc: np.ndarray
    G_inc_error: np.ndarray
    eta: np.ndarray
    sigma: np.ndarray
    sigma_I: np.ndarray
    sigma_I_error: np.ndarray
    start: np.ndarray
    direction: np.ndarray


def principal_stress(sigma: np.ndarray) -> np.ndarray:
    """Maximum principal stress of plane stresses (..., 3) given as xx, yy, xy.

    Examples
    --------
    >>> principal_stress(np.array([[3.0, 1.0, 0.0], [0.0, 0.0, 2.0]]))
    array([3., 2.])
    """
    xx, yy, xy = np.moveaxis(np.asarray(sigma, dtype=float), -1, 0)
    return (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)


class PlateModel:
    """Quadratic triangles on a body-fitted mesh, loaded as the scene says, with a slit along the path.

    The unknowns are the displacements of the closed body and, along the path, the jumps of the left face
    against the right one. Without jumps the body is uncracked.

    Parameters
    ----------
    mesh : PlateMesh
        Triangles, edges on the outlines and the path.
    scene : Scene
        Plate, material and load.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Nodes, mm; those of the slit's left face follow as separate nodes.
    triangles : ndarray, shape (m, 6)
        Node numbers, corners first.
    u : ndarray, shape (n, 2)
        Displacements of the uncracked body, mm.
    """

    def __init__(self, mesh: PlateMesh, scene: Any) -> None:
        """Assemble, factorise and solve for the uncracked body."""
        self.E, self.nu = scene.material.plane_stress_equivalent
        slit, right, left = _open_slit(mesh)
        self.points = slit.doflocs.T
        self.triangles = Basis(slit, ElementTriP2(), intorder=4).element_dofs.T
        n = len(self.points)
        # where a node's displacement of the closed body is found
        self.place = np.arange(n)
        self.place[left] = right

        # plane stress is plane strain with another first Lamé parameter
        lam, mu = lame_parameters(self.E, self.nu)
        basis = Basis(slit, ElementVector(ElementTriP2()), intorder=4)
        K = linear_elasticity(2 * lam * mu / (lam + 2 * mu), mu).assemble(basis)
        jump, follows = _components(left), _components(right)
        to_displacements = sp.eye_array(2 * n, format="csr") + sp.csr_array(
            (np.ones(len(jump)), (jump, follows)), shape=(2 * n, 2 * n)
        )
        load, prescribed, value = _loading(slit, self.points, scene)
        self._K = (to_displacements.T @ K @ to_displacements).tocsr()
        self._load = to_displacements.T @ load
        # a mouth on an edge that is held cannot open
        self._jump = jump[~prescribed[jump]]
        self._jump_place = np.repeat(np.arange(len(left)), 2)[~prescribed[jump]]
        self._n_path = len(mesh.path)
        self._closed = np.setdiff1d(np.flatnonzero(~prescribed), jump)
        self._factor = _factorised(self._K[self._closed][:, self._closed])
        value[jump] = 0.0
        value[self._closed] = self._factor.solve((self._load - self._K @ value)[self._closed])
        self._value = value
        self.u = (to_displacements @ value).reshape(-1, 2)

    def released_energy(self) -> np.ndarray:
        """Energy released per thickness (k,), N, by cracks whose tips are the path's k vertices."""
        force = (self._load - self._K @ self._value)[self._jump]
        y = crack_factor(self._condensed(), force[:, None])[:, 0]
        energy = np.concatenate([[0.0], 0.5 * np.cumsum(y**2)])
        # a tip at vertex k frees the 2 k nodes before it, corners and midsides
        return energy[np.searchsorted(self._jump_place, 2 * np.arange(self._n_path))]

    def _condensed(self) -> np.ndarray:
        """Stiffness condensed to the jumps: the last block of a factorisation that eliminates them last.

        Ten times faster than solving with one right-hand side for every jump.
        """
        m = len(self._jump)
        order = np.concatenate([self._closed[np.argsort(self._factor.perm_c)], self._jump])
        lu = _factorised(self._K[order][:, order], ordering="NATURAL")
        last = lu.perm_c[-m:] - (len(order) - m)
        S = (lu.L[-m:, -m:] @ lu.U[-m:, -m:]).toarray()[np.ix_(last, last)]
        return (S + S.T) / 2

    def nodal_stress(self) -> np.ndarray:
        """Stress (n, 3) of the uncracked body at the nodes, the mean of the elements around each, MPa."""
        strain = _strain(self.points[self.triangles], self.u[self.triangles])
        stress = (strain @ _stiffness(self.E, self.nu)).reshape(-1, 3)
        node = self.place[self.triangles].ravel()
        total = np.stack([np.bincount(node, component, len(self.points)) for component in stress.T], axis=1)
        count = np.bincount(node, minlength=len(self.points))
        return (total / np.maximum(count, 1)[:, None])[self.place]

    def stress_at(self, points: np.ndarray) -> np.ndarray:
        """Stress (k, 3) of the uncracked body at points (k, 2), MPa; NaN outside the material."""
        corner = self.points[self.triangles[:, :3]]
        nearest = shapely.STRtree(shapely.polygons(corner)).nearest(shapely.points(points))
        node = self.triangles[nearest]
        xi = _local_coordinates(self.points[node], points)
        stress = np.einsum("kn,knc->kc", _shape(xi), self.nodal_stress()[node])
        # not exactly 0: a quadratic edge follows its outline only so far
        stress[np.minimum(xi.min(axis=1), 1 - xi.sum(axis=1)) < -0.02] = np.nan
        return stress


def plate_stress(
    scene: Any, points: np.ndarray, size_max: float | None = None, angle_max: float = 0.12
) -> tuple[np.ndarray, np.ndarray]:
    """Stress of the uncracked plate, extrapolated from two body-fitted meshes.

    Parameters
    ----------
    scene : Scene
        With ``plate``, ``outlines``, ``material`` and ``load``.
    points : ndarray, shape (k, 2)
        Where, mm.
    size_max, angle_max : float, optional
        Largest element (mm) and largest turn (rad) of an outline along one, in the coarser mesh.

    Returns
    -------
    sigma : ndarray, shape (k, 3)
        Stress xx, yy, xy, MPa; NaN outside the material.
    error : ndarray, shape (k,)
        Estimate of its error (largest component), MPa.
    """
    points = np.asarray(points, dtype=float)
    mesh = plate_mesh(
        scene.plate.width, scene.plate.height, scene.outlines, size_max=size_max, angle_max=angle_max
    )
    coarse, fine = (PlateModel(m, scene).stress_at(points) for m in (mesh, mesh.refined()))
    # nodal means of a quadratic displacement field: the error is quadratic in the element size
    change = (fine - coarse) / 3
    return fine + change, np.abs(change).max(axis=1)


@dataclass(frozen=True)
class NotchStress:
    """Stress along one outline of the uncracked plate."""

    s: np.ndarray  # arc lengths (n,), mm
    points: np.ndarray  # (n, 2), mm
    sigma_I: np.ndarray  # maximum principal stress (n,), MPa
    sigma_I_error: np.ndarray  # estimate of its error (n,), MPa


def notch_stress(
    scene: Any, n: int = 360, size_max: float | None = None, angle_max: float = 0.12
) -> list[NotchStress]:
    """Maximum principal stress along every outline of the uncracked plate.

    Parameters
    ----------
    scene : Scene
        With ``plate``, ``outlines``, ``material`` and ``load``.
    n : int
        Points on each outline, evenly spaced in arc length from s = 0.
    size_max, angle_max : float, optional
        As in `plate_stress`.

    Returns
    -------
    list of NotchStress
        One for each outline; NaN where it lies outside the material.
    """
    outlines = scene.outlines
    s = [np.linspace(0.0, outline.length, n, endpoint=False) for outline in outlines]
    points = [outline.points(at) for outline, at in zip(outlines, s, strict=True)]
    if not points:
        return []
    sigma, error = plate_stress(scene, np.concatenate(points), size_max, angle_max)
    sigma_I = principal_stress(sigma)
    return [
        NotchStress(s[k], points[k], sigma_I[k * n : (k + 1) * n], error[k * n : (k + 1) * n])
        for k in range(len(outlines))
    ]


def full_fea_curves(
    scene: Any,
    outline_index: int | None = None,
    s: float | None = None,
    a_max: float | None = None,
    n_lengths: int = 48,
    a_min: float | None = None,
    eta: np.ndarray | None = None,
    start: Sequence[float] | None = None,
    direction: Sequence[float] | None = None,
    size_max: float | None = None,
    angle_max: float = 0.25,
) -> FullFEA:
    """Released energy and stress along a straight crack path by full FEA, extrapolated from three meshes.

    Parameters
    ----------
    scene : Scene
        With ``plate``, ``outlines``, ``material`` and ``load``.
    outline_index : int
        The notch the path starts from.
    s : float
        Arc length of the start on that outline, mm; the path follows the inward normal.
    a_max : float
        Longest crack, mm.
    n_lengths : int
        Number of crack lengths, evenly spaced in log(a). Many lengths also mean small elements.
    a_min : float
        Shortest crack, mm, by default a_max/120.
    eta : ndarray, shape (m,), optional
        Depths where the stress is wanted, mm; by default 0 and the crack lengths.
    start, direction : sequence of 2 floats, optional
        In place of a notch: any boundary point, mm, and the direction of the path from it.
    size_max, angle_max : float, optional
        Largest element (mm, by default an eighth of the plate's shorter side) and largest turn (rad) of an
        outline along one, in the coarsest of the three meshes.

    Returns
    -------
    FullFEA

    Raises
    ------
    ValueError
        When the path leaves the material, or a number is out of its range.
    ImportError
        Without netgen.

    Notes
    -----
    Elements along the path grow with the depth, so each crack length sees about the same relative tip
    element. The energy's error comes from the tip and is linear in the element there; the error of the
    stress is quadratic. Both are extrapolated from a mesh and its uniform refinements.
    """
    origin, along = _path_start(scene, outline_index, s, start, direction)
    if a_max is None or not a_max > 0:
        raise ValueError(f"a_max = {a_max!r} mm: must be a positive crack length")
    a_min = a_max / 120 if a_min is None else a_min
    if not 0 < a_min < a_max:
        raise ValueError(f"a_min = {a_min!r} mm: must lie between 0 and a_max = {a_max!r} mm")
    if n_lengths < 2:
        raise ValueError(f"n_lengths = {n_lengths!r}: at least 2")
    a = np.geomspace(a_min, a_max, n_lengths)
    depth = path_depths(a)
    # where the lengths are among the vertices of the path
    last_nodes = len(depth) - 1 - nodes_per_length(a) * np.arange(n_lengths)[::-1]
    eta = np.concatenate([[0.0], a]) if eta is None else np.asarray(eta, dtype=float)
    plate = scene.plate
    if size_max is None:
        size_max = min(plate.width, plate.height) / 8
    path = origin + depth[:, None] * along
    mesh = plate_mesh(plate.width, plate.height, scene.outlines, path, size_max, angle_max)
    released, stress = [], []
    for level in range(LEVELS):
        model = PlateModel(mesh, scene)
        released.append(model.released_energy()[last_nodes * 2**level] / a)
        stress.append(model.stress_at(origin + eta[:, None] * along))
        if np.any(np.isnan(stress[-1])):
            deep = eta[np.isnan(stress[-1]).any(axis=1)][0]
            raise ValueError(f"eta = {deep!r} mm: the path has left the material there")
        mesh = mesh.refined()
    # the tip's linear error cancels; what remains falls more than eightfold with every refinement
    before, G_inc = 2 * released[1] - released[0], 2 * released[2] - released[1]
    # at a single length the change may vanish by chance: the largest along the path counts for all
    G_inc_error = np.max(np.abs(1 - before / G_inc)) / 4 * G_inc
    sigma = (4 * stress[2] - stress[1]) / 3
    sigma_I = principal_stress(sigma)
    return FullFEA(
        a=a,
        G_inc=G_inc,
        G_inc_error=G_inc_error,
        eta=eta,
        sigma=sigma,
        sigma_I=sigma_I,
        sigma_I_error=np.abs(sigma_I - principal_stress(stress[2])),
        start=origin,
        direction=along,
    )


def path_depths(a: np.ndarray) -> np.ndarray:
    """Depths of the nodes on a path whose tip visits the lengths a (n,), evenly spaced in log(a).

    The last step to a length is at most GROWTH - 1 of it: between the lengths more nodes are put where
    needed, and equal steps lead to the first one.

    Examples
    --------
    >>> path_depths(np.array([0.6, 0.72, 0.864]))
    array([0.   , 0.12 , 0.24 , 0.36 , 0.48 , 0.6  , 0.72 , 0.864])
    """
    k = nodes_per_length(a)
    grown = np.geomspace(a[0], a[-1], k * (len(a) - 1) + 1)
    steps = max(1, round(grown[0] / (grown[1] - grown[0])))
    return np.concatenate([np.linspace(0.0, a[0], steps + 1)[:-1], grown])


def nodes_per_length(a: np.ndarray) -> int:
    """Number of path elements between two of the lengths a (n,), which are evenly spaced in log(a)."""
    return max(1, int(np.ceil(np.log(a[1] / a[0]) / np.log(GROWTH) - 1e-9)))


def _path_start(
    scene: Any,
    outline_index: int | None,
    s: float | None,
    start: Sequence[float] | None,
    direction: Sequence[float] | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Where a path starts and its unit direction."""
    if start is not None and direction is not None:
        along = np.asarray(direction, dtype=float)
        return np.asarray(start, dtype=float), along / np.linalg.norm(along)
    if outline_index is None or s is None:
        raise ValueError("a crack path needs outline_index and s, or start and direction")
    if not 0 <= outline_index < len(scene.outlines):
        raise ValueError(f"outline_index = {outline_index!r}: the scene has {len(scene.outlines)} outlines")
    outline = scene.outlines[outline_index]
    at = np.array([s % outline.length])
    return outline.points(at)[0], outline.normals(at)[0]


def _open_slit(mesh: PlateMesh) -> tuple[MeshTri2, np.ndarray, np.ndarray]:
    """Quadratic triangles on the true notch curves, and the nodes of the slit's right and left face.

    The node pairs run from the mouth inwards, corners and midsides, without the deepest tip.
    """
    triangles = mesh.triangles.copy()
    vertices = mesh.vertices
    opened = mesh.path[:-1]
    twin = np.arange(len(vertices))
    twin[opened] = len(vertices) + np.arange(len(opened))
    if len(opened):
        along = vertices[mesh.path[-1]] - vertices[mesh.path[0]]
        across = np.array([-along[1], along[0]])
        on_left = (vertices[triangles].mean(axis=1) - vertices[mesh.path[0]]) @ across > 0
        triangles[on_left] = twin[triangles[on_left]]
    vertices = np.concatenate([vertices, vertices[opened]])
    slit = MeshTri2.from_mesh(MeshTri(vertices.T.copy(), triangles.T.copy()))
    n = len(vertices)
    facet = _FacetNumbers(slit, n)
    doflocs = slit.doflocs.copy()
    middle = mesh.edge_midpoints()
    # next to the mouth an edge belongs to the left face and has its vertex there
    for ends in (mesh.edges, twin[mesh.edges], np.column_stack([twin[mesh.edges[:, 0]], mesh.edges[:, 1]]),
                 np.column_stack([mesh.edges[:, 0], twin[mesh.edges[:, 1]]])):  # fmt: skip
        number = facet(ends)
        doflocs[:, n + number[number >= 0]] = middle[number >= 0].T
    slit = replace(slit, doflocs=doflocs)
    faces = []
    for path in (mesh.path, twin[mesh.path]):
        nodes = np.empty(2 * len(opened), dtype=int)
        nodes[::2] = path[:-1]
        nodes[1::2] = n + facet(np.column_stack([path[:-1], path[1:]]))
        faces.append(nodes)
    return slit, faces[0], faces[1]


class _FacetNumbers:
    """Number of the facet between two vertices, -1 where there is none."""

    def __init__(self, mesh: MeshTri, n: int):
        self.n = n
        key = self._key(mesh.facets.T)
        self.order = np.argsort(key)
        self.key = key[self.order]

    def _key(self, ends: np.ndarray) -> np.ndarray:
        return ends.min(axis=1).astype(np.int64) * self.n + ends.max(axis=1)

    def __call__(self, ends: np.ndarray) -> np.ndarray:
        key = self._key(ends)
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        return np.where(self.key[at] == key, self.order[at], -1)


def _loading(slit: MeshTri2, points: np.ndarray, scene: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodal forces, which displacements are prescribed, and their values, each (2 n,)."""
    plate, load = scene.plate, scene.load
    x, y = points.T
    near = 1e-9 * max(plate.width, plate.height)
    bottom, top = np.abs(y) < near, np.abs(y - plate.height) < near
    force = np.zeros_like(points)
    prescribed = np.zeros(points.shape, dtype=bool)
    value = np.zeros_like(points)
    if load.strain is not None:
        e_xx, e_yy, g_xy = load.strain
        edge = bottom | top | (np.abs(x) < near) | (np.abs(x - plate.width) < near)
        prescribed[edge] = True
        value[edge] = np.column_stack([e_xx * x + g_xy * y / 2, g_xy * x / 2 + e_yy * y])[edge]
    elif load.displacement is not None:
        prescribed[bottom | top, 1] = True
        value[top, 1] = load.displacement
        prescribed[np.flatnonzero(bottom)[np.argmin(x[bottom])], 0] = True
    else:
        n = slit.nvertices
        for edge, stress in ((bottom, -load.stress), (top, load.stress)):
            facets = slit.boundary_facets()
            facets = facets[np.all(edge[slit.facets[:, facets]], axis=0)]
            ends = slit.facets[:, facets]
            length = np.abs(x[ends[1]] - x[ends[0]])
            # Simpson's rule: the consistent forces of a uniform traction
            for nodes, share in ((ends[0], 1 / 6), (ends[1], 1 / 6), (n + facets, 4 / 6)):
                np.add.at(force[:, 1], nodes, share * stress * length)
        moment = np.array([force[:, 1].sum(), (x - plate.width / 2) @ force[:, 1] / plate.width])
        if np.any(np.abs(moment) > 1e-9 * np.abs(force).sum()):
            raise ValueError(
                f"load.stress = {load.stress!r}: notches leave different parts of the top and bottom edge, "
                "so the forces do not balance; use load.displacement or load.strain"
            )
        # three supports without reaction hold the plate
        rows = np.flatnonzero(bottom)
        first, last = rows[np.argmin(x[rows])], rows[np.argmax(x[rows])]
        prescribed[first] = True
        prescribed[last, 1] = True
    return force.ravel(), prescribed.ravel(), value.ravel()


def _components(nodes: np.ndarray) -> np.ndarray:
    """Numbers of both displacements of each node."""
    return np.ravel(2 * nodes[:, None] + np.arange(2))


def _factorised(K: sp.csr_array, ordering: str = "MMD_AT_PLUS_A") -> SuperLU:
    """LU of a symmetric positive definite matrix, without the pivoting that it does not need."""
    return splu(K.tocsc(), permc_spec=ordering, diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _stiffness(E: float, nu: float) -> np.ndarray:
    """Plane stress: sigma = C epsilon with epsilon = (xx, yy, gamma_xy)."""
    return E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def _shape(xi: np.ndarray) -> np.ndarray:
    """Quadratic shape functions (k, 6) at local coordinates (k, 2)."""
    r, t = xi.T
    q = 1 - r - t
    return np.stack(
        [q * (2 * q - 1), r * (2 * r - 1), t * (2 * t - 1), 4 * q * r, 4 * r * t, 4 * q * t], axis=-1
    )


def _shape_gradients(xi: np.ndarray) -> np.ndarray:
    """Their derivatives (k, 6, 2)."""
    r, t = xi.T
    q, zero = 1 - r - t, np.zeros_like(r)
    by_r = [1 - 4 * q, 4 * r - 1, zero, 4 * (q - r), 4 * t, -4 * t]
    by_t = [1 - 4 * q, zero, 4 * t - 1, -4 * r, 4 * r, 4 * (q - t)]
    return np.stack([np.stack(by_r, axis=-1), np.stack(by_t, axis=-1)], axis=-1)


def _strain(points: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Strain (m, 6, 3) at the nodes of elements, from their nodes' points and displacements u (m, 6, 2)."""
    local = _shape_gradients(NODES)
    jacobian = np.einsum("pna,mni->mpia", local, points)
    gradient = np.einsum("pna,mni->mpia", local, u) @ np.linalg.inv(jacobian)
    return np.stack(
        [gradient[..., 0, 0], gradient[..., 1, 1], gradient[..., 0, 1] + gradient[..., 1, 0]], axis=-1
    )


def _local_coordinates(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Local coordinates (k, 2) of points (k, 2) in elements with nodes (k, 6, 2): Newton's method."""
    xi = np.full(points.shape, 1 / 3)
    for _ in range(8):
        residual = points - np.einsum("kn,kni->ki", _shape(xi), nodes)
        jacobian = np.einsum("kna,kni->kia", _shape_gradients(xi), nodes)
        xi = np.clip(xi + np.linalg.solve(jacobian, residual[..., None])[..., 0], -1.0, 2.0)
    return xi
