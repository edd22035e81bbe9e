"""Regression: failure indices of reference scenes against those of the version that last renewed them.

Not a check of truth, the other scripts are; it tells when a change moves a number that it was not meant to move.
Methods on voxels have to agree to 1e-6. Body-fitted meshes may come out differently with another mesher or processor:
there 1e-4 counts. No value and one of round-off are the same.

Reads validation/results/regression.csv; `--renew` writes it anew, for the reviewer of a change that is meant to move
numbers. Half a minute; ``--quick`` takes the methods on voxels alone.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable

import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm import Scene, failure_indices
from slmm.initiation.positions import find_positions
from slmm.scene import gallery

TOLERANCE, OTHER_MESHES = 1e-6, 1e-4
#: share of a scene's highest index below which round-off decides: where symmetry makes the stress zero, one processor
#: has 1e-8 of it and an index, another -1e-8 and none
ROUND_OFF = 1e-6

#: scene, methods on voxels, methods on body-fitted meshes
CASES: dict[str, tuple[Callable[[], Scene], tuple[str, ...], tuple[str, ...]]] = {
    "circular hole": (
        lambda: gallery.circular_hole(analysis={"positions": 8}),
        ("slmm", "slmm+ac", "rankine", "mises", "point", "line"),
        ("dislocations",),
    ),
    "elliptic hole, shear": (
        lambda: gallery.elliptic_hole(load={"strain": [0.0, 0.0, 0.1]}, analysis={"positions": 8}),
        ("slmm", "slmm+ac"),
        ("dislocations",),
    ),
    "lobed notch, published": (
        lambda: gallery.lobed_notch(analysis={"positions": 8, "settings": "published", "voxels": 250_000}),
        ("slmm", "slmm+ac"),
        (),
    ),
    "plane strain, averaged": (
        lambda: gallery.rounded_square(
            material={"name": "PMMA", "state": "plane strain"}, analysis={"positions": 8, "average": True}
        ),
        ("slmm+ac",),
        ("dislocations",),
    ),
    "corner": (
        lambda: gallery.v_notch(analysis={"points": [[10.0, 60.0]]}),
        (),
        ("asymptotics", "full-fea"),
    ),
    "crack": (gallery.edge_crack, (), ("griffith", "asymptotics", "full-fea")),
}


def compute(with_meshes: bool) -> dict[tuple[str, str, int], float]:
    """Failure index by scene, method and position."""
    found = {}
    for name, (build, on_voxels, on_meshes) in CASES.items():
        for method in (*on_voxels, *(on_meshes if with_meshes else ())):
            scene = build()
            result = failure_indices(scene, method)
            # without those that were added where the index is largest
            where = find_positions(scene)
            spread = set(zip(where.hole.tolist(), np.nan_to_num(where.s).tolist(), strict=True))
            places = zip(
                result.hole.values.tolist(), np.nan_to_num(result.arc_length.values).tolist(), strict=True
            )
            kept = [FI for FI, at in zip(result.failure_index.values, places, strict=True) if at in spread]
            found |= {(name, method, i): float(FI) for i, FI in enumerate(kept)}
    return found


def stored() -> dict[tuple[str, str, int], float]:
    with open(RESULTS / "regression.csv", newline="") as file:
        rows = csv.DictReader(file)
        return {(r["scene"], r["method"], int(r["position"])): float(r["failure_index"]) for r in rows}


def renew() -> None:
    rows = [
        {"scene": scene, "method": method, "position": i, "failure_index": f"{FI:.12g}"}
        for (scene, method, i), FI in compute(True).items()
    ]
    save("regression", rows)


def main(quick: bool = False) -> list[Check]:
    before, now = stored(), compute(not quick)
    highest: dict[tuple[str, str], float] = {}
    for (scene, method, _), FI in before.items():
        highest[scene, method] = max(highest.get((scene, method), 0.0), np.nan_to_num(FI))
    largest: dict[tuple[str, str], float] = {}
    for (scene, method, i), FI in now.items():
        old = before[scene, method, i]
        # no value, or one of round-off alone
        nothing = [not value > ROUND_OFF * highest[scene, method] for value in (FI, old)]
        change = 0.0 if all(nothing) else abs(FI - old) / max(abs(old), 1e-3)
        largest[scene, method] = max(
            largest.get((scene, method), 0.0), change if np.isfinite(change) else np.inf
        )
    checks = []
    for (scene, method), change in largest.items():
        limit = TOLERANCE if method in CASES[scene][1] else OTHER_MESHES
        checks.append(Check(f"{scene}, {method}", "largest change of FI", limit, change, rule="at most"))
    show("Regression", checks)
    return checks


if __name__ == "__main__":
    if "--renew" in sys.argv:
        renew()
    else:
        run(main, __doc__)
