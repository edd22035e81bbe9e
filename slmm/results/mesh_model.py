"""What a file with a mesh and data holds, by our element types, before stresses are settled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from slmm.results.displacement_names import name_and_step
from slmm.results.file_model import FileField, FileModel, Region, element_types, field_values
from slmm.results.mesh_step import MeshStep

#: names of nodal data or data of elements, in lower case; the first one found is taken
STRESS_NAMES = ("stress", "stresses", "s", "sigma")
ENERGY_NAMES = ("energy", "ener", "sener", "energy_density")
REGION_NAMES = ("region", "material", "gmsh:physical")


def mesh_model(step: MeshStep, reduced: bool) -> FileModel:
    """A step of any other file.

    Raises
    ------
    ValueError
        When there are no elements, or others than those known, or data do not fit.
    """
    mesh = step.mesh
    names = element_types(mesh.cells, reduced)
    return FileModel(
        mesh.points,
        step.u,
        {name: mesh.cells[kind] for kind, name in names.items()},
        {name: np.arange(len(mesh.cells[kind])) for kind, name in names.items()},
        *_mesh_regions(step, names),
        _mesh_field(step, names, STRESS_NAMES, tensor=True),
        _mesh_field(step, names, ENERGY_NAMES, tensor=False),
        f"data of nodes or elements with one of the names {', '.join(STRESS_NAMES)} and one of "
        f"{', '.join(ENERGY_NAMES)}",
    )


def _mesh_regions(step: MeshStep, names: Mapping[str, str]) -> tuple[dict[str, np.ndarray], list[Region]]:
    """Regions by data of the elements, in the order of the values."""
    for called in REGION_NAMES:
        # materials need not be written at every step
        steps = _steps_of(step.mesh.cell_data, called)
        key = steps.get(step.number) or steps.get(-1)
        if key is not None:
            values = {
                name: field_values(own, key, tensor=False)
                for name, own in _of_elements(step, key, names).items()
            }
            found = np.unique(np.concatenate([*values.values()]))
            if not np.isfinite(found).all():
                raise ValueError(f"{key} is not finite everywhere")
            regions = [Region(f"{key} = {value:g}") for value in found]
            return {name: np.searchsorted(found, own) for name, own in values.items()}, regions
    counts = {name: len(step.mesh.cells[kind]) for kind, name in names.items()}
    return {name: np.zeros(count, dtype=int) for name, count in counts.items()}, [Region("all elements")]


def _mesh_field(
    step: MeshStep, names: Mapping[str, str], called: Iterable[str], tensor: bool
) -> FileField | None:
    """Stresses or energies at the step of the displacements: nodal data, else data of elements."""
    called = tuple(called)
    for name in called:
        if key := _steps_of(step.mesh.point_data, name).get(step.number):
            return FileField(key, field_values(step.mesh.point_data[key], key, tensor), {})
    for name in called:
        if key := _steps_of(step.mesh.cell_data, name).get(step.number):
            values = _of_elements(step, key, names)
            return FileField(
                key, None, {kind: field_values(own, key, tensor) for kind, own in values.items()}
            )
    return None


def _steps_of(data: Iterable[str], called: str) -> dict[int, str]:
    """The names of the data that are called so, in capitals or not, by the number of the step, -1 if it has none."""
    found: dict[int, str] = {}
    for key in data:
        name, number = name_and_step(key)
        if name.lower() == called:
            if number in found:
                raise ValueError(f"{found[number]!r} and {key!r} have the same name but for capitals")
            found[number] = key
    return found


def _of_elements(step: MeshStep, key: str, names: Mapping[str, str]) -> dict[str, np.ndarray]:
    """Data of elements by type in place of by kind."""
    by_kind = step.mesh.cell_data[key]
    if missing := [kind for kind in names if kind not in by_kind]:
        raise ValueError(f"{key} has no values of {missing[0]}")
    return {name: by_kind[kind] for kind, name in names.items()}
