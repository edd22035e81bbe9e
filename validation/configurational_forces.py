"""Configurational forces against ConForce, the tool that Paper B published, and as the derivative of the energy.

All element types. Deformation gradients, stresses and forces of distorted elements against ConForce's; forces of
large strains against the differences of an element's energy, those of small strains against the differences of the
energy of a body that is solved anew when a node has moved; the two-phase bar of Paper B from a solve on a mesh.

Speed: 10^5 elements, both tools in turn, the median over runs of ConForce's time over ours. Both take the threads that
they take by themselves: ConForce's library has one, ours all cores; the ratio with one thread of ours is told as well.
On a machine that others keep busy (load above 1) it is told without a verdict.

Required: agreement to 1e-12, derivatives to 1e-8, speed at least ConForce's. Writes
validation/results/configurational_forces.csv, _speed.csv and .png; two minutes, ``--quick`` three types' speed alone.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from itertools import permutations

import conforce.cf_c as conforce
import matplotlib
import numba
import numpy as np
from checks import RESULTS, Check, run, save, show
from elastic_model import solved
from scipy.optimize import brentq

from slmm.fracture.configurational_forces import (
    compute_CF,
    compute_CS,
    compute_F,
    compute_P,
    nodal_configurational_forces,
)
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import ELEMENTS
from slmm.results.neighbourhood import interface_nodes

matplotlib.use("Agg")
import matplotlib.pyplot as plt

METHODS = ("mbf", "dbf")
ELEMENT_COUNT, RUNS = 100_000, 9
#: load of the machine above which times are not judged
BUSY = 1.0
#: with one point, it has ways to move without strain that a row of elements does not stop
HOURGLASSES = ("C3D8R",)

#: the types of Paper B; of VTK's biquadratic ones the published tool has none
PUBLISHED = tuple(name for name in ELEMENTS if name not in ("QUAD9", "HEX27", "WEDGE18"))


def random_elements(name: str, count: int, seed: int = 0) -> tuple[np.ndarray, ...]:
    """Distorted elements with random displacements, stresses and energies."""
    element, rng = ELEMENTS[name], np.random.default_rng(seed)
    n, d = element.nodes.shape
    X = element.nodes * rng.uniform(1.0, 3.0, (count, 1, 1)) + rng.uniform(-0.08, 0.08, (count, n, d))
    U = rng.uniform(-0.08, 0.08, (count, n, d))
    S = rng.normal(size=(count, len(element.points), d, d))
    return X, U, S + S.swapaxes(-1, -2), rng.normal(size=S.shape[:2])


def agreement() -> list[Check]:
    """Largest difference of each type of Paper B, over the largest value."""
    checks = []
    for name in PUBLISHED:
        X, U, S, e = random_elements(name, 200)
        pairs = [
            (compute_F(X, U, name), conforce.compute_F(X, U, name)),
            (compute_P(X, U, S, name), conforce.compute_P(X, U, S, name)),
        ]
        for method in METHODS:
            pairs.append(
                (compute_CS(X, U, S, e, name, method), conforce.compute_CS(e, X, U, S, name, method))
            )
            pairs.append(
                (compute_CF(X, U, S, e, name, method), conforce.compute_CF(e, X, U, S, name, method))
            )
        worst = max(np.abs(ours - theirs).max() / np.abs(theirs).max() for ours, theirs in pairs)
        checks.append(
            Check(name, "largest difference of F, P, CS, CF", 1e-12, worst, rule="at most", source="ConForce")
        )
    return checks


def derivative(energy: Callable[[np.ndarray], float], at: np.ndarray, step: float) -> np.ndarray:
    """Differences of fourth order of a function of an array, by each of its entries."""
    result = np.empty_like(at)
    for i in np.ndindex(*at.shape):
        W = []
        for h in (-2, -1, 1, 2):
            moved = at.copy()
            moved[i] += h * step
            W.append(energy(moved))
        result[i] = (W[0] - 8 * W[1] + 8 * W[2] - W[3]) / (12 * step)
    return result


def neo_hooke(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Energy density and Cauchy stress, plane strain in 2D."""
    mu, lame = 1.3, 2.1
    J, B, one = np.linalg.det(F), F @ F.swapaxes(-1, -2), np.eye(F.shape[-1])
    trace = np.trace(B - one, axis1=-2, axis2=-1)
    energy = mu / 2 * (trace - 2 * np.log(J)) + lame / 2 * np.log(J) ** 2
    return energy, (mu * (B - one) + lame * np.log(J)[..., None, None] * one) / J[..., None, None]


