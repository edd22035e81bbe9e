"""Full FEA of a notched plate: energy release and stress along a straight crack path (Paper A, 2.2.1).

The thesis solves one model for every crack length and subtracts potential energies. Here the path is one
slit whose faces are held together; what releases energy is letting them go, from the mouth inwards. All crack
lengths follow from one factorisation (slmm.mechanics.crack_line) and no two large numbers are subtracted. A path may go
through the ligament to the next surface; its longest crack then severs the ligament.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import SlitModel
from slmm.fem.supports import at_supports
from slmm.initiation.contact import until_closed
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.stress import principal_stress
from slmm.part.part import Part

#: from one path element to the next at most; also the mesher follows steps up to 1.5 alone; chosen
STEP_GROWTH = 1.25
#: a crack that releases less per length than this share of the most closes: the change relative to that has no
#: meaning; chosen
CLOSING = 0.01
#: a mesh and its uniform refinements; chosen
LEVELS = 3
#: released energy per area that stands for an infinite one, over that of the longest crack before; chosen
PLENTY = 1e6


@dataclass(frozen=True)
class FullFEA:
    """Curves along a trial crack path.

    Parameters
    ----------
    a : ndarray, shape (n,)
        Crack lengths, mm; of a path through the ligament the last one severs it.
    G_inc : ndarray, shape (n,)
        Incremental energy release rate, released energy per crack area, N/mm.
    G_inc_error : ndarray, shape (n,)
        Estimate of its error, N/mm: a quarter of what the last refinement changed in the extrapolated value, or, of two
        meshes, in the value itself.
    eta : ndarray, shape (m,)
        Depth along the path, mm.
    sigma : ndarray, shape (m, 3)
        Stress xx, yy, xy of the uncracked body in the axes of the plate, MPa.
    sigma_I : ndarray, shape (m,)
        Its maximum principal value, MPa.
    sigma_I_error : ndarray, shape (m,)
        Estimate of its error, MPa: by how much it differs from that of the last mesh, or, of two meshes, of the first.
    start, direction : ndarray, shape (2,)
        The crack's mouth, mm, and the unit vector along the path.
    severs : bool
        Whether the longest crack goes through the ligament.
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
    severs: bool = False


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
    singular: bool = False,
    end: np.ndarray | None = None,
    levels: int = LEVELS,
) -> FullFEA:
    """Released energy and stress along a straight crack path by full FEA, extrapolated from three meshes or two.

    Parameters
    ----------
    scene : Scene
        With ``part``, ``material`` and ``loading``.
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
        Depths where the stress is wanted, mm; by default 0 (unless ``singular``) and the crack lengths.
    start, direction : sequence of 2 floats, optional
        In place of a notch: any boundary point or crack tip, mm, and the direction of the path from it.
    size_max, angle_max : float, optional
        Largest element (mm, by default an eighth of the plate's shorter side) and largest turn (rad) of an
        outline along one, in the coarsest of the meshes.
    singular : bool
        The path starts at a corner or a crack tip, where the stress is infinite.
    end : ndarray, shape (2,), optional
        Point of a surface or crack where the path leaves the material, mm; in place of ``a_max``. The lengths are then
        dense towards both ends, (2 n_lengths - 1,) with tips and the severed ligament as the last one.
    levels : int
        Number of meshes, 2 or 3.

    Returns
    -------
    FullFEA

    Raises
    ------
    ValueError
        When the path leaves the material, or a number is out of its range.
    RuntimeError
        When the mesher fails.
    ImportError
        Without netgen.

    Notes
    -----
    Elements along the path grow with the depth, so each crack length sees about the same relative tip
    element. A crack that would grow into compression stays closed there. The energy's error comes from the tip
    and is linear in the element there; the error of the recovered stress is cubic. Both are extrapolated from a
    mesh and its uniform refinements.
    """
    origin, along = _path_start(scene, outline_index, s, start, direction)
    if end is not None:
        a_max = float(np.linalg.norm(end - origin))
        along = (end - origin) / a_max
    if a_max is None or not a_max > 0:
        raise ValueError(f"a_max = {a_max!r} mm: must be a positive crack length")
    a_min = a_max / 120 if a_min is None else a_min
    if not 0 < a_min < a_max:
        raise ValueError(f"a_min = {a_min!r} mm: must lie between 0 and a_max = {a_max!r} mm")
    if n_lengths < 2:
        raise ValueError(f"n_lengths = {n_lengths!r}: at least 2")
    a = np.geomspace(a_min, a_max if end is None else a_max / 2, n_lengths)
    depth = path_depths(a)
    if end is not None:
        a = np.concatenate([a, a_max - a[-2::-1], [a_max]])
        depth = np.append(depth, a_max - depth[-2::-1])
    if eta is None:
        eta = a if singular else np.concatenate([[0.0], a])
    eta = np.asarray(eta, dtype=float)
    part: Part = scene.part
    if size_max is None:
        size_max = float(np.ptp(part.outer, axis=0).min()) / 8
    path = origin + depth[:, None] * along
    policy = SizePolicy(size_max, angle_max)
    mesh = plate_mesh(part, path, policy, at_supports(part, scene.loading, policy), scene.loading.ends)
    # where the tips are among the vertices of the path; a severed ligament has none
    tips = a if end is None else a[:-1]
    last_nodes = cKDTree(mesh.vertices[mesh.path]).query(origin + tips[:, None] * along)[1]
    released, stress = [], []
    opening = np.ones(len(a))
    for level in range(levels):
        model = SlitModel(mesh, scene.material, scene.loading, part.thickness)
        energy = model.released_energy()[last_nodes * 2**level]
        if end is not None:
            energy = np.append(energy, min(model.severed_energy(), PLENTY * energy[-1]))
        released.append(energy / a)
        at_tips = slice(len(last_nodes))
        opening[at_tips] = np.minimum(opening[at_tips], model.tip_opening()[last_nodes * 2**level])
        stress.append(model.stress(origin + eta[:, None] * along))
        if np.any(np.isnan(stress[-1])):
            deep = eta[np.isnan(stress[-1]).any(axis=1)][0]
            raise ValueError(f"eta = {deep!r} mm: the path has left the material there")
        mesh = mesh.refined() if level < levels - 1 else mesh
    # the tip's linear error cancels; what remains falls more than eightfold with every refinement
    G_inc, _ = extrapolated(released[-2], released[-1], order=1)
    before = released[-1]
    if levels == LEVELS:
        before, _ = extrapolated(released[-3], released[-2], order=1)
    before, G_inc = (until_closed(a * G, opening) / a for G in (before, G_inc))
    # at a single length the change may vanish by chance: the largest along the path counts for all, but where the crack
    # all but closes
    change = np.abs(G_inc - before)
    opens = G_inc / a > CLOSING * np.max(G_inc / a)
    G_inc_error = np.maximum(np.max(change[opens] / G_inc[opens], initial=0.0) * G_inc, change) / 4
    sigma, _ = extrapolated(stress[-2], stress[-1], order=3)
    sigma_I = principal_stress(sigma)
    sigma_I_before = principal_stress(stress[-1] if levels == LEVELS else stress[0])
    return FullFEA(
        a=a,
        G_inc=G_inc,
        G_inc_error=G_inc_error,
        eta=eta,
        sigma=sigma,
        sigma_I=sigma_I,
        sigma_I_error=np.abs(sigma_I - sigma_I_before),
        start=origin,
        direction=along,
        severs=end is not None,
    )


def path_depths(a: np.ndarray) -> np.ndarray:
    """Depths of the nodes on a path whose tip visits the lengths a (n,), evenly spaced in log(a).

    The last step to a length is at most STEP_GROWTH - 1 of it: between the lengths more nodes are put where
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
    return max(1, int(np.ceil(np.log(a[1] / a[0]) / np.log(STEP_GROWTH) - 1e-9)))


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
    outlines = scene.part.outlines
    if not 0 <= outline_index < len(outlines):
        raise ValueError(f"outline_index = {outline_index!r}: the scene has {len(outlines)} outlines")
    outline = outlines[outline_index]
    at = np.array([s % outline.length])
    return outline.points(at)[0], outline.normals(at)[0]
