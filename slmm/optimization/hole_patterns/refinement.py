"""Better than the grid: from a design, support values and spacing vary continuously at fixed topology.

The optimizer is scipy's, derivative-free; toughness jumps where paths fork. What it finds is no design of the grid any
more, and is reported apart.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slmm import __version__
from slmm.optimization.checks import check_whole
from slmm.optimization.hole_patterns.continuous import ContinuousPattern
from slmm.optimization.hole_patterns.margins import SHIFTS
from slmm.optimization.hole_patterns.objectives import FIGURES, OVER
from slmm.optimization.hole_patterns.patterns import symmetric
from slmm.running.labelled import labelled
from slmm.running.line_journal import LineJournal, open_lines
from slmm.running.progress import Progress, silent

if TYPE_CHECKING:
    import xarray as xr

    from slmm.optimization.hole_patterns.problem import HolePattern

Array = NDArray[np.float64]

#: by how much support values and spacing (relative) may change; chosen: at half a hole would be none
REACH, STRETCH = 0.45, 0.1
#: of the optimizer's first steps, over these, and of its last ones; chosen
FIRST_STEP, LAST_STEP = 0.25, 1e-3


class _UsedUp(Exception):
    """All evaluations are made."""


@dataclass
class _Record:
    """What has been evaluated."""

    problem: HolePattern
    near: ContinuousPattern
    most: int
    journal: LineJournal | None
    progress: Progress
    known: dict[bytes, dict[str, Any]]
    alike: list[int]
    shifts: tuple[float, ...]
    answers: dict[bytes, float | None] = field(default_factory=dict)
    best: Mapping[str, Any] | None = None
    value: float = -math.inf
    steps: list[tuple[int, float]] = field(default_factory=list)

    @property
    def evaluations(self) -> int:
        """So far, whether made here or known from a journal."""
        return len(self.answers)

    @property
    def refused(self) -> int:
        """How many of them gave no value."""
        return sum(value is None for value in self.answers.values())

    def value_of(self, variables: Array) -> float | None:
        """What is to be large; None of a plate that is none, or has another topology."""
        name = variables.tobytes()
        if name in self.answers:
            return self.answers[name]
        if self.evaluations == self.most:
            raise _UsedUp
        record = self.known.get(name)
        if record is None:
            record = self.known[name] = self.evaluate(variables)
            if self.journal is not None:
                self.journal.add(record)
        value = None if record["reason"] else OVER[self.problem.over](record["by_direction"])
        self.answers[name] = value
        if value is not None and value > self.value:
            self.value, self.best = value, record
            self.steps.append((self.evaluations, value))
        units = self.problem.objective["units"]
        self.progress(
            self.evaluations / self.most, f"{self.evaluations} evaluations, best {self.value:.4g} {units}"
        )
        return value

    def evaluate(self, variables: Array) -> dict[str, Any]:
        """A record of the journal."""
        problem, near, found = self.problem, self.near, {}
        figure = FIGURES[problem.figure]
        try:
            if not near.keeps_topology(variables):
                raise ValueError("the topology is another")
            plate, values = near.plate_of(variables), near.values(variables)
            if plate.weight(values) > problem.heaviest:
                raise ValueError(f"it weighs more than {problem.heaviest:g}")
            for k in sorted(set(self.alike)):
                turned = np.rot90(values, k)
                scenes = [plate.scene(turned, (0.0, shift)) for shift in self.shifts]
                found[k] = min(figure.of(problem.fracture(scene, figure.largest)) for scene in scenes)
        except (ValueError, ArithmeticError, RuntimeError) as error:  # recorded, and the next one may go well
            return {"variables": variables.tolist(), "by_direction": [], "reason": str(error)}
        each = [found[k] for k in self.alike]
        return {"variables": variables.tolist(), "by_direction": each, "reason": ""}


def refine(
    problem: HolePattern,
    design: ArrayLike,
    evaluations: int = 100,
    *,
    shifted: bool = False,
    journal: str | Path | None = None,
    resume: bool = False,
    progress: Progress = silent,
) -> xr.Dataset:
    """Vary support values and spacing of a design for a better one of the same topology.

    Values that the design's own symmetry makes equal stay equal. They move by up to 0.45 and the spacing by up to a
    tenth. The same call finds the same result, to the bit, resumed or not.

    Parameters
    ----------
    problem : HolePattern
    design : array_like of bool (rows, columns)
        With a hole at least.
    evaluations : int
        Plates that are tried at most, the design's own among them; each takes a simulation for every direction that
        its symmetry leaves different.
    shifted : bool
        Whether a plate counts by the worst of three: as it is, and with all holes shifted by 0.02 mm up and down, each
        simulated. What is found then does not lie on a fork, where toughness without it may lead.
    journal : str or Path, optional
        A file to which each evaluation is written as soon as it is done.
    resume : bool
        Go on with what is in the journal.
    progress : callable

    Returns
    -------
    Dataset
        ``support`` (row, column), the values found, and ``design``, those it began with; ``spacing`` and ``frame`` in
        mm; ``by_direction`` and ``by_direction_before``; over ``improvement`` ``evaluation`` and ``value``, the best so
        far; how many were ``evaluations`` and of these ``refused``: with another topology, too heavy, or failed. The
        attribute ``margin`` tells how near the nearest saddle is to the threshold.

    Raises
    ------
    ValueError
        For a design that is not valid or has no hole, one that cannot be simulated, or a journal of another run.

    Examples
    --------
    >>> from slmm.optimization import HolePattern
    >>> problem = HolePattern(1, "full", sides="left", figure="stiffness")
    >>> found = refine(problem, [[True]], evaluations=6)
    >>> bool(found.by_direction[0] > found.by_direction_before[0]), bool(found.support[0, 0] < 1.0)
    (True, True)
    """
    check_whole("evaluations", evaluations, 1)
    whole = problem.whole(design)
    if not whole.any():
        raise ValueError("design: has no hole, and nothing to refine")
    if not problem.valid(np.asarray(design, dtype=bool)[None])[0]:
        raise ValueError(f"design: must be a valid one of {problem!r}")
    # equal by symmetry, equal results
    near = ContinuousPattern(problem.plate, symmetric(whole, problem.sides), problem.sides)
    shifts = (0.0, *SHIFTS) if shifted else (0.0,)
    run = {
        "problem": repr(problem),
        "design": near.whole.astype(int).tolist(),
        "method": f"refine within {REACH:g}, {STRETCH:g}, steps {FIRST_STEP:g} to {LAST_STEP:g}",
        "shifts": list(shifts),
        "version": __version__,
    }
    with nullcontext() if journal is None else open_lines(journal, run, resume) as opened:
        known = {
            np.array(record["variables"]).tobytes(): record for record in (opened.records if opened else ())
        }
        record = _Record(
            problem, near, evaluations, opened, progress, known, near.alike(problem.directions), shifts
        )
        stopped = _optimized(near.start, record)
    return _result(record, stopped)


def _optimized(start: Array, record: _Record) -> str:
    """Evaluate one after the other, and why that ended."""
    from scipy.optimize import minimize

    reach = np.append(np.full(len(start) - 1, REACH), STRETCH)
    first = record.value_of(start)
    if first is None:
        raise ValueError(f"design: {record.known[start.tobytes()]['reason']}")

    def minus(scaled: Array) -> float:
        value = record.value_of(start + reach * np.clip(scaled, -1.0, 1.0))
        return math.inf if value is None else -value

    simplex = np.vstack([np.zeros(len(start)), FIRST_STEP * np.eye(len(start))])
    try:
        minimize(
            minus,
            simplex[0],
            method="Nelder-Mead",
            bounds=[(-1.0, 1.0)] * len(start),
            options={"initial_simplex": simplex, "adaptive": True, "xatol": LAST_STEP, "fatol": 0.0},
        )
    except _UsedUp:
        return "evaluations used up"
    return "steps are small"


def _result(record: _Record, stopped: str) -> xr.Dataset:
    problem, near, best = record.problem, record.near, record.best
    assert best is not None
    plate, values = near.plate_of(best["variables"]), near.values(best["variables"])
    units, figure = problem.objective["units"], FIGURES[problem.figure].long_name
    before = record.known[near.start.tobytes()]["by_direction"]
    evaluation, value = zip(*record.steps, strict=True)
    level_set = plate.level_set(values)
    grid = "row", "column"
    return labelled(
        {
            "support": (grid, values, "1", "support values; row 0 is the top"),
            "design": (grid, near.whole, "1", "design it began with"),
            "spacing": ((), level_set.spacing, "mm", "of the support points"),
            "frame": ((), plate.frame, "mm", "breadth at the edges without support points"),
            "by_direction": ("direction", best["by_direction"], units, f"{figure} by directions"),
            "by_direction_before": ("direction", before, units, f"{figure} of the design by directions"),
            "evaluation": ("improvement", list(evaluation), "1", "number of the evaluation that was better"),
            "value": ("improvement", list(value), units, f"{problem.over} {figure} so far"),
            "evaluations": ((), record.evaluations, "1", "number of evaluations"),
            "refused": ((), record.refused, "1", "of which had another topology, weighed too much or failed"),
        },
        problem=repr(problem),
        stopped=stopped,
        margin=level_set.margin(),
    )
