"""The voxel model: a rectangular plate of bilinear elements whose stiffness varies from voxel to voxel.

Paper A, section 2.2.2. Conjugate gradients in double precision, preconditioned by the multigrid cycle of
`slmm.voxels.multigrid` in single precision; no matrix is ever assembled. A million voxels need some 150 bytes each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.stress import plane_stiffness_constants
from slmm.running.threaded import number_of_threads
from slmm.scene.loading import Load, Loading, plate_loading
from slmm.voxels import kernels as voxel_kernels
from slmm.voxels.element import coefficients
from slmm.voxels.load import Problem, apply_traction, pose
from slmm.voxels.multigrid import PADDING, Multigrid, padded_zeros


class NotConvergedError(RuntimeError):
    """The voxel solver did not reach its tolerance."""


class NotHeldError(ValueError):
    """Material hangs on nothing but the void: no solver can tell where it is."""


#: The multigrid cycle becomes dearer and better after so many iterations, where the residual is still above so much.
#: Chosen on random plates (validation/voxel_robustness.py); a plate with one hole has 1e-5 after 8 and needs 13.
SLOW = {6: 1.0, 8: 1e-3, 10: 1.0, 14: 1.0, 16: 1e-6, 24: 1e-6, 36: 1e-6}

#: iterations after which material in pieces is refused; random plates in one piece needed fewer (the same
#: script); measured
PATIENCE = 60


@dataclass(frozen=True)
class VoxelSolution:
    """Displacements of a voxel model.

    Attributes
    ----------
    u : (ny + 1, nx + 1, 2) array
        Nodal displacements u_x, u_y, mm; row 0 lies at y = 0. Where a load leaves a rigid motion free, it is
        chosen so that its mean over the nodes vanishes.
    iterations : int
        Conjugate gradient iterations.
    residual : float
        Euclidean norm of the nodal forces out of balance, recomputed from u, relative to that of the forces
        that the same load exerts on the edge nodes of a plate without notches. (The norm of the right-hand
        side would be lenient by a factor of hundreds when displacements are prescribed.)
    converged : bool
        Always true: a solution that did not converge is raised, not returned.
    """

    u: NDArray[np.float64]
    iterations: int
    residual: float
    converged: bool


def solve_voxels(
    stiffness: NDArray[np.floating],
    width: float,
    height: float,
    nu: float,
    load: Load | Loading,
    E: float = 1.0,
    tol: float = 1e-8,
    max_iterations: int = 200,
    degree: int | None = None,
    loaded: NDArray[np.float64] | None = None,
) -> VoxelSolution:
    """Displacements of a plate of voxels in plane stress.

    Parameters
    ----------
    stiffness : (ny, nx) array
        Relative stiffness of each voxel, above 0 and up to 1 (kept in single precision); row 0 lies at y = 0.
    width, height : float
        Plate, mm; its lower left corner is the origin.
    nu, E : float
        Poisson's ratio and Young's modulus (MPa), or what makes plane stress describe plane strain. E matters
        to a stress load only.
    load : Loading, or object with ``strain``, ``displacement`` and ``stress``
        A strain: u_x = e_xx x + g_xy y / 2, u_y = g_xy x / 2 + e_yy y on all four edges. A displacement: u_y of the
        top edge in mm, u_y = 0 at the bottom, sides and u_x free. A stress: normal traction in MPa on top and bottom,
        see ``loaded``. Of the short form exactly one is not None.
    tol : float
        Relative residual to reach; see ``VoxelSolution.residual``.
    max_iterations : int
        Conjugate gradient iterations after which to give up.
    degree : int, optional
        Degree of the Chebyshev smoother; by default what `smoother_degree` says.
    loaded : (2, nx) array, optional
        Share of the bottom and of the top edge of each column of voxels that a stress acts on; by default the
        stiffness of the edge's voxels. A hole beside an edge, nearer than a voxel, takes from that and not from the
        edge.

    Raises
    ------
    ValueError
        When an argument is out of range, or a stress load is not in equilibrium because notches cut the top
        and the bottom edge differently.
    NotHeldError
        When 60 iterations did not suffice and the material is in pieces that are joined by void alone.
    NotConvergedError
        When ``max_iterations`` do not suffice.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> load = SimpleNamespace(strain=(0.0, 0.1, 0.0), displacement=None, stress=None)
    >>> solution = solve_voxels(np.ones((20, 30)), 3.0, 2.0, 0.3, load)
    >>> solution.u[-1, 0]
    array([0. , 0.2])
    """
    stiffness = np.asarray(stiffness)
    _check(stiffness, width, height, nu, E, tol, max_iterations, 1 if degree is None else degree)
    ny, nx = stiffness.shape
    if not isinstance(load, Loading):
        load = plate_loading(width, height, load.strain, load.displacement, load.stress)
    problem = pose(load, nx, ny, width, height, nu, E)
    # in units in which voxels and the stiffest of them are one: far from it, single precision over- or underflows
    unit, stiffest = math.sqrt(width / nx * (height / ny)), float(stiffness.max())
    width, height = width / unit, height / unit
    density = padded_zeros(nx, ny, leading=())
    density[1:-4, 1:-4] = stiffness / stiffest
    if degree is None:
        degree = smoother_degree(width / nx, height / ny, nu)
    edges = np.asarray(stiffness[[0, -1]] if loaded is None else loaded, dtype=float) / stiffest
    threads = number_of_threads()
    try:
        u, iterations, residual = _conjugate_gradients(
            problem, density, edges, width, height, nu, tol, max_iterations, degree
        )
    finally:
        numba.set_num_threads(threads)
    if not residual <= tol:
        check_held(density[1:-4, 1:-4])
        raise NotConvergedError(
            f"{nx} x {ny} voxels: residual {residual:.1e} after {iterations} iterations, {tol:.1e} wanted; "
            f"allow more or make the void stiffer (now {stiffness.min():.1e})"
        )
    solution = np.multiply(np.moveaxis(u[:, 1:-3, 1:-3], 0, 2), problem.scale * unit, order="C")
    _remove_rigid(solution, problem.rigid, width, height)
    return VoxelSolution(solution, iterations, residual, True)


def smoother_degree(hx: float, hy: float, nu: float) -> int:
    """Degree of the Chebyshev smoother that voxels hx by hy of Poisson's ratio nu (plane stress) need.

    A voxel that hardly changes its area resists bending, the more the larger it is, so the coarse grids are too
    stiff for long waves of shear and leave them to the smoother. Those are softer than what it is made for by
    the ratio of bulk to shear modulus, and, in voxels that are not square, by the square of their sides' ratio;
    the degree has to grow with its root.

    Examples
    --------
    >>> smoother_degree(1.0, 1.0, 0.35), smoother_degree(1.0, 1.0, 0.98), smoother_degree(3.0, 1.0, 0.35)
    (3, 10, 5)
    """
    return max(3, math.ceil(max(hx / hy, hy / hx) * math.sqrt((1 + nu) / (1 - nu))))


def _conjugate_gradients(
    problem: Problem,
    density: NDArray[np.float32],
    edges: NDArray[np.float64],
    width: float,
    height: float,
    nu: float,
    tol: float,
    max_iterations: int,
    degree: int,
) -> tuple[NDArray[np.float64], int, float]:
    """Displacements (padded, unscaled), number of iterations and relative residual."""
    ny, nx = (side - PADDING for side in density.shape)
    hx, hy = width / nx, height / ny
    multigrid = Multigrid(
        density, nx, ny, width, height, nu, problem.free_rows, problem.free_sides, problem.rigid, degree
    )
    c, k = coefficients(hx, hy, nu), _energy_coefficients(hx, hy, nu)
    free, columns = multigrid.free, multigrid.columns
    u, r = (padded_zeros(nx, ny, np.float64) for _ in range(2))
    r_single, p = (padded_zeros(nx, ny) for _ in range(2))
    sums = np.zeros(len(density))
    multigrid.share_work(u)

    def balance() -> float:
        """Recompute the residual from u."""
        r.fill(0)
        if problem.traction:
            apply_traction(r, edges, hx)
        voxel_kernels.subtract_force(density, u, r, r_single, c, free, columns, sums)
        if problem.rigid:
            # rounding leaves each node a share of a force that nothing can carry; summed over a million nodes
            # it is what conjugate gradients would diverge on, once the rest has gone below it
            forces = np.moveaxis(r[:, 1:-3, 1:-3], 0, 2)
            _remove_rigid(forces, problem.rigid, width, height)
            r_single[...] = r
        return math.sqrt(sums[1 : ny + 2].sum())

    _set_affine(u, width, height, problem.start)
    # a load of zero has nothing to be relative to, and no residual either
    reference = _edge_forces(problem.start, width, height, nx, ny, nu) or 1.0
    residual = balance() / reference
    iterations, previous = 0, np.inf
    while residual > tol and iterations < max_iterations:
        z, product = multigrid.precondition(r_single)
        voxel_kernels.combine(z, p, np.float32(product / previous))
        voxel_kernels.energy(density, p, k, sums)
        step = product / sums[1 : ny + 1].sum()
        voxel_kernels.advance(density, p, u, r, r_single, c, step, free, columns, sums)
        residual = math.sqrt(sums[1 : ny + 2].sum()) / reference
        iterations, previous = iterations + 1, product
        slow = residual > max(tol, SLOW.get(iterations, np.inf))
        if residual <= tol or slow:
            # what the recursion claims has to be true of u itself; if not, start over from here
            residual, previous = balance() / reference, np.inf
        if slow:
            multigrid.strengthen()
        if residual > tol and iterations == PATIENCE:
            check_held(density[1:-4, 1:-4])
    return u, iterations, residual


def check_held(stiffness: NDArray) -> None:
    """Refuse material in pieces, once a solve is slow: whatever is much stiffer than the void counts."""
    from scipy.ndimage import label  # only a solve that is slow needs it, and it takes long to load

    pieces, number = label(stiffness > math.sqrt(stiffness.min()))
    if number > 1:
        sizes = np.bincount(pieces.ravel())[1:]
        raise NotHeldError(
            f"the material of {stiffness.shape[1]} x {stiffness.shape[0]} voxels is in {number} pieces with"
            f" nothing but void between them, the largest of {sizes.max()} voxels, the smallest of {sizes.min()}:"
            " join them, or take away what nothing holds"
        )


def _check(
    stiffness: NDArray, width: float, height: float, nu: float, E: float, tol: float, limit: int, degree: int
) -> None:
    if stiffness.ndim != 2 or min(stiffness.shape) < 2:
        raise ValueError(
            f"stiffness has shape {stiffness.shape}: (ny, nx) with at least 2 x 2 voxels is needed"
        )
    low, high = float(stiffness.min()), float(stiffness.max())
    if not (low >= 1e-12 and high <= 1 + 1e-9):  # NaN fails here too
        raise ValueError(f"stiffness between {low} and {high}: must lie above 0 (1e-12) and not exceed 1")
    for name, value in (("width", width), ("height", height), ("E", E), ("tol", tol)):
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: must be a positive number")
    if not -1 < nu < 1:
        raise ValueError(f"nu = {nu!r}: must lie between -1 and 1 (in plane stress)")
    if limit < 1 or degree < 1:
        raise ValueError(f"max_iterations = {limit}, degree = {degree}: both must be at least 1")


def _set_affine(
    u: NDArray[np.float64], width: float, height: float, strain: tuple[float, float, float]
) -> None:
    e_xx, e_yy, g_xy = strain
    nodes = u[:, 1:-3, 1:-3]
    x = np.linspace(0, width, nodes.shape[2])
    y = np.linspace(0, height, nodes.shape[1])[:, None]
    nodes[0] = e_xx * x + g_xy / 2 * y
    nodes[1] = g_xy / 2 * x + e_yy * y


def _edge_forces(
    strain: tuple[float, float, float], width: float, height: float, nx: int, ny: int, nu: float
) -> float:
    """Norm of the forces on the edge nodes of a solid plate (E = 1) under a uniform strain."""
    C11, C12, C33 = plane_stiffness_constants(nu)
    e_xx, e_yy, g_xy = strain
    s_xx, s_yy, s_xy = C11 * e_xx + C12 * e_yy, C11 * e_yy + C12 * e_xx, C33 * g_xy
    sides = 2 * height**2 / ny * (s_xx**2 + s_xy**2)
    return math.sqrt(sides + 2 * width**2 / nx * (s_yy**2 + s_xy**2))


def _energy_coefficients(hx: float, hy: float, nu: float) -> NDArray[np.float32]:
    """Coefficients of the strain energy in a voxel's sums and differences (kernels.energy)."""
    C11, C12, C33 = plane_stiffness_constants(nu)
    flat, steep = hy / hx / 4, hx / hy / 4
    return np.array(
        [C11 * flat, C11 * steep, C12 / 2, C33 * steep, C33 * flat, 1 / 3, C33 / 2], dtype=np.float32
    )


def _remove_rigid(u: NDArray[np.float64], rigid: tuple[str, ...], width: float, height: float) -> None:
    """Take the mean of the named rigid motions over all nodes out of ``u``."""
    for component, name in enumerate("xy"):
        if name in rigid:
            u[..., component] -= u[..., component].mean()
    if "rotation" in rigid:
        x = np.linspace(-width / 2, width / 2, u.shape[1])
        y = np.linspace(-height / 2, height / 2, u.shape[0])[:, None]
        angle = (x * u[..., 1] - y * u[..., 0]).sum() / (x**2 + y**2).sum()
        u[..., 0] += angle * y
        u[..., 1] -= angle * x
