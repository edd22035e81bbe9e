"""How often searches find the toughest hole pattern, and at which cost, on spaces whose values are all known.

TBFSL(3, 3) from the solid plate, as published, beside the same from random designs, several descents that share their
values, iterated local search, tabu search and random sampling. Values are looked up (`hole_pattern_values.py`), so a
search takes milliseconds. Cost is the number of designs simulated; one that is equal to another by symmetry, or asked
for again, costs nothing. Each search goes on until it has found the optimum or ends; told are the share of runs that
have found it by the end, and within the median cost of the published search, and the median rank there.

Required: one search that finds the optimum within that cost more often than the published one, on all spaces of more
than a hundred classes together. Five minutes; writes validation/results/hole_pattern_searches.csv. ``--quick`` does ten
runs on one space and writes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from checks import Check, run, save, show
from hole_pattern_spaces import all_listed

from slmm.optimization import Bound, Value, search
from slmm.optimization.hole_patterns.listed import ListedPattern

RUNS, QUICK_RUNS = 50, 5
#: classes of equal designs from which on a space tells searches apart; chosen
LARGE = 100
PUBLISHED = "TBFSL(3, 3) from the solid plate"
Row = dict[str, object]


class Searched(NamedTuple):
    """An algorithm, whether it starts from the solid plate, and its settings."""

    algorithm: str
    solid: bool
    settings: dict[str, Any]


SEARCHES = {
    PUBLISHED: Searched("tbfsl", True, {"depth": 3, "radius": 3}),
    "TBFSL(3, 3) from a random design": Searched("tbfsl", False, {"depth": 3, "radius": 3}),
    "TBFSL(2, 2) from the solid plate": Searched("tbfsl", True, {"depth": 2, "radius": 2}),
    "TBFSL(1, 0) from random designs": Searched(
        "ils", False, {"starts": 40, "depth": 1, "radius": 0, "kick": 0}
    ),
    "TBFSL(2, 2) from random designs": Searched(
        "ils", False, {"starts": 20, "depth": 2, "radius": 2, "kick": 0}
    ),
    "TBFSL(3, 3) from random designs": Searched(
        "ils", False, {"starts": 10, "depth": 3, "radius": 3, "kick": 0}
    ),
    **{
        f"iterated local search, depth {depth}, kick {kick}": Searched(
            "ils", True, {"starts": 40, "depth": depth, "radius": radius, "kick": kick}
        )
        for depth, radius in ((1, 0), (2, 2))
        for kick in (2, 3, 4)
    },
    "tabu search": Searched("tabu", True, {"steps": 200}),
    "random sampling": Searched("rs", False, {"limit": -np.inf}),
}


@dataclass(frozen=True)
class Recorded(ListedPattern):
    """A listed pattern that remembers which classes were asked for, in which order."""

    asked: dict[bytes, float] = field(default_factory=dict, repr=False, compare=False)
    keys: dict[bytes, bytes] = field(default_factory=dict, repr=False, compare=False)

    def key(self, design: np.ndarray) -> bytes:
        """See `HolePattern.key`."""
        name = np.asarray(design, dtype=bool).tobytes()
        if name not in self.keys:
            self.keys[name] = super().key(design)
        return self.keys[name]

    def evaluate(self, design: np.ndarray, below: float) -> Value | Bound:
        """See `ListedPattern.evaluate`."""
        self.asked.setdefault(self.key(design), self.values[self.key(design)])
        return super().evaluate(design, below)


def asked_by(space: ListedPattern, searched: Searched, seed: int, keys: dict[bytes, bytes]) -> np.ndarray:
    """Values of the classes that a search simulates, in their order."""
    recorded = Recorded(space.grid, space.pattern, values=space.values, keys=keys)
    start = recorded.start if searched.solid else None
    search(recorded, searched.algorithm, seed=seed, start=start, **searched.settings)
    return np.array(list(recorded.asked.values()))


def rows_of(space: ListedPattern, runs: int) -> list[Row]:
    """A line for each search."""
    values = np.array(list(space.values.values()))
    best = np.nanmin(values)
    case = f"{space.pattern} {space.grid}"
    keys: dict[bytes, bytes] = {}
    found = {
        name: [asked_by(space, searched, seed, keys) for seed in range(runs)]
        for name, searched in SEARCHES.items()
    }
    cost = int(np.median([len(asked) for asked in found[PUBLISHED]]))
    rows = []
    for name, all_asked in found.items():
        within = [np.nanmin(asked[:cost]) for asked in all_asked]
        at = [int((asked == best).argmax()) + 1 if (asked == best).any() else np.inf for asked in all_asked]
        rows.append(
            {
                "space": case,
                "classes": len(values),
                "search": name,
                "runs": runs,
                "designs": float(np.median([len(asked) for asked in all_asked])),
                "finds": float(np.isfinite(at).mean()),
                "cost": cost,
                "finds_within_cost": float((np.array(at) <= cost).mean()),
                "rank_within_cost": float(np.median([space.rank(value) for value in within])),
                "designs_to_optimum": float(np.median(at)),
            }
        )
    return rows


def judged(rows: list[Row]) -> list[Check]:
    checks = [
        Check(str(row["space"]), f"{row['search']}: finds it within {row['cost']} designs", np.nan,
              float(str(row["finds_within_cost"])), rule="told")
        for row in rows
    ]  # fmt: skip
    large = [row for row in rows if int(str(row["classes"])) > LARGE]
    if large:
        misses = {
            name: np.mean(
                [1 - float(str(row["finds_within_cost"])) for row in large if row["search"] == name]
            )
            for name in SEARCHES
        }
        name = min(misses, key=lambda name: misses[name])
        checks.append(
            Check(
                "all of more than a hundred classes",
                f"misses within the published cost: {name}, beside the published search",
                np.nextafter(misses[PUBLISHED], 0.0),
                misses[name],
                rule="at most",
                source="required",
            )
        )
    return checks


def main(quick: bool = False) -> list[Check]:
    spaces = [space for space in all_listed() if len(space.values) >= (100 if quick else 50)]
    rows = [
        row
        for space in spaces[: 1 if quick else None]
        for row in rows_of(space, QUICK_RUNS if quick else RUNS)
    ]
    checks = judged(rows)
    show("Searches among hole patterns", checks)
    if not quick:
        save("hole_pattern_searches", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
