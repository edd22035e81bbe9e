"""Parts meshed and solved as others do it: meshes of each kind of element, models of CalculiX and FreeFEM, their files.

A mesh has so many elements for each quarter turn of a notch; quadrilaterals are thirds of triangles. Conditions of the
scene become what programs take: displacements of nodes, and forces on nodes that do the work of uniform tractions.
"""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from calculix import solved_by_calculix
from skfem import Basis, ElementQuad1, ElementTriP1, ElementVector, MeshQuad, MeshTri, condense, solve
from skfem.models.elasticity import linear_elasticity

from slmm import Scene
from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.mechanics.element_types import ELEMENT_TYPES

#: elements that CalculiX has, by their kind; R: integrated at fewer points
TYPES = {
    "CPS3": "triangle",
    "CPS4": "quad",
    "CPS4R": "quad",
    "CPS6": "triangle6",
    "CPS8": "quad8",
    "CPS8R": "quad8",
}


@dataclass(frozen=True)
class Model:
    """Nodes (n, 2), elements (m, k) of one kind, and what holds and loads the nodes (n, 2): NaN where nothing does."""

    points: np.ndarray
    kind: str
    nodes: np.ndarray
    held: np.ndarray
    force: np.ndarray


def model(scene: Scene, kind: str, per_quarter: int, straight: bool = False) -> Model:
    """A scene as a finite element model, with straight edges between nodes on the curve if wanted."""
    thirds = kind.startswith("quad")
    turn = np.pi / 2 / per_quarter * (2 if thirds else 1)
    side = float(np.ptp(scene.part.outer, axis=0).min())
    policy = SizePolicy(side / (4 if thirds else 8), turn * 1.0001, at_tips=0.02)
    mesh = plate_mesh(scene.part, policy=policy, nodes_at=scene.loading.ends)
    vertices, triangles = mesh.vertices, mesh.triangles
    curved, middle = np.sort(mesh.edges, axis=1), mesh.edge_midpoints()
    if thirds:
        points, nodes = _thirds(vertices, triangles, curved, middle)
        if kind == "quad8":
            quarters = _quarter_points(mesh, points, len(vertices), triangles)
            points, nodes = _with_middles(points, nodes, *quarters, straight)
    elif kind == "triangle6":
        points, nodes = _with_middles(vertices, triangles, curved, middle, straight)
    else:
        points, nodes = vertices, triangles
    return Model(points, kind, nodes, *_conditions(scene, points, kind, nodes))


def _edges(nodes: np.ndarray) -> np.ndarray:
    """Pairs (m, k, 2) of corners beside each other."""
    return np.sort(np.stack([nodes, np.roll(nodes, -1, axis=1)], axis=-1), axis=-1)


