"""What the fit scripts share: factors of an estimate, data that grow scene by scene, constants beside fitted values.

An estimate is a sum of features, each times a factor that is not negative. The factors are those of the quantile of
nineteen errors in twenty (quantile regression: the sum of tilted absolute deviations is least, a linear programme),
with every deviation taken relative to the estimate itself, so that small errors count as much as large ones.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from checks import RESULTS, Check
from estimates import COVERED
from scipy.optimize import linprog

from slmm import Scene
from slmm.criteria.coupled_curves import Coupled
from slmm.initiation.paths import trial_paths
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT
from slmm.initiation.task import Task
from slmm.running.cell_file import shipped_database
from slmm.running.progress import silent

#: times that the deviations are related to the estimate of the time before
ROUNDS = 12
#: no estimate is smaller
LEAST_ESTIMATE = 1e-12

Row = dict[str, float]


def covering_factors(features: np.ndarray, errors: np.ndarray, first: Sequence[float]) -> np.ndarray:
    """Factors (k,) of features (n, k) whose sum lies above nineteen of twenty errors (n,).

    ``first`` are the factors (k,) whose estimate the deviations are related to at the start.
    """
    factors = np.asarray(first, dtype=float)
    n, k = features.shape
    for _ in range(ROUNDS):
        scale = 1 / np.maximum(features @ factors, LEAST_ESTIMATE)
        relative, wanted = features * scale[:, None], errors * scale
        # errors = features @ factors + above - below; variables: factors, above, below
        cost = np.concatenate([np.zeros(k), np.full(n, COVERED), np.full(n, 1 - COVERED)])
        balance = np.hstack([relative, np.eye(n), -np.eye(n)])
        found = linprog(cost, A_eq=balance, b_eq=wanted, method="highs")
        if not found.success:
            raise RuntimeError(f"no factors: {found.message}")
        factors = found.x[:k]
    return factors


def tilted_deviation(estimate: np.ndarray, errors: np.ndarray, scale: np.ndarray) -> float:
    """Mean tilted absolute deviation of errors (n,) from their estimates (n,): what the fit makes least."""
    off = (errors - estimate) / scale
    return float(np.mean(np.where(off > 0, COVERED * off, (COVERED - 1) * off)))


def judged_factors(
    case: str,
    names: Sequence[str],
    constants: Sequence[float],
    features: np.ndarray,
    errors: np.ndarray,
) -> list[Check]:
    """Constants beside fitted factors, and what share of the errors either leaves above its estimate, how widely."""
    fitted = covering_factors(features, errors, constants)
    checks = [
        Check(case, f"{name}: constant, fitted", constant, value, rule="told")
        for name, constant, value in zip(names, constants, fitted, strict=True)
    ]
    best = np.maximum(features @ fitted, LEAST_ESTIMATE)
    for whose, factors in (("constants", np.asarray(constants)), ("fitted", fitted)):
        estimate = features @ factors
        above = float(np.mean(errors > estimate))
        width = float(np.median(estimate / np.maximum(errors, LEAST_ESTIMATE)))
        deviation = tilted_deviation(estimate, errors, best)
        rule = "at most" if whose == "constants" else "told"
        checks += [
            Check(case, f"{whose}: errors above their estimate", 1 - COVERED, above, rule=rule),
            Check(case, f"{whose}: estimate over error, median", np.nan, width, rule="told"),
            Check(case, f"{whose}: tilted deviation", np.nan, deviation, rule="told"),
        ]
    return checks


def to_its_digits(case: str, name: str, constant: float, fitted: float, digit: float) -> Check:
    """A constant against its fitted value, which has to round to it; ``digit`` is one of its last digit."""
    half = 0.5 * digit / abs(constant)
    return Check(case, f"{name}, to its digits", constant, fitted, half, source="slmm")


def task_at(scene: Scene, positions: int) -> Task:
    """The task of a scene at equally spaced positions, with the package's own settings."""
    where = find_positions(scene, positions)
    paths = trial_paths(scene, where)
    return Task(scene, where, paths, Coupled(), 0.02, DEFAULT, shipped_database(), None, silent)


def stored(name: str) -> list[Row]:
    """Lines of results/name.csv; none where there is no such file."""
    file = RESULTS / f"{name}.csv"
    if not file.exists():
        return []
    with open(file, newline="") as lines:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def completed(name: str, scenes: int, examine: Callable[[int], list[Row]]) -> list[Row]:
    """Lines of results/name.csv, with those of the scenes that it does not have yet computed and added, in order."""
    rows = stored(name)
    for number in range(1 + int(max((row["scene"] for row in rows), default=-1)), scenes):
        found = examine(number)
        print(f"scene {number}: {len(found)} lines", flush=True)
        if found:
            _add(RESULTS / f"{name}.csv", found)
            rows += found
    return rows


def _add(file: Path, rows: Iterable[Row]) -> None:
    rows = list(rows)
    new = not file.exists()
    with open(file, "a", newline="") as lines:
        writer = csv.DictWriter(lines, list(rows[0]), lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerows({key: f"{value:.6g}" for key, value in row.items()} for row in rows)


def run(main: Callable[[bool, int], list[Check]], doc: str | None, scenes: int) -> None:
    """Command line of a fit script: ``--quick``, ``--scenes``; ends with 1 where a requirement is not met."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="from the stored data alone, seconds, no files")
    parser.add_argument("--scenes", type=int, default=scenes, help="scenes that the data are to have")
    options = parser.parse_args()
    checks = main(options.quick, options.scenes)
    raise SystemExit(0 if all(check.holds for check in checks) else 1)
