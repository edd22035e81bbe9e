"""Tensile toughness and F(u) of six hole patterns against the length of increments (thesis, Paper D, Figs. 16 and 17).

The six designs A to F of the paper are not at hand: these are the first six random patterns of 7 x 7 points of
`fracture_patterns.py`, from the left. Increments of 0.5, 1, 2 and 4 mm and those that are chosen by themselves, cracks
start with 1 mm. Required, as the paper found: at 2 mm U_T is within 1 % of that at 1 mm. Told: U_T with a force that
falls steadily where cracks grow steadily, and the time. Writes validation/results/fracture_increments.csv,
fracture_increments_curves.csv and fracture_increments.png, a minute of CPU; ``--quick`` takes one design and two
increments and writes nothing.
"""

from __future__ import annotations

import time

import matplotlib
import numpy as np
import xarray as xr
from checks import RESULTS, Check, run, save, show
from fracture_patterns import design_of
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slmm.fracture import simulate
from slmm.optimization.hole_patterns.objectives import LARGEST
from slmm.pictures.cracked_part import draw_part
from slmm.scene.scene import Scene

#: numbers of designs, with 7 x 7 points
DESIGNS = dict(zip("ABCDEF", (4, 12, 20, 28, 36, 44), strict=True))
#: mm; the second of them is the paper's reference, the third its choice
INCREMENTS: tuple[float | str, ...] = (0.5, 1.0, 2.0, 4.0, "auto")
FIRST = 1.0
#: of U_T at 2 mm against 1 mm; published
TOLERANCE = 0.01
NAME = "fracture_increments"

Results = dict[float | str, tuple[xr.Dataset, float]]


def broken(scene: Scene, increment: float | str) -> tuple[xr.Dataset, float]:
    """A simulation, and its CPU time, s."""
    begin = time.process_time()
    result = simulate(scene, increment, first_length=FIRST, largest_displacement=LARGEST, errors=False)
    return result, time.process_time() - begin


def checks_of(name: str, results: Results) -> list[Check]:
    """Of one design: each increment against 1 mm, the paper's reference."""
    checks, reference = [], results[1.0][0]
    for increment, (result, cpu) in results.items():
        case = f"design {name}, " + ("auto" if increment == "auto" else f"increment {increment:g} mm")
        is_published = increment == 2.0
        checks += [
            Check(
                case,
                "U_T against 1 mm, mJ",
                float(reference.U_T),
                float(result.U_T),
                TOLERANCE,
                rule="equal" if is_published else "told",
                source="published" if is_published else "",
            ),
            Check(
                case,
                "the same, force falling steadily",
                float(reference.U_T_integrated),
                float(result.U_T_integrated),
                rule="told",
            ),
            Check(case, "steps that compete", np.nan, result.attrs["competing_events"], rule="told"),
            Check(case, "CPU time, s", np.nan, cpu, rule="told"),
        ]
    return checks


def draw(every: dict[str, tuple[Scene, Results]]) -> None:
    """Crack paths and F(u) of each design, coloured by the increment; U_T over the increment."""
    colours = dict(
        zip(INCREMENTS, matplotlib.colormaps["viridis"](np.linspace(0, 0.9, len(INCREMENTS))), strict=True)
    )
    figure = Figure(figsize=(17.0, 8.4), layout="constrained")
    axes = figure.subplots(3, len(every), height_ratios=(1.3, 1.0, 0.8), squeeze=False)
    for k, (name, (scene, results)) in enumerate(every.items()):
        paths, curves, toughness = axes[:, k]
        draw_part(paths, scene)
        for increment, (result, _) in results.items():
            _draw_paths(paths, result, colours[increment])
            curves.plot(result.u, result.F / 1e3, color=colours[increment], lw=1.0, label=str(increment))
        reference = float(results[1.0][0].U_T)
        fixed = [increment for increment in results if increment != "auto"]
        off = {
            increment: 100 * (float(result.U_T) / reference - 1) for increment, (result, _) in results.items()
        }
        toughness.plot(fixed, [off[increment] for increment in fixed], "o-", color="0.3")
        toughness.axhline(off["auto"], color=colours["auto"], lw=1.0)
        toughness.set(xlabel="increment, mm", ylim=(-6.0, 6.0))
        paths.set(title=f"{name}: design {DESIGNS[name]}", xlabel="", ylabel="")
        curves.set(xlabel="u, mm")
    axes[1, 0].set_ylabel("F, kN")
    axes[2, 0].set_ylabel("U_T against 1 mm, %\n(line: auto)")
    axes[1, 0].legend(title="increment, mm", fontsize="small")
    figure.savefig(RESULTS / f"{NAME}.png", dpi=110)


def _draw_paths(axes: Axes, result: xr.Dataset, colour: np.ndarray) -> None:
    for x, y in zip(result.crack_x.values, result.crack_y.values, strict=True):
        axes.plot(x, y, color=colour, lw=1.2, zorder=4)


def main(quick: bool = False) -> list[Check]:
    every: dict[str, tuple[Scene, Results]] = {}
    increments = INCREMENTS[1:3] if quick else INCREMENTS
    for name, number in list(DESIGNS.items())[: 1 if quick else None]:
        problem, design = design_of(number)
        scene = problem.scene(design)
        every[name] = scene, {increment: broken(scene, increment) for increment in increments}
    checks = [check for name, (_, results) in every.items() for check in checks_of(name, results)]
    show("Increments", checks)
    if not quick:
        save(NAME, (check.row() for check in checks))
        save(
            f"{NAME}_curves",
            curves_of({f"{n}, {i}": r for n, (_, of) in every.items() for i, (r, _) in of.items()}),
        )
        draw(every)
    return checks


def curves_of(results: dict[str, xr.Dataset]) -> list[dict[str, object]]:
    """Corner points of F(u), as rows."""
    return [
        {"case": case, "u": u, "F": F}
        for case, result in results.items()
        for u, F in zip(result.u.values.tolist(), result.F.values.tolist(), strict=True)
    ]


if __name__ == "__main__":
    run(main, __doc__)
