"""The command line: ``slmm initiation``, ``slmm forces``, ``slmm optimize``, ``slmm info``.

Libraries that take long to import are imported where they are needed, so that help and refusals come at once.
"""

from __future__ import annotations

import json
import math
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from slmm.command.optimize_command import optimize
from slmm.command.terminal import (
    MESH_FORMATS,
    PICTURE_FORMATS,
    RESULT_FORMATS,
    Application,
    check_no_input,
    check_target,
    console,
    progress_bar,
    refusals,
    say_error,
    table_box,
    word_on_compilation,
)
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS
from slmm.running.encoding import has
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from slmm.mechanics.element_results import ElementResults

app = Application(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)
app.add_typer(optimize, name="optimize")

LISTED = 10  # positions in the table


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
    field: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Which nodal data of --displacements they are, where names do not tell."
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
    with refusals():
        check_target(output, RESULT_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        from slmm.scene.scene import read_scene

        scene = read_scene(scene_file)
        if displacements is not None and not displacements.is_file():
            raise ValueError(f"--displacements {displacements}: there is no such file")
        inputs = [scene_file, database, displacements, *(getattr(hole, "file", None) for hole in scene.holes)]
        check_no_input(inputs, {"-o": output, "--plot": plot})
        with progress_bar() as progress, word_on_compilation():
            from slmm import failure_indices

            result = failure_indices(
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
                field=field,
            )
            result.attrs["command"] = shlex.join(["slmm", *sys.argv[1:]])
            if output is not None:
                with whole_file(output) as unfinished:
                    result.to_netcdf(unfinished, engine="netcdf4")
            if plot is not None:
                progress(1.0, "picture")
                from slmm.pictures.figure_file import write_figure
                from slmm.pictures.initiation import plot_initiation

                model: object = displacements
                if displacements is not None and field is not None:
                    from slmm.results.results import read_displacements

                    model = read_displacements(displacements, field=field)
                figure = plot_initiation(scene, result, model)
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


@app.command()
def forces(
    result_file: Annotated[
        Path,
        typer.Argument(
            metavar="MESH_WITH_RESULTS",
            help="Displacements and, unless elasticity is known, stresses and energies (.frd, .vtu, .xdmf and others).",
        ),
    ],
    inp: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.inp",
            help="Element types and materials of a .frd file; by default the file of the same name beside it.",
        ),
    ] = None,
    step: Annotated[int, typer.Option(help="Which step of the file, from 0; from the end if negative.")] = -1,
    field: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Which nodal data are the displacements, where names do not tell."),
    ] = None,
    young: Annotated[
        float | None,
        typer.Option(metavar="E", help="Young's modulus, MPa: stresses follow from the displacements."),
    ] = None,
    poisson: Annotated[
        float | None, typer.Option(metavar="NU", help="Poisson's ratio, with --young.")
    ] = None,
    plane_stress: Annotated[
        bool, typer.Option("--plane-stress", help="With --young: plane stress in place of plane strain.")
    ] = False,
    method: Annotated[
        str | None, typer.Option(help="linear (small strains), mbf or dbf; else what fits the file.")
    ] = None,
    reduced: Annotated[
        bool, typer.Option("--reduced", help="Elements whose type no file tells have reduced integration.")
    ] = False,
    thickness: Annotated[
        float | None, typer.Option(help="Of plane models, mm; else what the .inp file says, or 1.")
    ] = None,
    contours: Annotated[int, typer.Option(min=1, help="Number of domains around each crack tip.")] = 5,
    symmetry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="x|y",
            help="Half model: the direction in which nothing moves on its line of symmetry, or that line, as y=20; a "
            "second one for a quarter. All results are those of the whole part.",
        ),
    ] = None,
    tip: Annotated[
        list[str] | None,
        typer.Option(
            metavar="X,Y[,ANGLE]",
            help="A crack tip that is not found by itself, mm, as of a narrow notch; with the direction in which it "
            "points, degrees, if it is not the middle between the faces. May be given several times.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.vtu", help="Write mesh and nodal forces for ParaView."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw forces and crack tips (.png, .pdf or .svg).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the crack tips as JSON.")] = False,
) -> None:
    """Configurational forces of a finite element result, J, K_I and K_II at its crack tips, and where they run."""
    with refusals():
        check_target(output, MESH_FORMATS, "-o")
        check_target(plot, PICTURE_FORMATS, "--plot")
        check_no_input([result_file, inp], {"-o": output, "--plot": plot})
        if (young is None) != (poisson is None):
            raise ValueError("--young and --poisson belong together: give both, or none")
        tips = [_tip_place(text) for text in tip or ()]
        with progress_bar() as progress, word_on_compilation():
            progress(0.0, "reading")
            from slmm.fracture.configurational_forces import nodal_configurational_forces
            from slmm.fracture.loading import crack_tip_loading
            from slmm.fracture.symmetry import whole_part
            from slmm.mechanics.elasticity import Elasticity
            from slmm.pictures.figure_file import write_figure
            from slmm.pictures.forces import plot_forces
            from slmm.results.read_results import read_element_results
            from slmm.results.vtu import write_vtu

            elasticity = None
            if young is not None and poisson is not None:
                elasticity = Elasticity(young, poisson, "plane stress" if plane_stress else "plane strain")
            results = read_element_results(
                result_file, step, elasticity, method, reduced, thickness, inp, field
            )
            progress(0.4, "forces")
            whole = whole_part(results, symmetry or ())
            found = nodal_configurational_forces(
                whole.points, whole.cells, whole.u, whole.stress, whole.energy, whole.method, whole.thickness
            )
            if plot is not None and results.dimension != 2:
                raise ValueError(f"--plot {plot}: pictures are drawn of plane models; -o writes a .vtu file")
            progress(0.6, "crack tips")
            loading = None
            if results.dimension == 2:
                loading = crack_tip_loading(results, contours, found, symmetry or (), tips)
            if output is not None:
                with whole_file(output) as unfinished:
                    write_vtu(unfinished, whole, found)
            if plot is not None and loading is not None:
                progress(0.8, "picture")
                figure = plot_forces(whole, found, loading)
                write_figure(figure, plot)
        from slmm.fracture import tip_summary

        if as_json:
            print(tip_summary.as_json(whole, found, loading))
        else:
            _print_forces(whole, found, loading)


@app.command()
def info(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE.nc]", help="A database; by default the shipped one.")
    ] = None,
) -> None:
    """What a crack-cell database holds, after its checksum has been verified."""
    with refusals():
        from slmm.initiation.meta_model import shipped_database
        from slmm.running.cell_file import read_cells

        path = shipped_database() if file is None else file
        _print_database(path, read_cells(path))


