"""Where methods fail: what happens there, what the status says, and what `auto` does instead.

Point and line method on bending beams; the stress at a crack; crack cells that intrude, overhang or are undercut;
notches too small for their crack; thin ligaments; Poisson's ratios near their ends; compression and biaxial tension;
soft and stiff void; coarse voxels; outlines from noisy pictures; cracks beside holes; minute notches.

Each case asks several methods at one position. The truth is full FEA, for pictures that of the outline drawn.
Required: `auto` within 2 % of it everywhere and nowhere farther off than it says (and a quarter of a per cent, full
FEA's share); each other method of ours that gives a value likewise no farther off than it says in 95 % of the cases;
and a status with the words expected where a method does not apply.

Writes validation/results/limits.csv and limits.png; about five minutes, ``--quick`` a few cheap cases.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show
from limits_cases import (
    OURS,
    Case,
    cells_that_do_not_fit,
    cracks_and_corners,
    cracks_beside_holes,
    ligaments,
    loads,
    pictures,
    poissons_ratios,
    small_radii,
    voxels,
)

from slmm import Material, coupled_criterion, failure_indices
from slmm.criteria.distances import line_distance, line_stress, point_distance, point_stress

matplotlib.use("Agg")
import matplotlib.pyplot as plt

#: what full FEA and the truth's own extrapolation leave open
TRUTH_ERROR = 0.0025

Row = dict[str, object]


def asked(case: Case, method: str) -> Row:
    """What a method says at the case's position."""
    try:
        result = failure_indices(case.scene, method).isel(position=0)
    except (ValueError, RuntimeError) as error:
        status = str(error).removeprefix(f"{Path.cwd()}/")
        return {"FI": np.nan, "estimate": np.nan, "status": status, "used_method": method, "reason": ""}
    return {
        "FI": float(result.failure_index),
        "estimate": float(result.failure_index_error),
        "status": str(result.status.values),
        "used_method": str(result.used_method.values),
        "reason": str(result.reason.values),
    }


def rows_of(case: Case) -> list[Row]:
    true = failure_indices(case.true or case.scene, "full-fea").isel(position=0)
    truth = float(true.failure_index)
    rows = []
    for method in (*case.methods, "auto"):
        said = asked(case, method)
        FI = float(str(said["FI"]))
        error = abs(FI / truth - 1) if truth else abs(FI)  # NaN without truth
        rows.append({"limit": case.limit, "case": case.name, "truth": truth, "method": method} | said)
        rows[-1] |= {"error": error, "estimate": float(str(said["estimate"])) / (truth or 1.0)}
    return rows


def beams() -> tuple[list[Row], list[Check]]:
    """Beams in bending: the stress sinks to zero at half their height h, the edge crack's energy is Tada's."""
    material = Material.from_name("PMMA")
    l_ch = material.irwin_length / np.pi
    rows: list[Row] = []
    checks = []
    for share in (1.0, 1.5, 2.0, 4.0, 10.0, 40.0):
        h = share * l_ch
        eta = np.linspace(0, h, 401)
        x = np.linspace(0, 0.6, 400)
        F = 1.122 - 1.40 * x + 7.33 * x**2 - 13.08 * x**3 + 14.0 * x**4
        steps = np.concatenate([[0.0], np.cumsum(0.5 * (x * F**2)[1:] + 0.5 * (x * F**2)[:-1]) * x[1]])
        G_inc = np.pi * h / material.E * np.divide(steps, x, out=np.zeros_like(x), where=x > 0)
        found = coupled_criterion(x * h, G_inc, 1 - 2 * x, material)
        values = {
            "point": float(point_stress(eta, 1 - 2 * eta / h, np.array([point_distance(material)]))[0]),
            "line": float(line_stress(eta, 1 - 2 * eta / h, np.array([line_distance(material)]))[0]),
            "coupled criterion": material.sigma_c / found.load_factor,
        }
        rows += [
            {"limit": "bending beam", "case": f"h = {share:g} l_ch", "method": method, "FI": value}
            for method, value in values.items()
        ]
        if share <= 2:
            methods = ("point", "line") if share == 1 else ("line",)
            checks += [
                Check(
                    f"beam, h = {share:g} l_ch",
                    f"{m} method gives a stress",
                    0.0,
                    float(np.isfinite(values[m])),
                    0.0,
                )
                for m in methods
            ]
        checks.append(
            Check(
                f"beam, h = {share:g} l_ch",
                "coupled criterion: stress at initiation over sigma_c, 1 at least",
                1.0,
                float(values["coupled criterion"]),
                rule="at most",
            )
        )
    return rows, checks


