"""The one-time precompute command."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from precompute.spec import SweepSpec, read_spec
from precompute.store import assemble, write
from precompute.sweep import run_sweep
from slmm.command.terminal import Application, console, progress_bar, refusals, say_error
from slmm.running.input_file import shown
from slmm.running.whole_file import NotWrittenError

app = Application(add_completion=False)
DEFAULT_OUTPUT = Path("models/cells.nc")


@app.command()
def precompute(
    spec_file: Annotated[
        Path | None,
        typer.Argument(metavar="[SPEC.toml]", help="Settings of the sweep; without it the default."),
    ] = None,
    poisson: Annotated[
        float | None,
        typer.Option(help="Only this effective Poisson's ratio: nu, or nu/(1 - nu) in plane strain."),
    ] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="The database to write.")] = DEFAULT_OUTPUT,
    workers: Annotated[int, typer.Option(min=1, help="Number of processes.")] = os.cpu_count() or 1,
) -> None:
    """Solve all crack cells once and write them as a netCDF database.

    Killed at any moment, the same command resumes and ends with the same file.
    """
    with refusals():
        spec = read_spec(spec_file) if spec_file else SweepSpec()
        if poisson is not None:
            title = f"Crack cells for the effective Poisson's ratio {poisson:g}"
            spec = SweepSpec.model_validate(spec.model_dump() | {"poisson": (poisson,), "title": title})
        parts = _parts_folder(output, spec)
        with _word_of_parts(parts):
            with progress_bar() as progress:
                run_sweep(spec, parts, workers, progress)
            write(assemble(spec, parts), output, parts)
        shutil.rmtree(parts)
        console().print(f"{output}: {output.stat().st_size / 1e6:.1f} MB")


def _parts_folder(output: Path, spec: SweepSpec) -> Path:
    """The folder of the results that are there, which is made if it is not."""
    if os.path.isdir(output):
        raise ValueError(f"-o {shown(output)}: is a folder; name the file to write")
    parts = output.with_name(f"{output.name}.{spec.fingerprint}.parts")
    try:
        parts.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        says = error.strerror or str(error)
        raise ValueError(f"-o {shown(output)}: a folder beside it cannot be made: {says}") from error
    return parts


@contextlib.contextmanager
def _word_of_parts(parts: Path) -> Iterator[None]:
    """Say where results lie when the work ends before they are joined; a folder without any is removed."""
    try:
        yield
    except BaseException as error:
        if not any(parts.iterdir()):
            parts.rmdir()
            raise
        says = f"the same command goes on with what is in {shown(parts)}"
        if isinstance(error, NotWrittenError):
            raise NotWrittenError(f"{error}; {says}") from error
        say_error(f"stopped; {says}")
        raise
