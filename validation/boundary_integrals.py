"""Boundary integrals against closed forms and high-order values, and their time beside a body-fitted mesh.

Stress at and below the surface of a circular hole (Kirsch), a notch across an edge, stress intensities of edge,
internal, inclined, kinked and meeting cracks, at a hole and in three-point bending (loads 0.005 W wide), and the
energy that growth releases by two ways. A plate with three holes and a crack is solved by both engines; times are
CPU seconds of one process, the least of five.

Required: 1e-5 of exact and high-order values, or what these are good for; a first solve of the plate five times and an
increment fifty times as fast as the mesh. Writes validation/results/boundary_integrals.csv, half a minute; ``--quick``
leaves out the times.
"""

from __future__ import annotations

import os

# a small factorisation takes longer on several threads
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import time
from collections.abc import Callable

import numpy as np
from checks import Check, run, save, show

from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import Condition, Loading, plate_edges, plate_loading

PMMA = Material.from_name("PMMA")
REQUIRED = 1e-5
#: how much faster than the mesh a first solve and an increment must be
FIRST, INCREMENT = 5.0, 50.0


def hole(x: float, y: float, radius: float) -> Outline:
    return Outline.through(circle((x, y), radius))


def surfaces() -> list[Check]:
    """Stress at and below surfaces; a half width of 2000 radii leaves 6e-7 of Kirsch's."""
    W = 4000.0
    model = BoundaryModel(
        Part.plate(W, W, [hole(W / 2, W / 2, 1.0)]), PMMA, plate_loading(W, W, stress=1.0), p=12
    )
    checks = []
    for depth in (0.0, 1e-4, 1e-3, 0.1, 1.0):
        q = 1 / (1 + depth)
        stress = model.stress(np.array([[W / 2 + 1 + depth, W / 2]]))[0, 1]
        exact = 1 + q**2 / 2 + 1.5 * q**4
        checks.append(
            Check(
                "circular hole",
                f"stress at a depth of {depth:g} radii",
                exact,
                stress,
                REQUIRED,
                source="Kirsch, exact",
            )
        )
    W = 400.0
    model = BoundaryModel(
        Part.plate(W, 2 * W, [hole(0.0, W, 1.0)]), PMMA, plate_loading(W, 2 * W, stress=1.0), p=12
    )
    notch = model.stress(np.array([[1.0, W]]))[0, 1]
    return [
        *checks,
        Check("half circle in an edge", "largest stress", 3.065, notch, 5e-4, source="handbooks, 3 digits"),
    ]


def edge_cracked(W: float, a: float) -> Part:
    """A long plate with a crack of length a from its left edge."""
    return Part.plate(W, 12 * W, cracks=[[(0, 6 * W), (a, 6 * W)]])


def intensity(part: Part, loading: Loading, tip: int = 0) -> np.ndarray:
    """K_I and K_II of a tip."""
    return BoundaryModel(part, PMMA, loading, p=10, crack_p=8).stress_intensities()[tip]


def cracks() -> list[Check]:
    checks = []
    W = 20.0
    high = "p-version FE and boundary integrals, 1e-5"
    for share, F in ((0.1, 1.189178), (0.3, 1.659866), (0.5, 2.824578)):
        a = share * W
        K = intensity(
            Part.plate(W, 12 * W, cracks=[[(0, 6 * W), (a, 6 * W)]]), plate_loading(W, 12 * W, stress=1.0)
        )
        checks.append(
            Check(
                "edge crack in tension",
                f"F, a/W = {share:g}",
                F,
                K[0] / np.sqrt(np.pi * a),
                REQUIRED,
                source=high,
            )
        )
    W, angle = 4000.0, np.radians(37.0)
    arm = np.array([np.cos(angle), np.sin(angle)])
    K = np.abs(
        intensity(Part.plate(W, W, cracks=[[W / 2 - arm, W / 2 + arm]]), plate_loading(W, W, stress=1.0))
    )
    for name, value, exact in zip(
        ("K_I", "K_II"), K / np.sqrt(np.pi), (np.cos(angle) ** 2, np.sin(angle) * np.cos(angle)), strict=True
    ):
        checks.append(
            Check(
                "internal crack at 37 degrees", f"{name}, normalised", exact, value, REQUIRED, source="exact"
            )
        )
    W = 200.0
    for L, F in ((0.01, 3.2932), (0.1, 2.7727), (0.2, 2.3746), (1.0, 1.3061)):
        part = Part.plate(2 * W, 2 * W, [hole(W, W, 1.0)], [[(W + 1, W), (W + 1 + L, W)]])
        K = intensity(part, plate_loading(2 * W, 2 * W, stress=1.0))
        checks.append(
            Check(
                "one crack at a circular hole",
                f"F, L/R = {L:g}",
                F,
                K[0] / np.sqrt(np.pi * L),
                2e-4,
                source="p-version FE, 1e-4",
            )
        )
    return [*checks, *kinks(), *star(), *bending()]


def kinks() -> list[Check]:
    checks = []
    W, b = 4000.0, 1e-4
    for ratio, degrees, G in ((0.25, 25.86, 1.10762), (0.5, 42.03, 1.32774)):
        slope = np.arctan(ratio)
        arm = np.array([np.cos(slope), np.sin(slope)])
        loading, tip = plate_loading(W, W, stress=1.0), W / 2 + arm
        straight = intensity(Part.plate(W, W, cracks=[[W / 2 - arm, tip]]), loading, 1)
        turned = slope - np.sign(straight[1]) * np.radians(degrees)
        kink = tip + b * np.array([np.cos(turned), np.sin(turned)])
        kinked = intensity(Part.plate(W, W, cracks=[[W / 2 - arm, tip, kink]]), loading, 1)
        ours = (kinked @ kinked) / (straight @ straight)
        checks.append(
            Check(
                f"kink of 1e-4, K_II/K_I = {ratio:g}",
                "G over that of the straight crack",
                G,
                ours,
                2e-4,
                source="boundary integrals, 5 digits",
            )
        )
    return checks


