"""Failure indices along the notches of a scene: the library's main entry."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from slmm import __version__
from slmm.initiation.cells import CURVE_POINTS, cell_curves, select_modes
from slmm.initiation.criterion import GOVERNED_BY, NONE, critical_load, stress_over_crack
from slmm.initiation.local_model import LocalModel, solve_local_model
from slmm.initiation.meta_model import MetaModel, load_meta_model, shipped_database
from slmm.initiation.placement import STOPPED
from slmm.initiation.positions import Positions, find_positions
from slmm.initiation.settings import DEFAULT, PUBLISHED, Settings
from slmm.scene import Scene

METHODS = ("slmm", "slmm+ac", "full-fea")
SETTINGS = {"default": DEFAULT, "published": PUBLISHED}

#: voxels = "auto": voxels over the smallest radius of curvature, and the limits of their total number
VOXELS_PER_RADIUS = 20
FEWEST_VOXELS, MOST_VOXELS = 250**2, 2000**2

Progress = Callable[[float, str], None]


@dataclass
class _Answer:
    """Arrays over the positions, filled hole by hole."""

    load_factor: np.ndarray
    crack_length: np.ndarray
    governed_by: np.ndarray
    status: np.ndarray
    curvature: np.ndarray
    height: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    misfit: np.ndarray
    a: np.ndarray
    G_inc: np.ndarray
    sigma_I: np.ndarray

    @classmethod
    def empty(cls, n: int) -> _Answer:
        nan = [np.full(n, np.nan) for _ in range(7)]
        curves = [np.full((n, CURVE_POINTS), np.nan) for _ in range(3)]
        return cls(nan[0], nan[1], np.full(n, NONE), np.full(n, "", dtype=object), *nan[2:], *curves)


def failure_indices(
    scene: Scene,
    method: str | None = None,
    positions: int | None = None,
    curves: bool = False,
    settings: str | Settings | None = None,
    database: Path | str | None = None,
    average: bool = False,
    progress: Progress = lambda fraction, text: None,
) -> xr.Dataset:
    """Failure index at positions along every notch of a scene, by the coupled criterion.

    Parameters
    ----------
    scene : Scene
        Plate, notches, material, load.
    method : {"slmm", "slmm+ac", "full-fea"}, optional
        Cells with held boundary, with auto-controlled boundary, or a body-fitted model for every position (needs
        the extra ``fea``). By default what the scene asks for.
    positions : int, optional
        Positions on each hole, equally spaced; by default what the scene asks for.
    curves : bool
        Also give G_inc and sigma_I along the crack paths.
    settings : {"default", "published"} or Settings, optional
        How cells are chosen, fitted and relaxed; "published" is Paper A's way. By default what the scene asks for.
    database : path, optional
        Crack-cell database in place of the shipped one.
    average : bool
        Compare the mean stress over the crack with the strength (thesis Eq. 3.21).
    progress : callable
        Called with the finished fraction and what is being done.

    Returns
    -------
    xarray.Dataset
        Dimension ``position`` (and ``crack`` with curves). ``failure_index`` is NaN where ``status`` is not "ok"
        and says why; it is 0 where the path carries no tension.

    Raises
    ------
    ValueError
        When the method or the settings are unknown, or the scene has no hole.
    DatabaseError
        When the database cannot be used.

    Examples
    --------
    >>> from slmm.gallery import circular_hole
    >>> result = failure_indices(circular_hole(analysis={"points": [[70, 50]], "voxels": 40000}), "slmm+ac")
    >>> round(float(result.failure_index[0]), 1)
    9.3
    """
    method = scene.analysis.method if method is None else method
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: available are {', '.join(METHODS)}")
    settings = scene.analysis.settings if settings is None else settings
    if isinstance(settings, str):
        if settings not in SETTINGS:
            raise ValueError(f"settings = {settings!r}: available are {', '.join(SETTINGS)}")
        settings = SETTINGS[settings]
    where = find_positions(scene, positions)
    provenance: dict[str, object] = {"method": method}
    if method == "full-fea":
        answer = _by_full_fea(scene, where, average, progress)
    else:
        path = Path(database) if database is not None else shipped_database()
        _, nu = scene.material.plane_stress_equivalent
        meta = select_modes(load_meta_model(nu, path), settings.modes)
        voxels = _voxels(scene, where)
        progress(0.0, f"local model, {voxels} voxels")
        void = settings.void_stiffness or scene.analysis.void_stiffness
        local = solve_local_model(scene.with_(analysis={"void_stiffness": void}), voxels)
        progress(0.6, f"{len(where.s)} positions")
        answer = _by_cells(scene, where, local, meta, settings, method == "slmm+ac", average)
        provenance |= {
            "settings": json.dumps(settings.describe()),
            "database": path.name,
            "database_checksum": meta.checksum,
            "voxels": local.nx * local.ny,
            "voxel_size": f"{local.hx:.6g} x {local.hy:.6g} mm",
            "solver_iterations": local.iterations,
        }
    progress(1.0, "done")
    return _dataset(scene, where, answer, curves, provenance)


def _voxels(scene: Scene, where: Positions) -> int:
    """Number of voxels that the sharpest notch needs."""
    if scene.analysis.voxels != "auto":
        return int(scene.analysis.voxels)
    sharpest = max(
        float(np.max(-outline.curvatures(where.s[where.hole == k]), initial=0.0))
        for k, outline in enumerate(scene.outlines)
    )
    area = scene.plate.width * scene.plate.height
    wanted = area * (VOXELS_PER_RADIUS * sharpest) ** 2
    return int(np.clip(wanted, FEWEST_VOXELS, MOST_VOXELS))


def _by_cells(
    scene: Scene,
    where: Positions,
    local: LocalModel,
    meta: MetaModel,
    settings: Settings,
    auto_control: bool,
    average: bool,
) -> _Answer:
    answer = _Answer.empty(len(where.s))
    material = scene.material
    for k, outline in enumerate(scene.outlines):
        left = np.flatnonzero(where.hole == k)
        # a wide cell is only asked where the fine one has no answer
        for rule in dict.fromkeys((settings.fine, settings.wide)):
            if len(left) == 0:
                break
            cells = cell_curves(scene, outline, where.s[left], local, meta, settings, rule, auto_control)
            _judge(answer, left, cells, material.G_c, material.sigma_c, average)
            left = left[answer.status[left] != "ok"]
    return answer


def _judge(answer, index, cells, G_c, sigma_c, average):
    """Apply the criterion to the curves of some positions and store everything."""
    strength = stress_over_crack(cells.a, cells.sigma_I, average)
    for row, i in enumerate(index):
        if not np.isfinite(cells.height[row]):
            if answer.status[i] == "":
                answer.status[i] = f"no cell: {STOPPED[cells.stopped[row]]}"
            continue
        lf, length, code = critical_load(cells.a[row], cells.G_inc[row], strength[row], G_c, sigma_c)
        answer.load_factor[i], answer.crack_length[i], answer.governed_by[i] = lf, length, code
        answer.status[i] = "crack longer than the cell" if np.isnan(lf) else "ok"
        answer.curvature[i], answer.height[i] = cells.curvature[row], cells.height[row]
        answer.weight[i], answer.support[i] = cells.weight[row], cells.support[row]
        answer.misfit[i] = cells.misfit[row]
        answer.a[i], answer.G_inc[i], answer.sigma_I[i] = cells.a[row], cells.G_inc[row], cells.sigma_I[row]


#: longest trial crack of the full FEA in Irwin's lengths: at a straight edge a_c is 0.51 of them
LONGEST_IN_IRWIN_LENGTHS = 0.7
#: and as a share of the ligament
LONGEST_IN_LIGAMENT = 0.8


def _by_full_fea(scene: Scene, where: Positions, average: bool, progress: Progress) -> _Answer:
    from slmm.initiation.full_fea import full_fea_curves  # imports the finite element libraries

    answer = _Answer.empty(len(where.s))
    material = scene.material
    for i, (hole, s) in enumerate(zip(where.hole, where.s, strict=True)):
        progress(i / len(where.s), f"full FEA, position {i + 1} of {len(where.s)}")
        outline = scene.outlines[hole]
        answer.curvature[i] = 0.5 * outline.curvatures(s)
        ligament = ligament_length(scene, where.points[i], outline.normals(s))
        a_max = min(LONGEST_IN_IRWIN_LENGTHS * material.irwin_length, LONGEST_IN_LIGAMENT * ligament)
        try:
            model = full_fea_curves(scene, int(hole), float(s), a_max)
        except (ValueError, RuntimeError) as error:
            answer.status[i] = f"no mesh: {error}"
            continue
        fine = np.linspace(0.0, 1.0, CURVE_POINTS) ** 2 * a_max
        answer.a[i] = fine
        answer.G_inc[i] = np.interp(fine, model.a, model.G_inc / model.a) * fine
        answer.sigma_I[i] = np.interp(fine, model.eta, model.sigma_I)
        strength = stress_over_crack(fine, answer.sigma_I[i], average)
        lf, length, code = critical_load(fine, answer.G_inc[i], strength, material.G_c, material.sigma_c)
        answer.load_factor[i], answer.crack_length[i], answer.governed_by[i] = lf, length, code
        answer.status[i] = "crack longer than the path" if np.isnan(lf) else "ok"
    return answer


def ligament_length(scene: Scene, point: np.ndarray, direction: np.ndarray) -> float:
    """Distance from a notch point along a direction to the next surface, mm."""
    import shapely

    plate = shapely.box(0, 0, scene.plate.width, scene.plate.height)
    holes = shapely.union_all([shapely.Polygon(outline.polygon(2000)) for outline in scene.outlines])
    reach = scene.plate.width + scene.plate.height
    start = point + 1e-4 * reach * direction
    ray = shapely.LineString([start, point + reach * direction])
    inside = ray.intersection(plate.difference(holes))
    pieces = getattr(inside, "geoms", [inside])
    first = min(pieces, key=lambda piece: piece.distance(shapely.Point(start)))
    return float(first.length)


def _irwin_length_limit(scene: Scene, answer: _Answer) -> np.ndarray:
    """G_inc E/sigma_I^2 at the longest crack, mm: the applicability factor times the notch radius (Eq. 33).

    A material with a longer Irwin's length starts a crack longer than the curves.
    """
    E = scene.material.plane_stress_equivalent[0]
    stress = answer.sigma_I[:, -1]
    limit = np.full(len(stress), np.nan)
    tension = stress > 0
    limit[tension] = answer.G_inc[tension, -1] * E / stress[tension] ** 2
    return limit


_UNITS = {
    "x": ("mm", "x coordinate of the notch point"),
    "y": ("mm", "y coordinate of the notch point"),
    "arc_length": ("mm", "arc length along the outline"),
    "hole": ("1", "index of the outline"),
    "curvature": ("1/mm", "curvature c of the parabola eta = c xi^2"),
    "failure_index": ("1", "failure index FI = 1/load_factor"),
    "load_factor": ("1", "factor on the load at which a crack starts"),
    "crack_length": ("mm", "length with which the crack starts"),
    "governed_by": ("1", "condition that decides the load"),
    "status": ("1", "ok, or why there is no value"),
    "cell_height": ("mm", "height of the crack cell"),
    "control_weight": ("1", "weight of the relaxed boundary"),
    "edge_support": ("1", "share of the held cell's stiffness that the plate's edges give"),
    "misfit": ("1", "part of the boundary displacement that the modes leave"),
    "irwin_length_limit": ("mm", "Irwin's length up to which the curves reach far enough"),
    "a": ("mm", "crack length, and distance from the notch"),
    "G_inc": ("N/mm", "incremental energy release rate"),
    "sigma_I": ("MPa", "maximum principal stress without a crack"),
}


def _dataset(scene: Scene, where: Positions, answer: _Answer, curves: bool, provenance: dict) -> xr.Dataset:
    with np.errstate(divide="ignore"):
        failure_index = 1 / answer.load_factor
    values = {
        "x": where.points[:, 0],
        "y": where.points[:, 1],
        "arc_length": where.s,
        "hole": where.hole,
        "curvature": answer.curvature,
        "failure_index": failure_index,
        "load_factor": answer.load_factor,
        "crack_length": answer.crack_length,
        "governed_by": np.array([GOVERNED_BY[code] for code in answer.governed_by]),
        "status": answer.status.astype(str),
        "cell_height": answer.height,
        "control_weight": answer.weight,
        "edge_support": answer.support,
        "misfit": answer.misfit,
        "irwin_length_limit": _irwin_length_limit(scene, answer),
    }
    data: dict[str, tuple] = {name: ("position", array) for name, array in values.items()}
    if curves:
        data |= {name: (("position", "crack"), getattr(answer, name)) for name in ("a", "G_inc", "sigma_I")}
    dataset = xr.Dataset(data)
    for name in dataset.data_vars:
        dataset[name].attrs = dict(zip(("units", "long_name"), _UNITS[str(name)], strict=True))
    dataset.attrs = {"title": scene.title, "version": __version__} | provenance
    return dataset
