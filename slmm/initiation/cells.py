"""Curves along the crack paths of many positions from the meta-model: SLMM and SLMM+AC (Paper A, 2.3 and 2.4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from slmm.contours.outline import Outline
from slmm.initiation import control
from slmm.initiation.local_model import LocalModel
from slmm.initiation.meta_model import MetaModel, polynomial_matrix
from slmm.initiation.placement import CELL_HEIGHT, Constraints, fit_cells, grow_cells
from slmm.initiation.settings import IMPORTANT_MODES, Settings
from slmm.initiation.support import edge_support, supported
from slmm.scene import Scene

#: points of the curves along a crack path, dense towards the surface
CURVE_POINTS = 201


@dataclass(frozen=True)
class Curves:
    """What cells say about n positions; NaN where there is no cell.

    Attributes
    ----------
    a : ndarray (n, CURVE_POINTS)
        Crack length and, alike, distance from the notch, mm.
    G_inc : ndarray (n, CURVE_POINTS)
        Incremental energy release rate, N/mm; 0 where the crack would be closed.
    sigma_I : ndarray (n, CURVE_POINTS)
        Maximum principal stress, MPa.
    height, curvature, weight, support, misfit : ndarray (n,)
        Of the cell: height (mm), fitted c (1/mm), weight w of the auto control, support rho of the plate's edges,
        misfit of the boundary fit.
    stopped : ndarray (n,)
        Index into `placement.STOPPED`.
    """

    a: np.ndarray
    G_inc: np.ndarray
    sigma_I: np.ndarray
    height: np.ndarray
    curvature: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    misfit: np.ndarray
    stopped: np.ndarray


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


def cell_curves(
    scene: Scene,
    outline: Outline,
    s: np.ndarray,
    local: LocalModel,
    meta: MetaModel,
    settings: Settings,
    rule: Constraints,
    auto_control: bool,
) -> Curves:
    """Place the largest valid cells, fit their boundaries, superpose the stored results.

    Parameters
    ----------
    scene : Scene
        Plate, load and material.
    outline : Outline
        The notch.
    s : ndarray (n,)
        Arc lengths of the positions, mm.
    local : LocalModel
        Displacements around the notch.
    meta : MetaModel
        Only the modes that are to be fitted.
    settings : Settings
        How.
    rule : Constraints
        When a cell is valid.
    auto_control : bool
        False: the boundary is held (SLMM); True: it yields (SLMM+AC).
    """
    coefficients, length = np.ascontiguousarray(outline.coefficients), outline.length
    voxel = max(local.hx, local.hy)
    # no cell that fits the plate is higher than this
    largest = settings.height or 2 * max(local.nx * local.hx, local.ny * local.hy)
    first = settings.height or settings.cell_voxels * voxel
    c_min, c_max = float(meta.curvature[0]), float(meta.curvature[-1])
    height, _, stopped = grow_cells(
        coefficients, length, s, first, largest, rule, c_min, c_max, local.density, local.hx, local.hy
    )

    along_xi = meta.powers[:, 0] == 0
    powers_xi, powers_eta = (np.ascontiguousarray(meta.powers[which, 1:]) for which in (along_xi, ~along_xi))

    def fitted(h):
        return fit_cells(coefficients, length, s, h, rule, powers_xi, powers_eta, local.u, local.hx, local.hy)

    has_cell = np.isfinite(height)
    n, points = len(s), CURVE_POINTS
    a, G_inc, sigma_I = (np.full((n, points), np.nan) for _ in range(3))
    weight, support = np.full(n, np.nan), np.full(n, np.nan)
    curvature, modes, misfit = fitted(height)
    if has_cell.any():
        h, c, u = height[has_cell], curvature[has_cell], modes[has_cell]
        small_c, small_u = (v[has_cell] for v in fitted(0.5 * height)[:2]) if auto_control else (c, u)
        rho = np.zeros(len(h))
        if auto_control and settings.relaxed == "unbounded":
            rho = edge_support(scene, outline, s[has_cell], h, c)
        E = scene.material.plane_stress_equivalent[0]
        w, curves = _superpose(meta, E, h, c, u, small_c, small_u, settings, auto_control, rho)
        weight[has_cell], support[has_cell] = w, rho
        a[has_cell], G_inc[has_cell], sigma_I[has_cell] = curves
    return Curves(a, G_inc, sigma_I, height, curvature, weight, support, misfit, stopped)


def _superpose(meta, E, height, curvature, modes, small_curvature, small_modes, settings, auto_control, rho):
    """Weights (n,) and the curves a, G_inc, sigma_I (n, CURVE_POINTS) in the real space."""
    scale = height / CELL_HEIGHT  # lambda_l, Eq. 15
    image_c = np.clip(curvature * scale, meta.curvature[0], meta.curvature[-1])
    stress = meta.path_stress(image_c, modes)
    opening, release = _bounds(meta, image_c, modes, stress, settings, auto_control)
    if auto_control:
        half_c = np.clip(small_curvature * scale / 2, meta.curvature[0], meta.curvature[-1])
        half_stress = meta.path_stress(half_c, small_modes)
        longest = slice(-1, None)
        _, half_release = _bounds(meta, half_c, small_modes, half_stress, settings, auto_control, longest)
        # a_n of the small cell is half of that of the large one; G scales with the length
        a_n = meta.lengths[-1]
        small = 0.5 * half_release[..., -1]
        large = np.stack([_at_length(meta, row, 0.5 * a_n) for row in release])
        w = control.auto_weight(small, large)
    else:
        w = np.zeros(len(scale))
    held = release[0]
    G = supported(held + w[:, None] * (release[1] + w[:, None] * release[2]), held, rho)

    a_image = path_fractions(settings.linear_lengths) * meta.lengths[-1]
    if settings.linear_lengths:
        # Psi/a linear between the stored lengths and 0 without a crack (Eq. 9)
        stored = np.linspace(0.0, meta.lengths[-1], settings.linear_lengths + 1)
        at_stored = np.stack([_at_length(meta, G, a) for a in stored], axis=1)
        G_dense = np.array([np.interp(a_image, stored, row) for row in at_stored])
    else:
        G_dense = CubicSpline(meta.lengths, G / meta.lengths, axis=1)(a_image) * a_image
    closed = CubicSpline(meta.lengths, opening, axis=1)(a_image) <= 0
    G_dense = np.where(closed, 0.0, np.maximum(G_dense, 0.0))

    sigma = stress @ polynomial_matrix(meta.eta, a_image).T
    normal, tangential, shear = sigma[:, 0], sigma[:, 1], sigma[:, 2]
    principal = 0.5 * (normal + tangential) + np.hypot(0.5 * (normal - tangential), shear)
    return w, (a_image * scale[:, None], G_dense * (E * scale)[:, None], principal * E)


def _at_length(meta, values, a):
    """Smooth interpolation of G (n, n_a) to one crack length, through G/a."""
    return CubicSpline(meta.lengths, values / meta.lengths, axis=1)(a) * a


def _bounds(meta, curvature, modes, stress, settings, auto_control, which=slice(None)):
    """Mean opening (n, n_a), and the coefficients of G' = q0 + q1 w + q2 w^2 (3, n, n_a), for some lengths."""
    lengths = meta.lengths[which]
    upper, opening = (values[:, which] for values in meta.unbounded_release(curvature, stress))
    Psi = meta.stiffness_loss(curvature, which)
    held = control.displacement_controlled(Psi, modes, lengths)
    if not auto_control:
        return opening, np.stack([held, np.zeros_like(held), np.zeros_like(held)])
    if settings.relaxed == "unbounded":
        return opening, np.stack([held, upper - held, np.zeros_like(held)])
    released = control.force_controlled_modes(meta.stiffness(curvature), Psi, modes)
    return opening, control.mixed_release(Psi, modes, released, lengths)
