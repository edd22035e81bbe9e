"""What ``slmm optimize toughness`` shows: the best design as a table, as JSON and as a picture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slmm.command.optimize_command import print_design, rows_of
from slmm.command.terminal import console

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from slmm.optimization.hole_patterns.problem import HolePattern

#: a saddle is told of if it is so near to the threshold; chosen
NEAR = 0.05


def draw(problem: HolePattern, design: np.ndarray, target: Path) -> None:
    """The weakest direction of a design: its cracks and F(u)."""
    from slmm.pictures.figure_file import write_figure
    from slmm.pictures.fracture import plot_fracture

    scene = problem.scene(design, int(problem.by_direction(design).argmin()))
    write_figure(plot_fracture(scene, problem.fracture(scene, errors=True)), target)


def record(
    result: xr.Dataset, whole: np.ndarray, margins: xr.Dataset | None, refined: xr.Dataset | None
) -> dict[str, Any]:
    """What JSON shows."""
    found: dict[str, Any] = {
        "algorithm": result.attrs["algorithm"],
        "settings": json.loads(result.attrs["settings"]),
        "by_direction": result.by_direction.values.tolist(),
        "simulations": int(result.simulations),
        "failed": int(result.failed),
        "stopped": result.attrs["stopped"],
        "margin": result.attrs["margin"],
        "best_design": rows_of(whole),
    }
    if margins is not None:
        found["margins"] = {
            **{name: margins[name].values.tolist() for name in ("U_T_upside_down", "U_T_shifted", "hinging")},
            **{name: margins.attrs[name] for name in ("numerical_error", "spread")},
            "forks": bool(margins.attrs["forks"]),
        }
    if refined is not None:
        found["refined"] = {
            **{name: refined[name].values.tolist() for name in ("support", "by_direction")},
            **{name: float(refined[name]) for name in ("spacing", "frame")},
            "evaluations": int(refined.evaluations),
            "stopped": refined.attrs["stopped"],
        }
    return found


def show(
    result: xr.Dataset, whole: np.ndarray, margins: xr.Dataset | None, refined: xr.Dataset | None
) -> None:
    """The best design and how tough it is."""
    out = console()
    units = result.by_direction.attrs["units"]
    said = [
        f"{result.attrs['algorithm']}: the best of {int(result.simulations)} designs asked for has "
        f"{_listed(result.by_direction)} {units} by directions ({int(result.failed)} failed; "
        f"{result.attrs['stopped']}):"
    ]
    out.print(*said, soft_wrap=True)
    print_design(whole)
    if result.attrs["margin"] < NEAR:
        out.print(
            f"Its holes all but meet: a saddle of the level set is {result.attrs['margin']:.2g} from the threshold.",
            soft_wrap=True,
        )
    if margins is not None:
        out.print(_of_margins(margins), soft_wrap=True)
    if refined is not None:
        out.print(
            f"Refined in {int(refined.evaluations)} evaluations: {_listed(refined.by_direction)} {units} by "
            f"directions, with a spacing of {float(refined.spacing):.4g} mm and the support values",
            soft_wrap=True,
        )
        for row in refined.support.values:
            out.print("  " + " ".join(f"{value:6.3f}" for value in row), soft_wrap=True)


def _listed(values: xr.DataArray) -> str:
    return ", ".join(f"{value:.4g}" for value in values.values)


def _of_margins(margins: xr.Dataset) -> str:
    """Margins in words."""
    error, spread = (100 * margins.attrs[name] for name in ("numerical_error", "spread"))
    share = 100 * float(margins.hinging.max())
    forks = "it forks" if margins.attrs["forks"] else "it does not fork"
    return (
        f"Numerical error {error:.2g} %; holes shifted by 0.02 mm change U_T by {spread:.2g} %: {forks}. "
        f"Up to {share:.2g} % of U_T come when the force has fallen below a tenth of its peak."
    )