def derivatives() -> list[Check]:
    """Largest difference to the derivative of the energy, over the largest force."""
    checks, source = [], "differences of the energy"
    for name, element in ELEMENTS.items():
        X, U, _, _ = random_elements(name, 1, seed=3)
        density, S = neo_hooke(compute_F(X, U, name))
        for method in METHODS:

            def energy(moved, X=X, U=U, name=name, element=element, method=method):
                kept = U if method == "dbf" else U + X - moved
                volume = np.linalg.det(np.einsum("eni,qnj->eqij", moved, element.gradient_at_points))
                return float((neo_hooke(compute_F(moved, kept, name))[0] * volume)[0] @ element.weights)

            forces = compute_CF(X, U, S, density, name, method)
            worst = np.abs(forces - derivative(energy, X, 1e-3)).max() / np.abs(forces).max()
            checks.append(
                Check(
                    name, f"derivative, {method}, large strains", 1e-8, worst, rule="at most", source=source
                )
            )
        worst = moved_node(name)
        checks.append(
            Check(name, "derivative, linear, body solved anew", 1e-8, worst, rule="at most", source=source)
        )
    return checks


def moved_node(name: str) -> float:
    """Error of the force on the node in the middle of a body of two elements a side; the body is solved anew."""
    d = ELEMENTS[name].dimension
    points, nodes = block(name, *[[-1.0, 0.1, 1.0]] * d)
    middle = int(np.argmin(np.linalg.norm(points, axis=1)))
    rim = np.repeat(np.abs(points).max(axis=1, keepdims=True) > 1 - 1e-9, d, axis=1)
    pull = 1e-2 * np.random.default_rng(1).normal(size=points.shape)

    def results(place: np.ndarray) -> ElementResults:
        moved = points.copy()
        moved[middle] = place
        return solved(moved, {name: nodes}, Elasticity(1e3, 0.3), rim, pull)

    def energy(place: np.ndarray) -> float:
        found, element = results(place), ELEMENTS[name]
        volume = np.linalg.det(np.einsum("eni,qnj->eqij", found.points[nodes], element.gradient_at_points))
        return float(((found.energy[name] * volume) @ element.weights).sum())

    force = forces_of(results(points[middle]))[middle]
    return float(np.abs(force - derivative(energy, points[middle], 1e-3)).max() / np.abs(force).max())


