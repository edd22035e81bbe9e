"""Values of all designs of small spaces of hole patterns, to try searches on problems whose optimum is known.

Each design that is not equal to another by turning and mirroring is simulated to its end from every direction that its
pattern leaves different: no early termination. Every value is appended to a journal as soon as it is known, and a run
that was stopped goes on. A design without a value has its reason in place of it. Spaces that are complete go to
validation/results/hole_pattern_values.nc, which `slmm.optimization.hole_patterns.listed.ListedPattern` reads.

``--spaces rotated-3 full-3`` does these alone, ``--workers 2`` on so many processes.
"""

from __future__ import annotations

import argparse
import json
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from hole_pattern_spaces import JOURNALS, VALUES

from slmm import __version__
from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.patterns import Design
from slmm.running.processes import processes

#: in the order of their cost
SPACES = (
    "rotated-3",
    "rotated-4",
    "reflected-3",
    "reflected-4",
    "rotated-5",
    "full-3",
    "rotated-6",
    "reflected-5",
    "reflected-6",
    "rotated-7",
)
Values = dict[str, float | str]


def classes(problem: HolePattern) -> dict[str, np.ndarray]:
    """A valid design of each class of those that are equal, by their keys."""
    cells = np.argwhere(~problem.fixed)
    found: dict[str, np.ndarray] = {}
    for bits in range(2 ** len(cells)):
        design = problem.start
        design[tuple(cells.T)] = (bits >> np.arange(len(cells))) & 1
        if (name := problem.key(design).hex()) not in found and problem.valid(design[None])[0]:
            found[name] = design
    return found


def known(journal: Path) -> Values:
    """What is in a journal; a last line that a kill has cut is left out."""
    values: Values = {}
    for line in journal.read_text().splitlines() if journal.exists() else []:
        try:
            values.update(json.loads(line))
        except ValueError:
            continue
    return values


def value_of(problem: HolePattern, design: Design) -> float | str:
    """U_T, mJ, of a design, or why it has none."""
    try:
        return -problem.evaluate(design, np.inf).value  # type: ignore[union-attr]
    except (ValueError, ArithmeticError, RuntimeError) as error:
        return str(error)


def enumerated(space: str, workers: int) -> Values:
    """U_T, mJ, or why there is none, of every class."""
    pattern, grid = space.split("-")
    problem = HolePattern(int(grid), pattern)
    journal = JOURNALS / f"values_{space}.jsonl"
    values, designs = known(journal), classes(problem)
    missing = {name: design for name, design in designs.items() if name not in values}
    print(f"{space}: {len(designs)} classes, {len(missing)} to be simulated", flush=True)
    with open(journal, "a") as lines, processes(workers) as pool:
        lines.write("\n")  # behind a line that was cut
        answers = pool.map(partial(value_of, problem), missing.values())
        for name, answer in zip(missing, answers, strict=True):
            values[name] = answer
            lines.write(json.dumps({name: answer}) + "\n")
            lines.flush()
    best = max(value for value in values.values() if isinstance(value, float))
    failed = sum(isinstance(value, str) for value in values.values())
    print(f"{space}: {failed} failed, best {best:.4f} mJ", flush=True)
    return values


def dataset(spaces: dict[str, Values]) -> xr.Dataset:
    """All of it over ``design``."""
    rows = [
        (*space.split("-"), name, value) for space, values in spaces.items() for name, value in values.items()
    ]
    U_T = [value if isinstance(value, float) else np.nan for *_, value in rows]
    reasons = [value if isinstance(value, str) else "" for *_, value in rows]
    return xr.Dataset(
        {
            "pattern": ("design", [row[0] for row in rows], {"units": "1", "long_name": "what designs vary"}),
            "grid": (
                "design",
                [int(row[1]) for row in rows],
                {"units": "1", "long_name": "points along a side"},
            ),
            "key": (
                "design",
                [row[2] for row in rows],
                {"units": "1", "long_name": "key of the design, in hex"},
            ),
            "U_T": (
                "design",
                U_T,
                {"units": "mJ", "long_name": "least tensile toughness over the directions"},
            ),
            "reason": ("design", reasons, {"units": "1", "long_name": "why there is no value"}),
        },
        attrs={"problem": repr(HolePattern()), "version": __version__},
    )


def write(spaces: dict[str, Values]) -> None:
    """Add spaces to the file, in place of what it has of them."""
    found = dataset(spaces)
    if VALUES.exists():
        # its encoding would cut longer keys
        before = xr.load_dataset(VALUES).drop_encoding()
        names = [
            f"{pattern}-{grid}"
            for pattern, grid in zip(before.pattern.values, before.grid.values, strict=True)
        ]
        others = before.isel(design=[k for k, name in enumerate(names) if name not in spaces])
        found = xr.concat([others, found], dim="design", combine_attrs="override")
    found.to_netcdf(VALUES, engine="netcdf4")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spaces", nargs="+", default=SPACES, choices=SPACES, help="which")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    given = parser.parse_args()
    JOURNALS.mkdir(exist_ok=True)
    for chosen in given.spaces:
        write({chosen: enumerated(chosen, given.workers)})
