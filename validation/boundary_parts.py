"""Boundary integrals on parts of other outlines than plates, and how they converge.

A ring under pressure inside; a crack in a square by orders; compact tension and semi-circular bend as scenes; T-stress
of edge cracks.

Required: 1e-5 of exact values, the digits of high-order ones; K converges to 1e-9 where all is smooth. Writes
validation/results/boundary_parts.csv, some seconds; ``--quick`` writes nothing.
"""

from __future__ import annotations

import os

# a small factorisation takes longer on several threads
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from checks import Check, run, save, show

from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.part.span import Span
from slmm.scene.loading import Condition, Loading, plate_loading
from slmm.scene.scene import Scene

PMMA = Material.from_name("PMMA")
REQUIRED = 1e-5


def ring() -> list[Check]:
    """Lamé's ring under pressure inside: the default order, and how the error falls with it."""
    inner, outer, pressure = 10.0, 20.0, 5.0
    part = Part.within(Outline.through(circle((0, 0), outer)), [Outline.through(circle((0, 0), inner))])
    around = Span(part.holes[0], part.holes[0].length, 0.0)
    at = (inner, 0.0)
    loading = Loading((Condition(at, at, pressure=pressure, span=around),))
    A = pressure * inner**2 / (outer**2 - inner**2)
    E, nu = PMMA.E, PMMA.nu
    wanted = A / E * ((1 - nu) * inner + (1 + nu) * outer**2 / inner)
    checks = []
    for p, allowed in ((8, REQUIRED), (10, 1e-6), (12, 1e-7)):
        model = BoundaryModel(part, PMMA, loading, p)
        right, left = model.displacement(np.array([[inner, 0.0], [-inner, 0.0]]))[:, 0]
        checks.append(
            Check(
                "ring",
                f"u at the hole, {p} points a panel",
                wanted,
                0.5 * (right - left),
                allowed,
                source="exact",
            )
        )
    hoop = A * (1 + outer**2 / inner**2)
    stress = model.stress(np.array([[inner, 0.0], [0.0, inner + 0.01]]))
    return [
        *checks,
        Check("ring", "hoop stress at the hole, 12 points", hoop, stress[0, 1], REQUIRED, source="exact"),
        Check(
            "ring",
            "hoop stress 0.01 mm below",
            A * (1 + outer**2 / (inner + 0.01) ** 2),
            stress[1, 0],
            REQUIRED,
            source="exact",
        ),
    ]


def orders() -> list[Check]:
    """An inclined crack in a square plate under tension: how K converges where all is smooth."""
    part = Part.plate(40.0, 40.0, cracks=[[(14.0, 19.0), (25.0, 22.0)]])
    loading = plate_loading(40.0, 40.0, stress=1.0)
    fine = BoundaryModel(part, PMMA, loading, 20, 16).stress_intensities()[0]
    checks = []
    for p, crack_p, allowed in ((6, 4, 1e-4), (8, 6, 1e-6), (10, 8, 1e-8), (12, 10, 1e-9)):
        K = BoundaryModel(part, PMMA, loading, p, crack_p).stress_intensities()[0]
        quantity = f"off the K of 20 and 16 points, {p} and {crack_p}"
        error = float(np.abs(K - fine).max() / fine[0])
        checks.append(Check("inclined crack in a square", quantity, allowed, error, rule="at most"))
    return checks


def specimens() -> list[Check]:
    """Test specimens as scenes: compact tension, semi-circular bend; T-stress of inclined and edge cracks."""
    checks, source = [], "boundary integrals, 5 digits"
    for depth, f in ((0.45, 8.3116), (0.5, 9.6165), (0.55, 11.3202)):
        scene = compact_tension(depth)
        K = BoundaryModel(scene.part, PMMA, scene.loading).stress_intensities()[0]
        checks.append(
            Check(
                "compact tension",
                f"f, a/W = {depth:g}",
                f,
                K[0] * 10 * np.sqrt(40) / 600,
                3e-5,
                source=source,
            )
        )
    scene = semi_circular_bend(0.1)
    K = BoundaryModel(scene.part, PMMA, scene.loading).stress_intensities()[0]
    Y = K[0] * 100 / np.sqrt(np.pi * 25)
    checks.append(Check("semi-circular bend, s/2R = a/R = 0.5", "Y", 3.6119, Y, 3e-5, source=source))
    for depth, T in ((0.3, -0.61033), (0.5, -0.42168)):
        strip = Part.plate(40.0, 480.0, cracks=[[(0.0, 240.0), (40 * depth, 240.0)]])
        model = BoundaryModel(strip, PMMA, plate_loading(40.0, 480.0, stress=1.0))
        ours = float(model.t_stresses()[0])
        checks.append(Check("edge crack", f"T, a/W = {depth:g}", T, ours, 5e-5, source="Sham 1991"))
    return checks


def compact_tension(depth: float) -> Scene:
    holes = [{"shape": "circle", "center": [0, y], "radius": 5.0} for y in (11, -11)]
    outline = {"shape": "rectangle", "center": [15, 0], "size": [50, 48], "corner_radius": 0.0}
    return Scene.from_dict(
        {
            "part": {"outline": outline, "thickness": 10.0},
            "holes": holes,
            "cracks": [{"points": [[-10, 0], [40 * depth, 0]]}],
            "material": {"name": "PMMA"},
            "boundary": [{"on": "hole 0", "pin": [0, 600.0]}, {"on": "hole 1", "pin": [0, -600.0]}],
        }
    )


def semi_circular_bend(width: float) -> Scene:
    R = 50.0
    outline = {
        "shape": "polygon",
        "points": [[-R, 0], [R, 0], [R, R], [-R, R]],
        "corner_radii": [0.0, 0.0, R, R],
    }
    forces = (([-25.0, 0.0], 0.5), ([25.0, 0.0], 0.5), ([0.0, R], -1.0))
    return Scene.from_dict(
        {
            "part": {"outline": outline},
            "cracks": [{"points": [[0, 0], [0, 25]]}],
            "material": {"name": "PMMA"},
            "boundary": [{"at": at, "width": width, "force": [0.0, F]} for at, F in forces],
        }
    )


def main(quick: bool = False) -> list[Check]:
    checks = [*ring(), *orders(), *specimens()]
    show("Boundary integrals on parts of any outline", checks)
    if not quick:
        save("boundary_parts", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