def judged(case: Case, rows: list[Row]) -> list[Check]:
    checks = []
    for method, words in case.says.items():
        if words:
            status = next(str(row["status"]) for row in rows if row["method"] == method)
            told = float(words in status)
            checks.append(Check(f"{case.limit}: {case.name}", f"{method} says '{words}'", 1.0, told, 0.0))
    auto = rows[-1]
    error, estimate = float(str(auto["error"])), float(str(auto["estimate"]))
    name, used = f"{case.limit}: {case.name}", auto["used_method"]
    if not np.isfinite(float(str(auto["truth"]))):  # full FEA has no value either
        return [
            *checks,
            Check(name, f"auto says '{auto['status']}'", 1.0, float(auto["status"] != "ok"), 0.0),
        ]
    rule = "at most" if case.strict else "told"
    checks.append(Check(name, f"error of auto ({used})", 0.02, error, rule=rule))
    if case.true is None:
        allowed = estimate + TRUTH_ERROR
        checks.append(Check(name, "error of auto and what it says", allowed, error, rule="at most"))
    return checks


def honest(rows: list[Row], methods: tuple[str, ...]) -> list[Check]:
    """Of the values that the methods give, how many are farther off than they say."""
    checks = []
    for method in methods:
        given = [
            (float(str(row["error"])), float(str(row["estimate"])))
            for row in rows
            if row["method"] == method and row["status"] == "ok" and row["limit"] != "picture of a hole"
        ]
        off = np.mean([error > estimate + TRUTH_ERROR for error, estimate in given]) if given else 0.0
        checks.append(
            Check(
                f"{method}, {len(given)} values",
                "share farther off than said",
                0.05,
                float(off),
                rule="at most",
            )
        )
    return checks


def draw(rows: list[Row]) -> None:
    """Errors of every method by limit; a cross at the top where it says that it does not apply."""
    limits = list(dict.fromkeys(str(row["limit"]) for row in rows if row["limit"] != "bending beam"))
    methods = {
        "line": "0.6",
        "slmm": "#CC79A7",
        "slmm+ac": "#0072B2",
        "dislocations": "#009E73",
        "auto": "#D55E00",
    }
    figure, axis = plt.subplots(figsize=(11, 5.5), layout="constrained")
    for k, (method, colour) in enumerate(methods.items()):
        for i, limit in enumerate(limits):
            mine = [row for row in rows if row["limit"] == limit and row["method"] == method]
            x = i + (k - 2) * 0.15 + np.linspace(-0.05, 0.05, len(mine) + 2)[1:-1]
            error = np.array([float(str(row["error"])) for row in mine])
            said = np.isfinite(error)
            label = method if i == 0 else None
            axis.plot(x[said], np.maximum(error[said], 1e-5), "o", ms=4, color=colour, label=label)
            axis.plot(x[~said], np.full((~said).sum(), 3.0), "x", ms=5, color=colour)
    axis.axhline(0.02, color="0.7", lw=1, zorder=0)
    axis.set(yscale="log", ylim=(7e-6, 6), ylabel="error of the failure index (cross: status, no value)")
    axis.set_xticks(range(len(limits)), limits, rotation=25, ha="right")
    axis.legend(frameon=False, ncol=5, loc="lower left", bbox_to_anchor=(0, 1))
    figure.savefig(RESULTS / "limits.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    rows, checks = beams()
    with tempfile.TemporaryDirectory() as folder:
        chapters = [cracks_and_corners(), poissons_ratios(), loads()]
        if not quick:
            chapters += [cells_that_do_not_fit(), small_radii(), ligaments(), voxels(), cracks_beside_holes()]
            chapters.append(pictures(Path(folder)))
        for chapter in chapters:
            for case in list(chapter)[: 2 if quick else None]:
                found = rows_of(case)
                rows += found
                checks += judged(case, found)
    checks += honest(rows, OURS)
    show("Where methods fail", checks)
    if not quick:
        keys = dict.fromkeys(key for row in rows for key in row)
        save("limits", [{key: row.get(key, "") for key in keys} for row in rows])
        draw([row for row in rows if "error" in row])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
