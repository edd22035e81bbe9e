"""``slmm info``: what a crack-cell database holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from slmm.command.terminal import console, refusals

if TYPE_CHECKING:
    from slmm.running.labelled import LabelledArrays


def info(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE.nc]", help="A database; by default the shipped one.")
    ] = None,
) -> None:
    """What a crack-cell database holds, after its checksum has been verified."""
    with refusals():
        from slmm.running.cell_file import read_cells, shipped_database

        path = shipped_database() if file is None else file
        _print_database(path, read_cells(path))


def _print_database(path: Path, cells: LabelledArrays) -> None:
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
        lines[name] = f"{len(axis.values)} values, {axis.attrs['long_name']}: {values}{unit}"
    powers = zip(cells["mode_direction"].values, cells["mode_p"].values, cells["mode_q"].values, strict=True)
    names = ", ".join(f"{('xi', 'eta')[int(d)]}:{_monomial(int(p), int(q))}" for d, p, q in powers)
    lines["modes"] = f"{cells.sizes['mode']} (direction:displacement): {names}"
    table = Table(show_header=False, box=None, padding=(0, 1))
    table.add_column()
    table.add_column(overflow="fold")
    for name, text in lines.items():
        table.add_row(name, str(text))
    console().print(table)


def _scalars(settings: str) -> str:
    """Settings that are no lists; those are the axes."""
    values = json.loads(settings)
    return ", ".join(f"{key} {value}" for key, value in values.items() if isinstance(value, int | float))


def _monomial(p: int, q: int) -> str:
    factors = [f"{x}^{n}" if n > 1 else x for x, n in (("xi", p), ("eta", q)) if n]
    return " ".join(factors) or "1"
