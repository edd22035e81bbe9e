"""The command line: ``slmm initiation``, ``slmm info``.

Libraries that take long to import are imported where they are needed, so that help and refusals come at once.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from slmm.initiation.failure import METHODS, ON_DISPLACEMENTS  # the package itself has imported it

if TYPE_CHECKING:
    import xarray as xr

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)

RESULT_FORMATS = (".nc",)
PICTURE_FORMATS = (".png", ".pdf", ".svg")
LISTED = 10  # positions in the table
FILE_WIDTH = 100  # columns where there is no terminal
BAD_INPUT = 2


def _show_version(wanted: bool) -> None:
    if wanted:
        from slmm import __version__

        print(f"slmm {__version__}")
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Crack initiation at 2D notches: will a crack start, at which load, and where."""


@app.command()
def initiation(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Plate, notches, material, load.")],
    method: Annotated[
        str | None, typer.Option(help=f"{', '.join(METHODS)}; else what the scene asks for.")
    ] = None,
    positions: Annotated[
        int | None, typer.Option(min=1, help="Number on each hole, in place of what the scene asks for.")
    ] = None,
    displacements: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Displacements of the uncracked part from a finite element model (.frd, .vtu, .xdmf and others), for "
            f"the methods {', '.join(ON_DISPLACEMENTS)}.",
        ),
    ] = None,
    average: Annotated[
        bool | None,
        typer.Option("--average", help="Compare the mean stress over the crack with the strength."),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            min=0.0005, max=0.5, help="Relative error of the failure index that method auto aims at."
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.nc", help="Write everything as netCDF.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw the result (.png, .pdf or .svg).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all positions as JSON.")] = False,
    database: Annotated[
        Path | None, typer.Option(metavar="FILE.nc", help="Crack-cell database in place of the shipped one.")
    ] = None,
) -> None:
    """Failure indices along the notches of a scene."""
    with _refusals():
        _check_target(output, RESULT_FORMATS, "-o")
        _check_target(plot, PICTURE_FORMATS, "--plot")
        from slmm.scene import read_scene

        scene = read_scene(scene_file)
        if displacements is not None and not displacements.is_file():
            raise ValueError(f"--displacements {displacements}: there is no such file")
        inputs = [scene_file, database, displacements, *(getattr(hole, "file", None) for hole in scene.holes)]
        _check_no_input(inputs, {"-o": output, "--plot": plot})
        with _progress() as progress, _word_on_compilation():
            from slmm import failure_indices

            result = failure_indices(
                scene,
                method=method,
                positions=positions,
                curves=True,
                database=database,
                average=average,
                tolerance=tolerance,
                displacements=displacements,
                progress=progress,
            )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with _whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                progress(1.0, "picture")
                from slmm.plot import plot_initiation

                figure = plot_initiation(scene, result, displacements)
                with _whole_file(plot) as unfinished:
                    figure.savefig(unfinished, format=plot.suffix[1:].lower(), dpi=120)
        from slmm import summary

        if as_json:
            print(summary.as_json(result))
        else:
            _print_result(result)
        if not summary.by_criticality(result):
            _say_error("no position has a failure index")
            raise typer.Exit(1)


@app.command()
def info(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE.nc]", help="A database; by default the shipped one.")
    ] = None,
) -> None:
    """What a crack-cell database holds, after its checksum has been verified."""
    with _refusals():
        from slmm.cell_file import read_cells
        from slmm.initiation.meta_model import shipped_database

        path = shipped_database() if file is None else file
        _print_database(path, read_cells(path))


def _errors() -> Console:
    return Console(stderr=True, highlight=False)


@contextlib.contextmanager
def _refusals() -> Iterator[None]:
    """Bad input ends with a sentence and code 2, a failed computation with a sentence and code 1."""
    try:
        yield
    except (ValueError, ImportError) as error:  # SceneError, DatabaseError; an extra that is not installed
        _say_error(str(error))
        raise typer.Exit(BAD_INPUT) from None
    except (RuntimeError, OSError, MemoryError) as error:
        if isinstance(error, typer.Exit):  # is a RuntimeError
            raise
        _say_error(str(error) or type(error).__name__)
        raise typer.Exit(1) from None


def _say_error(text: str) -> None:
    # no markup: [0] in a message is an index, not a style
    _errors().print(f"error: {text}", style="red", markup=False, soft_wrap=True)


def _check_target(path: Path | None, formats: tuple[str, ...], option: str) -> None:
    """Refuse before the long work what could not be written after it."""
    if path is None:
        return
    if path.suffix.lower() not in formats:
        raise ValueError(f"{option} {path}: the name must end with {' or '.join(formats)}")
    if path.is_dir():
        raise ValueError(f"{option} {path}: is a folder")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(f"{option} {path}: the folder {path.parent} is not writable")


def _check_no_input(inputs: list[Path | str | None], targets: dict[str, Path | None]) -> None:
    """A result must not take the place of what it is made from, as a notch's picture."""
    for option, target in targets.items():
        for file in inputs:
            if target is not None and file is not None and Path(file).resolve() == target.resolve():
                raise ValueError(f"{option} {target}: is an input of this run and would be overwritten")


