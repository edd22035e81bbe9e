"""From the parts of a sweep to the netCDF database."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from precompute.crack_cell import HALF_HEIGHT, right_edge
from precompute.provenance import provenance
from precompute.spec import SweepSpec
from precompute.sweep import read_part
from slmm.running.cell_file import LAYOUT, SCHEMA
from slmm.running.labelled import labelled
from slmm.running.model_file import checksum
from slmm.running.whole_file import whole_file


def assemble(spec: SweepSpec, folder: Path) -> xr.Dataset:
    """The database from the part files of a finished sweep."""
    cells = [
        [read_part(folder, (i, j)) for j in range(len(spec.poisson))] for i in range(len(spec.curvature))
    ]
    opened = [read_part(folder, (i, -1))["compliance"] for i in range(len(spec.curvature))]
    modes = spec.mode_list
    lengths = np.array(spec.crack_length)

    def from_cells(name: str) -> np.ndarray:
        return np.array([[cell[name] for cell in row] for row in cells])

    # rounded before the checksum is taken, so that it holds for what is stored
    dataset = labelled(
        {
            "K": (LAYOUT["K"], rounded(from_cells("K")), "N/mm", "stiffness between modes"),
            "stress": (
                LAYOUT["stress"],
                rounded(from_cells("stress")),
                "MPa",
                "stress on the uncracked path of each mode",
            ),
            "compliance": (
                LAYOUT["compliance"],
                rounded(np.array(opened)),
                "1/MPa",
                "compliance of the crack faces in an unbounded body over a^2",
            ),
            "right_edge": (
                LAYOUT["right_edge"],
                np.array([right_edge(c) for c in spec.curvature]),
                "mm",
                "eta of the edge facing the notch",
            ),
            "mode_direction": (
                LAYOUT["mode_direction"],
                np.array([m.direction for m in modes]),
                "1",
                "displacement along xi (0) or eta (1)",
            ),
            "mode_p": (LAYOUT["mode_p"], np.array([m.p for m in modes]), "1", "power of xi"),
            "mode_q": (LAYOUT["mode_q"], np.array([m.q for m in modes]), "1", "power of eta"),
        },
        {
            "curvature": (np.array(spec.curvature), "1/mm", "curvature c' of the curved side eta = c' xi^2"),
            "poisson": (np.array(spec.poisson), "1", "effective Poisson's ratio (plane stress)"),
            "crack_length": (np.concatenate([[0.0], lengths]), "mm", "crack length a'"),
            "length_open": (lengths, "mm", "crack length a' in the unbounded body"),
            "eta": (spec.eta, "mm", "distance from the notch along the crack path"),
        },
        title=spec.title,
        schema=SCHEMA,
        source="slmm-precompute: crack cells of Paper A, section 2.2.3, with E' = 1 MPa, thickness 1 mm",
        settings=spec.model_dump_json(),
        mesh=f"structured 8-node quadrilaterals, 2 x 2 points; tip {spec.tip} a, growth {spec.growth}",
        half_height=HALF_HEIGHT,
        max_crack_length=float(lengths[-1]),
        **provenance("slmm-precompute"),
    ).assign_coords(component=["xi-xi", "eta-eta", "xi-eta"], direction=["opening", "sliding"])
    dataset.attrs["checksum"] = checksum(dataset)
    return dataset


def rounded(values: np.ndarray, bits: int = 36) -> np.ndarray:
    """Values with ``bits`` bits of mantissa (36: 1.5e-11 relative); the rest is round-off, not compressible."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**bits) / 2.0**bits, exponent)


def write(dataset: xr.Dataset, path: Path, folder: Path) -> None:
    """Write the file whole or not at all.

    It grows in ``folder``, which is on the same file system and removed in the end, so that a killed run
    leaves nothing beside ``path``.
    """
    encoding = {
        name: {"zlib": True, "complevel": 9, "shuffle": True} for name in ("K", "stress", "compliance")
    }
    with whole_file(path, folder) as unfinished:
        dataset.to_netcdf(unfinished, engine="netcdf4", encoding=encoding)
