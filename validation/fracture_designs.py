"""Tensile toughness and F(u) of simple hole designs on 7 x 7 points (thesis, Paper D, Fig. 19).

A plate without holes, with all points empty, with a diamond, with one empty point, and with a slit of 1 x 7 points,
upright and level; increments of 2 mm, cracks start with 1 mm. Required: the published values are met within 4 %, and
ours change by less than 0.5 % at a quarter of the increment and a finer tolerance. How large the paper's diamond is its
text does not say, nor the U_T of it and of the small hole. Writes validation/results/fracture_designs.csv,
fracture_designs_curves.csv and fracture_designs.png, a minute of CPU; ``--quick`` leaves out what is finer, and writes
nothing.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from checks import RESULTS, Check, run, save, show
from fracture_increments import curves_of
from matplotlib.figure import Figure

from slmm.fracture import simulate
from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.objectives import LARGEST
from slmm.pictures.cracked_part import draw_cracks, draw_part
from slmm.scene.scene import Scene

GRID = 7
ROW, COLUMN = np.indices((GRID, GRID)) - GRID // 2
NOTHING = np.zeros((GRID, GRID), dtype=bool)
#: empty points, and U_T of Paper D, mJ: text and caption of Fig. 19 (two values where they differ)
DESIGNS: dict[str, tuple[np.ndarray, tuple[float, ...]]] = {
    "full plate": (NOTHING, (109.0,)),
    "all empty": (~NOTHING, (337.0,)),
    "diamond of 5 points": (np.abs(ROW) + np.abs(COLUMN) < 2, ()),
    "diamond of 13 points": (np.abs(ROW) + np.abs(COLUMN) < 3, ()),
    "diamond of 25 points": (np.abs(ROW) + np.abs(COLUMN) < 4, ()),
    "one point": ((ROW == 0) & (COLUMN == 0), ()),
    "upright slit": (COLUMN == 0, (759.0, 757.0)),
    "level slit": (ROW == 0, (90.7, 91.0)),
}
#: of the published values, and of ours against a finer model; required
PUBLISHED, FINER = 0.04, 5e-3
NAME = "fracture_designs"


def broken(scene: Scene, increment: float = 2.0, tolerance: float = 0.01) -> xr.Dataset:
    """A simulation as those of searches."""
    return simulate(
        scene, increment, first_length=1.0, tolerance=tolerance, largest_displacement=LARGEST, errors=False
    )


def draw(scenes: dict[str, Scene], results: dict[str, xr.Dataset]) -> None:
    """Crack paths and F(u), as Fig. 19."""
    figure = Figure(figsize=(17.0, 5.2), layout="constrained")
    axes = figure.subplots(2, len(scenes), height_ratios=(1.0, 1.0))
    for k, (name, scene) in enumerate(scenes.items()):
        path, curve = axes[:, k]
        draw_part(path, scene)
        draw_cracks(path, results[name], results[name].sizes["step"])
        path.set(title=name, xlabel="", ylabel="")
        curve.plot(results[name].u, results[name].F / 1e3, color="0.2")
        curve.set(
            title=f"U_T = {float(results[name].U_T):.1f} mJ", xlabel="u, mm", xlim=(0, 1.1), ylim=(0, 2.1)
        )
    axes[1, 0].set_ylabel("F, kN")
    figure.savefig(RESULTS / f"{NAME}.png", dpi=110)


def main(quick: bool = False) -> list[Check]:
    problem, checks = HolePattern(GRID, "full"), []
    scenes = {name: problem.scene(design) for name, (design, _) in DESIGNS.items()}
    results = {name: broken(scene) for name, scene in scenes.items()}
    for name, (_, published) in DESIGNS.items():
        U_T = float(results[name].U_T)
        if published:
            checks += [
                Check(name, "U_T, mJ", value, U_T, PUBLISHED, source="published") for value in published
            ]
        else:
            checks.append(Check(name, "U_T, mJ", np.nan, U_T, rule="told"))
        compete = results[name].attrs["competing_events"]
        checks.append(Check(name, "steps that compete", np.nan, compete, rule="told"))
        if not quick:
            finer = float(broken(scenes[name], 0.5, 1e-3).U_T)
            checks.append(Check(name, "U_T against increments of 0.5 mm, finer model, mJ", finer, U_T, FINER))
    show("Simple hole designs", checks)
    if not quick:
        save(NAME, (check.row() for check in checks))
        save(f"{NAME}_curves", curves_of(results))
        draw(scenes, results)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
