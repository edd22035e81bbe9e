"""Meshes and data from what meshio reads: XDMF, MED, gmsh's .msh, structured .vtk and others."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from slmm.results.file_mesh import FileMesh, checked

#: what meshio says when it leaves elements out, which must not pass
_LEFT_OUT = ("cannot handle", "skipping", "could not parse")


def read_with_meshio(path: Path, chosen: Callable[[int], int]) -> tuple[FileMesh, bool]:
    """A mesh with its data, and whether they are of the chosen time alone.

    Parameters
    ----------
    path : path
    chosen : callable
        The number of the time, from 0, by how many there are.

    Raises
    ------
    OSError, ValueError
        When the file cannot be read, or only in part.
    """
    with _reading(path):
        series = _xdmf_series(path)
    if series is None:
        with _reading(path) as said:
            mesh = meshio.read(path)
        points, blocks, point_data, cell_data = mesh.points, mesh.cells, mesh.point_data, mesh.cell_data
        components = _med_components(mesh)
    else:
        step = chosen(series.num_steps)
        with _reading(path) as said, series:
            points, blocks = series.read_points_cells()
            _, point_data, cell_data = series.read_data(step)
        components = {}
    if any(word in said.getvalue().lower() for word in _LEFT_OUT):
        raise ValueError(f"{path}: cannot be read as a whole: {' '.join(said.getvalue().split())[:200]}")
    kinds = [block.type for block in blocks]
    of_kind: dict[str, list[np.ndarray]] = {}
    for block in blocks:
        of_kind.setdefault(block.type, []).append(np.asarray(block.data))
    mesh = FileMesh(
        np.asarray(points, dtype=float),
        {kind: np.concatenate(parts) for kind, parts in of_kind.items()},
        point_data,
        {name: _by_kind(kinds, parts) for name, parts in cell_data.items()},
        components,
    )
    return checked(path, mesh), series is not None


def _by_kind(kinds: Iterable[str], parts: Iterable[np.ndarray | None]) -> dict[str, np.ndarray]:
    """Data of elements by kind in place of by block, of the kinds all of whose blocks have them."""
    found: dict[str, list[np.ndarray | None]] = {}
    for kind, part in zip(kinds, parts, strict=True):
        found.setdefault(kind, []).append(part)
    result = {}
    for kind, own in found.items():
        known = [part for part in own if part is not None]
        if len(known) == len(own):
            result[kind] = np.concatenate(known)
    return result


def _med_components(mesh: Any) -> dict[str, list[str]]:
    """What a MED file calls the components of its fields, by the field's name."""
    called = mesh.field_data.get("med:nom")
    if not isinstance(called, list):
        return {}
    # one list for each field of nodes or elements, in the order of the fields
    own = dict.fromkeys(name.split("[")[0] for name in (*mesh.point_data, *mesh.cell_data))
    names = [name for name in own if name not in ("point_tags", "cell_tags")]
    return dict(zip(names, called, strict=False)) if len(names) == len(called) else {}


def _xdmf_series(path: Path) -> meshio.xdmf.TimeSeriesReader | None:
    """The steps of an XDMF file that has them."""
    if path.suffix.lower() not in (".xdmf", ".xmf"):
        return None
    try:
        return meshio.xdmf.TimeSeriesReader(path)
    except meshio.ReadError:
        return None


def _in_words(error: BaseException) -> str:
    """What happened, also where meshio says nothing."""
    if isinstance(error, KeyError):
        return f"it has, or lacks, {str(error.args[0])[:60]!r}, which meshio does not expect"
    return f"{str(error)[:200] or 'it is damaged, or of a form that meshio does not know'} ({type(error).__name__})"


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[io.StringIO]:
    """Make one error of all that happens to a bad file in meshio: it prints, raises anything, or exits."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            yield said
    except (Exception, SystemExit) as error:
        reason = " ".join(said.getvalue().split()) or _in_words(error)
        raise ValueError(f"{path}: cannot be read: {reason}") from error
