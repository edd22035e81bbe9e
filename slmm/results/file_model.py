"""What files of results hold, by the element types of `slmm.mechanics.elements`, before stresses are settled."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.elements import ALIASES, ELEMENTS, type_named
from slmm.mechanics.material import State
from slmm.results.frd import FrdField, FrdResult
from slmm.results.inp_model import InpModel
from slmm.results.results import FACES, THIN, lower_faces

#: beginnings of meshio's names of elements without an entry in `slmm.mechanics.element_types` that are plane
PLANE = ("triangle", "quad")

#: places of the components of a file in the tensor, by their number
COMPONENTS = {
    3: np.array([[0, 2], [2, 1]]),
    4: np.array([[0, 3], [3, 1]]),
    6: np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]]),
    9: np.arange(9).reshape(3, 3),
}


#: of the six digits of a .frd file, as a share of the largest coordinate; round-off
FRD_DIGITS = 1e-5


class FileField(NamedTuple):
    """Stresses (..., d, d) or energies (...,) of a file: of all nodes, or of the elements of each type."""

    name: str
    of_nodes: np.ndarray | None
    of_elements: Mapping[str, np.ndarray]

    @property
    def origin(self) -> str:
        """In words."""
        return (
            f"{self.name} of the elements"
            if self.of_nodes is None
            else f"{self.name} of the nodes, interpolated"
        )


class Region(NamedTuple):
    """A material as the file calls it; elasticity and state where the file knows them."""

    name: str
    elasticity: Elasticity | None = None
    state: State | None = None


@dataclass(frozen=True)
class FileModel:
    """Nodes, displacements, and elements by type.

    Parameters
    ----------
    points, u : ndarray (n, 2 or 3)
        All nodes of the file.
    cells : mapping of str to ndarray (el, k)
        As the file has their nodes.
    numbers : mapping of str to ndarray (el,)
        What the file calls the elements.
    region : mapping of str to ndarray (el,)
        Places in ``regions``.
    regions : sequence of Region
    stress, energy : FileField or None
    wanted : str
        What would put stresses and energies into the file.
    input_file : str
        Its name, when there is one.
    linear : bool
        The input file says that the analysis is geometrically linear.
    unsettled : sequence of str
        Why stresses do not follow from displacements and what the input file knows.
    thickness : float
        Of plane elements; NaN when the input file has several.
    """

    points: np.ndarray
    u: np.ndarray
    cells: Mapping[str, np.ndarray]
    numbers: Mapping[str, np.ndarray]
    region: Mapping[str, np.ndarray]
    regions: Sequence[Region]
    stress: FileField | None
    energy: FileField | None
    wanted: str
    input_file: str = ""
    linear: bool = False
    unsettled: Sequence[str] = ()
    thickness: float = 1.0


# CalculiX


def result_model(result: FrdResult, displacement: FrdField, reduced: bool) -> FileModel:
    """A result of CalculiX without its input file: solids are solids.

    Raises
    ------
    ValueError
        When there are no elements, or others than those known.
    """
    names = element_types(result.cells, reduced)
    return FileModel(
        result.nodes,
        displacement.values,
        {name: result.cells[kind] for kind, name in names.items()},
        {name: result.cell_ids[kind] for kind, name in names.items()},
        {name: np.zeros(len(result.cells[kind]), dtype=int) for kind, name in names.items()},
        [Region("all elements")],
        _frd_field(result, displacement, "STRESS", 6),
        _frd_field(result, displacement, "ENER", 1),
        "STRESS and ENER (*EL FILE with S, ENER), or the .inp of a linear elastic model",
    )


def input_model(result: FrdResult, displacement: FrdField, inp: InpModel, reduced: bool) -> FileModel:
    """A result of CalculiX with its input file, which knows types, materials and thicknesses.

    Raises
    ------
    ValueError
        When elements are unknown, plane and solid, without section, or others than in the input file.
    """
    if inp.unlike:
        raise ValueError(f"{inp.path.name}: {inp.unlike[0]}")
    cells = {kind: nodes for kind, nodes in result.cells.items() if not kind.startswith(THIN)}
    if not cells:
        raise ValueError("there are no plane or solid elements")
    numbers = {kind: result.cell_ids[kind] for kind in cells}
    names = sorted({name for ids in numbers.values() for name in inp.types_of(ids).tolist()})
    plane = _plane(names, inp)
    if reduced and (full := [name for name in names if _could_be_reduced(name)]):
        raise ValueError(
            f"reduced = True: {inp.path.name} has {', '.join(full)}, which are not; leave it out"
        )
    if plane and any(kind in FACES for kind in cells):
        cells, numbers = _plane_elements(result, displacement, cells, numbers)
    by_type, ids = _by_type(cells, numbers, inp)
    region, regions = _materials(inp, ids)
    unsettled = [inp.reasons[own.name] for own in regions if own.name in inp.reasons]
    if incompatible := [name for name in names if name in type_named(name).incompatible]:
        unsettled.append(
            f"{', '.join(incompatible)} have incompatible modes, of which displacements do not tell"
        )
    if inp.nlgeom:
        unsettled.append(f"{inp.path.name} has NLGEOM, or *MPC, which implies it")
    sections = {inp.sections[k].thickness for own in ids.values() for k in np.unique(inp.section_of(own))}
    thicknesses = {1.0 if thickness is None else thickness for thickness in sections} if plane else {1.0}
    return FileModel(
        _coordinates(result.nodes, inp, plane),
        displacement.values,
        by_type,
        ids,
        region,
        regions,
        _frd_field(result, displacement, "STRESS", 6),
        _frd_field(result, displacement, "ENER", 1),
        "STRESS and ENER (*EL FILE with S, ENER)",
        inp.path.name,
        not inp.nlgeom,
        list(dict.fromkeys(unsettled)),
        thicknesses.pop() if len(thicknesses) == 1 else math.nan,
    )


def _could_be_reduced(name: str) -> bool:
    """Whether an element has full integration and there is another with reduced integration."""
    known = type_named(name)
    return known.reduced is not None and known.elements[name] is known.element


def _coordinates(nodes: np.ndarray, inp: InpModel, plane: bool) -> np.ndarray:
    """Nodes (n, 3) with the digits of the input file: a result has six, too few beside a crack tip."""
    # by their place: solids that stand for plane elements have nodes of their own
    d = 2 if plane else 3
    off, nearest = cKDTree(inp.nodes[:, :d]).query(nodes[:, :d])
    same = off <= FRD_DIGITS * np.abs(nodes).max()
    result = nodes.copy()
    result[same, :d] = inp.nodes[nearest[same], :d]
    return result


def _frd_field(result: FrdResult, displacement: FrdField, name: str, components: int) -> FileField | None:
    """A nodal result at the step of the displacements."""
    for field in result.fields.get(name, []):
        if (field.step, field.value) == (displacement.step, displacement.value):
            if len(field.components) != components:
                raise ValueError(
                    f"{name} has the components {', '.join(field.components)}: {components} are expected"
                )
            return FileField(name, field_values(field.values, name, tensor=components > 1), {})
    return None


def _plane(names: Sequence[str], inp: InpModel) -> bool:
    """Whether these elements of an input file are plane."""
    if unknown := [name for name in names if name not in ELEMENTS and name not in ALIASES]:
        raise ValueError(
            f"{inp.path.name} has elements of type {', '.join(unknown)}: only plane elements (CPE, CPS) and solids "
            "(C3D) are read"
        )
    dimensions = {type_named(name).element.dimension for name in names}
    if len(dimensions) > 1:
        raise ValueError(
            f"{inp.path.name} has plane elements and solids ({', '.join(names)}): one of them is needed"
        )
    return dimensions == {2}


def _plane_elements(
    result: FrdResult,
    displacement: FrdField,
    cells: Mapping[str, np.ndarray],
    numbers: Mapping[str, np.ndarray],
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Plane elements and their numbers from the solids that CalculiX has made of them."""
    if flat := sorted(set(cells) - set(FACES)):
        raise ValueError(
            f"elements of type {', '.join(flat)} beside the solids that stand for plane elements"
        )
    faces, solids = lower_faces(result.nodes, cells, displacement.values[:, :2])
    ids = np.concatenate([numbers[kind] for kind in cells])
    return faces, {kind: ids[own] for kind, own in solids.items()}


