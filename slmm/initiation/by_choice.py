"""Method auto: for every position the cheapest method whose own estimate meets the tolerance.

In order of their cost: trial cracks from smooth surfaces, all at once; at corners, crack tips and beside them, where
there is a mesher, asymptotics and dislocations in one body-fitted model of the part; wherever these leave more than the
tolerance, and where the index is largest, a trial crack for the position, or, where that costs less, a model with a
slit for it. Parts with so many outlines that boundary integrals cost more go another way: the strength alone, where any
critical crack is so short that the stress hardly falls along it; a crack cell on voxels; the asymptotics of corners and
crack tips; dislocations in a body-fitted model of the part. Each method is asked only at the positions that those
before could not settle, and the result says what was used where, and why.

The tolerance is relative to the index, but no crack starts where another position has several times as large a one:
of indices below a quarter of the largest it is the tolerance of that quarter. Where nothing is under tension, and all
indices are 0, a quarter of the index that a circular hole would have in tension takes its place.

Where a method's curves end before both conditions meet, they still bound the index, from below by what they reach and
from above by the stress at their end. The middle is then the value, with half the difference as its error, until a
method does better.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from time import perf_counter

import numpy as np

from slmm.criteria.coupled import NONE
from slmm.criteria.coupled_curves import middle_of_bounds
from slmm.criteria.status import Status
from slmm.initiation.cell_errors import reference_stress
from slmm.initiation.task import Answer, Task

#: with more points on its boundary than this a part by boundary integrals is dear; chosen
POINTS_AFFORDED = 3000
#: with more voxels than this a body-fitted model is cheaper; chosen
VOXELS_AFFORDED = 700**2

#: with at least this tolerance dislocations do with elements so many times as large, up to this effective Poisson's
#: ratio: nearer to 1, that is incompressible, elements lock; all chosen
LOOSE, COARSENESS, LOCKING = 0.01, 1.5, 0.95
#: indices below this share of the largest one need no more than its accuracy; chosen
MATTERS = 0.25
#: and where what is known keeps the index below this share, no model of its own is made for it; chosen
NEGLIGIBLE = 0.1

#: up to so many a trial crack for one position costs less than a mesh with a slit for it; chosen
BORDERS_AFFORDED = 800
#: methods that leave hardly an error
EXACT = ("boundary", "full-fea")

#: the method where curves end too early, and bound the index
BOUNDS = "bounds"
ELSEWHERE = "a crack starts elsewhere first: the strength keeps the index below {} of the largest"

MANY_VOXELS = "crack cell: the sharpest notch needs {} voxels, which cost more than a body-fitted model"
NO_FEA = "no method comes closer without the extra 'fea', which is not installed"
GIVEN = "given displacements serve crack cells alone"
NOTHING_CLOSER = "no method comes closer"


def by_choice(task: Task) -> Answer:
    """Answer of the cheapest sufficient method for each position."""
    choice = _Choice(task)
    if task.displacements is not None:
        choice.ask("crack cell", _cells_or_strength, choice.open)
        return choice.explained(GIVEN)
    has_fea = find_spec("netgen") is not None
    points = _boundary_points(task)
    if points <= POINTS_AFFORDED:
        from slmm.initiation.by_boundary import by_surfaces

        choice.ask("trial cracks at once", by_surfaces, choice.open)
        choice.settle_negligible()
        if has_fea and len(choice.open) > 1:
            _on_meshes(choice)
        exact = [_by_borders]
        if has_fea:
            exact.insert(1 if points <= BORDERS_AFFORDED else 0, _by_slits)
        for ask in exact:
            ask(choice)
            choice.settle_negligible()
    else:
        _many_outlines(choice, has_fea)
    return choice.explained(NOTHING_CLOSER if has_fea else NO_FEA)


def _by_slits(choice: _Choice) -> None:
    """Ask meshes with a slit one by one, and where the index is largest."""
    _open_by_slits(choice)
    if not choice.is_exact_at_largest:
        from slmm.initiation.by_full_fea import by_full_fea  # imports the finite element libraries

        choice.ask_at_largest("full FEA", by_full_fea)


def _open_by_slits(choice: _Choice) -> None:
    if len(choice.open):
        from slmm.initiation.by_full_fea import by_full_fea  # imports the finite element libraries

        choice.ask_one_by_one("full FEA", by_full_fea, choice.open)


def _by_borders(choice: _Choice) -> None:
    """Ask trial cracks one by one, and where the index is largest."""
    from slmm.initiation.by_boundary import by_borders

    choice.ask_one_by_one("trial cracks", lambda task, least, reached: by_borders(task, reached), choice.open)
    choice.ask_at_largest("trial cracks", by_borders)


def _boundary_points(task: Task) -> float:
    """How many points on its boundary the part needs; infinite where boundary integrals refuse it."""
    from slmm.initiation.boundary_field import boundary_points

    if "boundary points" not in task.solved:
        try:
            task.solved["boundary points"] = boundary_points(task.scene)
        except ValueError:
            task.solved["boundary points"] = np.inf
    return float(task.solved["boundary points"])


def _many_outlines(choice: _Choice, has_fea: bool) -> None:
    """Ask what costs less where boundary integrals are dear."""
    from slmm.initiation.by_cells import voxel_count

    task = choice.task
    voxels = voxel_count(task) if task.scene.outlines else 0
    if voxels <= VOXELS_AFFORDED or not has_fea:
        choice.ask("crack cell", _cells_or_strength, choice.open)
    else:
        choice.pass_over(choice.open[task.smooth], MANY_VOXELS.format(voxels))
    if not has_fea:
        from slmm.initiation.by_boundary import by_boundary

        choice.settle_negligible()
        choice.ask_one_by_one("trial cracks", lambda task, least, reached: by_boundary(task), choice.open)
        return
    _on_meshes(choice)
    choice.settle_negligible()
    _open_by_slits(choice)


def _on_meshes(choice: _Choice) -> None:
    """Ask what one body-fitted model of the part serves at many positions."""
    from slmm.initiation.by_asymptotics import by_asymptotics  # these import the finite element libraries
    from slmm.initiation.by_dislocations import by_dislocations

    task, left = choice.task, choice.open
    choice.ask("asymptotics", by_asymptotics, left[~task.smooth[left]])
    left = choice.open
    loose = task.tolerance >= LOOSE and task.scene.material.plane_stress_equivalent[1] < LOCKING
    coarseness = COARSENESS if loose else 1.0
    choice.ask("dislocations", partial(by_dislocations, coarseness=coarseness), left[task.smooth[left]])
    choice.settle_negligible()
    left = choice.open
    choice.ask("asymptotics", by_asymptotics, left[task.smooth[left]])


class _Choice:
    """The best answer so far, and why others were passed over."""

    def __init__(self, task: Task):
        self.task = task
        self.answer = Answer.empty(task.n, "none")
        self.passed_over: list[list[str]] = [[] for _ in range(task.n)]
        self.settled = np.zeros(task.n, dtype=bool)

    @property
    def index(self) -> np.ndarray:
        """Failure indices so far; NaN where there is none."""
        return np.where(self.answer.status == Status.OK, 1 / self.answer.load_factor, np.nan)

    @property
    def largest(self) -> float:
        """Largest failure index so far; of bounds the lower ones count."""
        at_least = np.where(self.bounded, self.index * (1 - self.answer.error), self.index)
        return float(np.nanmax(at_least, initial=0.0))

    @property
    def highest(self) -> np.ndarray:
        """What the index is at most (n,); infinite where nothing is known."""
        known = self.answer.status == Status.OK
        error = np.nan_to_num(self.answer.index_error, nan=np.inf)
        return np.where(known, np.nan_to_num(self.index) + error, np.inf)

    @property
    def bounded(self) -> np.ndarray:
        """Which positions have bounds alone."""
        return self.answer.method == BOUNDS

    @property
    def open(self) -> np.ndarray:
        """Positions that no method has settled yet."""
        return np.flatnonzero(~self.settled)

    def pass_over(self, rows: np.ndarray, why: str) -> None:
        """Note why a method was not taken at some positions."""
        for i in rows:
            self.passed_over[i].append(why)

    def ask(self, name: str, method: Callable[[Task], Answer], rows: np.ndarray) -> None:
        """Ask a method at some positions, and take what is better than before; bounds where it gives no value."""
        if not len(rows):
            return
        began = perf_counter()
        found = method(self.task.among(rows))
        status = found.status.copy()
        if self.task.by_least_stress:
            _take_bounds(found, self.task)
        known = self.answer
        known.spend({name: (len(rows), perf_counter() - began)})
        has_value = found.status == Status.OK
        error = np.where(has_value, np.nan_to_num(found.index_error, nan=np.inf), np.inf)
        is_known = known.status[rows] == Status.OK
        before = np.where(is_known, np.nan_to_num(known.index_error[rows], nan=np.inf), np.inf)
        without = known.status[rows] != Status.OK
        better = (has_value & (without | (error < before))) | (~has_value & without)
        known.take(rows[better], found.rows(better))
        self.settle()
        for k, i in enumerate(rows):
            if not self.settled[i]:
                said = f"error {_percent(found.error[k])}" if status[k] == Status.OK else str(status[k])
                self.passed_over[i].append(f"{name}: {said}")

    def ask_one_by_one(self, name: str, method: Callable[..., Answer], rows: np.ndarray) -> None:
        """Ask a dear method, the most dangerous position first: what it finds there may leave others far below."""
        for k, i in enumerate(rows[np.argsort(-self.highest[rows], kind="stable")]):
            if not self.settled[i]:
                self.task.progress(k / len(rows), f"{name}, position {k + 1} of {len(rows)}")
                reached = self.answer.curves.a[[i], -1] if self.bounded[i] else None
                self.ask(name, partial(method, least=MATTERS * self.largest, reached=reached), np.array([i]))
                self.settle_negligible()

    def ask_at_largest(self, name: str, method: Callable[[Task], Answer]) -> None:
        """Ask an exact method where the index is largest, until it has given the largest one itself."""
        for _ in range(self.task.n):
            if self.is_exact_at_largest:
                break
            i = int(np.nan_to_num(self.index).argmax())
            before = self.answer.method[i]
            self.ask(name, method, np.array([i]))
            if self.answer.method[i] == before:
                break

    @property
    def is_exact_at_largest(self) -> bool:
        """Whether an exact method has given the largest index, or there is none."""
        index = np.nan_to_num(self.index)
        i = int(index.argmax())
        return bool(index[i] == 0) or self.answer.method[i] in EXACT

    def settle(self) -> None:
        """Find the positions whose error is small enough beside their index or the largest one."""
        allowed = self.task.tolerance * np.maximum(self.index, MATTERS * self.largest)
        self.settled |= self.answer.index_error <= allowed

    def settle_negligible(self) -> None:
        """Be content with values and bounds that keep the index far below the largest."""
        self.settled |= self.negligible

    @property
    def negligible(self) -> np.ndarray:
        """Which positions have an index far below the largest, or, where all are 0, below what is asked of a hole."""
        if self.largest > 0:
            return self.highest < NEGLIGIBLE * self.largest
        of_hole = reference_stress(self.task.scene) / self.task.scene.material.sigma_c
        return self.highest <= self.task.tolerance * MATTERS * of_hole

    def explained(self, rest: str) -> Answer:
        """The answer with its reasons; ``rest`` is why the positions left open stay so."""
        goal, negligible = _percent(self.task.tolerance), self.negligible
        for i, why in enumerate(self.passed_over):
            error = self.answer.error[i]
            if not self.settled[i]:
                says = f"{rest} ({goal} asked for)"
            elif self.answer.load_factor[i] == np.inf:
                says = f"no tension, but for an index of {error:.2g}"
            elif error <= self.task.tolerance:
                says = f"error {_percent(error)} within {goal}"
            elif negligible[i]:
                says = ELSEWHERE.format(_percent(NEGLIGIBLE))
            else:
                says = f"error {_percent(error)}, within {goal} of the quarter of the largest index"
            self.answer.reason[i] = says + (f"; passed over: {'; '.join(why)}" if why else "")
        self.answer.note(tolerance=self.task.tolerance)
        return self.answer


def _cells_or_strength(task: Task) -> Answer:
    """Crack cells, and where they are not needed the strength alone."""
    from slmm.fem.triangulation import MesherError
    from slmm.initiation.by_cells import cells_on, local_field, rows_with_cells, strength_on
    from slmm.initiation.meta_model import PoissonNotHeldError, load_meta_model

    answer = Answer.empty(task.n, "slmm+ac")
    rows = rows_with_cells(task, answer)
    if not len(rows):
        return answer
    try:
        load_meta_model(task.scene.material.plane_stress_equivalent[1], task.database)
    except PoissonNotHeldError as error:
        answer.status[rows] = Status.NO_CELL.of(error)
        return answer
    try:
        local = local_field(task)
    except MesherError as error:
        answer.status[rows] = Status.NO_MESH.of(error)
        return answer
    answer.note(**local.described)
    if task.by_least_stress:
        strength_on(local, task, answer, rows)
    cells_on(local, task, True, answer, rows[answer.status[rows] != Status.OK])
    return answer


def _take_bounds(found: Answer, task: Task) -> None:
    """Where curves ended too early: the middle of the bounds that they give, and half the difference as an error."""
    load_factor, error = middle_of_bounds(found.curves, task.scene.material)
    rows = np.flatnonzero((found.status != Status.OK) & ~np.isnan(load_factor))
    found.load_factor[rows], found.error[rows] = load_factor[rows], error[rows]
    found.crack_length[rows], found.governed_by[rows] = np.nan, NONE
    found.status[rows], found.method[rows] = Status.OK, BOUNDS


def _percent(error: float) -> str:
    return "unknown" if not np.isfinite(error) else f"{100 * error:.2g} %"
