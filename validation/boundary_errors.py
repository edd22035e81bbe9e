"""Do boundary integrals tell their error? Random parts with cracks, against higher orders and body-fitted meshes.

Parts are those of random_parts.py, each with one or two more cracks: inside, from an edge, kinked by up to 90 degrees.
Each is loaded in three ways: a displaced edge, a strain on all edges, and a traction on a stretch of one side with a
stretch of the bottom held. K of every tip and the stress at thirty points of the surfaces and as many inside come with
their estimated error (`BoundaryModel.with_error`), and are compared with those by 12 points on a panel and on the
cracks. K and the stress at the surfaces are compared with those of a body-fitted mesh and its uniform refinement, too,
which are extrapolated and tell their own error.

Required: 95 % of the errors are below what was told or below 1e-6 of the largest value, the estimate is in the median
not ten times too wide; 95 % of the K and stresses agree with the mesh within what both tell or 0.1 %.

Writes validation/results/boundary_errors.csv part by part, and goes on where it ended: to compute a part anew, take out
its lines. Half an hour for 60 parts on one core; ``--quick`` three parts without meshes.
"""

from __future__ import annotations

import os

# a small factorisation takes longer on several threads
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from collections.abc import Callable, Iterator

import numpy as np
import shapely
from checks import Check, append, run, saved, show
from random_parts import drawn

from slmm.boundary.model import BoundaryModel
from slmm.fem.mesh import PlateMesh, plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fem.supports import at_supports
from slmm.fracture.loading import crack_tip_loading
from slmm.initiation.body_fitted import BodyFitted
from slmm.initiation.uncracked import Raster
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import Affine, Condition, Loading, plate_loading

PMMA = Material.from_name("PMMA")
PARTS = 60
#: order of what is taken as true
TRUE = {"p": 12, "crack_p": 12}
#: share of the largest value below which an error is of no importance; the same of what meshes are good for anyhow
ROUND, MESH = 1e-6, 1e-3
#: points on surfaces and inside, of the former so many on the outer edge, and their distance from cracks and from where
#: conditions change, mm
PLACES, ON_EDGE, CLEAR = 30, 10, 1.0
Row = dict[str, float | int | str]


def cracked(rng: np.random.Generator) -> Part:
    """A random part with cracks that do not sever it."""
    while True:
        part = drawn(rng).scene.part
        width, height = np.ptp(part.outer, axis=0)
        for _ in range(rng.integers(1, 3)):
            start = rng.uniform(0.1, 0.9, 2) * (width, height)
            if rng.random() < 0.4:
                start[0] = 0.0
            angle = rng.uniform(0.0, 2 * np.pi)
            line = [start]
            for _ in range(rng.integers(1, 3)):
                line.append(
                    line[-1]
                    + rng.uniform(0.03, 0.15) * min(width, height) * np.array([np.cos(angle), np.sin(angle)])
                )
                angle += rng.uniform(-0.5, 0.5) * np.pi
            try:
                part = part.with_crack(np.array(line))
            except ValueError:
                continue
        if part.tips and not part.is_severed:
            return part


def loadings(part: Part, rng: np.random.Generator) -> dict[str, Loading]:
    """Three ways to load it."""
    width, height = (float(x) for x in np.ptp(part.outer, axis=0))
    low, high = sorted(float(x) for x in rng.uniform(0.1, 0.9, 2) * height)
    left, right = sorted(float(x) for x in rng.uniform(0.0, 1.0, 2) * width)
    if rng.random() < 0.5:
        left, right = 0.0, width
    held = Condition((left, 0.0), (right, 0.0), (Affine(), Affine()))
    pulled = Condition((width, low), (width, high), traction=(float(rng.uniform(-3, 3)), 1.0))
    strain = tuple(float(x) for x in rng.uniform(-1e-3, 1e-3, 3))
    return {
        "displacement": plate_loading(width, height, displacement=0.1),
        "strain": plate_loading(width, height, strain=(strain[0], strain[1], strain[2])),
        "bottom held": Loading((held, pulled)),
    }