def _by_type(
    cells: Mapping[str, np.ndarray], numbers: Mapping[str, np.ndarray], inp: InpModel
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Nodes and numbers of the elements of each type of an input file."""
    nodes: dict[str, np.ndarray] = {}
    ids: dict[str, np.ndarray] = {}
    for kind, own in numbers.items():
        types = inp.types_of(own)
        for name in np.unique(types).tolist():
            here = types == name
            if type_named(name).kind != kind:
                raise ValueError(
                    f"element {own[here][0]} is {kind} here, and {name} in {inp.path.name}: is it of another model?"
                )
            nodes[name], ids[name] = cells[kind][here], own[here]
    return nodes, ids


def _materials(
    inp: InpModel, numbers: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], list[Region]]:
    """Regions: the materials in the order of the file; one in plane strain is another than in plane stress."""
    order = list(inp.materials)
    states: tuple[State, State] = ("plane strain", "plane stress")
    of_section = np.array([order.index(section.material) for section in inp.sections], dtype=int)
    code = {
        name: 2 * of_section[inp.section_of(ids)] + (name in type_named(name).plane_stress)
        for name, ids in numbers.items()
    }
    codes = np.unique(np.concatenate([*code.values()]))
    regions = []
    for name, state in ((order[c // 2], states[c % 2]) for c in codes):
        elasticity = inp.materials[name]
        regions.append(Region(name, None if elasticity is None else replace(elasticity, state=state), state))
    return {name: np.searchsorted(codes, own) for name, own in code.items()}, regions


# all files


def element_types(cells: Mapping[str, np.ndarray], reduced: bool) -> dict[str, str]:
    """What the solids, or else the plane elements, of a file are taken for, by their kind.

    Raises
    ------
    ValueError
        When there are none, or others than those known.
    """
    inside = [kind for kind, nodes in cells.items() if len(nodes) and not kind.startswith(THIN)]
    kinds = [kind for kind in inside if not _is_plane(kind)] or inside
    if not kinds:
        raise ValueError("there are no plane or solid elements")
    if unknown := sorted(set(kinds) - set(ELEMENT_TYPES)):
        raise ValueError(f"elements of type {', '.join(unknown)}: known are {', '.join(ELEMENT_TYPES)}")
    known = {kind: ELEMENT_TYPES[kind] for kind in kinds}
    return {kind: ((reduced and own.reduced) or own.element).name for kind, own in known.items()}


def _is_plane(kind: str) -> bool:
    """Whether elements of a kind, which need not be known, are plane."""
    known = ELEMENT_TYPES.get(kind)
    return kind.startswith(PLANE) if known is None else known.element.dimension == 2


def field_values(values: np.ndarray, name: str, tensor: bool) -> np.ndarray:
    """Tensors (n, 3, 3), or (n, 2, 2) when the file has no more; or scalars (n,).

    Raises
    ------
    ValueError
        When the values have another shape, or are not symmetric.
    """
    if not tensor:
        if values.size != len(values):
            raise ValueError(
                f"{name} has the shape {values.shape}: one number is needed for each node or element"
            )
        return values.reshape(-1)
    if values.shape[1:] in ((2, 2), (3, 3)):
        result = values
    elif values.ndim == 2 and values.shape[1] in COMPONENTS:
        result = values[:, COMPONENTS[values.shape[1]]]
    else:
        raise ValueError(
            f"{name} has the shape {values.shape}: components xx, yy, zz, xy, yz, zx are needed, the first four, "
            "xx, yy, xy, or all nine"
        )
    finite = result[np.isfinite(result).all(axis=(1, 2))]
    skew = np.abs(finite - finite.swapaxes(-1, -2)).max(initial=0.0)
    if skew > 1e-6 * np.abs(finite).max(initial=0.0):
        raise ValueError(f"{name} is not symmetric, by up to {skew:g}: Cauchy stresses are needed")
    return result
