"""Does the summary of the default method promise what a closer look refutes? 300 random scenes, a third as pictures.

Scenes are those of random_parts.py: one to four holes and notches of every shape, round and sharp, near edges and near
each other, three kinds of load, Irwin's length 0.02 to 5 times the radius of a notch. Of every third one the default
method sees a picture alone. The truth is that of the outlines drawn: `auto` at 200 positions (at 50 or more of each
outline), with full FEA at the three highest of its peaks, and where the default's peak is higher, at that; positions
whose index surely lies below nine tenths of the highest keep what the cheaper methods say. The load is scaled such that
the true index lies between 0.9 and 1.1, where words matter.

Required: no scene raises; in none do the words promise what the truth refutes. They do where they say that no crack
starts and the true index is 1 or more, where they say that one starts and it is less by more than the stated error,
and where the highest index is low by more than that (unless the verdict is open). At most 5 % of the positions have
no value.

Writes validation/results/random_scenes.csv, one line a scene as soon as it is done; started again, it goes on with
what is missing. ``--first 100 --scenes 20`` does a slice. Some three hours on two cores, ``--quick`` six scenes, fewer
positions and no file.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from unittest import mock

import numpy as np
import xarray as xr
from checks import RESULTS, Check, show
from random_parts import drawn, picture

from slmm import Scene, failure_indices
from slmm.initiation import by_choice
from slmm.initiation.summary import status_counts, verdict

FILE = RESULTS / "random_scenes.csv"
SCENES = 300
#: with ``--quick``: one hole each, two pictures, two corners
QUICK = (16, 18, 34, 37, 51, 55)
#: scenes from pictures: every third
PICTURES = 3
#: positions on each outline of the default, and on all of them of the truth; and with ``--quick``
POSITIONS, TRUE_POSITIONS = 50, 200
QUICK_POSITIONS, QUICK_TRUE_POSITIONS = 8, 16
#: the truth's tolerance where full FEA follows, the share of the highest index below which that does not, positions on
#: each outline at least, how many positions full FEA looks at, and how far these are apart, as a share of the plate
LOOSE, LOW, FEWEST, CANDIDATES, NEAR = 0.05, 0.9, 50, 3, 0.01
#: where the load puts the true index
LOWEST, HIGHEST = 0.9, 1.1
#: share of positions that may have no value
WITHOUT = 0.05
#: scenes after which processes are replaced
BATCH = 40
#: what a picture is refused for, by right, whose pixels do not see a ligament of the outlines drawn
CUT = "cut the plate into"
#: words of a summary that commit it
SAFE, CRACK = "No crack starts", ("A crack starts", "The crack goes on")

Row = dict[str, object]
FIELDS = (
    "scene",
    "shapes",
    "picture",
    "load",
    "l_ch_over_radius",
    "positions",
    "without_value",
    "wide",
    "statuses",
    "FI",
    "error",
    "FI_true",
    "error_true",
    "truth_by",
    "words",
    "refuted",
    "seconds",
    "seconds_truth",
    "raised",
)


def examine(number: int, positions: int, true_positions: int) -> Row:
    """One line of the file."""
    rng = np.random.default_rng(number)
    part = drawn(rng)
    row: Row = {
        "scene": number,
        "shapes": part.shapes,
        "picture": int(number % PICTURES == 0),
        "load": next(
            k for k in ("strain", "displacement", "stress") if getattr(part.scene.load, k) is not None
        ),
        "l_ch_over_radius": part.irwin_over_radius,
        "raised": "",
    }
    with tempfile.TemporaryDirectory() as folder:
        try:
            start = time.perf_counter()
            true, own, by = truth(part.scene, true_positions)
            row["seconds_truth"] = time.perf_counter() - start
            factor = float(rng.uniform(LOWEST, HIGHEST)) / true if true > 0 else 1.0
            true, own = factor * true, factor * own
            seen = picture(part, Path(folder) / "holes.png") if row["picture"] else part.scene
            start = time.perf_counter()
            result = failure_indices(scaled(seen, factor), "auto", positions=positions)
            row["seconds"] = time.perf_counter() - start
            if not row["picture"] and np.nanmax(result.failure_index, initial=0.0) > true + own:
                true, own, by = max((true, own, by), at_its_peak(scaled(part.scene, factor), result))
        # whatever a scene raises is a finding, and the study goes on
        except Exception as error:
            words = "refused" if row["picture"] and CUT in str(error) else ""
            return row | {"words": words, "raised": f"{type(error).__name__}: {error}"}
    return row | {"FI_true": true, "error_true": own, "truth_by": by} | told(result, true, own)


def truth(scene: Scene, positions: int) -> tuple[float, float, str]:
    """The highest failure index of a scene, its error, and the method it comes from."""
    loose = scene.with_(analysis={"tolerance": LOOSE})
    with mock.patch.object(by_choice, "NEGLIGIBLE", LOW):
        result = failure_indices(
            loose, "auto", positions=max(FEWEST, positions // max(1, len(scene.outlines)))
        )
    FI, error = result.failure_index.values, np.nan_to_num(result.failure_index_error.values)
    if not np.nanmax(FI, initial=0.0) > 0:
        return 0.0, 0.0, str(result.used_method.values[0])
    # what may be the highest, but for the neighbours of a higher one
    rows = [i for i in np.argsort(-np.nan_to_num(FI)) if FI[i] + error[i] >= np.nanmax(FI - error)]
    at = np.stack([result.x, result.y], axis=1)
    candidates: list[int] = []
    for i in rows:
        near = NEAR * max(scene.plate.width, scene.plate.height)
        if len(candidates) < CANDIDATES and all(np.linalg.norm(at[i] - at[k]) > near for k in candidates):
            candidates.append(int(i))
    full = failure_indices(scene.with_(analysis={"points": at[candidates].tolist()}), "full-fea")
    # where full FEA has no value either, what the index is at least
    missing, at_least = np.isnan(full.failure_index.values), (FI - error)[candidates]
    values = np.where(missing, np.maximum(at_least, 0.0), full.failure_index)
    errors = np.where(missing, 0.0, full.failure_index_error)
    top = int(values.argmax())
    by = (
        "full-fea"
        if np.isfinite(full.failure_index[top])
        else str(result.used_method.values[candidates[top]])
    )
    return float(values[top]), float(errors[top]), by


def at_its_peak(scene: Scene, result: xr.Dataset) -> tuple[float, float, str]:
    """The index by full FEA where a result has its highest one, its error and method; 0 where there is none."""
    top = int(np.nanargmax(result.failure_index.values))
    points = [[float(result.x[top]), float(result.y[top])]]
    full = failure_indices(scene.with_(analysis={"points": points}), "full-fea").isel(position=0)
    if np.isnan(full.failure_index):
        return 0.0, 0.0, "none"
    return float(full.failure_index), float(full.failure_index_error), "full-fea"


def scaled(scene: Scene, factor: float) -> Scene:
    """The scene with its load multiplied."""
    load = scene.load
    if load.strain is not None:
        return scene.with_(load={"strain": [factor * e for e in load.strain]})
    name = "displacement" if load.displacement is not None else "stress"
    return scene.with_(load={name: factor * getattr(load, name)})


def told(result: xr.Dataset, true: float, own: float) -> Row:
    """What the summary says, and whether the truth refutes it."""
    FI, errors = result.failure_index.values, np.nan_to_num(result.failure_index_error.values)
    known = np.isfinite(FI)
    top = int(np.nanargmax(FI)) if known.any() else 0
    index, error = float(FI[top]), float(errors[top])
    text = verdict(result)
    words = "safe" if SAFE in text else "crack" if any(word in text for word in CRACK) else "open"
    refuted = ""
    if words == "safe" and true - own >= 1:
        refuted = "a crack starts"
    elif words == "crack" and true + own < min(1.0, index - error):
        refuted = "no crack starts"
    elif words != "open" and index + error < true - own:
        refuted = "index is low"
    statuses = Counter(status_counts(result))
    return {
        "positions": len(FI),
        "without_value": int((~known).sum()),
        "wide": int(np.sum(errors[known] > WITHOUT * index)),
        "statuses": "; ".join(f"{n} {status}" for status, n in statuses.items() if status != "ok"),
        "FI": index,
        "error": error,
        "words": words,
        "refuted": refuted,
    }


def gathered(numbers: Iterable[int], positions: int, true_positions: int, file: Path | None) -> list[Row]:
    """Lines of some scenes, those that the file has not yet computed and added to it."""
    wanted = list(numbers)
    rows = [row for row in lines_of(file) if int(str(row["scene"])) in set(wanted)]
    missing = sorted(set(wanted) - {int(str(row["scene"])) for row in rows})
    # processes that grow with their scenes are replaced: all at once, for a pool that replaces one by one may hang
    for first in range(0, len(missing), BATCH):
        with ProcessPoolExecutor(2, get_context("spawn")) as pool:
            batch = missing[first : first + BATCH]
            jobs = [pool.submit(examine, number, positions, true_positions) for number in batch]
            for k, job in enumerate(as_completed(jobs), first + 1):
                row = {name: job.result().get(name, "") for name in FIELDS}
                rows.append(row)
                if file is not None:
                    add(file, row)
                print(f"{k} of {len(missing)}: {in_words(row)}", flush=True)
    return rows


def in_words(row: Row) -> str:
    """A line for whoever watches."""
    scene = f"scene {row['scene']}, {row['shapes']}{' (picture)' if row['picture'] else ''}"
    if row["raised"]:
        return f"{scene} RAISED {row['raised']}"
    values = "FI {FI:.4f} ± {error:.4f}, true {FI_true:.4f} ± {error_true:.4f}".format(**row)
    refuted = f" REFUTED: {row['refuted']}" if row["refuted"] else ""
    return f"{scene}: {row['words']}, {values}, {row['without_value']} without value{refuted}"


def lines_of(file: Path | None) -> list[Row]:
    """What a file holds; nothing where there is none."""
    if file is None or not file.exists():
        return []
    with open(file, newline="") as lines:
        return list(csv.DictReader(lines))


def add(file: Path, row: Row) -> None:
    """One more line of a file."""
    file.parent.mkdir(exist_ok=True)
    new = not file.exists()
    with open(file, "a", newline="") as lines:
        writer = csv.DictWriter(lines, FIELDS, lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


def judged(rows: list[Row]) -> list[Check]:
    answered = [row for row in rows if not row["raised"]]

    def numbers(name: str) -> np.ndarray:
        return np.array([float(str(row[name])) for row in answered])

    def count(name: str, value: str) -> int:
        return sum(row[name] == value for row in answered)

    case = f"{len(rows)} random scenes"
    positions = numbers("positions").sum()
    checks = [
        Check(
            case,
            "scenes that raise",
            0,
            sum(bool(row["raised"]) and row["words"] != "refused" for row in rows),
            rule="at most",
        ),
        Check(
            case,
            "pictures refused, with a ligament thinner than a pixel",
            np.nan,
            sum(row["words"] == "refused" for row in rows),
            rule="told",
        ),
        *(
            Check(case, f"refuted: {what}", 0, count("refuted", what), rule="at most")
            for what in ("a crack starts", "no crack starts", "index is low")
        ),
        Check(
            f"{case}, {positions:.0f} positions",
            "share without value",
            WITHOUT,
            numbers("without_value").sum() / positions,
            rule="at most",
        ),
        Check(
            case,
            "share with an error above 5 % of the highest index",
            np.nan,
            numbers("wide").sum() / positions,
            rule="told",
        ),
    ]
    for words in ("safe", "crack", "open"):
        checks.append(Check(case, f"verdict: {words}", np.nan, count("words", words), rule="told"))
    loaded = numbers("FI_true") > 0
    off = np.abs(numbers("FI")[loaded] / numbers("FI_true")[loaded] - 1)
    checks += [
        Check(case, "error of the highest index, median", np.nan, float(np.nanmedian(off)), rule="told"),
        Check(case, "seconds, median", np.nan, float(np.median(numbers("seconds"))), rule="told"),
    ]
    return checks


def main(quick: bool = False, first: int = 0, scenes: int = SCENES) -> list[Check]:
    if quick:
        rows = gathered(QUICK, QUICK_POSITIONS, QUICK_TRUE_POSITIONS, None)
    else:
        rows = gathered(range(first, first + scenes), POSITIONS, TRUE_POSITIONS, FILE)
    checks = judged(rows)
    show("Words and values of random scenes against a closer look", checks)
    return checks


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="six scenes, a minute at most, no files")
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--scenes", type=int, default=SCENES, help="how many")
    options = parser.parse_args()
    passed = all(check.holds for check in main(options.quick, options.first, options.scenes))
    raise SystemExit(0 if passed else 1)
