"""The file format of the crack-cell database: what the precompute stage and the library agree on."""

from __future__ import annotations

from pathlib import Path

from slmm.running.labelled import LabelledArrays
from slmm.running.model_file import read_verified, shipped

#: version of the layout below; a file of another one is refused
SCHEMA = 1

#: variables of a database and their dimensions
LAYOUT: dict[str, tuple[str, ...]] = {
    "K": ("curvature", "poisson", "crack_length", "mode", "mode_"),
    "stress": ("curvature", "poisson", "mode", "component", "eta"),
    "compliance": ("curvature", "direction", "length_open", "order", "order_"),
    "right_edge": ("curvature",),
    "mode_direction": ("mode",),
    "mode_p": ("mode",),
    "mode_q": ("mode",),
}


def shipped_database() -> Path:
    """The database of crack cells that comes with the package."""
    return shipped("cells.nc")


def read_cells(path: Path | str) -> LabelledArrays:
    """Read a database into memory and verify it.

    Raises
    ------
    DatabaseError
        When the file is missing, truncated, altered, or of another schema.
    """
    return read_verified(path, SCHEMA, LAYOUT, "slmm-precompute")
