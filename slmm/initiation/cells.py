"""Curves along the crack paths of many positions from the meta-model: SLMM and SLMM+AC (Paper A, 2.3 and 2.4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slmm.criteria.path_curves import CURVE_POINTS, PathCurves
from slmm.initiation import control
from slmm.initiation.cell_errors import energy_error, faded, reference_stress, relative_change, stress_error
from slmm.initiation.contact import tip_opening, until_closed
from slmm.initiation.meta_model import MetaModel, polynomial_matrix
from slmm.initiation.placement import CELL_HEIGHT, Constraints, boundary_points, fit_cells, grow_cells
from slmm.initiation.settings import IMPORTANT_MODES, Settings
from slmm.initiation.support import edge_support, supported
from slmm.initiation.uncracked import UncrackedField
from slmm.mechanics.cubics import through
from slmm.mechanics.stress import principal
from slmm.part.outline import Outline
from slmm.scene.scene import Scene

#: sum of the principal stresses below which, as a share of the reference stress, what is always there of errors cannot
#: make a tension of it: sixteen times that (chosen)
COMPRESSED = 0.05


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
    local: UncrackedField,
    meta: MetaModel,
    settings: Settings,
    rule: Constraints,
) -> Placed:
    """Place the largest valid cell and one of half its size at each position, and fit their boundaries.

    Parameters
    ----------
    scene : Scene
        Its size is used.
    outline : Outline
        The notch.
    s : ndarray (n,)
        Arc lengths of the positions, mm.
    local : UncrackedField
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
    largest = settings.height or 2 * scene.size
    first = settings.cell_voxels * local.resolution(outline.points(s))
    if settings.height:
        first = np.full(len(s), settings.height)
    c_min, c_max = float(meta.curvature[0]), float(meta.curvature[-1])
    solid, hx, hy, origin = local.raster
    breaks, coefficients = spline[0], spline[1].copy()
    coefficients[3] -= origin
    height, _, stopped = grow_cells(
        breaks, coefficients, s, first, largest, rule, c_min, c_max, solid, hx, hy
    )
    rows = np.flatnonzero(np.isfinite(height))
    s, height = s[rows], height[rows]

    along_xi = meta.powers[:, 0] == 0
    powers_xi, powers_eta = (np.ascontiguousarray(meta.powers[which, 1:]) for which in (along_xi, ~along_xi))

    def fitted(h, field):
        curvature, points = boundary_points(*spline, s, h, rule)
        u = field.displacement(points.reshape(-1, 2)).reshape(points.shape)
        modes, misfit = fit_cells(*spline, s, h, curvature, powers_xi, powers_eta, u)
        return curvature, misfit, _Cell.scaled(meta, h, curvature, modes)

    curvature, misfit, large = fitted(height, local)
    small = fitted(0.5 * height, local)[2]
    rough = None if local.coarser is None else fitted(height, local.coarser)[2]
    return Placed(rows, s, height, curvature, misfit, large, small, rough, rule is settings.wide, stopped)


@dataclass(frozen=True)
class _Cell:
    """Cells in the image space."""

    scale: np.ndarray  # lambda_l (n,), Eq. 15
    curvature: np.ndarray  # c' (n,)
    modes: np.ndarray  # u'_RP (n, m)
    stress: np.ndarray  # path stress (n, 3, n_eta)

    def only(self, one):
        return _Cell(self.scale[one], self.curvature[one], self.modes[one], self.stress[one])

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
    rough : _Cell, optional
        The cell on a coarser local model.
    wide : bool
        Whether they are of the settings' wide rule.
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
    rough: _Cell | None
    wide: bool
    stopped: np.ndarray

    def only(self, i: int) -> Placed:
        """The i-th cell alone."""
        one = slice(i, i + 1)
        return replace(
            self,
            rows=self.rows[one],
            s=self.s[one],
            height=self.height[one],
            curvature=self.curvature[one],
            misfit=self.misfit[one],
            large=self.large.only(one),
            small=self.small.only(one),
            rough=None if self.rough is None else self.rough.only(one),
        )


