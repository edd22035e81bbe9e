"""``slmm optimize cantilever``: searches on the benchmark of Paper C."""

from __future__ import annotations

import json
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slmm.command.terminal import (
    PICTURE_FORMATS,
    RESULT_FORMATS,
    check_target,
    console,
    progress_bar,
    refusals,
    say_error,
    table_box,
    word_on_compilation,
)
from slmm.running.input_file import shown
from slmm.running.whole_file import NotWrittenError, whole_file

if TYPE_CHECKING:
    import xarray as xr

optimize = typer.Typer(no_args_is_help=True, help="Look for the best design on a grid of cells.")

BRUTE_FORCE = "brute-force"
ALGORITHMS = ("tbfsl", "bfsl", "ga", "sa", "fs", "rs", "bf", "mg", "tabu", "ils", BRUTE_FORCE)
#: runs in the table
LISTED = 10


@optimize.callback()
def _group() -> None:
    """Look for the best design on a grid of cells."""


@optimize.command()
def cantilever(
    grid: Annotated[
        str, typer.Option(metavar="COLUMNSxROWS", help="Cells along and over the height.")
    ] = "8x5",
    algorithm: Annotated[str, typer.Option(help=f"{', '.join(ALGORITHMS)}.")] = "tbfsl",
    depth: Annotated[
        int | None, typer.Option(min=1, help="Cells flipped at most (tbfsl, bfsl, ils).")
    ] = None,
    radius: Annotated[int | None, typer.Option(min=0, help="How far they may be apart (tbfsl, ils).")] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Another setting of the algorithm, as temperature=0.05."
        ),
    ] = None,
    runs: Annotated[int, typer.Option(min=1, help="Searches, the k-th with seed + k.")] = 1,
    seed: Annotated[
        int, typer.Option(min=0, help="Of the random numbers: the same seed, the same result.")
    ] = 0,
    workers: Annotated[
        int, typer.Option(min=1, help="Processes, for runs side by side or, with one, for designs.")
    ] = 1,
    best: Annotated[
        int | None,
        typer.Option(min=1, help="How many of the best designs brute-force keeps, 200,000 by default."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.nc", help="Write everything as netCDF.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw design and convergence (.png, .pdf or .svg).")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", help="Go on where a killed search was: needs -o, beside which its journals lie."
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the runs as JSON.")] = False,
) -> None:
    """The cantilever under its own weight whose end should sag as little as can be."""
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        if algorithm not in ALGORITHMS:
            raise ValueError(f"--algorithm {algorithm}: must be one of {', '.join(ALGORITHMS)}")
        if resume and output is None:
            raise ValueError("--resume: needs -o, beside which the journals lie")
        its = settings_of(depth, radius, settings or [])
        with progress_bar() as progress, word_on_compilation():
            from slmm.optimization import Cantilever
            from slmm.optimization.cantilever.brute_force import BEST, brute_force
            from slmm.optimization.runs import search_runs
            from slmm.optimization.search import check_settings
            from slmm.pictures.figure_file import write_figure
            from slmm.pictures.optimization import plot_optimization

            beam = Cantilever(*_grid(grid))
            journals = None if output is None else output.with_suffix(".journals")
            if journals is not None and journals.is_file():
                raise ValueError(
                    f"-o {output}: its journals lie in the folder {journals}, and there is a file there"
                )
            with word_of_journals(journals):
                if algorithm == BRUTE_FORCE:
                    if its or runs > 1 or seed or workers > 1:
                        raise ValueError(
                            "brute-force has no settings and no seed, uses all cores, and one run finds all"
                        )
                    journal = None if journals is None else journals / "brute-force.npz"
                    result = brute_force(beam, best or BEST, progress, journal, resume)
                else:
                    if best is not None:
                        raise ValueError(f"--best {best}: is for brute-force alone")
                    check_settings(algorithm, its)
                    result = search_runs(
                        beam,
                        algorithm,
                        runs=runs,
                        seed=seed,
                        workers=workers,
                        journals=journals,
                        resume=resume,
                        progress=progress,
                        **its,
                    )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                figure = plot_optimization(beam, result)
                write_figure(figure, plot)
        if as_json:
            print(json.dumps(_record(result), indent=2))
        else:
            _print(result)


@contextmanager
def word_of_journals(journals: Path | None) -> Iterator[None]:
    """Say how a search goes on that is interrupted, or ends with an error that is no refusal."""
    try:
        yield
    except ValueError:
        raise
    except BaseException as error:
        if journals is None or not journals.is_dir():
            raise
        if not any(journals.iterdir()):
            journals.rmdir()
            raise
        says = f"with --resume it goes on with what is in {journals}"
        if isinstance(error, NotWrittenError):
            raise NotWrittenError(f"{error}; {says}") from error
        say_error(f"stopped; {says}")
        raise


def _grid(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([0-9]{1,9})x([0-9]{1,9})", text)
    if match is None:
        raise ValueError(f"--grid {shown(text)}: must be columns x rows, as 8x5")
    return int(match[1]), int(match[2])


def settings_of(depth: int | None, radius: int | None, others: list[str]) -> dict[str, Any]:
    """Settings by name; numbers as JSON has them."""
    found: dict[str, Any] = {
        name: value for name, value in (("depth", depth), ("radius", radius)) if value is not None
    }
    for text in others:
        name, equals, value = text.partition("=")
        try:
            found[name] = json.loads(value)
        except (ValueError, RecursionError):  # no JSON; a number of too many digits; lists without bottom
            equals = ""
        if not (name and equals):
            raise ValueError(
                f"--set {shown(text)}: must be NAME=VALUE with a number or JSON, as temperature=0.05"
            )
    return found


def _record(result: xr.Dataset) -> dict[str, Any]:
    """What JSON shows."""
    if "endpoint_displacement" in result:
        return {
            "n_valid": int(result.n_valid),
            "best": float(result.endpoint_displacement[0]),
            "best_design": rows_of(result.best_design.values),
        }
    return {
        "algorithm": result.attrs["algorithm"],
        "settings": json.loads(result.attrs["settings"]),
        "runs": [
            {
                "seed": int(run.seed),
                "value": float(run.value),
                "simulations": int(run.simulations),
                "stopped": run.stopped.item(),
                "best_design": rows_of(run.best_design.values),
            }
            for run in (result.isel(run=k) for k in range(result.sizes["run"]))
        ],
    }


def rows_of(design: Any) -> list[str]:
    """A design as text, 1 where a cell is on."""
    return ["".join("1" if cell else "0" for cell in row) for row in design]


def _print(result: xr.Dataset) -> None:
    """The best design, and the runs in order."""
    from rich.table import Table

    out = console()
    if "endpoint_displacement" in result:
        out.print(
            f"{int(result.n_valid):,} valid designs; the best one's end sags {result.endpoint_displacement[0]:.6g} mm:"
        )
        print_design(result.best_design.values)
        return
    order = result.value.argsort().values
    table = Table(
        title=f"{result.attrs['algorithm']}: best {min(LISTED, len(order))} of {len(order)} runs",
        box=table_box(out),
        pad_edge=False,
    )
    for name in ("seed", "sag of the end\nmm", "simulations"):
        table.add_column(name, justify="right")
    table.add_column("stopped")
    for k in order[:LISTED]:
        run = result.isel(run=int(k))
        table.add_row(
            str(int(run.seed)), f"{float(run.value):.6g}", str(int(run.simulations)), run.stopped.item()
        )
    out.print(table)
    print_design(result.best_design.values[order[0]])
    if len(order) > 1:
        low, middle, high = result.value.quantile([0.25, 0.5, 0.75]).values
        count = float(result.simulations.median())
        out.print(f"Quartiles: {low:.6g}, {middle:.6g}, {high:.6g} mm; median of the simulations {count:g}.")


def print_design(design: Any) -> None:
    """Rows of a design, a block where a cell is on."""
    for row in design:
        console().print("  " + "".join("█" if cell else "·" for cell in row), soft_wrap=True)
