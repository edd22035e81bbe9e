"""What is asked of a scene: where, by which method and criterion; and the answer of all its positions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.criterion import CRITERIA, Criterion
from slmm.criteria.status import Status
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS, SOURCES, Source
from slmm.initiation.paths import trial_paths
from slmm.initiation.peaks import LEAST_RISE, find_peaks, positions_at, tops
from slmm.initiation.positions import FEW, Positions, find_positions, positions_on
from slmm.initiation.settings import DEFAULT, PUBLISHED, Settings
from slmm.initiation.task import Answer, Task
from slmm.initiation.uncracked import UncrackedField
from slmm.running.cell_file import shipped_database
from slmm.running.progress import Progress, silent
from slmm.scene.scene import Scene

#: times that positions are added where the index is largest; chosen
ROUNDS = 4

#: where cracks go
DIRECTIONS = ("normal", "best")

SETTINGS = {"default": DEFAULT, "published": PUBLISHED}

Method = Callable[[Task], Answer]


@dataclass(frozen=True)
class Question:
    """What is asked of a scene.

    Attributes
    ----------
    task : Task
    ask : callable
        Takes a task, gives its answer.
    source : Source
        Where that has curves from.
    turns : bool
        Whether cracks go into the direction that needs the least load.
    refined : bool
        Whether positions are added where the index is largest.
    facts : dict of str to object
        What was asked for, as attributes of the result.
    """

    task: Task
    ask: Method
    source: Source
    turns: bool
    refined: bool
    facts: dict[str, object]

    def of(self, scene: Scene) -> Question:
        """The same of another scene with the same outlines."""
        task = replace(self.task, scene=scene, paths=trial_paths(scene, self.task.where), solved={})
        return replace(self, task=task)

    def answered(self) -> tuple[Task, Answer]:
        """The answer, and the task with all positions that it has."""
        task = self.task
        if task.scene.part.is_severed:
            answer = Answer.empty(task.n, "none")
            answer.status[:] = Status.SEVERED
            return task, answer
        answer = self.ask(task)
        return with_peaks(task, answer, self.ask) if self.refined else (task, answer)


def posed(
    scene: Scene,
    method: str | None = None,
    positions: int | None = None,
    settings: str | Settings | None = None,
    database: Path | str | None = None,
    average: bool | None = None,
    tolerance: float | None = None,
    displacements: Any = None,
    progress: Progress = silent,
    field: str | None = None,
    criterion: str | None = None,
    direction: str | None = None,
) -> Question:
    """The question by its words; None is what the scene asks for.

    Parameters are those of `slmm.initiation.failure.failure_indices`.

    Raises
    ------
    ValueError
        When a word is unknown, or some do not go together.
    """
    analysis = scene.analysis
    method = analysis.method if method is None else method
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: available are {', '.join(METHODS)}")
    if criterion is None and METHODS[method].criterion == "coupled":
        criterion = analysis.criterion
    judge = chosen_criterion(method, criterion, analysis.average if average is None else average)
    settings = analysis.settings if settings is None else settings
    if isinstance(settings, str):
        if settings not in SETTINGS:
            raise ValueError(f"settings = {settings!r}: available are {', '.join(SETTINGS)}")
        settings = SETTINGS[settings]
    source = SOURCES[METHODS[method].source]
    ask, turns = _directed(source, method, analysis.direction if direction is None else direction)
    # the paper's way has the positions it was given
    spread = analysis.positions if positions is None else positions
    refined = (positions is not None or analysis.points is None) and spread >= FEW and settings != PUBLISHED
    where = find_positions(scene, positions)
    if displacements is None and field is not None:
        raise ValueError(f"field = {field!r}: belongs to displacements from a file, and none is given")
    given = None if displacements is None else _given(displacements, method, scene, where, field)
    task = Task(
        scene,
        where,
        trial_paths(scene, where),
        judge,
        analysis.tolerance if tolerance is None else tolerance,
        settings,
        Path(database) if database is not None else shipped_database(),
        given,
        progress,
    )
    facts: dict[str, object] = {"method": method}
    if criterion is not None:
        facts["criterion"] = criterion
    if turns:
        facts["direction"] = "best"
    return Question(task, ask, source, turns, refined, facts)


def _directed(source: Source, method: str, direction: str) -> tuple[Method, bool]:
    """What answers for cracks in a direction, and whether that turns them."""
    if direction not in DIRECTIONS:
        raise ValueError(f"direction = {direction!r}: must be one of {', '.join(DIRECTIONS)}")
    if direction == "normal":
        return source.answer, False
    if not source.turns:
        turning = [name for name, made_of in METHODS.items() if SOURCES[made_of.source].turns]
        raise ValueError(
            f"direction = 'best': the method {method} turns no cracks; {', '.join(turning)} does"
        )
    from slmm.initiation.turned import in_best_direction

    return in_best_direction(source.answer), True


def chosen_criterion(method: str, name: str | None, average: bool) -> Criterion:
    """The criterion of a method, or another one in its place.

    Raises
    ------
    ValueError
        When there is none of the name, the method is one criterion and no other, or gives less than it needs.
    """
    own = METHODS[method].criterion
    if name is None or name == own:
        return Coupled(average) if own == "coupled" else CRITERIA[own]
    if own != "coupled":
        raise ValueError(
            f"criterion = {name!r}: the method {method} is one itself; ask another method for it"
        )
    if name not in CRITERIA:
        raise ValueError(f"criterion = {name!r}: available are {', '.join(CRITERIA)}")
    if average:
        raise ValueError(f"average: belongs to the coupled criterion, not to {name}")
    wanted = CRITERIA[name]
    if lacking := wanted.needs - SOURCES[METHODS[method].source].gives:
        raise ValueError(
            f"criterion = {name!r}: the method {method} gives no {' and no '.join(sorted(lacking))}"
        )
    return wanted


def with_peaks(task: Task, answer: Answer, method: Callable[[Task], Answer]) -> tuple[Task, Answer]:
    """The task and its answer with further positions, until the estimates cover the peaks between positions.

    What they still do not cover after `ROUNDS` is added to the estimate.
    """
    for left in reversed(range(ROUNDS + 1)):
        with np.errstate(divide="ignore"):
            index = np.where(answer.status == Status.OK, 1 / answer.load_factor, np.nan)
        peaks = find_peaks(task.scene, task.where, index, answer.index_error, answer.crack_length)
        if not peaks:
            rows = tops(task.where, index)
            answer.error[rows] = np.maximum(answer.error[rows], LEAST_RISE)
            break
        if not left:
            for peak in peaks:
                answer.error[peak.row] += peak.rise / index[peak.row]
            break
        hole, s = positions_at(peaks, task.where)
        task.progress(0.9, f"{len(s)} positions more, where the index is largest")
        further = task.at(positions_on(task.scene, hole, s, np.full(len(s), -1)))
        both = Positions(*(np.concatenate(pair) for pair in zip(task.where, further.where, strict=True)))
        # crack tips, which have no outline, stay behind all outlines
        order = np.lexsort((np.nan_to_num(both.s), np.where(both.hole < 0, np.inf, both.hole)))
        answer = answer.with_more(method(further), order)
        task = task.at(Positions(*(values[order] for values in both)))
    return task, answer


def _given(
    displacements: Any, method: str, scene: Scene, where: Positions, field: str | None
) -> UncrackedField:
    if method not in ON_DISPLACEMENTS:
        raise ValueError(
            f"method = {method!r}: takes no displacements; those that do are {', '.join(ON_DISPLACEMENTS)}"
        )
    from slmm.initiation.given_field import given_field  # imports the readers of result files

    return given_field(displacements, scene, where, field)