def block(name: str, *edges: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, d) and cells (el, k) of a grid whose lines are given, each of its cells cut into elements of a type."""
    element = ELEMENTS[name]
    d = element.dimension
    unit, one = np.eye(d), np.ones(d)
    if element.nodes.min() < 0:
        pieces = [(element.nodes + 1) / 2]
    elif d == 3 and element.corners == 4:
        # six tetrahedra, each along the edges in another order; every second one the other way round
        walks = [np.cumsum(unit[list(order)], axis=0) for order in permutations(range(3))]
        pieces = [element.nodes @ (w if np.linalg.det(w) > 0 else w[[1, 0, 2]]) for w in walks]
    else:
        # two triangles or wedges; the other one turned by half a turn in the plane
        turned = unit.copy()
        turned[:2] *= -1
        pieces = [element.nodes, element.nodes @ turned + np.where(np.arange(d) < 2, one, 0.0)]
    origins = np.stack(np.meshgrid(*[e[:-1] for e in edges], indexing="ij"), axis=-1).reshape(-1, 1, d)
    sizes = np.stack(np.meshgrid(*[np.diff(e) for e in edges], indexing="ij"), axis=-1).reshape(-1, 1, d)
    places = np.concatenate([origins + sizes * piece for piece in pieces])
    points, cells = np.unique(places.reshape(-1, d).round(9), axis=0, return_inverse=True)
    return points, cells.reshape(len(places), -1)


def forces_of(results: ElementResults) -> np.ndarray:
    return nodal_configurational_forces(
        results.points, results.cells, results.u, results.stress, results.energy, results.method
    )


def two_phase_bar() -> list[Check]:
    """Force on the interface of a bar of 20 x 10 x 1 mm, 0.1 mm longer, its left half twice as stiff."""
    checks = []
    phases = [Elasticity(210e3, 0.0), Elasticity(105e3, 0.0)]
    for name, element in ELEMENTS.items():
        if name in HOURGLASSES:
            continue
        lines = [0.0, 2.0, 5.0, 10.0, 14.0, 20.0], [0.0, 3.0, 10.0], [0.0, 1.0]
        points, nodes = block(name, *lines[: element.dimension])
        region = {name: (points[nodes][..., 0].mean(axis=1) > 10.0).astype(int)}
        prescribed, values = np.zeros(points.shape, dtype=bool), np.zeros(points.shape)
        prescribed[points[:, 0] == 0.0] = True
        right = points[:, 0] == 20.0
        prescribed[right, 0], values[right, 0] = True, 0.1
        found = solved(points, {name: nodes}, phases, prescribed, values, region)
        force = forces_of(found)[interface_nodes(found.cells, region)].sum(axis=0)
        case = f"two-phase bar, {len(nodes)} {name}"
        checks.append(
            Check(case, "force on the interface, N", 35 / 3, force[0], 1e-9, source="exact, small strains")
        )
    checks.append(
        Check(
            "two-phase bar, 2 CPE4",
            "large strains, N",
            11.718,
            logarithmic_bar(),
            5e-5,
            source="Paper B, its tool",
        )
    )
    return checks


def logarithmic_bar() -> float:
    """As Abaqus has the bar with large displacements: half the stress times the logarithmic strain."""
    E, length = np.array([210e3, 105e3]), 10.0

    def stress(left: float) -> np.ndarray:
        return E * np.log1p(np.array([left, 0.1 - left]) / length)

    left = brentq(lambda left: float(np.subtract(*stress(left))), 0.0, 0.1)
    points, nodes = block("CPE4", [0.0, 10.0, 20.0], [0.0, 10.0])
    u = np.zeros_like(points)
    u[:, 0] = np.interp(points[:, 0], [0.0, 10.0, 20.0], [0.0, left, 0.1])
    S = np.zeros((2, 4, 2, 2))
    S[..., 0, 0] = stress(left)[:, None]
    energy = S[..., 0, 0] ** 2 / (2 * E[:, None])
    forces = nodal_configurational_forces(points, {"CPE4": nodes}, u, {"CPE4": S}, {"CPE4": energy})
    return float(forces[points[:, 0] == 10.0, 0].sum())


def measured(name: str, method: str) -> dict[str, object]:
    """Times of both tools, run in turn, in ms."""
    X, U, S, e = random_elements(name, ELEMENT_COUNT)

    def ours() -> None:
        compute_CF(X, U, S, e, name, method)

    def theirs() -> None:
        conforce.compute_CF(e, X, U, S, name, method)

    times = in_turn(ours, theirs)
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    one_thread = in_turn(ours, theirs)
    numba.set_num_threads(threads)
    return {
        "element": name,
        "method": method,
        "ours_ms": np.median(times[0]),
        "conforce_ms": np.median(times[1]),
        "ratio": np.median(times[1] / times[0]),
        "ratio_of_the_best": times[1].min() / times[0].min(),
        "ratio_one_thread": np.median(one_thread[1] / one_thread[0]),
    }


def in_turn(*tools: Callable[[], None]) -> np.ndarray:
    """Times (tools, RUNS) in ms; what loads and compiles kernels, and starts threads, is not counted."""
    times = np.empty((RUNS + 1, len(tools)))
    for row in times:
        for k, tool in enumerate(tools):
            start = time.perf_counter()
            tool()
            row[k] = 1e3 * (time.perf_counter() - start)
    return times[1:].T


def speed(names: tuple[str, ...], methods: tuple[str, ...]) -> tuple[list[Check], list[dict[str, object]]]:
    """ConForce's time over ours; judged as ours over ConForce's."""
    busy = os.getloadavg()[0] > BUSY
    checks, rows = [], []
    for name in names:
        for method in methods:
            row = measured(name, method)
            rows.append(row)
            quantity = f"our time over ConForce's, {method}"
            rule = "told" if busy else "at most"
            checks.append(Check(name, quantity, 1.0, 1 / row["ratio"], rule=rule, source="required"))
            checks.append(
                Check(name, f"{quantity}, one thread", 1.0, 1 / row["ratio_one_thread"], rule="told")
            )
    return checks, rows


def draw(rows: list[dict[str, object]]) -> None:
    figure, axis = plt.subplots(figsize=(8, 3.6), layout="constrained")
    shown = [row for row in rows if row["method"] == "mbf"]
    x = np.arange(len(shown))
    axis.bar(x, [row["ratio"] for row in shown], color="C0", label="all cores")
    axis.plot(x, [row["ratio_one_thread"] for row in shown], "ko", ms=4, label="one thread")
    axis.axhline(1.0, color="0.5", lw=1)
    axis.set(
        yscale="log", ylabel="ConForce's time over ours", title="Configurational forces, 10$^5$ elements"
    )
    axis.set_yticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    axis.set_xticks(x, [row["element"] for row in shown], rotation=45)
    axis.legend(frameon=False)
    figure.savefig(RESULTS / "configurational_forces.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    # first, before our own work loads the machine
    checks, rows = speed(
        ("CPE3", "CPE4", "C3D8") if quick else tuple(ELEMENTS), METHODS[:1] if quick else METHODS
    )
    checks += agreement() + derivatives() + two_phase_bar()
    show("Configurational forces", checks)
    if not quick:
        save("configurational_forces", [check.row() for check in checks])
        save("configurational_forces_speed", rows)
        draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
