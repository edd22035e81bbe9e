"""Stress at points of a voxel model, at surfaces too: elastic polynomials through displacements and tractions nearby.

Within a patch around a point the solution is analytic: by Kolosov and Muskhelishvili,
2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi). Polynomials phi and psi are fitted to the displacements of nodes
that lie deep enough for the cut voxels not to matter, and to the tractions on surfaces in the patch, which are known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, label
from scipy.spatial import cKDTree

from slmm.mechanics.stress import kolosov, shear_modulus
from slmm.part.part import Part
from slmm.scene.loading import Loading
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.part_load import NEAR

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: radius of a patch, in voxels, and degree of its polynomials (chosen on validation/part_models.py)
RADIUS, DEGREE = 8.0, 5
#: voxels between a node that counts and those that are not all material (chosen: the cut voxels' error has faded)
DEEP = 1
#: points of a surface in each voxel (chosen)
SURFACE_POINTS = 2.0
#: share of material from which a voxel is whole
WHOLE = 1 - 1e-6
#: weight of tractions against displacements; these are exact (chosen)
EXACT = 1.0
#: equations for each unknown, at least (chosen)
EQUATIONS = 1.5


@dataclass(frozen=True, eq=False)
class Surface:
    """Points of a part's surfaces, and what is known of the tractions there.

    Attributes
    ----------
    points, inward : ndarray, shape (n, 2)
        mm, and unit normals into the body.
    traction : ndarray, shape (n, 2)
        MPa.
    known : ndarray of bool, shape (n, 2)
        Where it is known: in directions that are not held.
    """

    points: Array
    inward: Array
    traction: Array
    known: NDArray[np.bool_]


def surface_of(part: Part, loading: Loading, spacing: float) -> Surface:
    """Points about a spacing apart, mm, on all surfaces but the faces of cracks."""
    points, inward = [], []
    for outline in part.outlines:
        n = int(np.ceil(outline.length / spacing))
        s = (np.arange(n) + 0.5) * outline.length / n
        points.append(outline.points(s))
        inward.append(outline.normals(s))
    if part.rim is None:
        for a, b in zip(part.outer, np.roll(part.outer, -1, axis=0), strict=True):
            length = float(np.hypot(*(b - a)))
            n = int(np.ceil(length / spacing))
            points.append(a + (np.arange(n)[:, None] + 0.5) / n * (b - a))
            x, y = (b - a) / length
            inward.append(np.tile([-y, x], (n, 1)))
    all_points, all_inward = np.concatenate(points), np.concatenate(inward)
    # of outlines that cut each other, what bounds the body
    there = _on_body(part, all_points)
    all_points, all_inward = all_points[there], all_inward[there]
    traction, held = np.zeros(all_points.shape), np.zeros(all_points.shape, dtype=bool)
    for condition in loading:
        on = condition.on(all_points)
        traction[on] += condition.tractions(all_points[on], -all_inward[on])
        held[on] |= condition.is_held
    return Surface(all_points, all_inward, traction, ~held)


def _on_body(part: Part, points: Array) -> NDArray[np.bool_]:
    return np.asarray(shapely.dwithin(part.body, shapely.points(points), NEAR * part.tolerance))


class PatchStress:
    """Stress by patches of a voxel model.

    Parameters
    ----------
    grid : VoxelGrid
    u : ndarray, shape (ny + 1, nx + 1, 2)
        Displacements of its nodes, mm.
    density : ndarray, shape (ny, nx)
        The material's share of each voxel.
    surface : Surface
    E, nu : float
        MPa, of plane stress.
    """

    def __init__(
        self, grid: VoxelGrid, u: Array, density: Array, surface: Surface, E: float, nu: float
    ) -> None:
        """Find the nodes that count."""
        self.grid, self.surface = grid, surface
        self.radius = RADIUS * grid.size
        self._kappa, self._scale = kolosov(nu), 2 * shear_modulus(E, nu) / self.radius
        whole = np.pad(density > WHOLE, 1, constant_values=False)
        # nodes among four voxels of material, and as deep as asked for
        inside = whole[1:, 1:] & whole[:-1, 1:] & whole[1:, :-1] & whole[:-1, :-1]
        self._deep = binary_erosion(inside, np.ones((3, 3)), iterations=DEEP) if DEEP else inside
        self._u = u
        self._tree = cKDTree(surface.points)

    def stress(self, points: Array) -> Array:
        """Stress xx, yy, xy (k, 3) at points (k, 2), MPa; NaN where too little material is known around."""
        return np.array([self._at(point) for point in points]).reshape(-1, 3)

    def _at(self, point: Array) -> Array:
        """Stress (3,) at one point."""
        nodes = self._nodes(point)
        near = self._visible(point, nodes)
        known = self.surface.known[near].ravel()
        if 2 * len(nodes) + np.count_nonzero(known) < EQUATIONS * (4 * DEGREE + 2) or len(nodes) < 2 * DEGREE:
            return np.full(3, np.nan)
        places = (np.array(self.grid.origin) + nodes * (self.grid.hx, self.grid.hy) - point) / self.radius
        zeta = _complex(places)
        u = self._u[nodes[:, 1], nodes[:, 0]] * self._scale
        faces = _complex((self.surface.points[near] - point) / self.radius)
        weight = (1 - np.abs(zeta) ** 2) / np.sqrt(len(zeta))
        rows = [_components(displacements(zeta, self._kappa, DEGREE)) * np.repeat(weight, 2)[:, None]]
        values = [u.ravel() * np.repeat(weight, 2)]
        if known.any():
            weight = np.repeat(EXACT * (1 - np.abs(faces) ** 2) / np.sqrt(len(faces)), 2)[known]
            pulls = _components(tractions(faces, -_complex(self.surface.inward[near]), DEGREE))[known]
            rows.append(pulls * weight[:, None])
            values.append(self.surface.traction[near].ravel()[known] * weight)
        found = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
        a, b = found[0], found[2 * DEGREE] + 1j * found[3 * DEGREE]
        return np.array([2 * a - b.real, 2 * a + b.real, b.imag])

    def _nodes(self, point: Array) -> NDArray[np.int64]:
        """Columns and rows (n, 2) of the nodes that count: deep in the piece of material that the point belongs to."""
        grid = self.grid
        h = np.array([grid.hx, grid.hy])
        low = np.maximum(np.ceil((point - self.radius - grid.origin) / h).astype(int), 0)
        high = np.minimum(np.floor((point + self.radius - grid.origin) / h).astype(int), (grid.nx, grid.ny))
        window = self._deep[low[1] : high[1] + 1, low[0] : high[0] + 1]
        pieces, count = label(window)
        nodes = np.argwhere(window)[:, ::-1] + low
        away = np.hypot(*(np.array(grid.origin) + nodes * h - point).T)
        if count > 1:
            piece = pieces[window]
            mine = piece == piece[away.argmin()]
            nodes, away = nodes[mine], away[mine]
        return nodes[away < self.radius]

    def _visible(self, point: Array, nodes: NDArray[np.int64]) -> NDArray[np.int64]:
        """Points of the surface in a patch that bound its nodes' piece of material."""
        near = np.array(self._tree.query_ball_point(point, self.radius), dtype=int)
        if not len(near) or not len(nodes):
            return near
        below = self.surface.points[near] + (DEEP + 2) * self.grid.size * self.surface.inward[near]
        places = np.array(self.grid.origin) + nodes * (self.grid.hx, self.grid.hy)
        return near[cKDTree(places).query(below)[0] < 2 * self.grid.size]