def _print_result(result: xr.Dataset) -> None:
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
        numbers = (_text(row[name], digits) for name, _, digits in columns)
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


def _print_forces(results: ElementResults, forces: np.ndarray, loading: xr.Dataset | None) -> None:
    from slmm.fracture.tip_summary import interface_force, tip_record, tip_sentence

    out = console()
    elements = ", ".join(f"{len(nodes)} {name}" for name, nodes in results.cells.items())
    image = loading.attrs["symmetry"] if loading is not None else ""
    out.print(
        f"{len(results.points)} nodes, {elements}; stresses from {results.source}; method {results.method}"
        f"{f'; with the image by symmetry {image}' if image else ''}.",
        soft_wrap=True,
        markup=False,
    )
    if (force := interface_force(results, forces)) is not None:
        vector = ", ".join(f"{component:.5g}" for component in force)
        out.print(f"Material force on the interfaces: ({vector}) N.", soft_wrap=True)
    if loading is None:
        out.print(
            "Crack tips are looked for in plane models only; -o writes the nodal forces.", soft_wrap=True
        )
        return
    if remark := loading.attrs["remark"]:
        out.print(remark, soft_wrap=True, markup=False)
    if not loading.sizes["tip"]:
        return
    columns = {
        "x": ".2f",
        "y": ".2f",
        "angle": ".1f",
        "G": ".5g",
        "J_across": ".5g",
        "K_I": ".4g",
        "K_II": ".4g",
    }
    root = "MPa√mm" if has(out.encoding, "√") else "MPa\nsqrt(mm)"  # as narrow
    units = {"mm": "mm", "degree": "deg", "N/mm": "N/mm", "MPa sqrt(mm)": root}
    table = Table("tip", title="Crack tips", box=table_box(out), pad_edge=False)
    for name in columns:
        heading = f"{name.replace('_', ' ')}\n{units[loading[name].attrs['units']]}"
        table.add_column(heading, justify="right", no_wrap=True)
    criteria = [str(name) for name in loading.criterion.values]
    for name in criteria:
        table.add_column(f"{name}\ndeg", justify="right", no_wrap=True)
    records = [tip_record(loading, k) for k in range(loading.sizes["tip"])]
    for record in records:
        numbers = [_text(record[name], digits) for name, digits in columns.items()]
        table.add_row(
            str(record["tip"]), *numbers, *(_text(record["kink"][name], ".1f") for name in criteria)
        )
    out.print(table)
    for k in range(len(records)):
        out.print(tip_sentence(loading, k), soft_wrap=True)


def _tip_place(text: str) -> list[float]:
    """What --tip says: x, y and perhaps an angle."""
    try:
        place = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        place = []
    if len(place) not in (2, 3) or not all(map(math.isfinite, place)):
        raise ValueError(f"--tip {text}: must be X,Y in mm, or X,Y,ANGLE with the direction in degrees")
    return place


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
    console().print(table)


def _scalars(settings: str) -> str:
    """Settings that are no lists; those are the axes."""
    values = json.loads(settings)
    return ", ".join(f"{key} {value}" for key, value in values.items() if isinstance(value, int | float))


def _monomial(p: int, q: int) -> str:
    factors = [f"{x}^{n}" if n > 1 else x for x, n in (("xi", p), ("eta", q)) if n]
    return " ".join(factors) or "1"
