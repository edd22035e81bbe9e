"""Trial cracks by boundary integrals: energy at every length against full FEA, and the time of a position.

Ten parts, each at the position with the largest index: the energy that a crack sets free, at every length that full
FEA has solved, beside that of the finest of its three meshes; and failure indices by `auto` with all that it says of
itself. Required: 0.1 % of the energy beside what full FEA tells as its own error, 0.3 % of the index. CPU seconds of a
whole call on one core: 50 positions of a plate with two holes, less what the part costs without any (required: 0.3).

Writes validation/results/trial_cracks.csv; three minutes on one core, ``--quick`` two parts.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from checks import Check, run, save, show
from scipy.interpolate import PchipInterpolator

from slmm import failure_indices
from slmm.initiation.boundary_field import solve_boundary
from slmm.initiation.by_full_fea import SPAN
from slmm.scene import gallery
from slmm.scene.scene import Scene

PARTS: dict[str, Callable[[], Scene]] = {
    "circle": gallery.circular_hole,
    "small circle": lambda: gallery.sapora_plate(0.5),
    "ellipse": gallery.elliptic_hole,
    "rounded square": gallery.rounded_square,
    "two holes": gallery.two_holes,
    "two holes, 0.5 mm apart": lambda: gallery.two_holes(0.5),
    "lobes": gallery.lobed_notch,
    "lobes, shear": lambda: gallery.lobed_notch((0.0, 0.05, 0.1)),
    "V-notch": gallery.v_notch,
    "V-notch, root 0.5 mm": lambda: gallery.v_notch(60.0, 0.5),
}
#: positions whose time is told
MANY = 50


def energy(name: str) -> list[Check]:
    """One part at its most dangerous position."""
    scene = PARTS[name]()
    start = time.process_time()
    result = failure_indices(scene, "auto")
    seconds = time.process_time() - start
    k = int(np.nanargmax(result.failure_index.values))
    scene = scene.with_(analysis={"points": [[float(result.x[k]), float(result.y[k])]]})
    trial = failure_indices(scene, "boundary", curves=True).isel(position=0)
    full = failure_indices(scene, "full-fea", curves=True).isel(position=0)
    a, at = trial.a.values, full.a.values
    # below its shortest crack full FEA goes on by a power law
    inside = (at > at[-1] / SPAN) & (at <= a[-1] * (1 + 1e-9))
    G = PchipInterpolator(a, trial.G_inc.values)(np.minimum(at[inside], a[-1]))
    off = np.abs(G / full.G_inc.values[inside] - 1)
    index = abs(float(result.failure_index[k]) / float(full.failure_index) - 1)
    return [
        Check(name, "G_inc at every length", 1e-3, float(off.max()), rule="at most"),
        Check(name, f"index by auto, {seconds:.2g} s of CPU", 3e-3, index, rule="at most"),
    ]


def speed() -> list[Check]:
    """CPU seconds of fifty positions of a plate with two holes, less those of the part."""
    scene = gallery.two_holes()
    points = np.concatenate(
        [hole.points((np.arange(MANY // 2) + 0.37) * hole.length / (MANY // 2)) for hole in scene.outlines]
    )
    scene = scene.with_(analysis={"points": points.tolist()})
    failure_indices(scene, "boundary")

    def seconds(call: Callable[[], object]) -> float:
        times = []
        for _ in range(5):
            start = time.process_time()
            call()
            times.append(time.process_time() - start)
        return float(np.median(times))

    part = seconds(lambda: solve_boundary(scene))
    whole = seconds(lambda: failure_indices(scene, "boundary"))
    return [Check("two holes, 50 positions", "CPU seconds", 0.3, whole - part, rule="at most")]


def main(quick: bool = False) -> list[Check]:
    """Judge all parts."""
    names = list(PARTS)[:2] if quick else list(PARTS)
    checks = [*(check for name in names for check in energy(name)), *speed()]
    show("Trial cracks by boundary integrals", checks)
    if not quick:
        save("trial_cracks", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
