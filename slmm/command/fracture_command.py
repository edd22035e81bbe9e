"""``slmm fracture``: the fracture process of a part, its curve F(u) and its tensile toughness."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slmm.command.fracture_table import print_fracture
from slmm.command.terminal import (
    PICTURE_FORMATS,
    RESULT_FORMATS,
    check_no_input,
    check_target,
    check_target_folder,
    progress_bar,
    refusals,
    say_error,
    word_on_compilation,
)
from slmm.running.whole_file import NotWrittenError, whole_file

if TYPE_CHECKING:
    import xarray as xr

    from slmm.running.progress import Progress
    from slmm.scene.scene import Scene


def fracture(
    scene_file: Annotated[
        Path, typer.Argument(metavar="SCENE.toml", help="Part, holes, cracks, material, load.")
    ],
    increment: Annotated[
        str,
        typer.Option(
            metavar="MM|auto", help="Length by which cracks grow in a step; auto: as their path asks."
        ),
    ] = "auto",
    engine: Annotated[
        str,
        typer.Option(
            metavar="boundary|fem",
            help="What solves the part: boundary integrals, or a mesh for every increment.",
        ),
    ] = "boundary",
    initiation: Annotated[
        str,
        typer.Option(
            metavar="point|slmm+ac|coupled",
            help="What starts cracks at surfaces: the stress at a distance, crack cells, or trial cracks.",
        ),
    ] = "point",
    tolerance: Annotated[
        float, typer.Option(min=1e-6, max=0.5, help="Relative error of U_T that is aimed at.")
    ] = 0.01,
    direction: Annotated[
        str,
        typer.Option(
            metavar="CRITERION",
            help="Which way cracks grow: MTS (largest tangential stress), MERR (largest energy release rate), "
            "'local symmetry' (no mode II), J (along its vector), GMTS (as MTS at a distance, with the stress T).",
        ),
    ] = "MTS",
    critical_distance: Annotated[
        float | None, typer.Option(metavar="MM", help="That distance of GMTS; else the material's.")
    ] = None,
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
        Path | None, typer.Option(metavar="OUT.png", help="Draw cracks and curves (.png, .pdf or .svg).")
    ] = None,
    animate: Annotated[
        Path | None,
        typer.Option(metavar="OUT.gif", help="Draw them as they come (.gif, or .mp4 where ffmpeg is there)."),
    ] = None,
    magnify: Annotated[
        float | None,
        typer.Option(
            metavar="FACTOR",
            help="Draw displacements so many times as large, and cracks open: for --plot, --animate.",
        ),
    ] = None,
    vtk: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Write displacements and stress of each step for ParaView (fracture.pvd)."
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", help="Go on where a killed simulation was: needs -o, beside which its journal lies."
        ),
    ] = False,
    from_step: Annotated[
        int | None,
        typer.Option(
            metavar="K", min=0, help="With --resume: behind step K of the journal; what follows is dropped."
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print all steps, curves and cracks as JSON.")
    ] = False,
) -> None:
    """Cracks that grow, stop and start anew until the part is severed: F(u) and the tensile toughness."""
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        check_target_folder(vtk, "--vtk")
        if animate is not None:
            from slmm.pictures.fracture_animation import FORMATS, check_can_animate

            check_target(animate, FORMATS, "--animate")
            check_can_animate(animate)
        if magnify is not None and not 0 < magnify < math.inf:
            raise ValueError(f"--magnify {magnify:g}: must be a positive number")
        if magnify is not None and plot is None and animate is None:
            raise ValueError(f"--magnify {magnify:g}: needs --plot or --animate, which it is for")
        if resume and output is None:
            raise ValueError("--resume: needs -o, beside which the journal lies")
        if from_step is not None and not resume:
            raise ValueError(f"--from-step {from_step}: needs --resume, which it is for")
        journal = None if output is None else output.with_suffix(".jsonl")
        length = _increment(increment)
        from slmm.scene.scene import read_scene

        scene = read_scene(scene_file)
        inputs = [scene_file, *(getattr(hole, "file", None) for hole in scene.holes)]
        check_no_input(inputs, {"-o": output, "--plot": plot, "--animate": animate, "the journal": journal})
        with progress_bar() as progress, word_on_compilation(), _word_of_journal(journal):
            from slmm.fracture.simulation import simulate

            result = simulate(
                scene,
                length,
                initiation,
                engine,
                tolerance,
                direction=direction,
                critical_distance=critical_distance,
                first_length=first_length,
                largest_displacement=largest_displacement,
                journal=journal,
                resume=resume,
                from_step=from_step,
                progress=progress,
            )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            _draw(scene, result, plot, animate, magnify or 0.0, progress)
            if vtk is not None:
                from slmm.fracture.field_series import write_series

                write_series(scene, result, vtk, progress=progress)
        if as_json:
            from slmm.fracture.fracture_summary import as_json as in_json

            print(in_json(result))
        else:
            print_fracture(result)
        if result.attrs["outcome"].startswith("failed"):
            say_error(f"the simulation {result.attrs['outcome']}")
            raise typer.Exit(1)


def _draw(
    scene: Scene,
    result: xr.Dataset,
    plot: Path | None,
    animate: Path | None,
    magnified: float,
    progress: Progress,
) -> None:
    """The pictures that are asked for."""
    if plot is not None:
        progress(1.0, "picture")
        from slmm.pictures.figure_file import write_figure
        from slmm.pictures.fracture import plot_fracture

        write_figure(plot_fracture(scene, result, magnified), plot)
    if animate is not None:
        from slmm.pictures.fracture_animation import animate_fracture

        animate_fracture(scene, result, animate, magnified, progress)


@contextmanager
def _word_of_journal(journal: Path | None) -> Iterator[None]:
    """Say how a simulation goes on that is interrupted, or ends with an error that is no refusal."""
    try:
        yield
    except ValueError:
        raise
    except BaseException as error:
        if journal is None or not journal.is_file():
            raise
        says = f"with --resume it goes on with what is in {journal}"
        if isinstance(error, NotWrittenError):
            raise NotWrittenError(f"{error}; {says}") from error
        say_error(f"stopped; {says}")
        raise


def _increment(text: str) -> float | str:
    """What --increment says."""
    if text == "auto":
        return text
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"--increment {text}: must be a length in mm, or auto") from None
