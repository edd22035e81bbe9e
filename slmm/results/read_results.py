"""Results of finite element programs from their files, as configurational forces and crack tips take them.

Displacements, elements and materials come from CalculiX's .frd with the .inp beside it, or from other programs' files.
Stresses and energies at the integration points follow from the displacements wherever the elasticity is known: that is
what a linear program computed itself there. The nodal values of a file are means over the elements around a node.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element import DEGENERATE
from slmm.mechanics.element_results import METHODS, ElementResults, linear_elastic
from slmm.mechanics.elements import element_named
from slmm.results.file_model import FileField, FileModel, input_model, result_model
from slmm.results.inp import read_inp
from slmm.results.mesh_model import mesh_model
from slmm.results.mesh_step import mesh_displacements
from slmm.results.results import frd_displacements


def read_element_results(
    path: str | Path,
    step: int = -1,
    elasticity: Elasticity | Sequence[Elasticity] | None = None,
    method: str | None = None,
    reduced: bool = False,
    thickness: float | None = None,
    inp: str | Path | None = None,
    field: str | None = None,
) -> ElementResults:
    """Read displacements, and stresses and energies at the integration points, of a plane or solid model.

    Parameters
    ----------
    path : path
        A file as `slmm.results.results.read_displacements` takes it: CalculiX's ASCII results (.frd), .vtu, .pvtu,
        .pvd, Exodus, or a format of meshio; mm and MPa.
    step : int
        Which of the steps with displacements, counted from 0; from the end if negative.
    elasticity : Elasticity or sequence of Elasticity, optional
        The material, or one for each region in the order of the regions. Stresses and energies then follow from the
        displacements, whatever else the file holds.
    method : {"mbf", "dbf", "linear"}, optional
        The configurational stress of the result, see `slmm.fracture.configurational_forces`. By default "linear" when
        stresses follow from the displacements or the input file asks for no NLGEOM, else "dbf": to "mbf" the
        internal nodal forces add, which are zero in balance alone, and interpolated stresses are not quite.
    reduced : bool
        Quadrilaterals and bricks have reduced integration. An input file knows itself.
    thickness : float, optional
        Of plane elements, mm; by default that of the input file's sections, else 1.
    inp : path, optional
        CalculiX's input file: by default the one beside a .frd file, of the same name, if it is there.
    field : str, optional
        Which nodal data are the displacements, see `slmm.results.results.read_displacements`.

    Returns
    -------
    ElementResults
        ``source`` says where stresses come from. ``region`` counts the materials of the input file that are used,
        in its order (one that serves plane strain and plane stress is two), or the sorted values of data of the
        elements called region, material or gmsh:physical. Nodes without element are left out.

    Raises
    ------
    OSError
        When there is no such file.
    ValueError
        When a file cannot be read or is damaged, the step, displacements or stresses are not there or not finite,
        elements are unknown, degenerate or folded over, or what is given contradicts the file.

    Notes
    -----
    Stresses and energies are taken from the first of these that there is: the elasticity given; the input file,
    when all materials are linear elastic and isotropic, no step has NLGEOM (which *MPC implies) and no element has
    incompatible modes;
    the file's own STRESS and ENER, or nodal data called stress, stresses, s or sigma, and energy, ener, sener or
    energy_density, which shape functions carry to the integration points; the same as data of the elements, constant
    in each. Components are xx, yy, zz, xy, yz, zx (VTK's order; Abaqus has zx before yz), the first four, xx, yy, xy,
    or all nine.

    What displacements and elasticity give is what CalculiX 2.20 has at its integration points, to the digits of the
    file, in solids and in plane strain. Its plane stress elements are solids that become thinner node by node, which
    store 0.1 % more energy around a coarsely meshed crack; in a distorted C3D8R element its stresses were off by 0.7 %.
    Nodal stresses and energies are means, across materials as well, and poor near a crack tip: only radii of three
    elements and more gave the energy release rate within 0.3 %.

    A model of plane elements becomes plane, also where CalculiX has written the solids that it makes of them. Without
    an input file, solids are solids. Elements of lower dimension than the others, such as the surfaces in a .msh file,
    are left out. Elements whose nodes run the other way round are turned.

    Elements or pieces with nodes of their own are joined, see `slmm.results.joined_nodes`; their nodal stresses become
    means.

    Examples
    --------
    >>> results = read_element_results("tests/data/edge_crack_2d.frd")
    >>> results.source, results.method, {name: nodes.shape for name, nodes in results.cells.items()}
    ('displacements, and the elasticity in edge_crack_2d.inp', 'linear', {'CPE8': (400, 8)})
    >>> results.points.shape, results.stress["CPE8"].shape, results.energy["CPE8"].shape
    ((1301, 2), (400, 9, 2, 2), (400, 9))
    """
    path = Path(path)
    for file in (path, *((Path(inp),) if inp is not None else ())):
        if not file.is_file():
            raise FileNotFoundError(f"{file}: no such file")
    if method is not None and method not in METHODS:
        raise ValueError(f"method = {method!r}: must be one of {', '.join(METHODS)}")
    if thickness is not None and not (math.isfinite(thickness) and thickness > 0):
        raise ValueError(f"thickness = {thickness!r} mm: must be a positive number")
    of_calculix = path.suffix.lower() == ".frd"
    if inp is not None and not of_calculix:
        raise ValueError(f"inp = {inp}: belongs to results of CalculiX (.frd), not to {path}")
    if of_calculix:
        result, displacement = frd_displacements(path, step, field)
        beside = path.with_suffix(".inp") if inp is None else Path(inp)
        input_file = read_inp(beside) if os.path.lexists(beside) else None
    else:
        mesh = mesh_displacements(path, step, field)
    try:
        if not of_calculix:
            model = mesh_model(mesh, reduced)
        elif input_file is None:
            model = result_model(result, displacement, reduced)
        else:
            model = input_model(result, displacement, input_file, reduced)
        return _results(model, elasticity, method, thickness)
    except ValueError as error:
        # where a block is damaged that was not read before, file and line are named
        named = str(error).startswith(f"{path}, line ")
        raise ValueError(str(error) if named else f"{path}: {error}") from error


def _results(
    model: FileModel,
    elasticity: Elasticity | Sequence[Elasticity] | None,
    method: str | None,
    thickness: float | None,
) -> ElementResults:
    """Nodes of elements alone, elements the right way round, and stresses from the best source there is."""
    dimension = element_named(next(iter(model.cells))).dimension
    thickness = _thickness(model, dimension, thickness)
    used = np.unique(np.concatenate([nodes.ravel() for nodes in model.cells.values()]))
    points, u = _in_space(model, used, dimension)
    cells = {
        name: _oriented(name, np.searchsorted(used, nodes), points, model.numbers[name])
        for name, nodes in model.cells.items()
    }
    materials = _materials(model, elasticity, dimension)
    if elasticity is not None or (materials and not model.unsettled):
        origin = f"in {model.input_file}" if elasticity is None else "that is given"
        result = linear_elastic(points, cells, u, materials, model.region, thickness)
        return replace(
            result, method=method or "linear", source=f"displacements, and the elasticity {origin}"
        )
    if model.stress is None or model.energy is None:
        missing = [name for name in ("stress", "energy") if getattr(model, name) is None]
        known = f"{' and '.join(missing)} not known at this step: give elasticity, or {model.wanted}"
        raise ValueError("; ".join([known, *model.unsettled]))
    stress = _at_points(model.stress, cells, used)
    if next(iter(stress.values())).shape[-1] < dimension:
        raise ValueError(
            f"{model.stress.name} has components in the plane only: solid elements need xx to zx"
        )
    return ElementResults(
        points,
        u,
        cells,
        {name: np.ascontiguousarray(value[..., :dimension, :dimension]) for name, value in stress.items()},
        _at_points(model.energy, cells, used),
        model.region,
        method or ("linear" if model.linear else "dbf"),
        materials,
        thickness,
        f"{model.stress.origin}; {model.energy.origin}",
    )


def _thickness(model: FileModel, dimension: int, thickness: float | None) -> float:
    """What is given, or else what the input file says."""
    if dimension == 3:
        if thickness is not None:
            raise ValueError(f"thickness = {thickness:g} mm: belongs to plane elements, and these are solids")
        return 1.0
    if thickness is not None:
        return thickness
    if math.isnan(model.thickness):
        raise ValueError(
            f"the sections in {model.input_file} have several thicknesses: give the one that is meant"
        )
    if not model.thickness > 0:
        raise ValueError(f"the sections in {model.input_file} have the thickness {model.thickness:g} mm")
    return model.thickness


def _in_space(model: FileModel, used: np.ndarray, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and displacements of the nodes of elements."""
    points, u = np.asarray(model.points[used], dtype=float), np.asarray(model.u[used], dtype=float)
    if dimension > u.shape[1]:
        raise ValueError(f"displacements have {u.shape[1]} components: solid elements need 3")
    u = np.ascontiguousarray(u[:, :dimension])
    for name, value in (("coordinates", points), ("displacements", u)):
        wrong = np.flatnonzero(~np.isfinite(value).all(axis=1))
        if len(wrong):
            raise ValueError(
                f"the {name} of node {used[wrong[0]]}, counted from 0, are {value[wrong[0]].tolist()}: must be finite "
                f"({len(wrong)} of {len(used)} are not)"
            )
    if dimension == 2 and points.shape[1] == 3:
        z = points[:, 2]
        if np.ptp(z) > 1e-5 * np.ptp(points[:, :2], axis=0).max():
            raise ValueError(
                f"z varies from {z.min():g} to {z.max():g} mm: plane elements must lie in an x-y plane"
            )
    return np.ascontiguousarray(points[:, :dimension]), u


def _oriented(name: str, nodes: np.ndarray, points: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Nodes of elements, those turned that run the other way round."""
    element = element_named(name)

    def volumes(nodes: np.ndarray) -> np.ndarray:
        return np.linalg.det(
            np.einsum("eni,qnj->eqij", points[nodes], element.gradient_at_points, optimize=True)
        )

    volume = volumes(nodes)
    turned = np.flatnonzero((volume < 0).all(axis=1))
    nodes = nodes.copy()
    nodes[turned] = nodes[turned][:, element.turned[0]]
    volume[turned] = volumes(nodes[turned])
    size = np.ptp(points[nodes], axis=1).max(axis=1) ** element.dimension
    worst = volume.min(axis=1) / np.maximum(size, np.finfo(float).tiny)
    bad = np.flatnonzero(worst < DEGENERATE)
    if len(bad):
        raise ValueError(
            f"element {numbers[bad[0]]} ({name}) is degenerate or folded over: det dX/dR = {worst[bad[0]]:.3g} of its "
            f"size ({len(bad)} of {len(nodes)} such elements); are its nodes in order?"
        )
    return nodes


def _materials(
    model: FileModel, elasticity: Elasticity | Sequence[Elasticity] | None, dimension: int
) -> tuple[Elasticity, ...]:
    """The elasticity of each region, that is given or else of the input file, when it knows all of them."""
    if elasticity is None:
        known = tuple(region.elasticity for region in model.regions if region.elasticity is not None)
        return known if len(known) == len(model.regions) else ()
    count = len(model.regions)
    materials = (elasticity,) * count if isinstance(elasticity, Elasticity) else tuple(elasticity)
    if len(materials) != count:
        names = ", ".join(region.name for region in model.regions)
        raise ValueError(f"elasticity has {len(materials)} materials: {count} are needed, for {names}")
    for region, material in zip(model.regions, materials, strict=True):
        if dimension == 2 and region.state not in (None, material.state):
            raise ValueError(
                f"elasticity of {region.name} is of {material.state}: the elements in {model.input_file} are of "
                f"{region.state}"
            )
    return materials


def _at_points(field: FileField, cells: Mapping[str, np.ndarray], used: np.ndarray) -> dict[str, np.ndarray]:
    """A field of the file at the integration points."""
    result = {}
    for name, nodes in cells.items():
        element = element_named(name)
        if field.of_nodes is None:
            values = np.repeat(field.of_elements[name][:, None], len(element.points), axis=1)
        else:
            nodal = field.of_nodes[used][nodes]
            values = np.einsum("qn,en...->eq...", element.shape(element.points), nodal)
        wrong = np.count_nonzero(~np.isfinite(values.reshape(len(values), -1)).all(axis=1))
        if wrong:
            raise ValueError(
                f"{field.name} is not known, or not finite, in {wrong} of {len(nodes)} elements {name}"
            )
        result[name] = values
    return result