def cell_stress(
    placed: Placed, meta: MetaModel, scene: Scene, depths: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Stress across the path, along it, and shear (n, 3, k) at depths (k,), and an error (n, k), MPa.

    NaN beyond half a cell's length. The error is an estimate of that of the principal stress or, where the surface is
    compressed, of the largest component, which the principal stress says nothing about.
    """
    E, reference = scene.material.plane_stress_equivalent[0], reference_stress(scene)
    stress = np.full((len(placed.rows), 3, len(depths)), np.nan)
    error = np.full((len(placed.rows), len(depths)), np.nan)
    for i, scale in enumerate(placed.large.scale):
        at = depths / scale
        reached = at <= meta.eta[-1] * (1 + 1e-9)
        one = placed.only(i)
        stress[i][:, reached] = E * one.large.stress[0] @ polynomial_matrix(meta.eta, at[reached]).T
        measure = _principal if stress[i, 0, 0] + stress[i, 1, 0] > 0 else _largest
        sigma = measure(stress[i : i + 1, :, reached])
        of_cell, of_model = _changes(meta, one, at[reached], measure)
        relative = stress_error(of_cell, of_model, faded(reference, sigma))
        error[i, reached] = (relative * np.abs(sigma))[0]
    return stress, error


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
        Of the positions with a cell; with errors where these are known, for the default settings and auto control.
    weight, support : ndarray (n,)
        Weight w of the auto control and support rho of the plate's edges.
    """
    rho = np.zeros(len(placed.rows))
    if auto_control and settings.relaxed == "unbounded":
        rho = edge_support(scene, outline, placed.s, placed.height, placed.curvature)
    E = scene.material.plane_stress_equivalent[0]
    reference = reference_stress(scene)
    weight, curves = _superpose(meta, E, placed, settings, auto_control, rho, reference)
    return curves, weight, rho


def _superpose(meta, E, placed, settings, auto_control, rho, reference):
    """Weights (n,) and the curves in the real space."""
    large, small = placed.large, placed.small
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
        G_dense = _per_length(meta, G, a_image) * a_image
    G_dense = np.maximum(G_dense, 0.0)
    if settings.contact:
        openings = _per_length(meta, tip_opening(opening), a_image)
        with np.errstate(invalid="ignore"):
            G_dense = np.nan_to_num(until_closed(G_dense * a_image, openings) / a_image)

    scale = large.scale[:, None]
    sigma = _principal(large.stress @ polynomial_matrix(meta.eta, a_image).T)
    G_error = sigma_error = np.full(G_dense.shape, np.nan)
    if auto_control and settings.relaxed == "unbounded":
        of_cell, of_model = _changes(meta, placed, a_image, _principal)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.nan_to_num(release[1] / held, posinf=np.inf)
        bracket = np.array([np.interp(a_image, meta.lengths, row) for row in ratio]).reshape(G_dense.shape)
        fade = faded(reference, sigma * E)
        normal, tangential, _ = (large.stress @ polynomial_matrix(meta.eta, a_image).T).swapaxes(0, 1)
        fade[(normal + tangential) * E < -COMPRESSED * reference] = 0.0
        sigma_error = stress_error(of_cell, of_model, fade)
        G_error = energy_error(of_cell, of_model, fade, bracket, rho, placed.wide)
    return w, PathCurves(a_image * scale, G_dense * (E * scale), sigma * E, G_error, sigma_error)


def _changes(meta, placed, a_image, measure):
    """Relative changes (n, k) of a measure of the stress with the size of the cell, and with the local model."""
    # the small cell reaches half as far; beyond, its last change stands
    reached = np.minimum(2 * a_image, meta.eta[-1])
    at_large = measure(placed.large.stress @ polynomial_matrix(meta.eta, 0.5 * reached).T)
    at_small = measure(placed.small.stress @ polynomial_matrix(meta.eta, reached).T)
    of_cell = relative_change(at_large, at_small)
    if placed.rough is None:
        return of_cell, np.zeros_like(of_cell)
    at_depths = polynomial_matrix(meta.eta, a_image).T
    rough = measure(placed.rough.stress @ at_depths)
    return of_cell, relative_change(measure(placed.large.stress @ at_depths), rough)


def _principal(sigma):
    """Maximum principal stress (n, k) of components xi-xi, eta-eta, xi-eta (n, 3, k)."""
    return principal(*sigma.swapaxes(0, 1))


def _largest(sigma):
    """Largest amount (n, k) of the components xi-xi, eta-eta, xi-eta (n, 3, k)."""
    return np.abs(sigma).max(axis=1)


def _at_length(meta, values, a):
    """Smooth interpolation of G (n, n_a) to one crack length, through G/a."""
    return _per_length(meta, values, a) * a


def _per_length(meta, values, a):
    """What is proportional to small lengths a, values (n, n_a), over these: at one length (n,) or at several (n, k)."""
    return np.ascontiguousarray(through(meta.lengths, (values / meta.lengths).T)(a).T)


def _bounds(meta, cell, settings, auto_control, which=slice(None)):
    """Work of the opening (n, n_a, k) and G' = q0 + q1 w + q2 w^2 as coefficients (3, n, n_a), for some lengths."""
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
