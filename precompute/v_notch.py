"""Table of rounded V-notches for matched asymptotics (thesis section 3.3.4.3), by finite elements.

Near a rounded V-notch that is small in its part, the part is an unbounded body loaded by the first symmetric term of
Williams' series of the sharp notch. What then depends on the opening angle and the distance over the root's size only
is solved once here: the stress on the bisector and the energy that a crack on it releases. Lengths are measured in
half widths of the root, radius cos(opening/2), the distance of the tangent points from the bisector: in this unit
everything is smooth up to the straight edge, where the arc shrinks to a point.

Sharp notches are solved on meshes of the same kind. Their release coefficient is known exactly
(`slmm.mechanics.williams.release_coefficient`); stored in the table, theirs shows how good the meshes are.

Element sizes grow in proportion to the distance from the notch, so that every element end on the bisector is the tip
of a crack in a mesh that is fine for its length. The energy at a tip is then wrong by a fixed share of an element and
is extrapolated from two meshes.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
import xarray as xr

from precompute.provenance import provenance
from precompute.store import rounded
from precompute.v_notch_solution import NotchResult, solve_notch, straight_edge
from precompute.v_notch_spec import NotchSpec
from slmm.command.terminal import Application, check_target, console, progress_bar, refusals
from slmm.initiation.v_notch_table import LAYOUT, SCHEMA
from slmm.running.labelled import labelled
from slmm.running.model_file import checksum
from slmm.running.whole_file import whole_file

DEFAULT_OUTPUT = Path("models/v_notches.nc")


def assemble(spec: NotchSpec, results: list[NotchResult]) -> xr.Dataset:
    """The table from the results of all opening angles, closed by the straight edge."""
    length = results[0].length
    results = [*results, straight_edge(length)]
    # results are good to 1e-4; what lies beyond 24 bits is round-off
    release, stress, sharp_release = (
        rounded(np.array(values), 24)
        for values in zip(*((r.release, r.stress, r.sharp_release) for r in results), strict=True)
    )
    dataset = labelled(
        {
            "release": (
                LAYOUT["release"],
                release,
                "1",
                "E' G_inc/(k_1^2 l^(2 lambda_1 - 1)) over a/l at a rounded notch",
            ),
            "stress": (
                LAYOUT["stress"],
                stress,
                "1",
                "stress on the bisector over k_1 l^(lambda_1 - 1) at a rounded notch",
            ),
            "sharp_release": (
                LAYOUT["sharp_release"],
                sharp_release,
                "1",
                "E' B of a sharp notch on a mesh of the same kind, singular fields only",
            ),
        },
        {
            "opening": (np.radians([*spec.openings, 180.0]), "rad", "opening angle"),
            "length": (length, "1", "crack length or distance from the root over l = radius cos(opening/2)"),
            "component": (["across", "along"], "1", "direction of the normal stress to the bisector"),
            "mode": (["symmetric", "antisymmetric"], "1", "mode of the far field"),
        },
        title="Rounded V-notches under the first symmetric term of Williams' series",
        schema=SCHEMA,
        source="precompute.v_notch: matched asymptotics, thesis section 3.3.4.3",
        settings=json.dumps(asdict(spec)),
        mesh=f"structured 8-node quadrilaterals, 2 x 2 points; sizes {spec.step} and {spec.step / 2} of the "
        "distance, energies extrapolated",
        **provenance("python", "-m", "precompute.v_notch"),
    )
    dataset.attrs["checksum"] = checksum(dataset)
    return dataset


def write(dataset: xr.Dataset, path: Path) -> None:
    """Write the file whole or not at all."""
    with whole_file(path) as unfinished:
        dataset.to_netcdf(
            unfinished, engine="netcdf4", encoding={name: {"zlib": True, "shuffle": True} for name in LAYOUT}
        )


app = Application(add_completion=False)


@app.command()
def v_notches(
    output: Annotated[Path, typer.Option("-o", "--output", help="The table to write.")] = DEFAULT_OUTPUT,
) -> None:
    """Solve rounded V-notches of all opening angles once and write them as a netCDF table."""
    with refusals():
        check_target(output, (".nc",), "-o")
        spec = NotchSpec()
        notches = []
        with progress_bar() as progress:
            for k, opening in enumerate(np.radians(spec.openings)):
                progress(k / len(spec.openings), f"V-notch {k + 1} of {len(spec.openings)}")
                notches.append(solve_notch(opening, spec))
        write(assemble(spec, notches), output)
        console().print(f"{output}: {output.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    app()
