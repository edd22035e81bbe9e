"""Error against time of boundary integrals by their order, with body-fitted meshes and voxels beside them.

A plate with three holes and an edge crack (stress at the holes, and K), a ring under pressure, and a plate with
sixteen holes. Boundary integrals have 4 to 12 points on a panel, body-fitted local models three sizes of elements, each
with its refinement, and voxels, which know plates without cracks, 4e4 to 1e6 of them, by `failure_indices` with all
that it adds. The stress is the largest principal one at places on the holes; errors are the largest over its largest
value, against boundary integrals of 10 points on panels half as long. Times are CPU seconds with stresses, the least of
two, on one core.

Told. Writes validation/results/boundary_chart.csv and .png, five minutes; ``--quick`` the ring alone, no files.
"""

from __future__ import annotations

import os

# times are those of one core
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import time
from collections.abc import Callable
from typing import NamedTuple

import matplotlib
import numpy as np
from boundary_growth import plate as holed
from checks import RESULTS, Check, run, save, show
from matplotlib.ticker import NullFormatter

from slmm import Scene, failure_indices
from slmm.boundary import panels
from slmm.boundary.model import BoundaryModel
from slmm.fracture.loading import crack_tip_loading
from slmm.initiation.body_fitted import solve_body_fitted
from slmm.mechanics.stress import principal_stress

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ORDERS, TRUE = (4, 6, 8, 10, 12), 10
TURNS, VOXELS = (0.24, 0.12, 0.06), (40_000, 200_000, 1_000_000)
#: places on each hole
PLACES = 12
#: of a picture
COLOURS = {"boundary": "#D55E00", "body-fitted": "#009E73", "voxels": "#0072B2"}
Row = dict[str, float | int | str]


class Answer(NamedTuple):
    """K_I of the tip, empty without one, and the largest principal stress at the places, MPa."""

    K: np.ndarray
    stress: np.ndarray


def scenes() -> dict[str, Scene]:
    material, plate = {"name": "PMMA"}, {"width": 100.0, "height": 100.0}
    three = [((28, 44), 6.0), ((46, 30), 5.0), ((70, 60), 7.0)]
    many = [
        (
            outline.points(np.array([0.0, outline.length / 2])).mean(axis=0).tolist(),
            outline.length / (2 * np.pi),
        )
        for outline in holed(16, 0.2).outlines
    ]

    def circles(of: list[tuple[object, float]]) -> list[dict[str, object]]:
        return [{"shape": "circle", "center": list(centre), "radius": radius} for centre, radius in of]  # type: ignore[call-overload]

    ring = {
        "part": {"outline": {"shape": "circle", "center": [0.0, 0.0], "radius": 20.0}},
        "holes": circles([((0.0, 0.0), 10.0)]),
        "boundary": [{"on": "hole 0", "pressure": 5.0}],
    }
    cracked = {
        "plate": plate,
        "holes": circles([(centre, radius) for centre, radius in three]),
        "cracks": [{"points": [[0.0, 50.0], [15.0, 50.0]]}],
        "load": {"displacement": 0.1},
    }
    sixteen = {"plate": plate, "holes": circles([(c, r) for c, r in many]), "load": {"displacement": 0.1}}
    tables = {"ring under pressure": ring, "three holes and a crack": cracked, "sixteen holes": sixteen}
    return {name: Scene.from_dict(table | {"material": material}) for name, table in tables.items()}


def places(scene: Scene) -> np.ndarray:
    """Points (n, 2) on the holes."""
    share = (np.arange(PLACES) + 0.37) / PLACES
    return np.concatenate([hole.points(share * hole.length) for hole in scene.part.holes])


def by_boundary(scene: Scene, order: int) -> Answer:
    model = BoundaryModel(scene.part, scene.material, scene.loading, order, max(4, order - 2))
    return Answer(model.stress_intensities()[:, 0], principal_stress(model.stress(places(scene))))


