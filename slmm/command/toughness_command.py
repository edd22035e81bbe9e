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

from slmm.command.optimize_command import settings_of
from slmm.command.terminal import (
    PICTURE_FORMATS,
    RESULT_FORMATS,
    check_no_input,
    check_target,
    progress_bar,
    refusals,
    word_on_compilation,
)
from slmm.command.toughness_report import draw, record, show
from slmm.running.input_file import shown
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    import xarray as xr

    from slmm.optimization.hole_patterns.plate import CrackedPlate

BRUTE_FORCE = "brute-force"
#: their names, and whether they start from one design
ALGORITHMS = {
    "tbfsl": True,
    "bfsl": True,
    "ils": True,
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
    depth: Annotated[
        int | None, typer.Option(min=1, help="Points changed at most (tbfsl, bfsl, ils).")
    ] = None,
    radius: Annotated[int | None, typer.Option(min=0, help="How far they may be apart (tbfsl, ils).")] = None,
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
    plate: Annotated[
        Path | None,
        typer.Option(
            metavar="SCENE.toml",
            help="The plate, its crack and material; frame, length scale and threshold of a pattern in it.",
        ),
    ] = None,
    increment: Annotated[float, typer.Option(metavar="MM", help="By which cracks grow in a step.")] = 2.0,
    first_length: Annotated[float, typer.Option(metavar="MM", help="Length of a crack that starts.")] = 1.0,
    initiation: Annotated[
        str, typer.Option(help="What starts cracks at surfaces: point, slmm+ac or coupled.")
    ] = "point",
    engine: Annotated[str, typer.Option(help="What solves the plate: boundary or fem.")] = "boundary",
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
    margins: Annotated[
        bool,
        typer.Option(
            "--margins", help="Tell the best design's numerical error, its forks, its tail and saddles."
        ),
    ] = False,
    refine: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=1,
            help="Vary support values and spacing of the best design, in N evaluations at most.",
        ),
    ] = None,
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
        refined_journal = None if journal is None else journal.with_suffix(".refined.jsonl")
        check_no_input(
            [plate], {"-o": output, "--plot": plot, "--journal": journal, "the refinement's": refined_journal}
        )
        its = settings_of(depth, radius, settings or [])
        if algorithm == "tbfsl":
            its = PUBLISHED | its
        with progress_bar() as progress, word_on_compilation(), cluster(scheduler) as client:
            from slmm.optimization.hole_patterns.problem import PAPER, HolePattern
            from slmm.optimization.search import search

            problem = HolePattern(
                grid,
                pattern,
                increment,
                first_length,
                initiation,
                engine,
                PAPER if plate is None else _read_plate(plate),
                sides=sides,
                figure=figure,
                over=over,
                heaviest=heaviest,
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
                improved=None if plot is None else lambda design, _: draw(problem, design, plot),
                **its,
            )
            result = found.to_dataset()
            each = problem.by_direction(found.best_design)
            described = {"units": units, "long_name": f"{figure} of the best design by directions"}
            result["by_direction"] = ("direction", each, described)
            whole = problem.whole(found.best_design)
            result.attrs["margin"] = problem.level_set(whole).margin()
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            told = problem.margins(found.best_design) if margins else None
            refined = None
            if refine is not None:
                from slmm.optimization.hole_patterns.refinement import refine as refined_from

                refined = refined_from(
                    problem,
                    found.best_design,
                    refine,
                    journal=refined_journal,
                    resume=resume,
                    progress=progress,
                )
            if output is not None:
                with whole_file(output) as unfinished:
                    _write({"/": result, "margins": told, "refined": refined}, unfinished)
        if as_json:
            print(json.dumps(record(result, whole, told, refined), indent=2))
        else:
            show(result, whole, told, refined)


def _read_plate(path: Path) -> CrackedPlate:
    """The plate of a scene file."""
    from slmm.optimization.hole_patterns.plate import CrackedPlate
    from slmm.scene.scene import read_scene

    scene = read_scene(path)
    try:
        return CrackedPlate.of_scene(scene)
    except ValueError as error:
        raise ValueError(f"--plate {shown(path)}: {error}") from error


def _write(groups: dict[str, xr.Dataset | None], path: Path) -> None:
    """The search as the file itself, what was asked for besides as groups in it."""
    for name, dataset in groups.items():
        if dataset is not None:
            dataset.to_netcdf(path, "w" if name == "/" else "a", group=name, engine="netcdf4")


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