@contextlib.contextmanager
def _whole_file(path: Path) -> Iterator[Path]:
    """A name to write to; the file takes its place only when it is complete."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


@contextlib.contextmanager
def _progress() -> Iterator[Callable[[float, str], None]]:
    """A progress bar on stderr, on a terminal only."""
    errors = _errors()
    if not errors.is_terminal:
        yield lambda fraction, text: None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    with Progress(*columns, console=errors, transient=True) as bar:
        task = bar.add_task("start", total=1.0)
        yield lambda fraction, text: bar.update(task, completed=fraction, description=text)


@contextlib.contextmanager
def _word_on_compilation() -> Iterator[None]:
    """Say once when a kernel is compiled: numba tells, and only when its cache has none."""
    from numba.core import event

    class Teller(event.Listener):
        told = False

        def on_start(self, event: event.Event) -> None:
            if not self.told:
                self.told = True
                print(
                    "compiling kernels, once: this first start takes up to a minute longer", file=sys.stderr
                )

        def on_end(self, event: event.Event) -> None:
            pass

    with event.install_listener("numba:compile", Teller()):
        yield


def _print_result(result: xr.Dataset) -> None:
    from slmm.summary import by_criticality, methods_used, position_record, status_counts, verdict

    ranked = by_criticality(result)
    n = result.sizes["position"]
    title = result.attrs.get("title") or "Failure indices"
    table = Table(
        title=f"{title} ({result.attrs['method']}): {min(LISTED, len(ranked))} most critical of {n} positions",
        box=SIMPLE_HEAD,
    )
    rows = [position_record(result, i) for i in ranked[:LISTED]]
    columns = [("x", "x\nmm", ".2f"), ("y", "y\nmm", ".2f"), ("failure_index", "failure\nindex", ".4f")]
    length = "crack length\nmm"
    if any(row["failure_index_error"] is not None for row in rows):
        columns.append(("failure_index_error", "error\n±", ".1g"))
        length = "crack\nlength\nmm"  # all in 80 columns
    columns += [("load_factor", "load\nfactor", ".4f"), ("crack_length", length, ".4g")]
    words = ["governed_by"]
    if len(methods_used(result)) > 1:
        words.append("used_method")
    table.add_column("no.", justify="right")
    for _, heading, _ in columns:
        table.add_column(heading, justify="right", no_wrap=True)
    for name in words:
        table.add_column(name.replace("_", " "))
    for i, row in zip(ranked, rows, strict=False):
        numbers = (_text(row[name], digits) for name, _, digits in columns)
        table.add_row(str(i), *numbers, *(str(row[name]) for name in words))
    console = Console(highlight=False, width=None if sys.stdout.isatty() else FILE_WIDTH)
    if ranked:
        console.print(table)
    console.print(verdict(result), soft_wrap=True, markup=False)
    counts = "; ".join(f"{count} {status}" for status, count in status_counts(result).items())
    console.print(f"Positions: {counts}.", soft_wrap=True, markup=False)


def _text(value: float | None, digits: str) -> str:
    return "-" if value is None else format(value, digits)


def _print_database(path: Path, cells: xr.Dataset) -> None:
    attrs = cells.attrs
    lines = {
        "file": f"{path}, {path.stat().st_size / 1e6:.2f} MB",
        "title": attrs.get("title", ""),
        "schema": attrs["schema"],
        "version": attrs.get("version", ""),
        "command": attrs.get("command", ""),
        "mesh": attrs.get("mesh", ""),
        "solver": attrs.get("solver", ""),
        "settings": _scalars(attrs.get("settings", "{}")),
        "checksum": f"{attrs['checksum']} (verified)",
    }
    for name in ("curvature", "poisson", "crack_length", "eta"):
        axis = cells[name]
        values = ", ".join(f"{value:.4g}" for value in axis.values)
        unit = "" if axis.attrs["units"] == "1" else f" {axis.attrs['units']}"
        lines[name] = f"{axis.size} values, {axis.attrs['long_name']}: {values}{unit}"
    powers = zip(cells["mode_direction"].values, cells["mode_p"].values, cells["mode_q"].values, strict=True)
    names = ", ".join(f"{('xi', 'eta')[int(d)]}:{_monomial(int(p), int(q))}" for d, p, q in powers)
    lines["modes"] = f"{cells.sizes['mode']} (direction:displacement): {names}"
    table = Table(show_header=False, box=None, padding=(0, 1))
    table.add_column()
    table.add_column(overflow="fold")
    for name, text in lines.items():
        table.add_row(name, str(text))
    Console(highlight=False, markup=False).print(table)


def _scalars(settings: str) -> str:
    """Settings that are no lists; those are the axes."""
    values = json.loads(settings)
    return ", ".join(f"{key} {value}" for key, value in values.items() if isinstance(value, int | float))


def _monomial(p: int, q: int) -> str:
    factors = [f"{x}^{n}" if n > 1 else x for x, n in (("xi", p), ("eta", q)) if n]
    return " ".join(factors) or "1"
