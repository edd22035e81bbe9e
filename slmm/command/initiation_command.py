"""``slmm initiation``: failure indices along the notches of a scene."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from slmm.command.solved_part import ResultFlags, is_scene, scene_of
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
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    from slmm.running.labelled import LabelledArrays
    from slmm.scene.scene import Scene

#: positions in the table
LISTED = 10
#: how files of sweeps may end
SWEEP_FORMATS = (*RESULT_FORMATS, ".csv")


def initiation(
    scene_file: Annotated[
        Path,
        typer.Argument(
            metavar="SCENE.toml|RESULTS",
            help="Plate, notches, material, load; or a solved plane finite element model (.frd, .vtu, .med and "
            "others), with its material.",
        ),
    ],
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
    field: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Which nodal data of --displacements or RESULTS they are, where names do not tell.",
        ),
    ] = None,
    material: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of RESULTS: PMMA, PS, Al2O3; else its constants.")
    ] = None,
    young: Annotated[
        float | None,
        typer.Option(metavar="E", help="Of RESULTS: Young's modulus, MPa; of a .frd file else by its .inp."),
    ] = None,
    poisson: Annotated[
        float | None, typer.Option(metavar="NU", help="Poisson's ratio, with --young.")
    ] = None,
    strength: Annotated[
        float | None, typer.Option(metavar="SIGMA_C", help="Of RESULTS: tensile strength, MPa.")
    ] = None,
    toughness: Annotated[
        float | None, typer.Option(metavar="K_IC", help="Of RESULTS: fracture toughness, MPa sqrt(m).")
    ] = None,
    plane_strain: Annotated[
        bool, typer.Option("--plane-strain", help="RESULTS are in plane strain in place of plane stress.")
    ] = False,
    step: Annotated[
        int | None,
        typer.Option(help="Which step of RESULTS, from 0; from the end if negative; else the last."),
    ] = None,
    symmetry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SIDE",
            help="RESULTS are half a part, mirrored at this side (left, right, bottom, top); may be given twice.",
        ),
    ] = None,
    average: Annotated[
        bool | None,
        typer.Option("--average", help="Compare the mean stress over the crack with the strength."),
    ] = None,
    criterion: Annotated[
        str | None,
        typer.Option(
            help="coupled, rankine, point, line, griffith: judges what a method finds that is no criterion itself."
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            min=0.0005, max=0.5, help="Relative error of the failure index that method auto aims at."
        ),
    ] = None,
    direction: Annotated[
        str | None,
        typer.Option(
            help="normal, or best: cracks turn into the direction that needs the least load (method boundary)."
        ),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="Many loads and materials at once: load.strain=0.01:0.1:10 (start:stop:count, by factors with :log), "
            "material.sigma_c=50,60,70; several of them are combined.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT.nc", help="Write everything as netCDF; with --vary also as .csv."
        ),
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
    with refusals():
        check_target(output, SWEEP_FORMATS if vary else RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        flags = ResultFlags(
            material, young, poisson, strength, toughness, plane_strain, step, field, tuple(symmetry or ())
        )
        scene = scene_of(scene_file, flags, displacements)
        if displacements is not None and not displacements.is_file():
            raise ValueError(f"--displacements {displacements}: there is no such file")
        inputs = [scene_file, database, displacements, *(getattr(hole, "file", None) for hole in scene.holes)]
        check_no_input(inputs, {"-o": output, "--plot": plot})
        if vary:
            for option, given in (("--plot", plot), ("--displacements", displacements)):
                if given is not None:
                    raise ValueError(f"{option}: goes with one scene; leave --vary out")
            if not is_scene(scene_file, flags):
                raise ValueError(
                    f"--vary {vary[0]}: varies keys of a scene; give SCENE.toml in place of RESULTS"
                )
            _sweep(
                scene,
                vary,
                output,
                as_json,
                method=method,
                positions=positions,
                database=database,
                average=average,
                tolerance=tolerance,
                criterion=criterion,
                direction=direction,
            )
            return
        with progress_bar() as progress, word_on_compilation():
            from slmm.initiation.failure import failure_arrays

            result = failure_arrays(
                scene,
                method=method,
                positions=positions,
                curves=True,
                database=database,
                average=average,
                criterion=criterion,
                tolerance=tolerance,
                displacements=displacements,
                progress=progress,
                field=field if is_scene(scene_file, flags) else None,
                direction=direction,
            )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.dataset().to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                progress(1.0, "picture")
                from slmm.pictures.figure_file import write_figure
                from slmm.pictures.initiation import plot_initiation

                model: object = displacements
                if displacements is not None and field is not None:
                    from slmm.results.results import read_displacements

                    model = read_displacements(displacements, field=field)
                figure = plot_initiation(scene, result.dataset(), model)
                write_figure(figure, plot)
        from slmm.initiation import summary
        from slmm.initiation.verdict import conclude

        if as_json:
            print(summary.as_json(result))
        else:
            _print_result(result)
        if not summary.by_criticality(result):
            say_error("no position has a failure index")
            raise typer.Exit(1)
        if conclude(result).is_open:
            raise typer.Exit(1)


def _sweep(scene: Scene, vary: list[str], output: Path | None, as_json: bool, **asked: Any) -> None:
    """All combinations of what keys take, as a table, JSON or a file."""
    from slmm.scene.variants import parsed

    keys = [parsed(text) for text in vary]
    if twice := [key for k, (key, _) in enumerate(keys) if key in dict(keys[:k])]:
        raise ValueError(f"--vary {twice[0]}: comes twice; give all its values at once, as {twice[0]}=1,2,3")
    from slmm.command import sweep_table

    with progress_bar() as progress, word_on_compilation():
        from slmm.initiation.sweep import sweep_arrays

        result = sweep_arrays(scene, dict(keys), progress=progress, **asked)
        result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
        if output is not None:
            with whole_file(output) as unfinished:
                if output.suffix.lower() == ".csv":
                    sweep_table.write_csv(result, unfinished)
                else:
                    result.dataset().to_netcdf(unfinished, engine="netcdf4")
    if as_json:
        print(sweep_table.as_json(result))
    else:
        sweep_table.print_sweep(result)
    if not sweep_table.is_answered(result):
        raise typer.Exit(1)


def _print_result(result: LabelledArrays) -> None:
    from slmm.initiation.summary import by_criticality, methods_used, position_record, status_counts, verdict
    from slmm.initiation.verdict import conclude, remedy

    ranked = by_criticality(result)
    n = result.sizes["position"]
    title = result.attrs.get("title") or "Failure indices"
    out = console()
    table = Table(
        title=f"{title} ({result.attrs['method']}): {min(LISTED, len(ranked))} most critical of {n} positions",
        box=table_box(out),
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
        numbers = (number_text(row[name], digits) for name, _, digits in columns)
        table.add_row(str(i), *numbers, *(str(row[name]) for name in words))
    if ranked:
        out.print(table)
    out.print(verdict(result), soft_wrap=True)
    counts = "; ".join(f"{count} {status}" for status, count in status_counts(result).items())
    out.print(f"Positions: {counts}.", soft_wrap=True)
    if (helps := remedy(result)) and not conclude(result).is_open:  # which says it, too
        out.print(f"To have values at the others, {helps}.", soft_wrap=True)
    if "cost" in result.attrs:
        out.print(f"Cost: {result.attrs['cost']}.", soft_wrap=True)
