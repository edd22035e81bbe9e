"""Displacements and stress of a part in each step of its fracture, as a series of files for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import meshio
import numpy as np

from slmm.fracture.critical_state import CriticalState, critical_state, number_of_states
from slmm.fracture.cut_triangles import cut_triangles
from slmm.mechanics.stress import principal_stress
from slmm.running.progress import Progress, silent
from slmm.running.whole_file import whole_file
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

#: triangles along the part's longer side, if their size is not asked for; chosen
PER_SIDE = 60
#: time between steps at one displacement, over the largest one: ParaView takes files of the same time for one; chosen
APART = 1e-6


def write_series(
    scene: Scene,
    result: xr.Dataset,
    folder: str | Path,
    size: float | None = None,
    progress: Progress = silent,
) -> Path:
    """Write ``fracture.pvd``, whose time is u in mm, and a .vtu for the state before each step at its critical load.

    Data of the points are ``displacement``, mm, ``stress_xx``, ``stress_yy``, ``stress_xy`` and ``principal_stress``,
    MPa. Points on cracks are there once for each face, so that a warp by the displacements opens them. At tips the
    stress is that a tenth of a triangle ahead. Fields are those of boundary integrals at the points, not interpolated.

    Parameters
    ----------
    scene : Scene
        What was simulated.
    result : Dataset
        From `slmm.fracture.simulate`.
    folder : str or Path
        Made where it is missing; files of these names give way.
    size : float, optional
        Of the triangles, mm; a sixtieth of the part's longer side if not given.
    progress : callable

    Returns
    -------
    Path
        Of the .pvd file.

    Raises
    ------
    ValueError
        When the size is not positive, or too large for triangles between the part's lines.
    NotWrittenError
        When a file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from slmm.fracture import simulate
    >>> from slmm.scene.gallery import tensile_plate
    >>> scene = tensile_plate()
    >>> result = simulate(scene, increment=20.0, errors=False)
    >>> with TemporaryDirectory() as folder:
    ...     _ = write_series(scene, result, folder, size=8.0)
    ...     sorted(path.name for path in Path(folder).iterdir())
    ['fracture.pvd', 'step_001.vtu', 'step_002.vtu', 'step_003.vtu', 'step_004.vtu']
    """
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    size = scene.size / PER_SIDE if size is None else size
    number = number_of_states(result)
    series = ElementTree.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ElementTree.SubElement(series, "Collection")
    u_load = np.append(result.u_load.values, result.u.values[-1])
    for k in range(number):
        progress(k / number, f"fields of step {k + 1} of {number}")
        name = f"step_{k + 1:0{max(3, len(str(number)))}d}.vtu"
        _write_state(folder / name, critical_state(scene, result, k), size)
        time = float(u_load[k]) + APART * k * float(u_load[-1])
        ElementTree.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=name)
    path = folder / "fracture.pvd"
    with whole_file(path) as unfinished:
        ElementTree.ElementTree(series).write(unfinished, encoding="utf-8", xml_declaration=True)
    return path


def _write_state(path: Path, state: CriticalState, size: float) -> None:
    """One file."""
    mesh = cut_triangles(state.model.part, size)
    stress = state.stress(mesh.places)
    data = {
        "displacement": np.pad(state.displacement(mesh.places), ((0, 0), (0, 1))),
        **{f"stress_{name}": stress[:, k] for k, name in enumerate(("xx", "yy", "xy"))},
        "principal_stress": principal_stress(stress),
    }
    points = np.pad(mesh.points, ((0, 0), (0, 1)))
    with whole_file(path) as unfinished:
        meshio.write(unfinished, meshio.Mesh(points, {"triangle": mesh.triangles}, data), file_format="vtu")