def _placed(pairs: np.ndarray, default: np.ndarray, curved: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Places (e, 2) of the middles of edges (e, 2), those of curved edges where they are known to be."""
    at, place = default.copy(), {tuple(pair): k for k, pair in enumerate(pairs.tolist())}
    for pair, point in zip(curved.tolist(), middle, strict=True):
        at[place[tuple(pair)]] = point
    return at


def _thirds(
    vertices: np.ndarray, triangles: np.ndarray, curved: np.ndarray, middle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Three quadrilaterals from each triangle."""
    pairs, number = np.unique(_edges(triangles).reshape(-1, 2), axis=0, return_inverse=True)
    half = _placed(pairs, vertices[pairs].mean(axis=1), curved, middle)
    n, e = len(vertices), len(pairs)
    ab, bc, ca = (n + number.reshape(-1, 3)).T
    centre = n + e + np.arange(len(triangles))
    a, b, c = triangles.T
    quads = [np.column_stack(q) for q in ((a, ab, centre, ca), (b, bc, centre, ab), (c, ca, centre, bc))]
    return np.concatenate([vertices, half, vertices[triangles].mean(axis=1)]), np.concatenate(quads)


def _quarter_points(mesh, points, n, triangles) -> tuple[np.ndarray, np.ndarray]:
    """Halves (2 e, 2) of the edges on outlines, as pairs of nodes, and where on the curve their middles lie."""
    pairs = np.unique(_edges(triangles).reshape(-1, 2), axis=0)
    place = {tuple(pair): n + k for k, pair in enumerate(pairs.tolist())}
    found, at = [], []
    for (i, j), which, (s, t) in zip(mesh.edges.tolist(), mesh.edge_outline, mesh.edge_s, strict=True):
        half = place[(min(i, j), max(i, j))]
        outline = mesh.outlines[which]
        for end, share in ((i, 0.25), (j, 0.75)):
            found.append(sorted((end, half)))
            at.append(outline.points(np.array([s + share * (t - s)]))[0])
    return np.array(found).reshape(-1, 2), np.array(at).reshape(-1, 2)


def _with_middles(points, nodes, curved, middle, straight) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in the middle of all edges, behind the corners."""
    pairs, number = np.unique(_edges(nodes).reshape(-1, 2), axis=0, return_inverse=True)
    at = points[pairs].mean(axis=1)
    if not straight:
        at = _placed(pairs, at, curved, middle)
    return np.concatenate([points, at]), np.hstack([nodes, len(points) + number.reshape(nodes.shape)])


def _conditions(scene: Scene, points, kind, nodes) -> tuple[np.ndarray, np.ndarray]:
    held, force = np.full(points.shape, np.nan), np.zeros(points.shape)
    local = ELEMENT_TYPES[kind].element.edges
    edges = nodes[:, local].reshape(-1, local.shape[1])
    share = [1 / 6, 1 / 6, 4 / 6] if local.shape[1] == 3 else [0.5, 0.5]
    _, of_edge, count = np.unique(
        np.sort(edges[:, :2], axis=1), axis=0, return_inverse=True, return_counts=True
    )
    edges = edges[count[of_edge.ravel()] == 1]
    for condition in scene.loading:
        on = condition.on(points)
        for i, component in enumerate(condition.displacement):
            if component is not None:
                held[on, i] = component(points[on])
        if condition.is_loaded:
            own = edges[on[edges].all(axis=1)]
            along = points[own[:, 1]] - points[own[:, 0]]
            length = np.hypot(*along.T)
            outward = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
            traction = condition.tractions(points[own[:, :2]].mean(axis=1), outward)
            for k, weight in enumerate(share):
                np.add.at(force, own[:, k], weight * length[:, None] * traction)
    if np.isnan(held).all(axis=0).any() or (~np.isnan(held)).sum() < 3:
        held = _supported(points, nodes, held)
    return held, force


def _supported(points: np.ndarray, nodes: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What is held, and what else is needed for a part whose loads balance, without reactions."""
    held = held.copy()
    used = np.unique(nodes)
    middle = points[used].mean(axis=0)
    near = used[np.argsort(np.hypot(*(points[used] - middle).T))]
    if np.isnan(held[:, 0]).all():
        held[near[0], 0] = 0.0
    if np.isnan(held[:, 1]).all():
        held[near[0], 1] = 0.0
        along = used[np.abs(points[used, 0] - points[near[0], 0]).argmax()]
        held[along, 1] = 0.0
    return held


def distorted(given: Model, by: float, seed: int = 0) -> Model:
    """The same mesh with its inner nodes moved at random by a share of the shortest edge beside them."""
    assert given.kind in ("triangle", "quad")
    edges = _edges(given.nodes).reshape(-1, 2)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    length = np.hypot(*(given.points[pairs[:, 1]] - given.points[pairs[:, 0]]).T)
    shortest = np.full(len(given.points), np.inf)
    for column in pairs.T:
        np.minimum.at(shortest, column, length)
    inside = np.ones(len(given.points), dtype=bool)
    inside[pairs[count == 1]] = False
    inside &= np.isfinite(shortest)
    angle = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(given.points))
    points = given.points.copy()
    points[inside] += by * shortest[inside, None] * np.column_stack([np.cos(angle), np.sin(angle)])[inside]
    return replace(given, points=points)


def calculix_input(given: Model, element_type: str, scene: Scene, file_output: str = "2D") -> str:
    """The model as CalculiX's input."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i + 1}, {x:.12g}, {y:.12g}, 0" for i, (x, y) in enumerate(given.points)]
    lines.append(f"*ELEMENT, TYPE={element_type}, ELSET=PART")
    lines += [f"{k + 1}, " + ", ".join(str(n + 1) for n in row) for k, row in enumerate(given.nodes)]
    material = scene.material
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{material.E:.9g}, {material.nu:.9g}"]
    lines += ["*SOLID SECTION, ELSET=PART, MATERIAL=M", "1.0", "*STEP", "*STATIC", "*BOUNDARY"]
    for i, j in np.argwhere(np.isfinite(given.held)):
        lines.append(f"{i + 1}, {j + 1}, {j + 1}, {given.held[i, j]:.12g}")
    loaded = np.argwhere(given.force != 0)
    if len(loaded):
        lines.append("*CLOAD")
        lines += [f"{i + 1}, {j + 1}, {given.force[i, j]:.12g}" for i, j in loaded]
    lines += [f"*NODE FILE, OUTPUT={file_output}", "U", "*EL FILE", "S", "*END STEP", ""]
    return "\n".join(lines)


def by_calculix(given: Model, element_type: str, scene: Scene, folder: Path, name: str) -> Path:
    """Solved by CalculiX: its .frd."""
    return solved_by_calculix(calculix_input(given, element_type, scene), folder, name)


#: FreeFEM's script: displacements along x and y, held at labels of the boundary, under tractions
FREEFEM = """load "iovtk"
mesh Th = readmesh("{name}.mesh");
fespace Vh(Th, {element});
fespace Wh(Th, P1);
Vh u, v, uu, vv;
real E = {E}, nu = {nu};
real mu = E / (2 * (1 + nu)), lambda = {lame};
macro e(u, v) [dx(u), dy(v), (dy(u) + dx(v))] //
macro div(u, v) (dx(u) + dy(v)) //
solve elasticity([u, v], [uu, vv]) =
  int2d(Th)(lambda * div(u, v) * div(uu, vv)
    + 2 * mu * (dx(u) * dx(uu) + dy(v) * dy(vv)) + mu * (dy(u) + dx(v)) * (dy(uu) + dx(vv))){loads}{held};
