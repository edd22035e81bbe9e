"""The one-time precompute command."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from precompute.spec import SweepSpec, read_spec
from precompute.store import assemble, write
from precompute.sweep import run_sweep

app = typer.Typer(add_completion=False)
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
    errors = Console(stderr=True)
    try:
        spec = read_spec(spec_file) if spec_file else SweepSpec()
        if poisson is not None:
            title = f"Crack cells for the effective Poisson's ratio {poisson:g}"
            spec = SweepSpec.model_validate(spec.model_dump() | {"poisson": (poisson,), "title": title})
        if output.is_dir():
            raise ValueError(f"{output}: is a folder; name the file to write")
        parts = output.with_name(f"{output.name}.{spec.fingerprint}.parts")
        parts.mkdir(parents=True, exist_ok=True)
    except (ValueError, OSError) as error:
        errors.print(f"[red]error:[/] {error}", highlight=False)
        raise typer.Exit(2) from None
    columns = (
        TextColumn("crack cells"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=errors) as bar:
        task = bar.add_task("cells", total=None)
        run_sweep(spec, parts, workers, lambda done, of: bar.update(task, completed=done, total=of))
    write(assemble(spec, parts), output, parts)
    shutil.rmtree(parts)
    Console().print(f"{output}: {output.stat().st_size / 1e6:.1f} MB")
