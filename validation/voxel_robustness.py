"""Random voxel problems: every one converges within 60 iterations, or is refused because something in it is not held.

Plates of 16 to some 3000 voxels a side, voxels square or not, void 1e-9 to 1e-2, effective Poisson's ratio -0.3 to
0.98, prescribed strain, displacement or stress; ellipses, wavy outlines, slits, thresholded noise like that of a
picture, and voxels of random stiffness. Whether a plate is in pieces is found here on the voxels, apart from the
solver. Writes validation/results/voxel_robustness.csv; --quick solves 40 and writes nothing.
"""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace

import numpy as np
from checks import Check, run, save, show
from scipy import ndimage

from slmm.part.coverage import area_fraction
from slmm.voxels.model import NotConvergedError, NotHeldError, solve_voxels

PROBLEMS, QUICK, LARGE = 1000, 40, 3
LIMIT = 60  # iterations
FAMILIES = {"ellipses": 0.3, "wavy": 0.2, "noise": 0.25, "slits": 0.15, "grain": 0.1}
LOADS = {"displacement": 0.1, "stress": 10.0}


def problem(seed: int, voxels: float | None = None) -> SimpleNamespace:
    """A random plate: density of its material (ny, nx), and what solve_voxels takes."""
    rng = np.random.default_rng(seed)
    total = 10 ** rng.uniform(2.6, 4.9) if voxels is None else voxels
    aspect = 2 ** rng.uniform(-4.5, 4.5) if voxels is None else 2 ** rng.uniform(-0.5, 0.5)
    nx, ny = (max(16, round(np.sqrt(total * ratio))) for ratio in (aspect, 1 / aspect))
    stretch = 2 ** rng.normal(0, 0.7) if rng.random() < 0.4 else 1.0
    scale = 10 ** rng.uniform(-3, 3)
    width, height = scale * nx * stretch, scale * ny
    void = 10 ** rng.uniform(-9, -2)
    nu = rng.uniform(-0.3, 0.5) if rng.random() < 0.4 else 1 - 10 ** rng.uniform(-1.7, -0.3)
    kind = str(rng.choice(["strain", "displacement", "stress"]))
    family = str(rng.choice(list(FAMILIES), p=list(FAMILIES.values())))
    if family == "noise":
        density = noise(rng, nx, ny, kind)
    elif family == "grain":
        density = rng.uniform(0, 1, (ny, nx)) ** rng.uniform(0.5, 4)
    else:
        holes = [
            hole
            for _ in range(rng.integers(1, 13))
            if (hole := outline(rng, family, width, height, kind)) is not None
        ]
        density = 1 - area_fraction(holes, width, height, nx, ny)
    if kind == "stress":  # in balance: both edges whole
        density[[0, -1]] = 1.0
    load = SimpleNamespace(strain=None, displacement=None, stress=None)
    setattr(load, kind, tuple(rng.normal(0, 0.01, 3)) if kind == "strain" else LOADS[kind])
    return SimpleNamespace(
        seed=seed,
        density=density,
        void=void,
        width=width,
        height=height,
        nu=nu,
        load=load,
        kind=kind,
        family=family,
    )


def outline(rng, family, width, height, kind):
    """Points (400, 2) of a hole anywhere; None where it would have to cut an edge that a stress pulls at."""
    t = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    size = min(width, height)
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    if family == "slits":
        points = circle * size * [rng.uniform(0.1, 0.45), 10 ** rng.uniform(-2.5, -1)]
    elif family == "ellipses":
        points = circle * size * rng.uniform(0.03, 0.35) * [1, rng.uniform(0.2, 1)]
    else:
        waves = sum(rng.normal(0, 0.25) / k * np.cos(k * t + rng.uniform(0, 7)) for k in range(2, 9))
        points = circle * size * rng.uniform(0.03, 0.35) * np.clip(1 + waves, 0.2, 3)[:, None]
    angle = rng.uniform(0, 2 * np.pi)
    points = points @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    points += [rng.uniform(0, width), rng.uniform(0, height)]
    if kind == "stress":
        low, high, margin = points[:, 1].min(), points[:, 1].max(), 0.03 * height
        if high - low > height - 2 * margin:
            return None
        points[:, 1] += max(0.0, margin - low) - max(0.0, high - (height - margin))
    return points


def noise(rng, nx, ny, kind):
    """Blobs as of a photograph, with blurred edges."""
    length = rng.uniform(1, max(2, min(nx, ny) / 8))
    field = ndimage.gaussian_filter(rng.normal(size=(ny, nx)), length, mode="nearest")
    level = np.quantile(field, rng.uniform(0.05, 0.5))
    density = np.clip((field - level) / (field.std() * rng.uniform(0.01, 0.3)) + 0.5, 0, 1)
    if kind == "stress" or rng.random() < 0.5:
        rows = max(1, int(0.03 * ny))
        density[:rows] = density[-rows:] = 1.0
    return density


def solved(case: SimpleNamespace) -> dict[str, object]:
    """One row of the file: iterations and how it ended."""
    stiffness = case.void + (1 - case.void) * case.density
    ny, nx = stiffness.shape
    iterations, end = 0, "converged"
    try:
        iterations = solve_voxels(stiffness, case.width, case.height, case.nu, case.load, E=1e3).iterations
    except NotHeldError:
        end = "not held"
    except NotConvergedError:
        end = "not converged"
    # pieces of what is much stiffer than the void
    pieces = ndimage.label(stiffness > np.sqrt(stiffness.min() * stiffness.max()))[1]
    return {
        "seed": case.seed,
        "nx": nx,
        "ny": ny,
        "nu": case.nu,
        "void": case.void,
        "load": case.kind,
        "family": case.family,
        "pieces": pieces,
        "iterations": iterations,
        "end": end,
    }


def main(quick: bool) -> list[Check]:
    """Solve them all, tell the iterations' distribution and what was refused."""
    rows = [solved(problem(seed)) for seed in range(QUICK if quick else PROBLEMS)]
    if not quick:
        rows += [solved(problem(seed, voxels=4e6)) for seed in range(PROBLEMS, PROBLEMS + LARGE)]
    ends = Counter(str(row["end"]) for row in rows)
    iterations = np.array([row["iterations"] for row in rows if row["end"] == "converged"])
    for share in (0.5, 0.9, 0.99, 1.0):
        print(
            f"{100 * share:4.0f} % of those that converged: at most {np.quantile(iterations, share):.0f} iterations"
        )
    print(", ".join(f"{number} {end}" for end, number in ends.items()))
    checks = [
        Check(
            f"{len(rows)} plates",
            "not converged",
            0.0,
            ends["not converged"],
            rule="at most",
            source="required",
        ),
        Check(
            f"{len(rows)} plates",
            "iterations",
            LIMIT,
            float(iterations.max()),
            rule="at most",
            source="required",
        ),
        Check(
            f"{len(rows)} plates",
            "refused although in one piece",
            0.0,
            sum(row["end"] == "not held" and row["pieces"] == 1 for row in rows),
            rule="at most",
            source="required",
        ),
    ]
    show("Random voxel problems", checks)
    if not quick:
        save("voxel_robustness", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