def star() -> list[Check]:
    a, side = 5.0, 800.0
    c = side / 2
    pulls = zip(plate_edges(side, side), ((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)), strict=True)
    loading = Loading(tuple(Condition(*edge, traction=traction) for edge, traction in pulls))
    arms = [[(c - a, c), (c + a, c)], [(c, c), (c, c + a)], [(c, c), (c, c - a)]]
    K = intensity(Part.plate(side, side, cracks=arms), loading)
    return [
        Check(
            "star of four arms", "F", 0.8636, K[0] / np.sqrt(np.pi * a), 1e-4, source="Rooke and Sneddon 1969"
        )
    ]


def bending() -> list[Check]:
    """Three points, S/W = 4; K = P S/(B W^1.5) f."""
    W, width, checks = 10.0, 0.05, []
    S, length = 4 * W, 4.4 * W
    middle = length / 2
    for share, f in ((0.3, 1.51389), (0.5, 2.64367), (0.6, 3.74859)):
        below = [((x - width / 2, 0.0), (x + width / 2, 0.0)) for x in (middle - S / 2, middle + S / 2)]
        loading = Loading(
            (
                *(Condition(*stretch, traction=(0.0, 0.5 / width)) for stretch in below),
                Condition((middle + width / 2, W), (middle - width / 2, W), traction=(0.0, -1.0 / width)),
            )
        )
        part = Part.plate(length, W, cracks=[[(middle, 0.0), (middle, share * W)]])
        K = intensity(part, loading)
        checks.append(
            Check(
                "three-point bending, S/W = 4",
                f"f, a/W = {share:g}",
                f,
                K[0] * W**1.5 / S,
                2e-5,
                source="boundary integrals, 5 digits",
            )
        )
    return checks


def three_holes(a: float) -> tuple[Part, Loading]:
    """A plate with three holes and an edge crack, its top edge moved."""
    holes = [hole(28, 44, 6.0), hole(46, 30, 5.0), hole(70, 60, 7.0)]
    return Part.plate(100.0, 100.0, holes, [[(0, 50), (a, 50)]]), plate_loading(
        100.0, 100.0, displacement=0.1
    )


def growth() -> list[Check]:
    """Energy by K and by the change of the reaction; the coarse orders against fine ones."""
    forces, step = [], 0.05
    for a in (15.0 - step, 15.0, 15.0 + step):
        part, loading = three_holes(a)
        model = BoundaryModel(part, PMMA, loading, 12, 10)
        forces.append(model.reaction(loading.conditions[1])[1])
        if a == 15.0:
            K = model.stress_intensities()[0]
            coarse = BoundaryModel(part, PMMA, loading, 6, 4).stress_intensities()[0]
    released = 0.5 * 0.1 * (forces[0] - forces[2]) / (2 * step)
    case = "plate with three holes and a crack"
    return [
        Check(
            case,
            "G by the reaction over K^2/E",
            1.0,
            released / float(K @ K / PMMA.E),
            1e-4,
            source="energy balance",
        ),
        Check(
            case,
            "K_I with 6 and 4 points a panel",
            float(K[0]),
            float(coarse[0]),
            1e-4,
            source="12 and 10 points",
        ),
    ]


def times() -> list[Check]:
    """CPU time of first solves and increments by both engines."""
    from slmm.fem.mesh import plate_mesh
    from slmm.fem.plate_model import PlateModel
    from slmm.fracture.loading import crack_tip_loading

    part, loading = three_holes(15.0)
    longer = part.grown(0, (16.5, 50.1))

    def first() -> BoundaryModel:
        model = BoundaryModel(part, PMMA, loading, 6, 4)
        model.stress_intensities()
        return model

    def meshed() -> None:
        crack_tip_loading(PlateModel(plate_mesh(longer), PMMA, loading).results)

    model = first().with_cracks_of(longer)
    # panels that the body has not met, every time
    tips = iter([(18.0, 50.0 + 0.01 * k) for k in range(9)])
    of_first = _least(first)
    of_increment = _least(lambda: model.with_cracks_of(longer.grown(0, next(tips))).stress_intensities())
    of_mesh = _least(meshed)
    case = "plate with three holes and a crack, one core"
    return [
        Check(case, "first solve, s", np.nan, of_first, rule="told"),
        Check(case, "increment of the crack, s", np.nan, of_increment, rule="told"),
        Check(case, "body-fitted mesh, model and tip, s", np.nan, of_mesh, rule="told"),
        Check(case, "first solve over the mesh", 1 / FIRST, of_first / of_mesh, rule="at most"),
        Check(case, "increment over the mesh", 1 / INCREMENT, of_increment / of_mesh, rule="at most"),
    ]


def _least(what: Callable[[], object]) -> float:
    """Least CPU time of five runs, s."""
    what()
    taken = []
    for _ in range(5):
        begin = time.process_time()
        what()
        taken.append(time.process_time() - begin)
    return min(taken)


def main(quick: bool = False) -> list[Check]:
    checks = [*surfaces(), *cracks(), *growth(), *([] if quick else times())]
    show("Boundary integrals against exact and high-order values", checks)
    if not quick:
        save("boundary_integrals", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
