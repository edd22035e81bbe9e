"""The command line: ``slmm initiation``, ``fracture``, ``forces``, ``optimize``, ``info``, each from its own module.

Libraries that take long to import are imported there where they are needed, so that help and refusals come at once.
"""

from __future__ import annotations

from typing import Annotated

import typer

from slmm.command.database_command import info
from slmm.command.forces_command import forces
from slmm.command.fracture_command import fracture
from slmm.command.initiation_command import initiation
from slmm.command.optimize_command import optimize
from slmm.command.terminal import Application
from slmm.command.toughness_command import toughness

app = Application(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


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
    """Crack initiation at 2D notches and the fracture that follows: will a crack start, at which load, where to."""


app.command()(initiation)
app.command()(fracture)
app.command()(forces)
app.command()(info)
optimize.command()(toughness)
app.add_typer(optimize, name="optimize")
