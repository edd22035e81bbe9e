"""Error of U_T against CPU time of simulated fracture, by the points on panels that a tolerance asks for.

Plates of `fracture_references.py` with holes and random hole patterns of `fracture_speed.py`; each with fewer and more
points on panels of outlines and cracks than the default tolerance takes. Errors are against the tolerance 1e-3, which
has 8 points on panels, too: what is below 1e-5 is not told. Beside them the figures of a prototype in numpy: its times
for plates with two to four holes, its typical errors over 13 plates. Times are CPU seconds of one run without errors,
outlines and scene included. Where events compete a path may fork: an error above 1 % is left out of the medians, and
counted.

Told. Writes validation/results/fracture_chart.csv and .png, two minutes; ``--quick`` one plate and one pattern, no
files.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show
from fracture_references import PLATES
from fracture_speed import designs, toughness
from matplotlib.ticker import NullFormatter

from slmm.boundary.stretches import ROUGH
from slmm.fracture import boundary_engine, simulate
from slmm.scene.gallery import tensile_plate

matplotlib.use("Agg")
import matplotlib.pyplot as plt

#: points on panels of outlines and cracks; even on outlines, for held edges with odd ones make the system singular
ORDERS, TRUE = ((4, 4), (6, 4), (6, 5), (8, 6)), 1e-3
#: those that `simulate` takes at its default tolerance
DEFAULT = (6, 5)
#: random patterns
PATTERNS = 4
FORK = 0.01
#: of the prototype: points on panels of outlines and cracks, CPU time, s (least, most), and error of U_T
PROTOTYPE = (
    ((4, 4), (0.2, 0.6), 7e-3),
    ((6, 4), (0.2, 0.75), 1e-3),
    ((6, 5), (0.3, 1.7), 2e-4),
    ((8, 6), (0.5, 4.0), 4e-5),
)
Row = dict[str, float | int | str]


@contextmanager
def orders(chosen: tuple[int, int]) -> Iterator[None]:
    """Simulations with these points on panels at any tolerance."""
    default = boundary_engine.ORDERS
    boundary_engine.ORDERS = ((0.0, chosen, ROUGH),)
    try:
        yield
    finally:
        boundary_engine.ORDERS = default


def cases(quick: bool) -> dict[str, Callable[[float], float]]:
    """U_T of the designs by a tolerance, mJ."""
    found: dict[str, Callable[[float], float]] = {
        name: lambda tolerance, holes=holes: float(
            simulate(tensile_plate(holes), 2.0, tolerance=tolerance, errors=False).U_T
        )
        for name, (holes, _) in PLATES.items()
        if holes
    }
    problem, patterns = designs(PATTERNS)
    found |= {
        f"pattern {k}": lambda tolerance, design=design: toughness(problem, problem.scene(design), tolerance)
        for k, design in enumerate(patterns)
    }
    return {name: found[name] for name in (next(iter(found)), list(found)[-1])} if quick else found


def measured(name: str, U_T: Callable[[float], float], quick: bool) -> list[Row]:
    """Errors and times of a design with all orders."""
    true = U_T(TRUE)
    rows: list[Row] = []
    for order in (DEFAULT,) if quick else ORDERS:
        with orders(order):
            begin = time.process_time()
            ours = U_T(TRUE)
            taken = time.process_time() - begin
        outlines, cracks = order
        rows.append(
            {
                "design": name,
                "order": outlines,
                "crack_order": cracks,
                "seconds": taken,
                "U_T": ours,
                "error": abs(ours / true - 1),
            }
        )
        print(rows[-1], flush=True)
    return rows


def front(rows: list[Row]) -> list[Row]:
    """Medians over the designs, and the share that forks, by the orders."""
    found: list[Row] = []
    for outlines, cracks in dict.fromkeys((row["order"], row["crack_order"]) for row in rows):
        of = [row for row in rows if (row["order"], row["crack_order"]) == (outlines, cracks)]
        error = np.array([row["error"] for row in of], dtype=float)
        followed = error <= FORK
        found.append(
            {
                "order": outlines,
                "crack_order": cracks,
                "seconds": float(np.median([float(row["seconds"]) for row in of])),
                "error": float(np.median(error[followed])) if followed.any() else float("nan"),
                "forks": float(1 - followed.mean()),
            }
        )
    return found


def draw(rows: list[Row]) -> None:
    """Draw results/fracture_chart.png."""
    figure, axis = plt.subplots(figsize=(6.5, 4.6), layout="constrained")
    for name in dict.fromkeys(str(row["design"]) for row in rows):
        of = [row for row in rows if row["design"] == name]
        colour = "#0072B2" if name.startswith("pattern") else "#009E73"
        axis.plot(
            [r["seconds"] for r in of], [r["error"] for r in of], "o-", color=colour, ms=3, lw=0.6, alpha=0.5
        )
    axis.plot([], [], "o-", color="#009E73", label="plates with one to three holes")
    axis.plot([], [], "o-", color="#0072B2", label="random hole patterns of 7 x 7")
    medians = front(rows)
    axis.plot([r["seconds"] for r in medians], [r["error"] for r in medians], "ks-", label="median")
    for row in medians:
        at = float(row["seconds"]), float(row["error"])
        axis.annotate(
            f"{row['order']}, {row['crack_order']}", at, (5, 5), textcoords="offset points", fontsize=8
        )
    for k, ((outlines, cracks), taken, error) in enumerate(PROTOTYPE):
        label = "prototype, plates with two to four holes" if k == 0 else None
        axis.plot(taken, (error, error), "|-", color="#D55E00", label=label)
        axis.annotate(
            f"{outlines}, {cracks}", (taken[1], error), (5, -3), textcoords="offset points", fontsize=8
        )
    axis.set(xscale="log", yscale="log", xlabel="CPU time of a simulation, s", ylabel="relative error of U_T")
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xticks([0.1, 0.2, 0.5, 1.0, 2.0, 5.0], ["0.1", "0.2", "0.5", "1", "2", "5"])
    axis.legend(fontsize=8)
    figure.savefig(RESULTS / "fracture_chart.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    """Measure all; see the module."""
    found = cases(quick)
    for U_T in (found[name] for name in (next(iter(found)), list(found)[-1])):
        U_T(TRUE)  # kernels
    rows = [row for name, U_T in found.items() for row in measured(name, U_T, quick)]
    checks = [
        Check(
            f"{row['order']} and {row['crack_order']} points a panel, median",
            quantity,
            float("nan"),
            float(row[quantity]),
            rule="told",
        )
        for row in front(rows)
        for quantity in ("seconds", "error", "forks")
    ]
    show("Error against time of simulated fracture", checks)
    if not quick:
        save("fracture_chart", rows)
        draw(rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
