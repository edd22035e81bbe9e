"""``slmm optimize toughness``: searches for the hole pattern that makes a plate tough (Paper D)."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slmm.command.optimize_command import print_design, rows_of, settings_of
from slmm.command.terminal import (
    PICTURE_FORMATS,
    RESULT_FORMATS,
    check_target,
    console,
    progress_bar,
    refusals,
    word_on_compilation,
)
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    import xarray as xr

BRUTE_FORCE = "brute-force"
#: their names, and whether they start from the solid plate
ALGORITHMS = {
    "tbfsl": True,
    "bfsl": True,
    "tabu": True,
    "fs": True,
    "sa": True,
    "rs": False,
    BRUTE_FORCE: False,
}
#: how far and how many support points TBFSL changes at a time; published (Paper D, section 2.4.4)
PUBLISHED = {"depth": 3, "radius": 3}


def toughness(
    pattern: Annotated[str, typer.Option(help="full, reflected or rotated.")] = "reflected",
    grid: Annotated[int, typer.Option(min=1, max=32, help="Support points along a side.")] = 8,
    algorithm: Annotated[str, typer.Option(help=f"{', '.join(ALGORITHMS)}.")] = "tbfsl",
    depth: Annotated[int | None, typer.Option(min=1, help="Points changed at most (tbfsl, bfsl).")] = None,
    radius: Annotated[int | None, typer.Option(min=0, help="How far they may be apart (tbfsl).")] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Another setting of the algorithm, as limit=100."),
    ] = None,
    increment: Annotated[float, typer.Option(metavar="MM", help="By which cracks grow in a step.")] = 2.0,
    seed: Annotated[
        int, typer.Option(min=0, help="Of the random numbers: the same seed, the same result.")
    ] = 0,
    workers: Annotated[int, typer.Option(min=1, help="Processes that simulate designs.")] = 1,
    journal: Annotated[
        Path | None, typer.Option(metavar="RUN.db", help="Keep every value in this file.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where a killed search was: needs --journal.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.nc", help="Write everything as netCDF.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw the best design (.png, .pdf or .svg).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """The plate with a crack from any side that should be as tough as can be, by its pattern of holes."""
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        if algorithm not in ALGORITHMS:
            raise ValueError(f"--algorithm {algorithm}: must be one of {', '.join(ALGORITHMS)}")
        if resume and journal is None:
            raise ValueError("--resume: needs --journal")
        its = settings_of(depth, radius, settings or [])
        if algorithm == "tbfsl":
            its = PUBLISHED | its
        with progress_bar() as progress, word_on_compilation():
            from slmm.optimization.hole_patterns.problem import HolePattern
            from slmm.optimization.search import search

            problem = HolePattern(grid, pattern, increment)
            found = search(
                problem,
                "bf" if algorithm == BRUTE_FORCE else algorithm,
                seed=seed,
                start=problem.start if ALGORITHMS[algorithm] else None,
                workers=workers,
                journal=journal,
                resume=resume,
                progress=lambda count, best: progress(
                    1 - 0.995**count, f"{count} designs, best {-best:.4g} mJ"
                ),
                **its,
            )
            result = found.to_dataset()
            each = problem.tensile_toughness(found.best_design)
            described = {"units": "mJ", "long_name": "tensile toughness of the best design by directions"}
            result["U_T"] = ("direction", each, described)
            result.attrs["margin"] = problem.level_set(problem.whole(found.best_design)).margin()
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                progress(1.0, "picture")
                _plot(problem, found.best_design, int(each.argmin()), plot)
        whole = problem.whole(found.best_design)
        if as_json:
            print(json.dumps(_record(result, whole), indent=2))
        else:
            _print(result, whole)


def _plot(problem: Any, design: Any, direction: int, target: Path) -> None:
    """The weakest direction of a design: its cracks and F(u)."""
    from slmm.fracture.simulation import simulate
    from slmm.pictures.figure_file import write_figure
    from slmm.pictures.fracture import plot_fracture

    scene = problem.scene(design, direction)
    result = simulate(scene, problem.increment, first_length=problem.first_length)
    write_figure(plot_fracture(scene, result), target)


def _record(result: xr.Dataset, whole: Any) -> dict[str, Any]:
    """What JSON shows."""
    return {
        "algorithm": result.attrs["algorithm"],
        "settings": json.loads(result.attrs["settings"]),
        "U_T": result.U_T.values.tolist(),
        "simulations": int(result.simulations),
        "failed": int(result.failed),
        "stopped": result.attrs["stopped"],
        "margin": result.attrs["margin"],
        "best_design": rows_of(whole),
    }


def _print(result: xr.Dataset, whole: Any) -> None:
    """The best design and how tough it is."""
    out = console()
    each = ", ".join(f"{value:.4g}" for value in result.U_T.values)
    out.print(
        f"{result.attrs['algorithm']}: the toughest of {int(result.simulations)} designs asked for has {each} mJ by "
        f"directions ({int(result.failed)} failed; {result.attrs['stopped']}):",
        soft_wrap=True,
    )
    print_design(whole)
    if result.attrs["margin"] < 0.05:
        out.print(
            f"Its holes all but meet: a saddle of the level set is {result.attrs['margin']:.2g} from the threshold.",
            soft_wrap=True,
        )
