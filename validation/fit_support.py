"""The factors of slmm.initiation.support, by which edges of the plate support a cell: fitted to full FEA.

Data: the cases of edge_support.py that are marked "fit", holes of r = 20 and 30 mm in a plate of 100 mm under three
kinds of load: what rho full FEA needs for the right G_inc at r/4. Fit: least squares of the relative error of G_inc.
The plate with r = 30 mm under stress bends about its short ligament, which a sum over edges cannot tell; with it and
without it there are two fits. Two factors of held edges follow from two cases.

Required is what the constants were chosen for: each lies between the two fits (of held edges: within 0.1 of the only
one), and none of the other five cases is farther off than the first fit leaves the worst of them. Edges that are held
are fitted, the others chosen between: to have -1.0, 2.2 and -5.5 come out, the plate that bends would have to count
with a weight that nobody can give a reason for.

Reads validation/results/edge_support.csv, which edge_support.py makes anew in two minutes; a second.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence

import numpy as np
from checks import RESULTS, Check, run, show
from edge_support import CASES, LOADS
from scipy.optimize import least_squares

from slmm.initiation.support import FACTORS, edge_shares, supported

#: factors that are fitted: what holds the edge, and whether the crack points at it (0) or it lies beside (1)
HELD = (("held", 0), ("held", 1))
OTHERS = (("rolling", 1), ("free", 0), ("loaded", 1))
#: the case that bends
BENDS = ("r = 30", "stress")
#: by how much a factor of held edges may differ from the fitted one: one of its last digit
DIGIT = 0.1

Key = tuple[str, int]
Row = dict[str, str]


def fitted_rows() -> list[Row]:
    """Lines of the cases that the factors were fitted to."""
    with open(RESULTS / "edge_support.csv", newline="") as file:
        return [row for row in csv.DictReader(file) if row["fit"] == "True"]


def shares_of(row: Row) -> dict[Key, float]:
    """Shares of the plate's edges at the point of a case."""
    scene, point, *_ = CASES[row["case"]]
    scene = scene.with_(load=LOADS[row["load"]])
    outline = scene.outlines[0]
    height, curvature = (np.array([float(row[name])]) for name in ("cell height", "cell curvature"))
    shares = edge_shares(scene, outline, outline.project(np.array([point])), height, curvature)
    return {key: float(share[0]) for key, share in shares.items()}


def errors(factors: dict[Key, float], rows: Sequence[Row]) -> np.ndarray:
    """Relative errors (n,) of G_inc at r/4 in some cases."""
    found = []
    for row in rows:
        rho = sum(factors.get(key, 0.0) * share for key, share in shares_of(row).items())
        needed, unbounded = float(row["rho needed"]), 1 + float(row["without edges"])
        # 1 = (1 - needed)/unbounded + needed/held, in shares of the true G_inc
        held = needed / (1 - (1 - needed) / unbounded)
        G = supported(np.array([[unbounded]]), np.array([[held]]), np.array([rho]))
        found.append(float(G[0, 0]) - 1)
    return np.array(found)


def fitted(keys: Sequence[Key], rows: Sequence[Row]) -> dict[Key, float]:
    """Factors with the least sum of squared errors."""

    def off(k: np.ndarray) -> np.ndarray:
        return errors(dict(zip(keys, k, strict=True)), rows)

    return dict(zip(keys, map(float, least_squares(off, [FACTORS[w][b] for w, b in keys]).x), strict=True))


def main(quick: bool = False) -> list[Check]:
    """Fit, with and without the plate that bends; ``quick`` is the same, since the fit takes a second."""
    rows = fitted_rows()
    strained = [row for row in rows if row["load"] == "strain"]
    others = [row for row in rows if row["load"] != "strain"]
    straight = [row for row in others if (row["case"], row["load"]) != BENDS]
    constants = {key: FACTORS[key[0]][key[1]] for key in HELD + OTHERS}
    of_held = fitted(HELD, strained)
    with_bending, without = fitted(OTHERS, others), fitted(OTHERS, straight)

    def named(key: Key) -> str:
        return f"{key[0]}, {'beside' if key[1] else 'ahead'}"

    checks = [
        Check(
            named(key),
            "factor, fitted",
            constants[key],
            of_held[key],
            DIGIT / abs(constants[key]),
            source="slmm",
        )
        for key in HELD
    ]
    for key in OTHERS:
        low, high = sorted((with_bending[key], without[key]))
        checks += [
            Check(named(key), "factor, fitted to all", constants[key], with_bending[key], rule="told"),
            Check(named(key), "without the plate that bends", constants[key], without[key], rule="told"),
            Check(
                named(key),
                "outside of the two fits by",
                0.0,
                max(low - constants[key], constants[key] - high, 0.0),
                rule="at most",
            ),
        ]
    kept = strained + straight
    largest = float(np.abs(errors(of_held | with_bending, kept)).max())
    case = "cases but for that which bends"
    checks += [
        Check(
            case,
            "largest error of G_inc: fit, constants",
            largest,
            float(np.abs(errors(constants, kept)).max()),
            rule="at most",
        ),
    ]
    for whose, factors in (
        ("constants", constants),
        ("fitted to all", of_held | with_bending),
        ("without the plate that bends", of_held | without),
    ):
        off = float(np.abs(errors(factors, [row for row in rows if row not in kept])).max())
        checks.append(Check("plate that bends", f"error of G_inc, {whose}", np.nan, off, rule="told"))
    show("Factors of the plate's edges", checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
