"""``slmm optimize toughness``: searches for the hole pattern that makes a plate tough (Paper D)."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
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
    import numpy as np
    import xarray as xr

BRUTE_FORCE = "brute-force"
#: their names, and whether they start from one design
ALGORITHMS = {
    "tbfsl": True,
    "bfsl": True,
    "tabu": True,
    "ga": False,
    "fs": True,
    "sa": True,
    "rs": False,
    BRUTE_FORCE: False,
}
#: how far and how many support points TBFSL changes at a time; published (Paper D, section 2.4.4)
PUBLISHED = {"depth": 3, "radius": 3}
#: a scheduler answers within so many seconds; chosen
PATIENCE = 10


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
    start: Annotated[
        str, typer.Option(help="solid (the plate without holes, as published) or random (by --seed).")
    ] = "solid",
    figure: Annotated[str, typer.Option(help="What is to be large: U_T, peak force or stiffness.")] = "U_T",
    over: Annotated[str, typer.Option(help="Of the directions: least or mean.")] = "least",
    sides: Annotated[str, typer.Option(help="From which the crack may come: all or left.")] = "all",
    heaviest: Annotated[
        float,
        typer.Option(help="What the plate may weigh, over one without holes; below 1 with --start random."),
    ] = 1.0,
    increment: Annotated[float, typer.Option(metavar="MM", help="By which cracks grow in a step.")] = 2.0,
    seed: Annotated[
        int, typer.Option(min=0, help="Of the random numbers: the same seed, the same result.")
    ] = 0,
    workers: Annotated[int, typer.Option(min=1, help="Processes that simulate designs.")] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Of a Dask cluster whose workers do it, as tcp://10.0.0.1:8786."
        ),
    ] = None,
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
        Path | None,
        typer.Option(metavar="OUT.png", help="Draw each better design, while it runs (.png, .pdf or .svg)."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """The plate with a crack from any side that should be as tough as can be, by its pattern of holes."""
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        if algorithm not in ALGORITHMS:
            raise ValueError(f"--algorithm {algorithm}: must be one of {', '.join(ALGORITHMS)}")
        if start not in ("solid", "random"):
            raise ValueError(f"--start {start}: must be solid or random")
        if resume and journal is None:
            raise ValueError("--resume: needs --journal")
        if scheduler is not None and workers > 1:
            raise ValueError(f"--workers {workers}: the cluster at {scheduler} has its own")
        its = settings_of(depth, radius, settings or [])
        if algorithm == "tbfsl":
            its = PUBLISHED | its
        with progress_bar() as progress, word_on_compilation(), cluster(scheduler) as client:
            from slmm.optimization.hole_patterns.problem import HolePattern
            from slmm.optimization.search import search

            problem = HolePattern(
                grid, pattern, increment, sides=sides, figure=figure, over=over, heaviest=heaviest
            )
            units = problem.objective["units"]
            found = search(
                problem,
                "bf" if algorithm == BRUTE_FORCE else algorithm,
                seed=seed,
                start=problem.start if ALGORITHMS[algorithm] and start == "solid" else None,
                workers=workers,
                client=client,
                journal=journal,
                resume=resume,
                progress=lambda count, best: progress(
                    1 - 0.995**count, f"{count} designs, best {-best:.4g} {units}"
                ),
                improved=None if plot is None else lambda design, _: _plot(problem, design, plot),
                **its,
            )
            result = found.to_dataset()
            each = problem.by_direction(found.best_design)
            described = {"units": units, "long_name": f"{figure} of the best design by directions"}
            result["by_direction"] = ("direction", each, described)
            result.attrs["margin"] = problem.level_set(problem.whole(found.best_design)).margin()
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
        whole = problem.whole(found.best_design)
        if as_json:
            print(json.dumps(_record(result, whole), indent=2))
        else:
            _print(result, whole)


@contextmanager
def cluster(scheduler: str | None) -> Iterator[Any]:
    """A client of the Dask cluster at an address, None without one.

    Raises
    ------
    ValueError
        When nothing answers there.
    ImportError
        Without the extra dask.
    """
    if scheduler is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError as error:
        raise ImportError("--scheduler: needs distributed, which comes with slmm[dask]") from error
    try:
        client = Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError, TypeError) as error:
        raise ValueError(f"--scheduler {scheduler}: no Dask cluster answers there") from error
    with client:
        yield client


def _plot(problem: Any, design: np.ndarray, target: Path) -> None:
    """The weakest direction of a design: its cracks and F(u)."""
    from slmm.fracture.simulation import simulate
    from slmm.pictures.figure_file import write_figure
    from slmm.pictures.fracture import plot_fracture

    scene = problem.scene(design, int(problem.by_direction(design).argmin()))
    result = simulate(scene, problem.increment, first_length=problem.first_length)
    write_figure(plot_fracture(scene, result), target)


def _record(result: xr.Dataset, whole: Any) -> dict[str, Any]:
    """What JSON shows."""
    return {
        "algorithm": result.attrs["algorithm"],
        "settings": json.loads(result.attrs["settings"]),
        "by_direction": result.by_direction.values.tolist(),
        "simulations": int(result.simulations),
        "failed": int(result.failed),
        "stopped": result.attrs["stopped"],
        "margin": result.attrs["margin"],
        "best_design": rows_of(whole),
    }


def _print(result: xr.Dataset, whole: Any) -> None:
    """The best design and how tough it is."""
    out = console()
    each = ", ".join(f"{value:.4g}" for value in result.by_direction.values)
    units = result.by_direction.attrs["units"]
    out.print(
        f"{result.attrs['algorithm']}: the best of {int(result.simulations)} designs asked for has {each} {units} by "
        f"directions ({int(result.failed)} failed; {result.attrs['stopped']}):",
        soft_wrap=True,
    )
    print_design(whole)
    if result.attrs["margin"] < 0.05:
        out.print(
            f"Its holes all but meet: a saddle of the level set is {result.attrs['margin']:.2g} from the threshold.",
            soft_wrap=True,
        )