def displacements(zeta: Complex, kappa: float, degree: int) -> Complex:
    """2 mu (u + i v) over the patch's radius at places (n,) in it, by each of 4 degree + 2 real coefficients.

    In turn the real and imaginary parts of phi's coefficients, from the first power on, of psi's, and a translation.
    """
    k = np.arange(1, degree + 1)
    power, other = zeta[:, None] ** k, k * zeta[:, None] * zeta.conj()[:, None] ** (k - 1)
    psi = power.conj()
    constant = np.ones((len(zeta), 1))
    return np.concatenate(
        [kappa * power - other, 1j * (kappa * power + other), -psi, 1j * psi, constant, 1j * constant], axis=1
    )


def tractions(zeta: Complex, outward: Complex, degree: int) -> Complex:
    """Tractions t_x + i t_y at places (n,) with unit normals (n,), by the same coefficients."""
    k = np.arange(1, degree + 1)
    slope = k * zeta[:, None] ** (k - 1)
    bend = zeta.conj()[:, None] * np.where(k > 1, k * (k - 1) * zeta[:, None] ** np.maximum(k - 2, 0), 0.0)
    n = outward[:, None]
    nothing = np.zeros((len(zeta), 2))
    return np.concatenate(
        [
            2 * slope.real * n - bend.conj() * n.conj(),
            -2 * slope.imag * n + 1j * bend.conj() * n.conj(),
            -slope.conj() * n.conj(),
            1j * slope.conj() * n.conj(),
            nothing,
        ],
        axis=1,
    )


def _complex(points: Array) -> Complex:
    return points[:, 0] + 1j * points[:, 1]


def _components(values: Complex) -> Array:
    """Real parts and imaginary parts (2 n, m) in turn."""
    return np.stack([values.real, values.imag], axis=1).reshape(-1, values.shape[1])
