"""Curves along the crack paths of many positions from the meta-model: SLMM and SLMM+AC (Paper A, 2.3 and 2.4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from slmm.contours.outline import Outline
from slmm.initiation import control
from slmm.initiation.curves import CURVE_POINTS, PathCurves
from slmm.initiation.local_model import LocalField
from slmm.initiation.meta_model import MetaModel, polynomial_matrix
from slmm.initiation.placement import CELL_HEIGHT, Constraints, boundary_points, fit_cells, grow_cells
from slmm.initiation.settings import IMPORTANT_MODES, Settings
from slmm.initiation.support import edge_support, supported
from slmm.scene import Scene


def select_modes(meta: MetaModel, modes: str) -> MetaModel:
    """Meta-model with the modes of the settings: "important" (D_imp), "published" (D_all) or "all"."""
    _, p, q = meta.powers.T
    if modes == "important":
        wanted = {tuple(mode) for mode in IMPORTANT_MODES}
        keep = np.array([tuple(row) in wanted for row in meta.powers.tolist()])
    elif modes == "published":
        keep = (p <= 2) & (q <= 2)
    elif modes == "all":
        keep = (p < 2) | (q == 0)  # the others repeat these on the cell's boundary
    else:
        raise ValueError(f"modes = {modes!r}: must be 'important', 'published' or 'all'")
    return meta.select(keep)


def path_fractions(linear_lengths: int) -> np.ndarray:
    """Distances along the path over a_n at which the curves are given."""
    fine = np.linspace(0.0, 1.0, CURVE_POINTS) ** 2
    if linear_lengths:
        # the kinks of the piecewise linear curve are points of the curve
        kinks = np.arange(1, linear_lengths + 1) / linear_lengths
        nearest = np.argmin(np.abs(fine[:, None] - kinks), axis=0)
        fine[nearest] = kinks
    return fine


def place_cells(
    scene: Scene,
    outline: Outline,
    s: np.ndarray,
    local: LocalField,
    meta: MetaModel,
    settings: Settings,
    rule: Constraints,
) -> Placed:
    """Place the largest valid cell and one of half its size at each position, and fit their boundaries.

    Parameters
    ----------
    scene : Scene
        Its plate is used.
    outline : Outline
        The notch.
    s : ndarray (n,)
        Arc lengths of the positions, mm.
    local : LocalField
        Displacements around the notch.
    meta : MetaModel
        Only the modes that are to be fitted.
    settings : Settings
        How.
    rule : Constraints
        When a cell is valid.
    """
    spline = np.ascontiguousarray(outline.breaks), np.ascontiguousarray(outline.coefficients)
    # no cell that fits the plate is higher than this
    largest = settings.height or 2 * max(scene.plate.width, scene.plate.height)
    first = settings.cell_voxels * local.resolution(outline.points(s))
    if settings.height:
        first = np.full(len(s), settings.height)
    c_min, c_max = float(meta.curvature[0]), float(meta.curvature[-1])
    height, _, stopped = grow_cells(*spline, s, first, largest, rule, c_min, c_max, *local.raster)
    rows = np.flatnonzero(np.isfinite(height))
    s, height = s[rows], height[rows]

    along_xi = meta.powers[:, 0] == 0
    powers_xi, powers_eta = (np.ascontiguousarray(meta.powers[which, 1:]) for which in (along_xi, ~along_xi))

    def fitted(h):
        curvature, points = boundary_points(*spline, s, h, rule)
        u = local.displacement(points.reshape(-1, 2)).reshape(points.shape)
        modes, misfit = fit_cells(*spline, s, h, curvature, powers_xi, powers_eta, u)
        return curvature, misfit, _Cell.scaled(meta, h, curvature, modes)

    curvature, misfit, large = fitted(height)
    return Placed(rows, s, height, curvature, misfit, large, fitted(0.5 * height)[2], stopped)


@dataclass(frozen=True)
class _Cell:
    """Cells in the image space."""

    scale: np.ndarray  # lambda_l (n,), Eq. 15
    curvature: np.ndarray  # c' (n,)
    modes: np.ndarray  # u'_RP (n, m)
    stress: np.ndarray  # path stress (n, 3, n_eta)

    @classmethod
    def scaled(cls, meta, height, curvature, modes):
        scale = height / CELL_HEIGHT
        image_c = np.clip(curvature * scale, meta.curvature[0], meta.curvature[-1])
        return cls(scale, image_c, modes, meta.path_stress(image_c, modes))


@dataclass(frozen=True)
class Placed:
    """Cells on a notch, with fitted boundaries.

    Attributes
    ----------
    rows : ndarray of int
        Which of the positions have a cell; the other arrays are of these.
    s, height, curvature : ndarray (n,)
        Arc length (mm), height of the larger cell (mm) and fitted c (1/mm).
    misfit : ndarray (n,)
        What the modes leave of the displacements on its boundary.
    large, small : _Cell
        The cell and one of half its size.
    stopped : ndarray of int
        Of all positions: index into `placement.STOPPED`.
    """

    rows: np.ndarray
    s: np.ndarray
    height: np.ndarray
    curvature: np.ndarray
    misfit: np.ndarray
    large: _Cell
    small: _Cell
    stopped: np.ndarray


def cell_stress(placed: Placed, meta: MetaModel, E: float, depths: np.ndarray) -> np.ndarray:
    """Stress across the path, along it, and shear (n, 3, k) at depths (n, k), MPa; NaN beyond half a cell's length."""
    result = np.full((len(placed.rows), 3, depths.shape[1]), np.nan)
    at = depths / placed.large.scale[:, None]
    for i, row in enumerate(at):
        reached = row <= meta.eta[-1] * (1 + 1e-9)
        result[i][:, reached] = E * placed.large.stress[i] @ polynomial_matrix(meta.eta, row[reached]).T
    return result


