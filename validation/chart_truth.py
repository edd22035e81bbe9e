"""The scenes of the chart, and the truth at their positions by full FEA."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from checks import at_spread_positions
from estimates import with_irwin_length

from slmm import Scene, failure_indices, read_scene
from slmm.criteria.coupled_curves import criticals
from slmm.criteria.path_curves import PathCurves
from slmm.initiation.by_full_fea import sampled
from slmm.initiation.full_fea import FullFEA, full_fea_curves
from slmm.initiation.paths import IN_LIGAMENT, trial_paths
from slmm.initiation.positions import find_positions
from slmm.scene import gallery

#: on each hole
POSITIONS = 20
#: Irwin's length over the radius of the notch
SHARES = (0.02, 0.2, 1.0)
MIDDLE = 0.2
#: positions beside the most critical one at which the truth is found
OTHERS = 4
EXAMPLE = Path(__file__).parents[1] / "examples" / "notch.toml"


def _hole_near_edge() -> Scene:
    hole = {"shape": "circle", "center": [30.0, 50.0], "radius": 20.0}
    return gallery.circular_hole(holes=[hole], load={"displacement": 1.0})


SCENES: dict[str, Callable[[], Scene]] = {
    "hole, strain": gallery.circular_hole,
    "hole, stress": partial(gallery.circular_hole, load={"stress": 10.0}),
    "hole, shear": partial(gallery.circular_hole, load={"strain": [0.0, 0.0, 0.1]}),
    "hole near the edge": _hole_near_edge,
    "small hole": partial(gallery.sapora_plate, 0.5),
    "two holes": partial(gallery.two_holes, 4.0),
    "ellipse, tip": gallery.elliptic_hole,
    "ellipse, flat side": partial(gallery.elliptic_hole, load={"strain": [0.1, 0.0, 0.0]}),
    "rounded square": gallery.rounded_square,
    "rounded square, nu 0.47": partial(
        gallery.rounded_square,
        material={"E": 2960.0, "nu": 0.47, "sigma_c": 70.5, "G_c": 1.3, "state": "plane strain"},
    ),
    "lobed notch, e_yy": partial(gallery.lobed_notch, (0.0, 0.1, 0.0)),
    "lobed notch, g_xy": partial(gallery.lobed_notch, (0.0, 0.0, 0.1)),
    "U-notch": partial(gallery.v_notch, 0.0, 2.0),
    "blunted V-notch": partial(gallery.v_notch, 60.0, 0.5),
    "notch from a picture": partial(read_scene, EXAMPLE),
    "sharp V-notch": partial(gallery.v_notch, 60.0),
    "square hole": gallery.square_hole,
    "edge crack": gallery.edge_crack,
}
SINGULAR = ("sharp V-notch", "square hole", "edge crack")


@dataclass(frozen=True)
class Case:
    """A scene with its materials, and the positions at which the truth is known."""

    name: str
    scenes: tuple[Scene, ...]  # one for each material
    points: np.ndarray  # (n, 2), mm
    index: np.ndarray  # true failure index (materials, n)
    own_error: np.ndarray  # of the truth, relative (n,)
    curves: tuple[PathCurves, ...]  # at the points

    def critical(self, material: int) -> int:
        """The most critical of the points."""
        return int(np.nanargmax(self.index[material]))


def radius_at_critical(scene: Scene) -> float:
    """Radius of the notch where the stress is highest, mm; 1 mm where that is a corner or a crack tip."""
    where = find_positions(scene, POSITIONS)
    if np.isfinite(where.corner).any():
        return 1.0
    stress = failure_indices(
        scene.with_(analysis={"local_model": "body-fitted"}), "rankine", positions=POSITIONS
    )
    i = int(np.nanargmax(stress.failure_index.values))
    outline = scene.outlines[int(stress.hole[i])]
    local = 1 / abs(float(outline.curvatures(float(stress.arc_length[i]))))
    return min(local, outline.length / (2 * np.pi))


def prepare(name: str) -> Case:
    """Choose positions by `auto` and find the truth there."""
    scene = SCENES[name]()
    radius = radius_at_critical(scene)
    scenes = tuple(with_irwin_length(scene, share * radius) for share in SHARES)
    wanted: list[int] = []
    for share, one in zip(SHARES, scenes, strict=True):
        result = failure_indices(at_spread_positions(one, POSITIONS), "auto", tolerance=0.05)
        FI = result.failure_index.values
        order = np.argsort(-np.nan_to_num(FI))
        wanted.append(int(order[0]))
        if share == MIDDLE and name not in SINGULAR:
            others = order[1:][FI[order[1:]] > 0.5 * np.nanmax(FI)]
            wanted += others[:: max(1, len(others) // OTHERS)][:OTHERS].tolist()
    where = find_positions(scene, POSITIONS)
    chosen = np.unique(wanted)
    points = where.points[chosen]
    paths = trial_paths(scene, where)
    found, errors = [], []
    for i in chosen:
        longest = min(0.8 * radius, IN_LIGAMENT * float(paths.ligament[i]))
        model = full_fea_curves(
            scene,
            a_max=longest,
            a_min=0.004 * radius,
            n_lengths=48,
            start=paths.start[i],
            direction=paths.direction[i],
            singular=bool(np.isfinite(where.corner[i])),
            angle_max=0.12,
        )
        found.append(sampled(model, float(where.corner[i])))
        errors.append(own_error(model))
    index = np.array(
        [[1 / criticals(curves, one.material, False).load_factor[0] for curves in found] for one in scenes]
    )
    return Case(name, scenes, points, index, np.array(errors), tuple(found))


def own_error(model: FullFEA) -> float:
    stress = model.sigma_I_error[1:] / np.maximum(np.abs(model.sigma_I[1:]), 1e-300)
    return float(max(np.max(model.G_inc_error / model.G_inc), np.median(stress)))
