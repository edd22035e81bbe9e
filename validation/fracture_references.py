"""Tensile toughness of reference plates: simulated, against a high-order prototype, and the time that it takes.

The plate of Paper D (section 2.1), increments and first lengths of 2 mm, the largest tangential stress. The prototype's
values are good to 1e-5. Writes validation/results/fracture_references.csv, a minute; ``--quick`` leaves out the finer
tolerance and the shorter increment, and writes nothing.
"""

from __future__ import annotations

import time

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.scene.gallery import tensile_plate

#: holes (x, y, radius) or (x, y, semi-axes, angle), mm and degrees, and U_T, mJ
PLATES: dict[str, tuple[list[tuple[float, ...]], float]] = {
    "full plate": ([], 106.9194),
    "circle of 8 mm in the middle": ([(40.0, 40.0, 8.0)], 274.276),
    "circle beside the middle": ([(38.0, 44.0, 7.0)], 268.585),
    "two circles": ([(46.0, 45.0, 12.0), (24.0, 36.0, 4.0)], 270.745),
    "two circles, an ellipse": (
        [(28.0, 44.0, 6.0), (46.0, 30.0, 5.0), (62.0, 45.0, 6.0, 4.0, 10.0)],
        238.791,
    ),
}
TOLERANCE = 1e-3


def references(tolerance: float) -> list[Check]:
    """U_T, its estimated error and the time, at a tolerance."""
    checks = []
    for name, (holes, U_T) in PLATES.items():
        scene = tensile_plate(holes)
        result = simulate(scene, 2.0, tolerance=tolerance)
        taken = []
        for _ in range(3):
            begin = time.process_time()
            simulate(scene, 2.0, tolerance=tolerance, errors=False)
            taken.append(time.process_time() - begin)
        case = f"{name}, tolerance {tolerance:g}"
        ours, error = float(result.U_T), float(result.U_T_error)
        source = "prototype of high order"
        checks += [
            Check(case, "U_T, mJ", U_T, ours, TOLERANCE, source=source),
            Check(
                case,
                "true error over U_T_error",
                1.0,
                abs(ours - U_T) / max(error, 1e-4 * U_T),
                rule="at most",
            ),
            Check(case, "CPU time, s", np.nan, min(taken), rule="told"),
        ]
    return checks


def increments() -> list[Check]:
    """Half the increment: where no event competes, U_T hardly changes."""
    checks = []
    for name, (holes, _) in PLATES.items():
        scene = tensile_plate(holes)
        long, short = (
            float(simulate(scene, step, first_length=2.0, errors=False).U_T) for step in (2.0, 1.0)
        )
        checks.append(Check(name, "U_T, increment of 2 against 1 mm", short, long, TOLERANCE))
    return checks


def main(quick: bool = False) -> list[Check]:
    checks = references(0.01)
    if not quick:
        checks += [*references(1e-3), *increments()]
    show("Tensile toughness of reference plates", checks)
    if not quick:
        save("fracture_references", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
