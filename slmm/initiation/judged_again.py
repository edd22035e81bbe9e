"""An answer for one material as that for others of the same elasticity, from the evidence that it has kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np

from slmm.criteria.coupled import NONE
from slmm.criteria.coupled_curves import middle_of_bounds
from slmm.criteria.criterion import Criterion
from slmm.criteria.status import Status
from slmm.initiation.by_choice import BOUNDS
from slmm.initiation.evidence import Evidence
from slmm.initiation.task import Answer
from slmm.mechanics.material import Material

#: why there is nothing at a position whatever the strength and the toughness
LASTING = tuple(
    status.value.split("{")[0]
    for status in (
        *(Status.SEVERED, Status.NO_CELL, Status.CORNER, Status.CRACK_TIP, Status.CRACKED),
        *(Status.UNKNOWN_SUPPORT, Status.NO_DISLOCATIONS, Status.STIFF, Status.NEAR_SINGULAR, Status.TOUCHED),
        *(Status.MIXED, Status.NO_CRACK, Status.CLOSES, Status.COMPRESSED, Status.SINGULAR),
    )
)


@dataclass(frozen=True)
class JudgedAgain:
    """What evidence says of n positions for m materials.

    Attributes
    ----------
    load_factor, crack_length, error, governed_by, status, method : ndarray (m, n)
        As those of `slmm.initiation.task.Answer`.
    stands : ndarray (m, n) of bool
        Whether the evidence suffices; elsewhere the method itself may know better.
    """

    load_factor: np.ndarray
    crack_length: np.ndarray
    error: np.ndarray
    governed_by: np.ndarray
    status: np.ndarray
    method: np.ndarray
    stands: np.ndarray

    def of(self, which: np.ndarray) -> JudgedAgain:
        """For some of the materials."""
        return JudgedAgain(*(getattr(self, field.name)[which] for field in fields(self)))

    def put_into(self, answer: Answer, k: int) -> Answer:
        """The answer of which this is another judgement, as that for the k-th material."""
        other = answer.rows(np.arange(len(answer.status)))
        for field in fields(self):
            if field.name != "stands":
                setattr(other, field.name, getattr(self, field.name)[k].copy())
        return other

    @property
    def index(self) -> np.ndarray:
        """Failure indices (m, n); NaN where there is none."""
        with np.errstate(divide="ignore"):
            return np.where(self.status == Status.OK, 1 / self.load_factor, np.nan)

    @property
    def index_error(self) -> np.ndarray:
        """Estimated errors (m, n) of the indices."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(np.isinf(self.load_factor), self.error, self.error / self.load_factor)


def judged_again(answer: Answer, criterion: Criterion, materials: Sequence[Material]) -> JudgedAgain:
    """Apply a criterion once more, to the evidence of an answer, for materials (m,) of the same elasticity.

    Of several pieces of evidence at a position the first one counts that has a value, unless another method has a
    smaller error, as it did for the answer.
    """
    m, n = len(materials), len(answer.status)
    nothing = np.full((m, n), np.nan)
    found = JudgedAgain(
        nothing,
        nothing.copy(),
        nothing.copy(),
        np.full((m, n), NONE),
        np.tile(answer.status, (m, 1)),
        np.tile(answer.method, (m, 1)),
        np.zeros((m, n), dtype=bool),
    )
    without = np.array([not pieces for pieces in answer.evidence], dtype=bool)
    found.stands[:, without] = [str(status).startswith(LASTING) for status in answer.status[without]]
    # what had no value has none where its evidence, which reaches farther than a new one would, has none again
    found.stands[:, (answer.status != Status.OK) & ~without] = True
    for evidence, rows in _pieces(answer):
        judged = evidence.judged(criterion, materials)
        critical, has_value = judged.critical, judged.status == Status.OK
        before = (found.status[:, rows] == Status.OK) & ~np.isnan(found.load_factor[:, rows])
        better = (found.method[:, rows] != evidence.method) & (critical.error < found.error[:, rows])
        new = ~before | (has_value & better)
        for name in ("load_factor", "crack_length", "error", "governed_by"):
            values = getattr(found, name)
            values[:, rows] = np.where(new, getattr(critical, name), values[:, rows])
        found.status[:, rows] = np.where(new, judged.status, found.status[:, rows])
        serves = judged.length >= evidence.stands.shortest
        found.stands[:, rows] = np.where(new & has_value, serves, found.stands[:, rows])
        found.method[:, rows] = np.where(new & has_value, evidence.method, found.method[:, rows])
    _bound(found, answer, materials)
    return found


def for_material(answer: Answer, criterion: Criterion, material: Material) -> Answer:
    """The answer for one other material."""
    return judged_again(answer, criterion, [material]).put_into(answer, 0)


def _pieces(answer: Answer) -> Iterator[tuple[Evidence, np.ndarray]]:
    """Evidence in the order in which it was found, with the positions (k,) that it is about."""
    depth = max((len(pieces) for pieces in answer.evidence), default=0)
    for level in range(depth):
        at: dict[int, tuple[Evidence, list[int], list[int]]] = {}
        for i, pieces in enumerate(answer.evidence.tolist()):
            if len(pieces) > level:
                evidence, row = pieces[level]
                _, positions, rows = at.setdefault(id(evidence), (evidence, [], []))
                positions.append(i)
                rows.append(row)
        for evidence, positions, rows in at.values():
            yield evidence.rows(np.array(rows)), np.array(positions)


def _bound(found: JudgedAgain, answer: Answer, materials: Sequence[Material]) -> None:
    """Bounds where the answer had bounds alone, and there is no value again."""
    rows = np.flatnonzero(answer.method == BOUNDS)
    curves = answer.curves.rows(rows)
    for k, material in enumerate(materials if len(rows) else ()):
        load_factor, error = middle_of_bounds(curves, material)
        without = (found.status[k, rows] != Status.OK) & ~np.isnan(load_factor)
        at = rows[without]
        found.load_factor[k, at], found.error[k, at] = load_factor[without], error[without]
        found.crack_length[k, at], found.governed_by[k, at] = np.nan, NONE
        found.status[k, at], found.method[k, at], found.stands[k, at] = Status.OK, BOUNDS, True
