"""What holds and loads a solved part: displacements where the model was moved, tractions where forces acted on it.

Where all nodes of a stretch move as a linear function of the place, as held, moved or rigidly coupled ones do, it is
moved as they were. Elsewhere the forces on its nodes count, which are in balance whatever the elements: displacements
there are too small by as much as the mesh makes the part too stiff. The traction is the smooth one whose work on the
elements' edges is that of the forces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.linalg import null_space

from slmm.mechanics.rigid import free_motions, motions_about
from slmm.part.span import Span
from slmm.results.field import DisplacementField
from slmm.results.outlines import Ring
from slmm.results.surface_forces import ABOVE_NOISE, SurfaceForces
from slmm.scene.loading import Condition
from slmm.scene.sampled import Sampled
from slmm.scene.varying_traction import VaryingTraction

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: displacements that miss a linear function by less than this share of the largest one are one; files have six digits
LINEAR = 1e-5
#: degree of the tractions, at most, and less by one than the number of edges (chosen)
DEGREE = 6
#: forces that act are so many times the noise, or fewer until those that act are in balance but for this share, and
#: layers of elements whose nodes' forces count for the loads they are about (chosen)
FAINTER, UNBALANCED, LAYERS = (ABOVE_NOISE, 4.0, 2.0), 0.02, 4
#: runs that carry less than this share of the largest one, by forces of less than so many times the noise, are noise
#: themselves: elements of one point, which other programs keep from folding in ways of their own, leave 4 % (chosen)
LITTLE, STANDS_OUT = 0.06, 24.0
#: edges between loaded ones that are loaded as well, at most (chosen)
GAP = 2
#: Gauss points on an edge: exact for the traction on a middle node's parabola; and how much resultants count beside
#: the force on a single node (chosen)
EDGE_POINTS, RESULTANT = 5, 1e3


@dataclass(frozen=True, eq=False)
class Run:
    """Edges in a row that carry forces.

    Attributes
    ----------
    span : Span
    edges : ndarray (m, 3)
        Nodes at start, end and middle, or else -1.
    nodes : ndarray (k,)
        In order.
    share : ndarray (k,)
        Of the span's length, ascending from 0 to 1.
    acts, moved : ndarray (2,) of bool
        In which directions forces act, and which of them are told by displacements.
    """

    span: Span
    edges: NDArray[np.int64]
    nodes: NDArray[np.int64]
    share: Array
    acts: Flags
    moved: Flags

    @property
    def pulled(self) -> Flags:
        """In which directions forces count."""
        return self.acts & ~self.moved

    @property
    def degree(self) -> int:
        """Of its traction."""
        return min(DEGREE, len(self.edges) - 1)


def solved_loads(
    field: DisplacementField, rings: Sequence[Ring], surface: SurfaceForces
) -> tuple[Condition, ...]:
    """What acts on a model's free edges, as conditions on its outlines.

    Examples
    --------
    >>> from slmm import Material
    >>> from slmm.results.outlines import mesh_outlines
    >>> from slmm.results.surface_forces import surface_forces
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> pulled = DisplacementField(square, {"quad": np.array([[0, 1, 2, 3]])}, 1e-3 * square * [1, 0])
    >>> rings = mesh_outlines(pulled)
    >>> forces = surface_forces(pulled, Material(100e3, 0.0, 10.0, 0.1), rings[0].nodes)
    >>> [(condition.rule[1].mean(axis=0).round(6) + 0.0).tolist() for condition in solved_loads(pulled, rings, forces)]
    [[0.0, 0.0], [100.0, 0.0], [0.0, 0.0], [-100.0, 0.0]]
    """
    for times in FAINTER:
        runs = [run for ring in rings for run in _runs(field, ring, surface.above(times))]
        runs = [run for run in runs if not _is_noise(run, runs, surface)]
        nearest = _nearest_run(field, runs)
        forces = [np.abs(surface.forces[nearest == k].sum(axis=0)).max() for k in range(len(runs))]
        left = surface.forces[nearest >= 0].sum(axis=0)
        if runs and np.abs(left).max() < UNBALANCED * sum(forces):
            break
    of_run = _tractions(field, runs, surface.forces, nearest)
    found = []
    for run, traction in zip(runs, of_run, strict=True):
        (x, y), (x_end, y_end) = field.points[run.nodes[[0, -1]]].tolist()
        u_x, u_y = (
            Sampled(run.span, run.share, field.u[run.nodes, i]) if run.moved[i] else None for i in range(2)
        )
        varying = None if traction is None else VaryingTraction(run.span, traction)
        found.append(Condition((x, y), (x_end, y_end), (u_x, u_y), span=run.span, varying=varying))
    return tuple(found)


def _runs(field: DisplacementField, ring: Ring, surface: SurfaceForces) -> Iterator[Run]:
    """Loaded edges of a ring, cut at its corners."""
    loaded = _loaded(ring, surface)
    n = len(loaded)
    if not loaded.any():
        return
    begins = loaded & (~np.roll(loaded, 1) | ring.corners)
    if not begins.any():
        begins[0] = True
    for first in np.flatnonzero(begins):
        run = [first]
        while loaded[after := (run[-1] + 1) % n] and not begins[after] and after != first:
            run.append(after)
        yield _run(field, ring, np.array(run), surface)


def _is_noise(run: Run, runs: Sequence[Run], surface: SurfaceForces) -> bool:
    """Whether a run carries little of the load, on nodes that stand out little from the noise."""
    size = np.abs(surface.forces)
    most = max(size[other.nodes].sum() for other in runs)
    out = (size[run.nodes] / surface.level[run.nodes, None]).max()
    return bool(size[run.nodes].sum() < LITTLE * most and out < STANDS_OUT)


def _loaded(ring: Ring, surface: SurfaceForces) -> Flags:
    """Which edges (n,) carry forces: those all of whose nodes do, and those beside a node that does alone."""
    there = ring.edges >= 0
    acts = np.asarray(surface.acts.any(axis=1))
    loaded = (acts[ring.edges] | ~there).all(axis=1)
    of_loaded = np.unique(ring.edges[loaded])
    alone = acts[ring.edges[:, 0]] & ~np.isin(ring.edges[:, 0], of_loaded)
    loaded = loaded | alone | np.roll(alone, -1)
    # forces of a support may pass through zero under it
    n = len(loaded)
    for gap in range(1, min(GAP, n - 2) + 1):
        for k in np.flatnonzero(loaded & ~np.roll(loaded, -1)):
            between = (k + 1 + np.arange(gap)) % n
            behind = (k + 1 + gap) % n
            if loaded[behind] and not loaded[between].any() and not ring.corners[[*between, behind]].any():
                loaded[between] = True
    return np.asarray(loaded)


def _run(field: DisplacementField, ring: Ring, of: NDArray[np.int64], surface: SurfaceForces) -> Run:
    edges = ring.edges[of]
    nodes = np.concatenate([edges[:, [0, 2]].ravel(), edges[-1:, 1]])
    nodes = nodes[nodes >= 0]
    outline = ring.outline
    s = outline.project(field.points[nodes])
    down = np.concatenate([[0.0], np.cumsum((s[:-1] - s[1:]) % outline.length)])
    span = Span(outline, float(s[0]), float(s[0] - down[-1]))
    # forces on its ends may be those of what is beside it
    inner = surface.acts[nodes[1:-1]].any(axis=0)
    acts = np.asarray(inner if inner.any() else surface.acts[nodes].any(axis=0))
    # all nodes of a held edge carry forces, and three of them tell a line
    whole = surface.acts[nodes].any(axis=1).sum() >= 3
    moved = acts & whole & _is_linear(field.points[nodes], field.u[nodes], np.abs(field.u).max())
    return Run(span, edges, nodes, down / down[-1], acts, moved)


def _is_linear(points: Array, u: Array, largest: float) -> Flags:
    """Which components (2,) of displacements (k, 2) are linear functions of the place."""
    on_line = np.column_stack([np.ones(len(points)), points - points.mean(axis=0)])
    off = u - on_line @ np.linalg.lstsq(on_line, u, rcond=1e-9)[0]
    return np.asarray(np.abs(off).max(axis=0) < LINEAR * largest)


def _nearest_run(field: DisplacementField, runs: Sequence[Run]) -> NDArray[np.int64]:
    """Which run each node (n,) is near, by layers of elements; -1 where none is.

    What other elements exert on their nodes than ours do is in balance in each element. So all that is left on nodes
    about a load adds up to it, also where a load on few nodes is spread over the elements around.
    """
    nearest = np.full(len(field.points), -1)
    for k, run in enumerate(runs):
        nearest[run.nodes] = k
    for _ in range(LAYERS if runs else 0):
        further = np.full(len(nearest), -1)
        for nodes in field.cells.values():
            of_element = nearest[nodes].max(axis=1)
            np.maximum.at(further, nodes.ravel(), np.repeat(of_element, nodes.shape[1]))
        nearest = np.where(nearest >= 0, nearest, further)
    return nearest


def _tractions(
    field: DisplacementField, runs: Sequence[Run], forces: Array, nearest: NDArray[np.int64]
) -> list[Array | None]:
    """Coefficients (k, 2) of the traction on each run; None where no force counts."""
    wanted = [(k, i) for k, run in enumerate(runs) for i in range(2) if run.pulled[i]]
    sizes = [runs[k].degree + 1 for k, _ in wanted]
    begins = np.cumsum([0, *sizes])
    columns = {pair: slice(begins[j], begins[j + 1]) for j, pair in enumerate(wanted)}
    if not wanted:
        return [None] * len(runs)
    # on a node of an edge that is moved nobody knows which part of the force is whose
    shared = np.unique(np.concatenate([run.nodes for run in runs if run.moved.any()] or [np.zeros(0, int)]))
    work = np.zeros((2 * len(field.points), begins[-1]))
    for (k, i), own in columns.items():
        for nodes, shares in _work_of_nodes(runs[k]):
            for node, row in zip(nodes, shares, strict=True):
                work[2 * node + i, own] += row
    of_nodes = np.unique(
        [2 * node + i for k, i in wanted for node in runs[k].nodes if node not in shared]
    ).astype(int)
    rows, right = [work[of_nodes]], [forces.ravel()[of_nodes]]
    for group in _groups(runs, shared):
        own = field.points[np.unique(np.concatenate([runs[k].nodes for k in group]))]
        at = np.flatnonzero(np.isin(nearest, group))
        motions = motions_about(field.points[at], own.mean(axis=0), float(np.ptp(own, axis=0).max()))
        acts = np.array([any(runs[k].pulled[i] for k in group) for i in range(2)])
        sums = np.einsum("nim,nik->mk", motions * acts[:, None], work.reshape(-1, 2, begins[-1])[at])
        rows.append(RESULTANT * sums)
        right.append(RESULTANT * np.einsum("nim,ni->m", motions * acts[:, None], forces[at]))
    a, b = np.concatenate(rows), np.concatenate(right)
    free = _balance(runs, columns, begins[-1])
    basis = null_space(free) if len(free) else np.eye(begins[-1])
    found = basis @ np.linalg.lstsq(a @ basis, b, rcond=1e-10)[0]
    result: list[Array | None] = []
    for k, run in enumerate(runs):
        if not run.pulled.any():
            result.append(None)
            continue
        coefficients = np.zeros((run.degree + 1, 2))
        for i in range(2):
            if (k, i) in columns:
                coefficients[:, i] = found[columns[k, i]]
        result.append(coefficients)
    return result


def _work_of_nodes(run: Run) -> Iterator[tuple[NDArray[np.int64], Array]]:
    """For each edge its nodes (2 or 3), and what each polynomial (k,) of traction does on them, mm."""
    x, w = leggauss(EDGE_POINTS)
    place = dict(zip(run.nodes.tolist(), run.share.tolist(), strict=True))
    # of a whole outline the last node is the first one
    starts = [0.0, *(place[node] for node in run.edges[1:, 0].tolist()), 1.0]
    for edge, start, end in zip(run.edges, starts, starts[1:], strict=False):
        shape = np.array([0.5 * (1 - x), 0.5 * (1 + x)])
        if edge[2] >= 0:
            shape = np.array([0.5 * x * (x - 1), 0.5 * x * (x + 1), 1 - x * x])
        at = start + 0.5 * (1 + x) * (end - start)
        weight = 0.5 * w * (end - start) * run.span.length
        yield edge[edge >= 0], (shape * weight) @ legendre.legvander(2 * at - 1, run.degree)


def _groups(runs: Sequence[Run], shared: NDArray[np.int64]) -> list[list[int]]:
    """Runs that are pulled alone, in groups that have nodes in common: their resultants are known."""
    groups: list[list[int]] = []
    for k, run in enumerate(runs):
        if not run.pulled.any():
            continue
        touching = [group for group in groups if any(np.isin(run.nodes, runs[j].nodes).any() for j in group)]
        groups = [group for group in groups if group not in touching]
        groups.append([*(j for group in touching for j in group), k])
    return [group for group in groups if not any(np.isin(runs[k].nodes, shared).any() for k in group)]


def _balance(runs: Sequence[Run], columns: dict[tuple[int, int], slice], n: int) -> Array:
    """Work (m, n) of the tractions' coefficients on rigid motions that nothing holds."""
    rules = [run.span.rule for run in runs]
    points = np.concatenate([rule[0] for rule in rules])
    held = np.concatenate(
        [np.tile(run.moved, (len(rule[0]), 1)) for run, rule in zip(runs, rules, strict=True)]
    )
    free = free_motions(points, held).reshape(len(points), 2, -1)
    rows = np.zeros((free.shape[2], n))
    first = 0
    for k, (run, (at, _, weight)) in enumerate(zip(runs, rules, strict=True)):
        here = free[first : first + len(at)]
        first += len(at)
        values = legendre.legvander(2 * run.span.share(at) - 1, run.degree)
        for i in range(2):
            if (k, i) in columns:
                rows[:, columns[k, i]] += np.einsum("nm,n,nk->mk", here[:, i], weight, values)
    return rows
