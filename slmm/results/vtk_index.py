"""VTK's files that name others: the pieces of one mesh (.pvtu), and the meshes of several times (.pvd)."""

from __future__ import annotations

import math
from pathlib import Path, PurePosixPath, PureWindowsPath

from slmm.results.file_mesh import FileMesh, checked, side_by_side
from slmm.results.vtk_xml import read_index, read_vtu


def read_pvtu(path: Path) -> FileMesh:
    """All pieces of a mesh that was computed in parallel, without their ghosts.

    Raises
    ------
    OSError
        When a piece is not there.
    ValueError
        When it, or a piece, cannot be read, or lies outside the folder.
    """
    root = read_index(path, "PUnstructuredGrid")
    sources = [piece.get("Source", "") for piece in root.findall("PUnstructuredGrid/Piece")]
    if not sources:
        raise ValueError(f"{path}: names no <Piece>")
    return checked(path, side_by_side([read_vtu(beside(path, source)) for source in sources]))


def files_of_steps(path: Path) -> list[list[Path]]:
    """The files of each time of a series, in the order of time.

    Raises
    ------
    ValueError
        When the file cannot be read, names no data sets, or a time is no number.
    """
    root = read_index(path, "Collection")
    at: dict[float, list[Path]] = {}
    for data_set in root.findall("Collection/DataSet"):
        text = data_set.get("timestep", "0")
        try:
            time = float(text)
        except ValueError:
            time = math.nan
        if not math.isfinite(time):
            raise ValueError(f"{path}: timestep = {text[:20]!r}: must be a finite number")
        at.setdefault(time, []).append(beside(path, data_set.get("file", "")))
    if not at:
        raise ValueError(f"{path}: names no <DataSet>")
    return [at[time] for time in sorted(at)]


def beside(path: Path, source: str) -> Path:
    """A file that another one names, which must lie in its folder or below.

    Raises
    ------
    OSError
        When it is not there.
    ValueError
        When the name leads elsewhere.
    """
    # a Windows path takes both slashes, and knows drives
    name = PureWindowsPath(source)
    if not source or "\0" in source or name.anchor or ".." in name.parts:
        raise ValueError(
            f"{path}: names the file {source[:80]!r}: must lie in the same folder, or in one below"
        )
    file = path.parent / PurePosixPath(*name.parts)
    if not file.is_file():
        raise FileNotFoundError(f"{path}: names {source[:80]}, and there is no such file")
    return file
