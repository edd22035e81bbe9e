"""``slmm forces``: configurational forces of a finite element result, and its crack tips."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from slmm.command.terminal import (
    MESH_FORMATS,
    PICTURE_FORMATS,
    check_no_input,
    check_target,
    console,
    number_text,
    progress_bar,
    refusals,
    table_box,
    word_on_compilation,
)
from slmm.running.encoding import has
from slmm.running.whole_file import whole_file

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from slmm.mechanics.element_results import ElementResults


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
        numbers = [number_text(record[name], digits) for name, digits in columns.items()]
        table.add_row(
            str(record["tip"]), *numbers, *(number_text(record["kink"][name], ".1f") for name in criteria)
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
