"""The most critical place of each of many variants of a scene, as arrays that say what they are."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from slmm import __version__
from slmm.criteria.coupled import GOVERNED_BY
from slmm.criteria.status import Status
from slmm.initiation.bounds import upper_bounds
from slmm.initiation.elastic_class import ElasticClass
from slmm.initiation.judged_again import JudgedAgain
from slmm.initiation.labelled_answer import UNITS
from slmm.initiation.peaks import LEAST_RISE
from slmm.initiation.task import Answer, Task
from slmm.running.labelled import LabelledArrays, Variable
from slmm.scene.variants import Variants

#: of the most critical place, in the order of the result
NUMBERS = (
    *("failure_index", "failure_index_error", "failure_index_bound", "load_factor", "crack_length"),
    *("x", "y", "arc_length"),
)
WORDS = ("governed_by", "status", "used_method")
OF_PART = {
    "failure_index": "largest failure index FI = 1/load_factor of the part",
    "failure_index_error": "estimated error of the largest failure index",
    "failure_index_bound": "upper bound of the failure index anywhere; inf where unknown",
    "load_factor": "factor on the load at which the first crack starts",
    "crack_length": "length with which the first crack starts",
    "status": "ok, or why there is no value, or where the index may be higher",
}


@dataclass
class SweptAnswer:
    """What was found for n variants; filled as they are answered.

    Attributes
    ----------
    variants : Variants
    numbers : dict of str to ndarray (n,)
        NaN where there is no value.
    hole : ndarray (n,) of int
        Index of the outline, -1 at a crack tip and where there is no value.
    words : dict of str to ndarray (n,) of str
    answered : int
        For how many materials a method was asked itself.
    cost : dict of str to (int, float)
        As of `slmm.initiation.task.Answer`.
    """

    variants: Variants
    numbers: dict[str, np.ndarray]
    hole: np.ndarray
    words: dict[str, np.ndarray]
    answered: int = 0
    cost: dict[str, tuple[int, float]] = field(default_factory=dict)

    @classmethod
    def empty(cls, variants: Variants) -> SweptAnswer:
        """Nothing yet."""
        n = len(variants.load)
        return cls(
            variants,
            {name: np.full(n, np.nan) for name in NUMBERS},
            np.full(n, -1),
            {name: np.full(n, "", dtype=object) for name in WORDS},
        )

    def spend(self, answer: Answer) -> None:
        """Add what an answer has cost."""
        self.answered += 1
        for method, (positions, seconds) in answer.cost.items():
            before = self.cost.get(method, (0, 0.0))
            self.cost[method] = (before[0] + positions, before[1] + seconds)

    def refuse(self, members: np.ndarray, why: str) -> None:
        """Say why some variants (m,) have no value."""
        self.numbers["failure_index_bound"][members] = np.inf
        for name, word in (("status", why), ("governed_by", "none"), ("used_method", "none")):
            self.words[name][members] = word

    def put(
        self, elastic: ElasticClass, which: np.ndarray, task: Task, judged: JudgedAgain, answer: Answer
    ) -> None:
        """Take over the most critical place of some variants of an elastic field, by their numbers (m,) there.

        Parameters
        ----------
        elastic : ElasticClass
        which : ndarray (m,)
        task : Task
            With the positions of what was judged.
        judged : JudgedAgain
            (m, n)
        answer : Answer
            Of which it is another judgement.
        """
        if not len(which):
            return
        index, error = judged.index, np.nan_to_num(judged.index_error, nan=0.0)
        bound = np.where(judged.status == Status.OK, index + error, np.inf)
        traced = any(outline.accuracy is not None for outline in task.scene.outlines)
        for k in np.flatnonzero(traced | (judged.status != Status.OK).any(axis=1)):
            of_one = replace(task, scene=elastic.of(elastic.materials[which[k]]))
            view = judged.put_into(answer, int(k))
            if traced:
                from slmm.initiation.outline_error import add_outline_error  # imports asymptotics

                add_outline_error(of_one, view)
                judged.error[k] = view.error
            bound[k] = upper_bounds(of_one, view)
        error = judged.index_error
        rows, at = np.arange(len(which)), np.where(np.isnan(index), -1.0, index).argmax(axis=1)
        known = ~np.isnan(index[rows, at])
        error = error[rows, at]
        smooth = task.smooth[at] & (index[rows, at] > 0) & ~np.isnan(error)
        error[smooth] = np.maximum(error[smooth], (LEAST_RISE * index[rows, at])[smooth])
        reached = np.where(known, index[rows, at] + np.nan_to_num(error, nan=0.0), -np.inf)
        bound[rows, at] = np.maximum(bound[rows, at], reached)
        members = elastic.members[which]
        values = {
            "failure_index": index[rows, at],
            "failure_index_error": error,
            "failure_index_bound": bound.max(axis=1),
            "load_factor": judged.load_factor[rows, at],
            "crack_length": judged.crack_length[rows, at],
            "x": task.where.points[at, 0],
            "y": task.where.points[at, 1],
            "arc_length": task.where.s[at],
        }
        for name, of in values.items():
            self.numbers[name][members] = of if name == "failure_index_bound" else np.where(known, of, np.nan)
        if "turned" in answer.columns:
            turned = self.numbers.setdefault("turned", np.full(len(self.hole), np.nan))
            turned[members] = np.where(known, answer.columns["turned"][at], np.nan)
        self.hole[members] = np.where(known, task.where.hole[at], -1)
        governed = np.array(GOVERNED_BY, dtype=object)[judged.governed_by[rows, at]]
        self.words["governed_by"][members] = np.where(known, governed, "none")
        self.words["used_method"][members] = np.where(known, judged.method[rows, at], "none")
        self.words["status"][members] = _statuses(judged, bound, index[rows, at])

    def labelled(self, title: str, facts: dict[str, object], fields: int) -> LabelledArrays:
        """As arrays over the keys; ``fields`` is how many elastic fields there are."""
        axes, shape = self.variants.axes, self.variants.shape
        dims = tuple(axis.key for axis in axes)
        variables = {
            axis.key: Variable(
                (axis.key,), np.array(axis.values), {"units": axis.units, "long_name": axis.long_name}
            )
            for axis in axes
        }
        found = self.numbers | {"hole": self.hole} | {name: of.astype(str) for name, of in self.words.items()}
        for name, values in found.items():
            units, long_name = UNITS[name]
            meaning = {
                "units": units,
                "long_name": OF_PART.get(name, f"{long_name}, where the first crack starts"),
            }
            variables[name] = Variable(dims, values.reshape(shape), meaning)
        attrs: dict[str, object] = {"title": title, "version": __version__} | facts
        attrs["elastic_fields"], attrs["answered"] = fields, self.answered
        if self.cost:
            attrs["cost"] = "; ".join(
                f"{name}: {count} positions in {seconds:.2g} s"
                for name, (count, seconds) in self.cost.items()
            )
        return LabelledArrays(variables, attrs)


def _statuses(judged: JudgedAgain, bound: np.ndarray, largest: np.ndarray) -> list[str]:
    """Of variants (m,) with largest indices (m,) and bounds (m, n)."""
    without = judged.status != Status.OK
    found = []
    for k in range(len(largest)):
        if np.isnan(largest[k]):
            ((why, _),) = Counter(judged.status[k].astype(str).tolist()).most_common(1)
            found.append(why)
            continue
        higher = np.flatnonzero(without[k] & (bound[k] > largest[k]))
        if not len(higher):
            found.append(str(Status.OK))
            continue
        worst = int(higher[bound[k, higher].argmax()])
        positions = f"{len(higher)} position{'s' * (len(higher) > 1)}"
        found.append(f"may be higher at {positions} without a value: {judged.status[k, worst]}")
    return found
