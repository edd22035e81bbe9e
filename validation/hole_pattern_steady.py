"""The toughest hole patterns that do not fork, on spaces whose values are all known.

Designs are broken again in the order of their U_T, and with all holes shifted by 0.02 mm up and down, until one changes
by less than 0.5 % and no later one can be tougher with its holes shifted the worse way. Lines of
validation/results/hole_pattern_steady.csv: each design that was asked, its rank by U_T and by the worst of the three.

Told: how much less tough the toughest steady design is than the optimum. ``--spaces rotated-6`` does these, by default
all that are listed and not in the file yet; ``--quick`` does the smallest and writes nothing.
"""

from __future__ import annotations

import argparse

import numpy as np
from checks import Check, append, saved, show
from hole_pattern_spaces import all_listed, listed, text_of
from table1_toughness import space_of

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.listed import ListedPattern
from slmm.optimization.hole_patterns.steady import toughest_steady

NAME = "hole_pattern_steady"
Row = dict[str, object]


def rows_of(space: ListedPattern) -> list[Row]:
    """A line for each design that was asked."""
    asked = toughest_steady(HolePattern(space.grid, space.pattern), space.ranked())
    by_worst = sorted(range(len(asked)), key=lambda k: -asked[k].worst)
    return [
        {
            "pattern": space.pattern,
            "grid": space.grid,
            "rank": rank + 1,
            "rank_by_worst": by_worst.index(rank) + 1,
            "U_T": each.value,
            "U_T_worst": each.worst,
            "spread": each.spread,
            "steady": int(each.is_steady),
            "design": text_of(each.whole),
        }
        for rank, each in enumerate(asked)
    ]


def judged(rows: list[dict[str, str]]) -> list[Check]:
    checks = []
    for name in dict.fromkeys(f"{row['pattern']} {row['grid']}" for row in rows):
        here = [row for row in rows if f"{row['pattern']} {row['grid']}" == name]
        first = float(here[0]["U_T"])
        steady = next((row for row in here if row["steady"] == "1"), None)
        value = np.nan if steady is None else float(steady["U_T"])
        checks += [
            Check(
                name, "U_T of the toughest steady design, beside the optimum, mJ", first, value, rule="told"
            ),
            Check(name, "designs asked", np.nan, len(here), rule="told"),
        ]
    return checks


def main(quick: bool = False, spaces: list[tuple[str, int]] | None = None) -> list[Check]:
    if quick:
        smallest = next(all_listed())
        rows = [{name: str(value) for name, value in row.items()} for row in rows_of(smallest)]
    else:
        done = {(row["pattern"], int(row["grid"])) for row in saved(NAME)}
        for space in all_listed():
            name = space.pattern, space.grid
            if name not in done and (not spaces or name in spaces):
                append(NAME, rows_of(space))
                print(name, flush=True)
        rows = saved(NAME)
    checks = judged(rows)
    show("Toughest hole patterns that do not fork", checks)
    return checks


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="the smallest space, no files")
    parser.add_argument("--spaces", nargs="+", type=space_of, help="which, as rotated-6")
    given = parser.parse_args()
    if missing := [name for name in given.spaces or () if listed(*name) is None]:
        parser.error(f"{missing}: not all values are known; see hole_pattern_values.py")
    raise SystemExit(0 if all(c.holds for c in main(given.quick, given.spaces)) else 1)
