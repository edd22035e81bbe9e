"""U_T of a compact tension specimen, whose crack grows steadily to its end: G_c times its ligament is all of the work.

The sum of Paper D, in which the force drops at constant displacement, errs in the first order of the increment, and
`U_T_integrated` in the second; beside the far edge, where the ligament is as short as increments, both in the first.
Writes validation/results/steady_growth.csv, half a minute; ``--quick`` takes long increments, and writes nothing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.scene.scene import read_scene

SCENE = Path(__file__).parents[1] / "examples" / "parts" / "compact_tension.toml"
#: mm
INCREMENTS = (4.0, 2.0, 1.0, 0.5)
#: before the ligament is short: 12 of 20 mm are broken then, mm
STOPPED = 1.0


def main(quick: bool = False) -> list[Check]:
    scene, checks = read_scene(SCENE), []
    increments = INCREMENTS[:2] if quick else INCREMENTS
    ligament = 20.0 * scene.part.thickness
    exact = scene.material.G_c * ligament
    for increment in increments:
        result = simulate(scene, increment)
        case = f"increment {increment:g} mm"
        U_T, integrated, told = (
            float(result[name]) for name in ("U_T", "U_T_integrated", "U_T_integrated_error")
        )
        checks += [
            Check(case, "U_T as published, mJ", exact, U_T, rule="told", source="G_c times the ligament"),
            Check(case, "U_T_integrated, mJ", exact, integrated, 0.03, source="G_c times the ligament"),
            Check(case, "true error over the told one", 1.0, abs(integrated - exact) / told, rule="at most"),
            Check(
                case,
                "true error of U_T over the told one",
                1.0,
                abs(U_T - exact) / float(result.U_T_error),
                rule="told",
            ),
        ]
    stopped = [
        float(simulate(scene, increment, largest_displacement=STOPPED, errors=False).U_T_integrated)
        for increment in INCREMENTS[: 3 if quick else None]
    ]
    for k, increment in enumerate(INCREMENTS[1 : len(stopped) - 1], start=1):
        order = np.log2((stopped[k - 1] - stopped[k]) / (stopped[k] - stopped[k + 1]))
        case = f"to u = {STOPPED:g} mm, increments around {increment:g} mm"
        checks.append(Check(case, "order of U_T_integrated", 2.0, float(order), 0.1, source="required"))
    show("Steady growth", checks)
    if not quick:
        save("steady_growth", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