def cell_curves(
    scene: Scene, outline: Outline, placed: Placed, meta: MetaModel, settings: Settings, auto_control: bool
) -> tuple[PathCurves, np.ndarray, np.ndarray]:
    """Superpose the stored results.

    Parameters
    ----------
    scene, outline, meta, settings
        As in `place_cells`.
    placed : Placed
    auto_control : bool
        False: the boundary is held (SLMM); True: it yields (SLMM+AC).

    Returns
    -------
    curves : PathCurves
        Of the positions with a cell; G_inc is 0 where the crack would be closed.
    weight, support : ndarray (n,)
        Weight w of the auto control and support rho of the plate's edges.
    """
    rho = np.zeros(len(placed.rows))
    if auto_control and settings.relaxed == "unbounded":
        rho = edge_support(scene, outline, placed.s, placed.height, placed.curvature)
    E = scene.material.plane_stress_equivalent[0]
    weight, curves = _superpose(meta, E, placed.large, placed.small, settings, auto_control, rho)
    return curves, weight, rho


def _superpose(meta, E, large, small, settings, auto_control, rho):
    """Weights (n,) and the curves in the real space."""
    opening, release = _bounds(meta, large, settings, auto_control)
    a_n = meta.lengths[-1]
    if auto_control:
        _, small_release = _bounds(meta, small, settings, auto_control, slice(-1, None))
        # a_n of the small cell is half of that of the large one; G scales with the length
        at_small_end = np.stack([_at_length(meta, row, 0.5 * a_n) for row in release])
        w = control.auto_weight(0.5 * small_release[..., -1], at_small_end)
    else:
        w = np.zeros(len(rho))
    held = release[0]
    G = supported(held + w[:, None] * (release[1] + w[:, None] * release[2]), held, rho)

    a_image = path_fractions(settings.linear_lengths) * a_n
    if settings.linear_lengths:
        # Psi/a linear between the stored lengths and 0 without a crack (Eq. 9)
        stored = np.linspace(0.0, a_n, settings.linear_lengths + 1)
        at_stored = np.stack([_at_length(meta, G, a) for a in stored], axis=1)
        G_dense = np.array([np.interp(a_image, stored, row) for row in at_stored])
    else:
        G_dense = CubicSpline(meta.lengths, G / meta.lengths, axis=1)(a_image) * a_image
    closed = CubicSpline(meta.lengths, opening, axis=1)(a_image) <= 0
    G_dense = np.where(closed, 0.0, np.maximum(G_dense, 0.0))

    scale = large.scale[:, None]
    missing = np.full(G_dense.shape, np.nan)
    sigma = _principal(large.stress @ polynomial_matrix(meta.eta, a_image).T)
    return w, PathCurves(a_image * scale, G_dense * (E * scale), sigma * E, missing, missing)


def _principal(sigma):
    """Maximum principal stress (n, k) of components xi-xi, eta-eta, xi-eta (n, 3, k)."""
    normal, tangential, shear = sigma.swapaxes(0, 1)
    return 0.5 * (normal + tangential) + np.hypot(0.5 * (normal - tangential), shear)


def _at_length(meta, values, a):
    """Smooth interpolation of G (n, n_a) to one crack length, through G/a."""
    return CubicSpline(meta.lengths, values / meta.lengths, axis=1)(a) * a


def _bounds(meta, cell, settings, auto_control, which=slice(None)):
    """Mean opening (n, n_a), and the coefficients of G' = q0 + q1 w + q2 w^2 (3, n, n_a), for some lengths."""
    lengths = meta.lengths[which]
    upper, opening = (values[:, which] for values in meta.unbounded_release(cell.curvature, cell.stress))
    Psi = meta.stiffness_loss(cell.curvature, which)
    held = control.displacement_controlled(Psi, cell.modes, lengths)
    if not auto_control:
        return opening, np.stack([held, np.zeros_like(held), np.zeros_like(held)])
    if settings.relaxed == "unbounded":
        return opening, np.stack([held, upper - held, np.zeros_like(held)])
    released = control.force_controlled_modes(meta.stiffness(cell.curvature), Psi, cell.modes)
    return opening, control.mixed_release(Psi, cell.modes, released, lengths)