def high_order(scene: Scene) -> Answer:
    """On panels half as long."""
    lengths = "PER_RADIUS", "PER_DISTANCE", "PER_SIDE"
    default = [getattr(panels, name) for name in lengths]
    for name, value in zip(lengths, default, strict=True):
        setattr(panels, name, value / 2)
    try:
        return by_boundary(scene, TRUE)
    finally:
        for name, value in zip(lengths, default, strict=True):
            setattr(panels, name, value)


def by_mesh(scene: Scene, turn: float) -> Answer:
    field = solve_body_fitted(scene, turn)
    K = crack_tip_loading(field.fine.results)["K_I"].values if scene.part.cracks else np.empty(0)
    return Answer(K, principal_stress(field.stress(places(scene))[0]))


def by_voxels(scene: Scene, voxels: int) -> Answer:
    analysis = {"points": places(scene).tolist(), "local_model": "voxels", "voxels": voxels}
    result = failure_indices(scene.with_(analysis=analysis), "rankine")
    return Answer(np.empty(0), result.failure_index.values * scene.material.sigma_c)


def measured(name: str, scene: Scene) -> list[Row]:
    """Errors and times of all configurations of a scene."""
    ways: list[tuple[str, float, Callable[[], Answer]]] = [
        ("boundary", order, lambda order=order: by_boundary(scene, order)) for order in ORDERS
    ]
    ways += [("body-fitted", turn, lambda turn=turn: by_mesh(scene, turn)) for turn in TURNS]
    if scene.plate is not None and not scene.part.cracks:
        ways += [("voxels", n, lambda n=n: by_voxels(scene, n)) for n in VOXELS]
    true = high_order(scene)
    rows: list[Row] = []
    for way, setting, answer in ways:
        taken = []
        for _ in range(2):
            begin = time.process_time()
            found = answer()
            taken.append(time.process_time() - begin)
        error = np.nanmax(np.abs(found.stress - true.stress)) / np.abs(true.stress).max()
        of_K = float(np.abs(found.K / true.K - 1).max()) if len(found.K) else float("nan")
        rows.append(
            {
                "scene": name,
                "way": way,
                "setting": setting,
                "seconds": min(taken),
                "stress_error": float(error),
                "K_error": of_K,
            }
        )
        print(rows[-1])
    return rows


def draw(rows: list[Row]) -> None:
    """Draw results/boundary_chart.png."""
    names = list(dict.fromkeys(str(row["scene"]) for row in rows))
    figure, axes = plt.subplots(
        1, len(names), figsize=(4.5 * len(names), 4.2), layout="constrained", sharey=True
    )
    for axis, name in zip(axes, names, strict=True):
        for way, colour in COLOURS.items():
            of = [row for row in rows if row["scene"] == name and row["way"] == way]
            for key, style in (("stress_error", "o-"), ("K_error", "s--")):
                line = [(row["seconds"], row[key]) for row in of if np.isfinite(float(row[key]))]
                label = f"{way}, {'stress' if key == 'stress_error' else '$K_I$'}"
                if line:
                    axis.plot(*zip(*line, strict=True), style, color=colour, label=label, ms=5)
        axis.set(xscale="log", yscale="log", title=name, xlabel="CPU time, s")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.legend(fontsize=8)
    axes[0].set_ylabel("largest error over the largest value")
    figure.savefig(RESULTS / "boundary_chart.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    """Measure all; see the module."""
    chosen = {name: scene for name, scene in scenes().items() if not quick or "ring" in name}
    rows = [row for name, scene in chosen.items() for row in measured(name, scene)]
    default = [row for row in rows if row["way"] == "boundary" and row["setting"] == 8]
    checks = [
        Check(str(row["scene"]), f"{key}, 8 points a panel", float("nan"), float(row[key]), rule="told")
        for row in default
        for key in ("seconds", "stress_error", "K_error")
    ]
    show("Error against time of boundary integrals", checks)
    if not quick:
        save("boundary_chart", rows)
        draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
