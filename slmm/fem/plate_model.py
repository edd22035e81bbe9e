"""A notched, cracked plate on a body-fitted mesh: displacements, stresses, and what a trial crack releases."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import shapely
from scipy.sparse.linalg import SuperLU
from skfem.models.elasticity import lame_parameters

from slmm.fem.closed_faces import NodePairs, held_closed
from slmm.fem.loads import nodal_load
from slmm.fem.mesh import PlateMesh
from slmm.fem.plane_stiffness import plane_stiffness
from slmm.fem.recovery import recovered_stress
from slmm.fem.rigid_bodies import Followers
from slmm.fem.slit import open_slits
from slmm.fem.sparse_factor import factorised, last_block, nested_dissection
from slmm.mechanics import triangle
from slmm.mechanics.crack_line import crack_factor
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults, linear_elastic
from slmm.mechanics.material import Material
from slmm.mechanics.stress import plane_stiffness_matrix
from slmm.scene.loading import Condition, Loading


class PlateModel:
    """Quadratic triangles on a body-fitted mesh of a part, cracks open, under a loading.

    A trial path in the mesh is closed; `SlitModel` lets it open. Where cracks sever the part, each piece moves by
    itself; one that the load carries away has no displacements (NaN).

    Parameters
    ----------
    mesh : PlateMesh
        Triangles, edges on the outlines, cracks and the trial path.
    material : Material
    loading : Loading
    thickness : float
        mm; displacements and what is released are those of 1 mm.
    contact : bool
        Whether faces of cracks that would overlap hold each other, without friction.

    Attributes
    ----------
    mesh : skfem.MeshTri2
        Vertices first, then the middles of the facets; each face of a crack or of the path with its own.
    faces : tuple of ndarray, shape (e, 3, 2)
        Nodes of the edges of each crack: start, middle and end, on its right and its left face.
    pairs : NodePairs
        These nodes as far as they lie on each other.
    touching : ndarray, shape (m,) of bool
        Which of them hold each other.
    points : ndarray, shape (n, 2)
        Nodes, mm.
    triangles : ndarray, shape (m, 6)
        Node numbers, corners first.
    K : sparse array, shape (2 n, 2 n)
        Stiffness, unsupported; the path's left face has the jumps against its right face as unknowns, and rigid bodies
        their motions.
    load : NodalLoad
    u : ndarray, shape (n, 2)
        Displacements, mm.
    factor, order : SuperLU, ndarray
        Of the stiffness of what is not prescribed, and its numbers in the factor's order; of models without a path.
    """

    factor: SuperLU
    order: np.ndarray

    def __init__(
        self,
        mesh: PlateMesh,
        material: Material,
        loading: Loading,
        thickness: float = 1.0,
        contact: bool = False,
    ) -> None:
        """Assemble, factorise and solve."""
        self.E, self.nu = material.plane_stress_equivalent
        self.material, self.thickness = material, thickness
        slit = open_slits(mesh)
        self.mesh, self.faces = slit.mesh, slit.cracks
        self.points = self.mesh.doflocs.T
        self.triangles = np.concatenate([self.mesh.t, self.mesh.nvertices + self.mesh.t2f[[0, 1, 2]]]).T
        n = len(self.points)
        # where a node's displacement is found while the path is closed
        self._place = np.arange(n)
        self._place[slit.left] = slit.right
        # plane stress is plane strain with another first Lamé parameter
        lam, mu = lame_parameters(self.E, self.nu)
        K = plane_stiffness(self.mesh, self.triangles, 2 * lam * mu / (lam + 2 * mu), mu)
        jump, follows = _components(slit.left), _components(slit.right)
        to_displacements = sp.eye_array(2 * n, format="csr") + sp.csr_array(
            (np.ones(len(jump)), (jump, follows)), shape=(2 * n, 2 * n)
        )
        self.K = (to_displacements.T @ K @ to_displacements).tocsr() if len(jump) else K
        self.load = nodal_load(loading, self.mesh, self.points, np.column_stack([slit.right, slit.left]))
        self._prescribed = self.load.prescribed.ravel()
        value = self.load.value.ravel().copy()
        value[jump] = 0.0
        force = to_displacements.T @ self.load.force.ravel()
        self._of_displacements = self.K
        from_unknowns = to_displacements
        if self.load.bodies:
            bodies = Followers(self.load, self.points, jump)
            from_unknowns = (to_displacements @ bodies.from_unknowns).tocsr()
            self._prescribed = self._prescribed & ~np.isin(np.arange(2 * n), bodies.masters)
            force, self.K = bodies.force(self.K, force), bodies.stiffness(self.K)
            value[bodies.all] = 0.0
            self._solve(force, value, jump)
            value = bodies.displacements(value)
        else:
            self._solve(force, value, jump)
        self.u = (to_displacements @ value).reshape(-1, 2)
        self.u[self.load.adrift] = np.nan
        self.pairs = NodePairs.of(self.points, self.faces)
        self.touching = np.zeros(len(self.pairs.nodes), dtype=bool)
        if contact:
            self._close_faces(from_unknowns)

    def _close_faces(self, from_unknowns: sp.csr_array) -> None:
        """Let faces of cracks that overlap hold each other."""
        if self.is_carried_away:
            raise ValueError(
                "the load carries a piece of the severed part away: of its pieces none can be held by contact"
            )
        unknowns = from_unknowns[:, self.order]
        jump = np.diff(self.u[self.pairs.nodes], axis=1)
        held = held_closed(
            self.pairs.openings(len(self.points)),
            self.u.ravel(),
            lambda force: unknowns @ self.factor.solve(unknowns.T @ force),
            float(np.abs(jump).max(initial=1e-300)),
        )
        if held is not None:
            more, self.touching = held
            self.u += more.reshape(-1, 2)

    @cached_property
    def internal_forces(self) -> np.ndarray:
        """What acts on the nodes (n, 2) of a model without a path, N for each mm of thickness."""
        return np.asarray((self._of_displacements @ self.u.ravel()).reshape(-1, 2))

    @property
    def is_carried_away(self) -> bool:
        """Whether the load carries a piece of a severed part away."""
        return bool(self.load.adrift.any())

    def reaction(self, condition: Condition) -> np.ndarray:
        """Force (2,) on the part along a stretch that is held or pulled there, N for each mm of thickness."""
        on = condition.on(self.points)
        force = np.where(self.load.prescribed, self.internal_forces, self.load.force)
        return force[on].sum(axis=0)

    @cached_property
    def opening(self) -> np.ndarray:
        """How far the faces of cracks are apart at the middles (k,) of their edges, mm; negative where they overlap."""
        found = [np.empty(0)]
        for edges in self.faces:
            right, left = edges[:, 1].T
            x, y = (self.points[right] - self.points[edges[:, 0, 0]]).T
            jump = self.u[left] - self.u[right]
            found.append((jump[:, 1] * x - jump[:, 0] * y) / np.hypot(x, y))
        return np.concatenate(found)

    def _solve(self, force: np.ndarray, value: np.ndarray, jump: np.ndarray) -> None:
        """Put the free displacements into ``value`` (2 n,), which holds the prescribed ones."""
        free = np.setdiff1d(np.flatnonzero(~self._prescribed), jump)
        self.order = free[nested_dissection(self.K, free)]
        self.factor = factorised(self.K, self.order)
        value[self.order] = self.factor.solve((force - self.K @ value)[self.order])

    @cached_property
    def results(self) -> ElementResults:
        """What configurational forces and crack tips take, a trial path closed."""
        corner = self.points[self.triangles[:, :3]]
        a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        nodes = self._place[self.triangles]
        clockwise = a[:, 0] * b[:, 1] < a[:, 1] * b[:, 0]
        nodes[clockwise] = nodes[clockwise][:, [0, 2, 1, 5, 4, 3]]
        elasticity = Elasticity(self.material.E, self.material.nu, self.material.state)
        return linear_elastic(self.points, {"CPE6": nodes}, self.u, elasticity, thickness=self.thickness)

    @cached_property
    def nodal_stress(self) -> np.ndarray:
        """Stress (n, 3) xx, yy, xy at the nodes with the path closed, MPa."""
        closed = self._place[self.triangles]
        edges = np.sort(closed[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        _, first, count = np.unique(edges @ [len(self.points), 1], return_index=True, return_counts=True)
        interior = np.ones(len(self.points), dtype=bool)
        interior[edges[first[count == 1]]] = False
        C = plane_stiffness_matrix(self.E, self.nu)
        return recovered_stress(self.points, closed, self.u, C, interior)[self._place]

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Stress (k, 3) xx, yy, xy at points (k, 2), MPa; NaN outside the material."""
        node, weight, inside = self._locate(points)
        stress = np.einsum("kn,knc->kc", weight, self.nodal_stress[node])
        stress[~inside] = np.nan
        return stress

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm; outside the material those of the nearest element."""
        node, weight, _ = self._locate(points)
        return np.einsum("kn,kni->ki", weight, self.u[node])

    def element_size(self, points: np.ndarray) -> np.ndarray:
        """Square root of the area (k,) of the elements at points (k, 2), mm."""
        a, b, c = self.points[self.triangles[self._tree.nearest(shapely.points(points)), :3]].swapaxes(0, 1)
        return np.sqrt(0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]))

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree(shapely.polygons(self.points[self.triangles[:, :3]]))

    def _locate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes (k, 6) of the nearest elements, their weights (k, 6), and whether points (k, 2) lie inside."""
        nearest = self._tree.nearest(shapely.points(points))
        node = self.triangles[nearest]
        xi = triangle.reference_coordinates(self.points[node], points)
        # not exactly 0: a quadratic edge follows its outline only so far
        inside = np.minimum(xi.min(axis=1), 1 - xi.sum(axis=1)) > -0.02
        return node, triangle.shape(xi), inside