def places(part: Part, around: dict[str, Loading], rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) on the surfaces, and inside."""
    on_holes = np.concatenate([hole.points(rng.uniform(0, hole.length, PLACES)) for hole in part.holes])
    edge = shapely.LinearRing(part.outer)
    on_edge = shapely.get_coordinates(edge.interpolate(rng.uniform(0, edge.length, PLACES)))
    # cracks and ends of supports have no stress to compare
    ends = shapely.multipoints(np.concatenate([loading.ends for loading in around.values()]))
    cracks = [shapely.LineString(crack.points) for crack in part.cracks]
    near = shapely.union_all([*cracks, ends]).buffer(CLEAR)
    at_body = part.body.buffer(1e-3)

    def clear(points: np.ndarray) -> np.ndarray:
        return points[shapely.contains_xy(at_body, *points.T) & ~shapely.contains_xy(near, *points.T)]

    inside = rng.uniform(0, 1, (200, 2)) * np.ptp(part.outer, axis=0)
    inside = clear(inside[shapely.contains_xy(part.body, *inside.T)])
    return (
        np.concatenate([clear(on_holes)[: PLACES - ON_EDGE], clear(on_edge)[:ON_EDGE]]),
        inside[:PLACES],
    )


def meshes(part: Part, around: dict[str, Loading]) -> tuple[PlateMesh, PlateMesh]:
    """A mesh of a part that serves all its loadings, and its refinement."""
    supports = [at_supports(part, loading) for loading in around.values()]
    points, sizes = (np.concatenate(of) for of in zip(*supports, strict=True))
    ends = np.concatenate([loading.ends for loading in around.values()])
    mesh = plate_mesh(part, None, None, (points, sizes), np.unique(ends, axis=0))
    return mesh, mesh.refined()


def by_meshes(
    pair: tuple[PlateMesh, PlateMesh], part: Part, loading: Loading, surface: np.ndarray
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """K (k, 2) and stress (n, 3), extrapolated, with their errors (k,) and (n,).

    NaN for a tip whose surroundings leave no contour.
    """
    models = [PlateModel(mesh, PMMA, loading) for mesh in pair]
    found = []
    for model in models:
        tips = crack_tip_loading(model.results)
        at = np.column_stack([tips["x"], tips["y"]])
        K = np.column_stack([tips["K_I"], tips["K_II"]])
        wanted = np.array([line[-1] for line in part.tips])
        gap = np.linalg.norm(at[None] - wanted[:, None], axis=2)
        found.append(np.where((gap.min(axis=1) < 1e-3)[:, None], K[gap.argmin(axis=1)], np.nan))
    field = BodyFitted(*models, Raster(np.ones((1, 1)), *np.ptp(part.outer, axis=0)))
    # elements at tips have no singularity built in: what they lack is linear in their size
    return {
        "K": (2 * found[1] - found[0], np.linalg.norm(found[1] - found[0], axis=1)),
        "stress at the surface": field.stress(surface),
    }


def rows(number: int, with_mesh: bool) -> Iterator[Row]:
    """Errors and estimates of a part."""
    rng = np.random.default_rng(number)
    part = cracked(rng)
    around = loadings(part, rng)
    surface, inside = places(part, around, rng)
    pair = meshes(part, around) if with_mesh else None
    figures: dict[str, Callable[[BoundaryModel], np.ndarray]] = {
        "K": BoundaryModel.stress_intensities,
        "stress at the surface": lambda model: model.stress(surface),
        "stress inside": lambda model: model.stress(inside),
    }
    for name, loading in around.items():
        model = BoundaryModel(part, PMMA, loading)
        true = BoundaryModel(part, PMMA, loading, **TRUE)
        fitted = {} if pair is None else by_meshes(pair, part, loading, surface)
        for figure, of in figures.items():
            value, told = model.with_error(of)
            exact = of(true)
            scale = float(np.linalg.norm(exact, axis=1).max(initial=0.0))
            errors = np.linalg.norm(value - exact, axis=1)
            yield from (
                row(number, name, figure, *each)
                for each in enumerate(zip(errors / scale, told / scale, strict=True))
            )
            if figure in fitted:
                mesh, of_mesh = fitted[figure]
                errors, told = np.linalg.norm(value - mesh, axis=1), told + of_mesh
                for k in np.flatnonzero(np.isfinite(errors)):
                    yield row(
                        number, name, f"{figure}, by a mesh", int(k), (errors[k] / scale, told[k] / scale)
                    )


def row(number: int, loading: str, figure: str, place: int, error_and_told: tuple[float, float]) -> Row:
    error, told = (float(x) for x in error_and_told)
    return {
        "part": number,
        "loading": loading,
        "figure": figure,
        "place": place,
        "error": error,
        "told": told,
    }


def judged(found: list[Row]) -> list[Check]:
    """What is required of each figure."""
    checks = []
    for figure in dict.fromkeys(str(r["figure"]) for r in found):
        error, told = (
            np.array([float(r[key]) for r in found if r["figure"] == figure]) for key in ("error", "told")
        )
        floor = MESH if "mesh" in figure else ROUND
        outside = float(np.mean((error > told) & (error > floor)))
        checks.append(Check(figure, "share outside the estimate", 0.05, outside, rule="at most"))
        checks.append(
            Check(figure, "median of the errors", 10 * floor, float(np.median(error)), rule="at most")
        )
        wide = float(np.median(told[error > 0] / error[error > 0]))
        checks.append(Check(figure, "estimate over error, median", 10.0, wide, rule="at most"))
    return checks


def main(quick: bool = False) -> list[Check]:
    """Compare all parts; see the module."""
    if quick:
        found = [row for number in range(3) for row in rows(number, with_mesh=False)]
    else:
        done = {int(row["part"]) for row in saved("boundary_errors")}
        for number in sorted(set(range(PARTS)) - done):
            append("boundary_errors", rows(number, with_mesh=True))
        found = [*saved("boundary_errors")]
    checks = judged(found)
    show("Estimated errors of boundary integrals on random parts", checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
