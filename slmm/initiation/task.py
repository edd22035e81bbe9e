"""What is asked of a method, and what it answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from slmm.criteria.coupled import NONE
from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.criterion import Criterion
from slmm.criteria.path_curves import PathCurves
from slmm.criteria.status import Status
from slmm.initiation.evidence import Evidence, Found, Stands, nothing_found
from slmm.initiation.paths import Paths, trial_paths
from slmm.initiation.positions import Positions
from slmm.initiation.settings import Settings
from slmm.initiation.uncracked import UncrackedField
from slmm.running.progress import Progress
from slmm.scene.scene import Scene


@dataclass(frozen=True)
class Task:
    """Failure indices of a scene at some positions.

    Attributes
    ----------
    scene : Scene
    where : Positions
    paths : Paths
    criterion : Criterion
        What judges the curves.
    tolerance : float
        Relative error of the failure index that auto aims at.
    settings : Settings
        Of the crack cells.
    database : Path
        Of the crack cells.
    displacements : UncrackedField, optional
        The user's own model of the uncracked part, in place of ours.
    progress : callable
    solved : dict
        Local models that have been solved on the way, by their kind.
    for_shorter : bool
        Whether curves are to serve materials with a shorter Irwin's length, too.
    """

    scene: Scene
    where: Positions
    paths: Paths
    criterion: Criterion
    tolerance: float
    settings: Settings
    database: Path
    displacements: UncrackedField | None
    progress: Progress
    solved: dict[str, Any] = field(default_factory=dict)
    for_shorter: bool = False

    @property
    def n(self) -> int:
        """Number of positions."""
        return len(self.where.s)

    @property
    def by_least_stress(self) -> bool:
        """Whether the criterion is the coupled one with the least stress, whose curves bound the index."""
        return self.criterion == Coupled()

    @property
    def smooth(self) -> np.ndarray:
        """Which positions (n,) lie neither at a corner nor at a crack tip."""
        return np.isnan(self.where.corner)

    def among(self, rows: np.ndarray) -> Task:
        """The same for some of the positions."""
        where = Positions(*(values[rows] for values in self.where))
        paths = Paths(*(values[rows] for values in self.paths))
        return replace(self, where=where, paths=paths)

    def with_paths(self, paths: Paths) -> Task:
        """The same with other paths."""
        return replace(self, paths=paths)

    def at(self, where: Positions) -> Task:
        """The same at other positions."""
        return replace(self, where=where, paths=trial_paths(self.scene, where))


@dataclass
class Answer:
    """What a method found at n positions; filled row by row.

    Attributes
    ----------
    load_factor, crack_length, error : ndarray (n,)
        NaN where there is no value; ``error`` is the relative one, as the method itself estimates it, or where the
        index is 0 (the load factor infinite) that of the index.
    governed_by : ndarray (n,) of int
        Index into `coupled.GOVERNED_BY`.
    status, method, reason : ndarray (n,) of str
        "ok" or why there is no value; which method gave it; why this one.
    curves : PathCurves
    evidence : ndarray (n,) of tuple
        What the criterion has been applied to, see `slmm.initiation.evidence.Found`.
    columns : dict of str to ndarray (n,)
        What only some methods have.
    source : str
        Which method this is.
    provenance : dict of str to dict of str to object
        What it was made with, as attributes of the result: values by method.
    cost : dict of str to (int, float)
        By method: at how many positions it was asked, and how long that took, s.
    """

    load_factor: np.ndarray
    crack_length: np.ndarray
    error: np.ndarray
    governed_by: np.ndarray
    status: np.ndarray
    method: np.ndarray
    reason: np.ndarray
    curves: PathCurves
    evidence: np.ndarray
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    source: str = "none"
    provenance: dict[str, dict[str, object]] = field(default_factory=dict)
    cost: dict[str, tuple[int, float]] = field(default_factory=dict)

    @classmethod
    def empty(cls, n: int, method: str) -> Answer:
        """No value anywhere yet."""

        def nothing() -> np.ndarray:
            return np.full(n, np.nan)

        def text(word: str) -> np.ndarray:
            return np.full(n, word, dtype=object)

        return cls(
            load_factor=nothing(),
            crack_length=nothing(),
            error=nothing(),
            governed_by=np.full(n, NONE),
            status=text(""),
            method=text(method),
            reason=text(""),
            curves=PathCurves.empty(n),
            evidence=nothing_found(n),
            source=method,
        )

    def note(self, **made_with: object) -> None:
        """Say what this method has used."""
        for name, value in made_with.items():
            self.provenance.setdefault(name, {})[self.source] = value

    @property
    def described(self) -> dict[str, object]:
        """Attributes of the result; where methods differ, the value of each by its name."""
        found: dict[str, object] = {}
        for name, by_method in self.provenance.items():
            values = list(by_method.values())
            alike = all(value == values[0] for value in values)
            found[name] = (
                values[0] if alike else "; ".join(f"{method}: {value}" for method, value in by_method.items())
            )
        return found

    def judge(
        self,
        rows: np.ndarray,
        curves: PathCurves,
        task: Task,
        too_short: str,
        complete: np.ndarray | None = None,
        stands: Stands | None = None,
    ) -> None:
        """Apply the task's criterion to the curves of some positions, and keep them.

        Parameters
        ----------
        rows : ndarray of int
            The positions.
        curves : PathCurves
            Of these positions; all of them have values.
        task : Task
        too_short : str
            The status where the curves end before both conditions meet.
        complete : ndarray (n,) of bool, optional
            Which paths go through the whole ligament.
        stands : Stands, optional
            For which cracks the curves stand; by default for all within them.
        """
        self.weigh(rows, curves, task, too_short, complete, stands)
        self.curves.put(rows, curves)

    def weigh(
        self,
        rows: np.ndarray,
        curves: PathCurves,
        task: Task,
        too_short: str,
        complete: np.ndarray | None = None,
        stands: Stands | None = None,
    ) -> None:
        """Apply the task's criterion as `judge` does, to curves at points of their own, which are not kept as such."""
        k = len(rows)
        complete = np.zeros(k, dtype=bool) if complete is None else complete
        evidence = Evidence(curves, stands or Stands.everywhere(k), complete, too_short, self.source)
        judged = evidence.judged(task.criterion, [task.scene.material])
        self._keep(rows, [((evidence, i),) for i in range(k)])
        critical = judged.critical.of(0)
        self.load_factor[rows] = critical.load_factor
        self.crack_length[rows] = critical.crack_length
        self.governed_by[rows] = critical.governed_by
        self.error[rows] = critical.error
        self.status[rows] = judged.status[0]

    def _keep(self, rows: np.ndarray, found: Sequence[Found]) -> None:
        """Put evidence behind what did not suffice, and in place of what did: it is better."""
        for i, more in zip(np.asarray(rows).tolist(), found, strict=True):
            before: Found = self.evidence[i]
            sufficed = self.status[i] == Status.OK and any(e.method == self.method[i] for e, _ in before)
            self.evidence[i] = more if sufficed else (*before, *more)

    @property
    def index_error(self) -> np.ndarray:
        """Estimated error (n,) of the failure index itself."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(np.isinf(self.load_factor), self.error, self.error / self.load_factor)

    def column(self, name: str) -> np.ndarray:
        """A column by its name, made when it is not there yet."""
        return self.columns.setdefault(name, np.full(len(self.status), np.nan))

    def spend(self, cost: dict[str, tuple[int, float]]) -> None:
        """Add what methods have cost."""
        for method, (positions, seconds) in cost.items():
            before = self.cost.get(method, (0, 0.0))
            self.cost[method] = (before[0] + positions, before[1] + seconds)

    def with_more(self, other: Answer, order: np.ndarray) -> Answer:
        """These positions and another answer's, in the order (n,) of their numbers in both together."""
        n, m = len(self.status), len(other.status)
        both = Answer.empty(n + m, "none")
        both.source = self.source
        both.take(np.arange(n, n + m), other)
        both.take(np.arange(n), self)  # last: what the larger part was made with stays
        ordered = both.rows(order)
        ordered.spend(self.cost)
        ordered.spend(other.cost)
        return ordered

    def rows(self, rows: np.ndarray) -> Answer:
        """The answer at some of the positions."""
        names = ("load_factor", "crack_length", "error", "governed_by", "status", "method", "reason")
        return Answer(
            **{name: getattr(self, name)[rows] for name in names},
            curves=self.curves.rows(rows),
            evidence=self.evidence[rows],
            columns={name: values[rows] for name, values in self.columns.items()},
            source=self.source,
            provenance=self.provenance,
        )

    def take(self, rows: np.ndarray, other: Answer) -> None:
        """Take over another method's answer for some positions; ``other`` has just these."""
        self._keep(rows, other.evidence.tolist())
        for name in ("load_factor", "crack_length", "error", "governed_by", "status", "method", "reason"):
            getattr(self, name)[rows] = getattr(other, name)
        self.curves.put(rows, other.curves)
        for name, values in other.columns.items():
            self.column(name)[rows] = values
        for name, by_method in other.provenance.items():
            self.provenance[name] = {**self.provenance.get(name, {}), **by_method}
