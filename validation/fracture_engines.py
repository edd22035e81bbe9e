"""Both engines of the fracture simulator side by side: boundary integrals, and a mesh of its own for every increment.

Random hole patterns, plates with one to three random holes, and specimens under other loads. Where no events compete,
required: U_T within 0.5 %, and within the sum of both estimated errors. Designs in which some do are told apart: there
either path may be taken. Writes validation/results/fracture_engines.csv, ten minutes of CPU; ``--quick`` does one
design of each kind and writes nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.optimization import HolePattern
from slmm.scene.gallery import edge_crack, tensile_plate, v_notch
from slmm.scene.scene import Scene

#: relative difference of U_T; required
TOLERANCE = 5e-3
#: designs of each kind; chosen
PATTERNS, PLATES = 12, 12
#: designs without ties; required
ENOUGH = 20
#: share of holes in patterns, and gaps between random holes, to the plate's edges and the crack, mm; all chosen
DENSITY, GAP, RIM, OFF_CRACK = 0.3, 6.0, 12.0, 6.0


def patterns() -> Iterator[tuple[str, Scene]]:
    """Random patterns of 3, 4 and 5 support points a side, without islands."""
    random = np.random.default_rng(0)
    while True:
        for grid in (3, 4, 5):
            problem = HolePattern(grid=grid, pattern="full")
            design = random.random((grid, grid)) < DENSITY
            while not (design.any() and problem.valid(design[None])[0]):
                design = random.random((grid, grid)) < DENSITY
            holes = " ".join("".join("o" if hole else "." for hole in row) for row in design)
            yield f"pattern {holes}", problem.scene(design)


def plates() -> Iterator[tuple[str, Scene]]:
    """Plates with one to three random circles that keep off each other, the edges and the crack."""
    random = np.random.default_rng(1)
    while True:
        for count in (1, 2, 3):
            holes: list[tuple[float, float, float]] = []
            while len(holes) < count:
                radius = random.uniform(3.0, 8.0)
                x, y = random.uniform(RIM + radius, 80 - RIM - radius, 2)
                apart = all(np.hypot(x - u, y - v) > radius + r + GAP for u, v, r in holes)
                if apart and np.hypot(max(x - 10.0, 0.0), y - 40.0) > radius + OFF_CRACK:
                    holes.append((round(x, 1), round(y, 1), round(radius, 1)))
            words = ", ".join(f"({x:g}, {y:g}) {r:g}" for x, y, r in holes)
            yield f"holes {words}", tensile_plate(holes)


def specimens() -> Iterator[tuple[str, Scene]]:
    """Specimens under tractions, supports and pins; a hole between whose sides nothing decides."""
    yield "hole in the middle, no crack", tensile_plate([(40.0, 40.0, 8.0)], cracks=[])
    yield "edge crack", edge_crack()
    yield "sharp V-notch", v_notch()
    bar = {"width": 100.0, "height": 20.0, "thickness": 5.0}
    at = {"width": 0.5}
    supports = [{"at": [x, 0.0], "displacement": ["free", 0.0], **at} for x in (10.0, 90.0)]
    for name, x, top in (("bend bar", 50.0, 0.0), ("bend bar, crack aside", 40.0, 0.0)):
        yield (
            name,
            Scene.from_dict(
                {
                    "plate": bar,
                    "cracks": [{"points": [[x, 0.0], [x + top, 6.0]]}],
                    "material": {"name": "PMMA"},
                    "boundary": [*supports, {"at": [50.0, 20.0], "force": [0.0, -100.0], **at}],
                }
            ),
        )
    outline = {"shape": "rectangle", "center": [15.0, 0.0], "size": [50.0, 48.0], "corner_radius": 0.0}
    yield (
        "compact tension",
        Scene.from_dict(
            {
                "part": {"outline": outline, "thickness": 10.0},
                "holes": [{"shape": "circle", "center": [0.0, y], "radius": 5.0} for y in (11.0, -11.0)],
                "cracks": [{"points": [[-10.0, 0.0], [20.0, 0.0]]}],
                "material": {"name": "PMMA"},
                "boundary": [{"on": f"hole {k}", "pin": [0.0, F]} for k, F in ((0, 600.0), (1, -600.0))],
            }
        ),
    )


def compared(name: str, scene: Scene) -> dict[str, object]:
    """U_T by both engines, their estimated errors, and what they took."""
    row: dict[str, object] = {"design": name}
    for engine in ("boundary", "fem"):
        begin = time.process_time()
        result = simulate(scene, engine=engine)
        row |= {
            f"U_T_{engine}": float(result.U_T),
            f"error_{engine}": float(result.U_T_error),
            f"steps_{engine}": result.sizes["step"],
            f"arrests_{engine}": ", ".join(name for name in result.arrested_by.values if name),
            f"competing_{engine}": result.attrs["competing_events"],
            f"closed_{engine}": int(result.touches.sum()),
            f"outcome_{engine}": result.attrs["outcome"],
            f"cpu_{engine}": time.process_time() - begin,
        }
    row["difference"] = row["U_T_fem"] / row["U_T_boundary"] - 1
    row["over_estimates"] = abs(row["U_T_fem"] - row["U_T_boundary"]) / (
        row["error_fem"] + row["error_boundary"]
    )
    row["competing"] = max(row["competing_fem"], row["competing_boundary"])
    print(f"{name}: {100 * row['difference']:+.3f} %", flush=True)
    return row


def checks_of(row: dict[str, object]) -> list[Check]:
    """What is required of a design, or told where events compete."""
    name, told = row["design"], row["competing"] > 0
    case = f"{name}, {row['competing']} competing" if told else name
    U_T = Check(case, "U_T, mJ", row["U_T_boundary"], row["U_T_fem"], TOLERANCE, "told" if told else "equal")
    rule = "told" if told else "at most"
    over = Check(case, "difference over both estimates", 1.0, row["over_estimates"], rule=rule)
    return [U_T, over]


def main(quick: bool = False) -> list[Check]:
    kinds: tuple[tuple[Callable[[], Iterator[tuple[str, Scene]]], int | None], ...] = (
        (patterns, PATTERNS),
        (plates, PLATES),
        (specimens, None),
    )
    simulate(tensile_plate(), 8.0, engine="fem")  # compiles
    rows = [
        compared(*design) for designs, count in kinds for design in islice(designs(), 1 if quick else count)
    ]
    checks = [check for row in rows for check in checks_of(row)]
    alone = [row for row in rows if not row["competing"]]
    enough = 0 if quick else 20
    checks.append(
        Check("all", "designs short of twenty without ties", 0.0, max(0, enough - len(alone)), rule="at most")
    )
    for engine in ("boundary", "fem"):
        per_step = np.median([row[f"cpu_{engine}"] / row[f"steps_{engine}"] for row in rows])
        checks.append(
            Check("all", f"CPU time per increment, {engine}, s", np.nan, float(per_step), rule="told")
        )
    show("Tensile toughness by both engines", checks)
    if not quick:
        save("fracture_engines", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
