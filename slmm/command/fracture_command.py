"""``slmm fracture``: the fracture process of a part, its curve F(u) and its tensile toughness."""

from __future__ import annotations

import shlex
import sys
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from slmm.command.terminal import (
    PICTURE_FORMATS,
    RESULT_FORMATS,
    check_no_input,
    check_target,
    console,
    number_text,
    progress_bar,
    refusals,
    say_error,
    table_box,
    word_on_compilation,
)
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    import xarray as xr


def fracture(
    scene_file: Annotated[
        Path, typer.Argument(metavar="SCENE.toml", help="Part, holes, cracks, material, load.")
    ],
    increment: Annotated[
        str, typer.Option(metavar="MM|auto", help="Length by which cracks grow in a step.")
    ] = "auto",
    engine: Annotated[
        str,
        typer.Option(
            metavar="boundary|fem",
            help="What solves the part: boundary integrals, or a mesh for every increment.",
        ),
    ] = "boundary",
    initiation: Annotated[str, typer.Option(help="What starts cracks at surfaces: point.")] = "point",
    tolerance: Annotated[
        float, typer.Option(min=1e-6, max=0.5, help="Relative error of U_T that is aimed at.")
    ] = 0.01,
    first_length: Annotated[
        float | None, typer.Option(metavar="MM", help="Length of a crack that starts; else an increment.")
    ] = None,
    largest_displacement: Annotated[
        float | None, typer.Option(metavar="MM", help="Where to stop; else when the part is severed.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.nc", help="Write everything as netCDF.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw cracks and curve (.png, .pdf or .svg).")
    ] = None,
) -> None:
    """Cracks that grow, stop and start anew until the part is severed: F(u) and the tensile toughness."""
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        length = _increment(increment)
        from slmm.scene.scene import read_scene

        scene = read_scene(scene_file)
        inputs = [scene_file, *(getattr(hole, "file", None) for hole in scene.holes)]
        check_no_input(inputs, {"-o": output, "--plot": plot})
        with progress_bar() as progress, word_on_compilation():
            from slmm.fracture.simulation import simulate

            result = simulate(
                scene,
                length,
                initiation,
                engine,
                tolerance,
                first_length=first_length,
                largest_displacement=largest_displacement,
                progress=progress,
            )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                progress(1.0, "picture")
                from slmm.pictures.figure_file import write_figure
                from slmm.pictures.fracture import plot_fracture

                write_figure(plot_fracture(scene, result), plot)
        _print_result(result)
        if result.attrs["outcome"].startswith("failed"):
            say_error(f"the simulation {result.attrs['outcome']}")
            raise typer.Exit(1)


def _increment(text: str) -> float | str:
    """What --increment says."""
    if text == "auto":
        return text
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"--increment {text}: must be a length in mm, or auto") from None


def _print_result(result: xr.Dataset) -> None:
    """The runs of each crack, and what came of it all."""
    out = console()
    table = Table(title=result.attrs["title"] or "Fracture", box=table_box(out))
    for heading in (
        "steps",
        "crack",
        "from x\nmm",
        "from y\nmm",
        "to x\nmm",
        "to y\nmm",
        "u\nmm",
        "F before\nN",
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("then")
    for first, last in _runs(result):
        crack = int(result.tip[first])
        x, y, step = (result[name].values[crack] for name in ("crack_x", "crack_y", "crack_step"))
        at = int((step == first).argmax())
        start = at if result.event.values[first] == "start" else _neighbour(step, at)
        where = (x[start], y[start], float(result.x[last]), float(result.y[last]))
        u = float(result.u_load[first])
        table.add_row(
            f"{first + 1} to {last + 1}" if last > first else str(first + 1),
            str(crack),
            *(number_text(value, ".2f") for value in where),
            number_text(u, ".4f"),
            number_text(float(result.stiffness[first]) * u, ".1f"),
            str(result.arrested_by.values[last]) or "goes on",
        )
    if result.sizes["step"]:
        out.print(table)
    error = float(result.U_T_error)
    told = f" (error ± {error:.2g} mJ)" if error == error else ""
    out.print(
        f"Tensile toughness U_T = {float(result.U_T):.5g} mJ{told}; {result.attrs['outcome']}.",
        soft_wrap=True,
    )
    if count := result.attrs["competing_events"]:
        out.print(
            f"In {count} of {result.sizes['step']} steps another event was within 0.5 % of the load: the path may fork"
            " there.",
            soft_wrap=True,
        )
    if slid := result.attrs["sliding_tips"]:
        out.print(
            f"In {slid} steps a closed crack would have slid on first, which is not simulated: U_T is too high.",
            soft_wrap=True,
        )
    if touches := int(result.touches.sum()):
        contact = result.attrs["contact"]
        says = "overlap, and nothing holds them" if contact == "none" else f"hold each other, {contact}"
        out.print(f"In {touches} steps faces of cracks {says}.", soft_wrap=True)


def _runs(result: xr.Dataset) -> list[tuple[int, int]]:
    """First and last steps of stretches in which one crack grows at one displacement."""
    crack, u = result.tip.values, result.u_load.values
    first = [k for k in range(len(crack)) if k == 0 or crack[k] != crack[k - 1] or u[k] != u[k - 1]]
    return [(a, b - 1) for a, b in pairwise([*first, len(crack)])]


def _neighbour(step: list[float], at: int) -> int:
    """The point of a crack that was there before the one ``at`` which it grew to."""
    return at - 1 if at > 0 and step[at - 1] < step[at] else at + 1