#: stiffness of a rigid motion over the largest, and force that drives it over all force, up to which it is round-off
NO_STIFFNESS, NO_FORCE = 1e-9, 1e-6


class SlitModel(PlateModel):
    """A plate model whose trial path can open, from its mouth to any of its vertices.

    Parameters are those of `PlateModel`; the mesh has a path.
    """

    def _solve(self, force: np.ndarray, value: np.ndarray, jump: np.ndarray) -> None:
        """Solve for the closed path, with one factorisation that also gives the path's stiffness."""
        free = np.flatnonzero(~self._prescribed)
        closed = np.setdiff1d(free, jump)
        # a mouth on an edge that is held cannot open
        opens = np.isin(jump, free)
        self._path_nodes, self._jump_place = jump[::2] // 2, np.flatnonzero(opens) // 2
        m = int(opens.sum())
        order = np.concatenate([closed[nested_dissection(self.K, closed)], jump[opens]])
        # springs across the faces hold what an open path may sever
        springs = np.zeros(self.K.shape[0])
        springs[jump[opens]] = self.E
        factor = factorised(self.K + sp.diags_array(springs, format="csr"), order)
        held = last_block(factor, m)
        self._S = held - self.E * np.eye(m)
        rhs = (force - self.K @ value)[order]
        open_path = rhs.copy()
        open_path[-m:] = 0.0
        # what the jumps want to be is forced back to zero
        closing = -held @ factor.solve(open_path)[-m:]
        self._holding = rhs[-m:] - closing
        rhs[-m:] = closing
        value[order] = factor.solve(rhs)
        value[order[-m:]] = 0.0
        along = self.points[jump[-2] // 2] - self.points[jump[0] // 2]
        self._across = np.array([-along[1], along[0]]) / np.linalg.norm(along)

    def released_energy(self) -> np.ndarray:
        """Energy released per thickness (k,), N, by cracks whose tips are the path's k vertices.

        Of a path that ends on a surface, its last vertex is no tip.
        """
        m = self._freed[-1]
        y = crack_factor(self._S[:m, :m], self._holding[:m, None])[:, 0]
        return np.concatenate([[0.0], 0.5 * np.cumsum(y**2)])[self._freed]

    def severed_energy(self) -> float:
        """Energy released per thickness, N, where all of a path opens that ends on a surface.

        Infinite where the load then carries a part away. Parts that nothing holds and nothing carries away stay.
        """
        stiffness, mode = la.eigh(self._S)
        force = mode.T @ self._holding
        rigid = stiffness <= NO_STIFFNESS * stiffness[-1]
        if np.any(np.abs(force[rigid]) > NO_FORCE * np.linalg.norm(force)):
            return np.inf
        return float(0.5 * np.sum(force[~rigid] ** 2 / stiffness[~rigid]))

    def tip_opening(self) -> np.ndarray:
        """Opening (k,) of the faces next to tips at the path's k vertices, mm; 0 at the mouth."""
        m = self._freed[-1]
        L = la.cholesky(self._S[:m, :m], lower=True)
        y = la.solve_triangular(L, self._holding[:m], lower=True)
        opening = np.zeros(len(self._freed))
        for k, n in enumerate(self._freed):
            # back substitution from the tip: of the last freed midside node; one that cannot open has none
            if k and self._jump_place[n - 1] == self._jump_place[n - 2]:
                last = slice(n - 2, n)
                opening[k] = la.solve_triangular(L[last, last], y[last], lower=True, trans="T") @ self._across
        return opening

    @cached_property
    def _freed(self) -> np.ndarray:
        """Number of unknowns (k,) that tips at the path's k vertices free."""
        # a tip at vertex k frees the 2 k nodes before it, corners and midsides
        vertices = np.arange(len(self._path_nodes) // 2 + 1)
        if len(self._path_nodes) % 2:
            vertices = vertices[:-1]  # its last vertex lies on a surface: a hinge, no tip
        return np.searchsorted(self._jump_place, 2 * vertices)


def _components(nodes: np.ndarray) -> np.ndarray:
    """Numbers of both displacements of each node."""
    return np.ravel(2 * nodes[:, None] + np.arange(2))