Wh a = u, b = v;
int[int] order = [1];
savevtk("{name}.vtu", Th, [a, b, 0], order=order, dataname="displacement", bin=true);
"""


def by_freefem(scene: Scene, per_quarter: int, element: str, folder: Path, name: str) -> Path:
    """Meshed for, and solved by, FreeFEM ("P1" or "P2"): its .vtu, displacements of the corners of its triangles."""
    given = model(scene, "triangle", per_quarter)
    pairs, count = np.unique(_edges(given.nodes).reshape(-1, 2), axis=0, return_counts=True)
    pairs = pairs[count == 1]
    labels, held, loads = np.full(len(pairs), 99), [], []
    for k, condition in enumerate(scene.loading, start=1):
        labels[condition.on(given.points)[pairs].all(axis=1)] = k
        moved = [
            f"{called} = {u.at:.12g} + {u.by_x:.12g} * x + {u.by_y:.12g} * y"
            for called, u in zip("uv", condition.displacement, strict=True)
            if u is not None
        ]
        if moved:
            held.append(f"\n  + on({k}, {', '.join(moved)})")
        if condition.is_loaded:
            t_x, t_y = condition.traction
            loads.append(f"\n  - int1d(Th, {k})({t_x:.12g} * uu + {t_y:.12g} * vv)")
    held += _points_held(given, loads and not held)
    lines = ["MeshVersionFormatted 2", "Dimension 2", "Vertices", str(len(given.points))]
    lines += [f"{x:.15g} {y:.15g} 0" for x, y in given.points]
    lines += ["Edges", str(len(pairs))]
    lines += [f"{a + 1} {b + 1} {k}" for (a, b), k in zip(pairs, labels, strict=True)]
    lines += ["Triangles", str(len(given.nodes))]
    lines += [f"{a + 1} {b + 1} {c + 1} 0" for a, b, c in given.nodes]
    (folder / f"{name}.mesh").write_text("\n".join([*lines, "End", ""]))
    material = scene.material
    E, nu = material.E, material.nu
    lame = "E * nu / (1 - nu^2)" if material.state == "plane stress" else "E * nu / ((1 + nu) * (1 - 2 * nu))"
    text = FREEFEM.format(
        name=name, element=element, E=E, nu=nu, lame=lame, loads="".join(loads), held="".join(held)
    )
    (folder / f"{name}.edp").write_text(text)
    done = subprocess.run(
        ["FreeFem++", "-nw", "-v", "0", f"{name}.edp"],
        cwd=folder,
        capture_output=True,
        text=True,
        env={"FF_LOADPATH": "/usr/lib/freefem++", **os.environ},  # where Debian has its plugins
    )
    if done.returncode or not (folder / f"{name}.vtu").exists():
        raise RuntimeError(f"FreeFem++ {name} failed: {done.stdout[-500:]}")
    return folder / f"{name}.vtu"


def _points_held(given: Model, free: object) -> list[str]:
    """What holds a part that is loaded alone: next to nothing, everywhere."""
    return ["\n  + int2d(Th)(1e-9 * E * (u * uu + v * vv))"] if free else []


def by_scikit_fem(given: Model, scene: Scene) -> np.ndarray:
    """Displacements (n, 2) of linear triangles or quadrilaterals by scikit-fem."""
    mesh = (MeshTri if given.kind == "triangle" else MeshQuad)(given.points.T, given.nodes.T)
    element = ElementTriP1() if given.kind == "triangle" else ElementQuad1()
    basis = Basis(mesh, ElementVector(element))
    E, nu = scene.material.plane_stress_equivalent
    lame = E * nu / (1 - nu**2), E / (2 * (1 + nu))
    K = linear_elasticity(*lame).assemble(basis)
    u, force = np.zeros(K.shape[0]), np.zeros(K.shape[0])
    for i, dofs in enumerate(basis.nodal_dofs):
        u[dofs] = np.nan_to_num(given.held[:, i])
        force[dofs] = given.force[:, i]
    held = np.concatenate([dofs[np.isfinite(given.held[:, i])] for i, dofs in enumerate(basis.nodal_dofs)])
    u = solve(*condense(K, force, x=u, D=held))
    return u[basis.nodal_dofs].T
