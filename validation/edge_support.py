"""How the plate's edges change the energy released: the factors of slmm.initiation.support against full FEA.

For holes of several sizes and places under the three kinds of load, the share rho of the held cell's stiffness that
would make G_inc right at a quarter of the notch radius is set against the estimate from the distances of the edges.
The factors in the package were fitted to cases marked "fit" (fit_support.py); the others test them. Writes
validation/results/edge_support.csv and .png; two minutes, ``--quick`` a few cases and no files.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm import Scene, failure_indices
from slmm.initiation.full_fea import full_fea_curves
from slmm.initiation.settings import DEFAULT
from slmm.initiation.support import supported
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LOADS: dict[str, dict[str, Any]] = {
    "strain": {"strain": [0.0, 0.1, 0.0]},
    "displacement": {"displacement": 10.0},
    "stress": {"stress": 100.0},
}
#: part of the notch radius at which G_inc is compared
PART = 0.25
REQUIRED = 0.05


def circle(x: float, y: float, radius: float) -> Scene:
    """Circular hole anywhere in the plate of 100 mm x 100 mm."""
    return gallery.circular_hole(holes=[{"shape": "circle", "center": [x, y], "radius": radius}])


#: name: scene, a point at the notch, loads, whether the factors were fitted to it
CASES: dict[str, tuple[Scene, tuple[float, float], tuple[str, ...], bool]] = {
    "r = 20": (circle(50, 50, 20), (70, 50), tuple(LOADS), True),
    "r = 30": (circle(50, 50, 30), (80, 50), tuple(LOADS), True),
    "r = 15, near the right edge": (circle(70, 50, 15), (85, 50), tuple(LOADS), False),
    "r = 15, near the left": (circle(70, 50, 15), (55, 50), ("strain",), False),
    "r = 15, near the top": (circle(50, 72, 15), (65, 72), tuple(LOADS), False),
    "r = 8": (circle(50, 50, 8), (58, 50), tuple(LOADS), False),
    "2:1 ellipse": (gallery.elliptic_hole(), (70, 50), tuple(LOADS), False),
    "2:1 ellipse along the load": (
        gallery.elliptic_hole(load={"strain": [0.1, 0.0, 0.0]}),
        (50, 60),
        ("as it is",),
        False,
    ),
}


def compare(scene: Scene, point: tuple[float, float]) -> dict[str, float]:
    """Errors of G_inc with and without the edges, and rho as estimated and as needed."""
    scene = scene.with_(analysis={"points": [point]})
    outline = scene.outlines[0]
    s = float(outline.project(np.array([point]))[0])
    radius = abs(1 / float(outline.curvatures(s)))
    a = PART * radius
    reference = full_fea_curves(scene, 0, s, 1.2 * a, n_lengths=12, a_min=0.1 * a)
    true = float(np.interp(a, reference.a, reference.G_inc / reference.a)) * a

    # the stress releases the energy: with wide cells the comparison would mix in their errors
    settings = replace(DEFAULT, wide=DEFAULT.fine)
    mixed, of_held = (
        failure_indices(scene, method, settings=settings, curves=True).isel(position=0)
        for method in ("slmm+ac", "slmm")
    )
    ours, held = (float(np.interp(a, result.a, result.G_inc)) for result in (mixed, of_held))
    rho = float(mixed.edge_support)
    # 1/G = (1 - rho)/G_u + rho/G_h, so without the edges
    unbounded = (1 - rho) / (1 / ours - rho / held)
    needed = (1 / true - 1 / unbounded) / (1 / held - 1 / unbounded)
    assert np.isclose(supported(np.array([[unbounded]]), np.array([[held]]), np.array([rho])), ours)
    return {
        "without edges": unbounded / true - 1,
        "with edges": ours / true - 1,
        "rho": rho,
        "rho needed": needed,
        "cell height": float(mixed.cell_height),
        "cell curvature": float(mixed.curvature),
    }


def main(quick: bool) -> list[Check]:
    """Compare all cases, print and write."""
    rows, checks = [], []
    for name, (scene, point, loads, fitted) in CASES.items():
        if quick and name not in ("r = 20", "2:1 ellipse along the load"):
            continue
        for load in loads:
            loaded = scene.with_(load=LOADS[load]) if load in LOADS else scene
            row = compare(loaded, point)
            rows.append({"case": name, "load": load, "fit": fitted} | row)
            # the hole of r = 30 leaves a ligament shorter than its radius; under stress it bends
            rule = "told" if (name, load) == ("r = 30", "stress") else "at most"
            quantity = f"{load}: error of G_inc at r/4, with edges"
            checks.append(Check(name, quantity, REQUIRED, abs(row["with edges"]), rule=rule))
            checks.append(Check(name, f"{load}: without", REQUIRED, abs(row["without edges"]), rule="told"))
    show("Support of the plate's edges", checks)
    if not quick:
        save("edge_support", rows)
        draw(rows)
    return checks


def draw(rows: list[dict[str, Any]]) -> None:
    """Needed against estimated share, by load."""
    figure, axes = plt.subplots(figsize=(5.5, 5), layout="constrained")
    for load, marker in zip((*LOADS, "as it is"), "osD^", strict=True):
        chosen = [row for row in rows if row["load"] == load]
        axes.plot([r["rho"] for r in chosen], [r["rho needed"] for r in chosen], marker, label=load)
    axes.axline((0, 0), slope=1, color="0.6", lw=1)
    axes.set(xlabel="rho from the distances of the edges", ylabel="rho that full FEA needs")
    axes.legend(title="load")
    figure.savefig(RESULTS / "edge_support.png", dpi=120)


if __name__ == "__main__":
    run(main, __doc__)
