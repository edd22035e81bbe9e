"""What scripts on hole patterns share: Table 1 of Paper D, designs as text, simulations that are counted, lists."""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from checks import RESULTS

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.listed import ListedPattern
from slmm.optimization.hole_patterns.patterns import Design, fixed_cells
from slmm.scene.scene import Scene

VALUES = RESULTS / "hole_pattern_values.nc"
JOURNALS = Path(__file__).parent / "journals"


class Published(NamedTuple):
    """A run of Table 1: U_T*, mJ, designs, and simulations."""

    U_T: float
    iterations: int
    evaluations: int


#: published (Paper D, Table 1)
TABLE1 = {
    ("full", 3): Published(344.9, 24, 45),
    ("full", 4): Published(404.4, 397, 506),
    ("full", 5): Published(422.9, 1038, 1352),
    ("full", 6): Published(366.2, 1548, 2149),
    ("full", 7): Published(374.7, 1619, 2136),
    ("reflected", 3): Published(352.6, 10, 18),
    ("reflected", 4): Published(388.7, 10, 17),
    ("reflected", 5): Published(465.1, 122, 160),
    ("reflected", 6): Published(466.2, 55, 72),
    ("reflected", 7): Published(431.4, 255, 321),
    ("reflected", 8): Published(486.8, 235, 277),
    ("reflected", 9): Published(421.2, 850, 949),
    ("reflected", 10): Published(455.6, 644, 692),
    ("rotated", 3): Published(352.7, 6, 6),
    ("rotated", 4): Published(393.4, 10, 10),
    ("rotated", 5): Published(416.5, 52, 52),
    ("rotated", 6): Published(428.1, 99, 99),
    ("rotated", 7): Published(451.2, 251, 251),
    ("rotated", 8): Published(430.1, 259, 259),
    ("rotated", 9): Published(456.7, 602, 602),
    ("rotated", 10): Published(462.7, 687, 687),
}


def variables(pattern: str, grid: int) -> int:
    """How many cells a design has that may change."""
    return int((~fixed_cells(pattern, grid)).sum())


def by_size() -> list[tuple[str, int]]:
    """The runs of Table 1, those of few variables first."""
    return sorted(TABLE1, key=lambda run: (variables(*run), run))


def text_of(whole: Design) -> str:
    """A whole grid on one line."""
    return "/".join("".join("01"[int(cell)] for cell in row) for row in whole)


def whole_of(text: str) -> Design:
    """The whole grid of a text."""
    return np.array([[cell == "1" for cell in row] for row in text.split("/")])


def design_of(problem: HolePattern, whole: Design) -> Design:
    """The design of a problem that has a whole grid, up to symmetry: the first of its rotations and mirror images."""
    for k in range(4):
        for step in (1, -1):
            turned = np.rot90(whole, k)[::step]
            if problem.pattern == "full":
                return turned
            half = problem.grid // 2
            design = turned[: problem.shape[0], half:] & ~problem.fixed
            if (problem.whole(design) == turned).all():
                return design
    raise ValueError(f"whole: is no design of {problem!r}")


@dataclass(frozen=True)
class CountedPattern(HolePattern):
    """A hole pattern that writes a line to a file for each simulation: how much CPU time it took, s."""

    log: Path = field(default=Path(os.devnull), repr=False, compare=False)

    def fracture(self, scene: Scene, *arguments: Any, **options: Any) -> xr.Dataset:
        """See `HolePattern.fracture`."""
        begin = time.process_time()
        try:
            return super().fracture(scene, *arguments, **options)
        finally:
            with open(self.log, "a") as lines:  # short lines of several processes do not mix
                lines.write(f"{time.process_time() - begin:.3f}\n")


def counted(log: Path) -> tuple[int, float]:
    """How many simulations there were, and their CPU time, s."""
    lines = log.read_text().split() if log.exists() else []
    return len(lines), sum(map(float, lines))


def designs_in(journal: Path) -> int:
    """How many designs a journal of a search has anything of."""
    with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as connection:
        every = (
            "SELECT design FROM evaluation UNION SELECT design FROM bound UNION SELECT design FROM failure"
        )
        return int(connection.execute(f"SELECT count(*) FROM ({every})").fetchone()[0])


def listed(pattern: str, grid: int) -> ListedPattern | None:
    """The values of a space, if all of them are known."""
    try:
        return ListedPattern.read(VALUES, pattern, grid)
    except (ValueError, OSError):
        return None


def all_listed() -> Iterator[ListedPattern]:
    """Every space whose values are known, in the order of Table 1's sizes."""
    for run in by_size():
        if (space := listed(*run)) is not None:
            yield space
