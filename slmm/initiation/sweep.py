"""Many loads and materials on one part: what does not change is computed once.

Variants with one elastic field differ by strength and toughness alone (`slmm.initiation.elastic_class`), and of these
by their Irwin's length. The one with the longest is answered as any scene is. What its criterion was applied to serves
those with a shorter one, down to a share of it, as far as the curves stand for their cracks and their errors suffice;
of the others the next one is answered in turn.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from slmm.criteria.criterion import Criterion
from slmm.initiation.by_choice import BOUNDS, MATTERS, NEGLIGIBLE
from slmm.initiation.elastic_class import ElasticClass, elastic_classes
from slmm.initiation.judged_again import JudgedAgain, for_material, judged_again
from slmm.initiation.load_cases import LoadCases
from slmm.initiation.meta_model import PoissonNotHeldError
from slmm.initiation.question import Question, posed, with_peaks
from slmm.initiation.settings import Settings
from slmm.initiation.swept_answer import SweptAnswer
from slmm.initiation.task import Answer, Task
from slmm.mechanics.material import Material
from slmm.running.labelled import LabelledArrays
from slmm.running.progress import Progress, silent
from slmm.scene.plausible import UnusualValueWarning, unusual_values
from slmm.scene.scene import Scene
from slmm.scene.variants import Values, variants_of

#: Irwin's lengths are the same; round-off
SAME = 1e-12
#: materials between the longest and the shortest length for which peaks between positions are looked for; chosen
LOOKED_AT = 3
#: materials that are judged at once: arrays of some 10 MB; chosen
AT_ONCE = 2000
#: by how much the relative error of curves that reach farther may be larger, and what it may be anyway: that of trial
#: cracks that need no closer look (`slmm.initiation.by_boundary.ENOUGH`); both chosen
WORSE, ENOUGH = 2.0, 2e-3


def sweep_arrays(
    scene: Scene,
    vary: Mapping[str, Values],
    method: str | None = None,
    positions: int | None = None,
    settings: str | Settings | None = None,
    database: Path | str | None = None,
    average: bool | None = None,
    tolerance: float | None = None,
    progress: Progress = silent,
    criterion: str | None = None,
    direction: str | None = None,
) -> LabelledArrays:
    """The most critical place of a scene for all combinations of what some of its keys take.

    Parameters
    ----------
    scene : Scene
    vary : mapping of str to values
        See `slmm.scene.variants.variants_of`.
    method, positions, settings, database, average, tolerance, progress, criterion, direction
        As of `slmm.initiation.failure.failure_indices`.

    Returns
    -------
    LabelledArrays
        The keys are the dimensions. ``status`` is "ok", or says why there is no value, or that the index may be higher
        elsewhere.

    Warns
    -----
    UnusualValueWarning
        For materials that no solid is.

    Raises
    ------
    ValueError
        When a key is none of the scene's, or has no values.

    Examples
    --------
    >>> from slmm.scene.gallery import circular_hole
    >>> scene = circular_hole(analysis={"points": [[70, 50]], "voxels": 40000})
    >>> found = sweep_arrays(scene, {"load.strain": [0.01, 0.02], "material.sigma_c": [60, 80]}, "slmm+ac")
    >>> found["failure_index"].values.round(2).tolist()
    [[1.07, 0.82], [2.15, 1.65]]
    """
    variants = variants_of(scene, vary)
    unusual = [text for one in variants.made_of for text in unusual_values(one)]
    if unusual:
        more = f" (and {len(unusual) - 1} more among {len(variants.made_of)} materials)"
        unusual = [unusual[0] + (more if len(unusual) > 1 else "")]
        warnings.warn(unusual[0], UnusualValueWarning, stacklevel=3)
    classes = elastic_classes(variants)
    question = posed(
        classes[0].scene,
        method,
        positions,
        settings,
        database,
        average,
        tolerance,
        progress=progress,
        criterion=criterion,
        direction=direction,
    )
    found = SweptAnswer.empty(variants)
    cases: defaultdict[tuple[object, ...], LoadCases] = defaultdict(LoadCases)
    for k, elastic in enumerate(classes):

        def told(share: float, text: str, k: int = k) -> None:
            progress((k + share) / len(classes), text)

        one = elastic.materials[0]
        _answer(question, elastic, found, told, cases[one.E, one.nu, one.state])
    progress(1.0, "done")
    if unusual:
        question.facts["warnings"] = unusual[0]
    return found.labelled(scene.title, question.facts, len(classes))


def _answer(
    question: Question,
    elastic: ElasticClass,
    found: SweptAnswer,
    progress: Progress,
    cases: LoadCases,
) -> None:
    """Fill the variants of one elastic field; what has been solved under other loads serves, too."""
    size, length = _scales(question.task.criterion, elastic.materials)
    todo = np.argsort(-length, kind="stable")
    solved = cases.under(elastic.scene)
    while len(todo):
        lead, begun = int(todo[0]), 1 - len(todo) / len(length)
        progress(begun, f"{len(todo)} of {len(length)} loads and materials left")
        same = length[todo] >= (1 - SAME) * length[lead]
        near = length[todo] >= question.source.serves * length[lead]
        group = todo[near & ~same & (not question.turns)]
        of_lead = question.of(elastic.of(elastic.materials[lead]))
        part = (same.sum() + len(group)) / len(length)

        def told(share: float, text: str, begun: float = begun, part: float = part) -> None:
            progress(begun + share * part, text)

        asked = replace(of_lead.task, solved=solved, for_shorter=len(group) > 0, progress=told)
        of_lead = replace(of_lead, task=asked)
        try:
            task, answer = of_lead.answered()
        except PoissonNotHeldError as error:
            found.refuse(elastic.members, str(error))
            return
        found.spend(answer)
        served = todo[same]
        found.put(elastic, served, task, _scaled(answer, size[served] / size[lead]), answer)
        if len(group):
            task, answer = _with_peaks_of(of_lead, task, answer, elastic, group)
        for chunk in np.array_split(group, -(-len(group) // AT_ONCE)) if len(group) else ():
            again = judged_again(answer, task.criterion, [elastic.materials[k] for k in chunk])
            enough = _suffices(question, task, answer, again)
            found.put(elastic, chunk[enough], task, again.of(enough), answer)
            served = np.concatenate([served, chunk[enough]])
        todo = todo[~np.isin(todo, served)]
    cases.keep(elastic.scene, solved)


def _scales(criterion: Criterion, materials: tuple[Material, ...]) -> tuple[np.ndarray, np.ndarray]:
    """What load factors are proportional to (m,), and the lengths (m,) that they depend on else.

    A strength at the surface knows no length, nor does Griffith's criterion.
    """
    sigma_c, G_c, length = np.array([(m.sigma_c, m.G_c, m.irwin_length) for m in materials]).T
    if criterion.needs == {"energy"}:
        return np.sqrt(G_c), np.ones(len(materials))
    if "energy" not in criterion.needs and not criterion.depth(materials[0]):
        return sigma_c, np.ones(len(materials))
    return sigma_c, length


def _scaled(answer: Answer, ratio: np.ndarray) -> JudgedAgain:
    """The answer for materials (m,) of the same length, of which load factors are so many times as large."""
    m, ratio = len(ratio), ratio[:, None]
    infinite = np.isinf(answer.load_factor)
    return JudgedAgain(
        answer.load_factor * ratio,
        np.tile(answer.crack_length, (m, 1)),
        np.where(infinite, answer.error / ratio, answer.error),
        np.tile(answer.governed_by, (m, 1)),
        np.tile(answer.status, (m, 1)),
        np.tile(answer.method, (m, 1)),
        np.ones((m, len(answer.status)), dtype=bool),
    )


def _with_peaks_of(
    of_lead: Question, task: Task, answer: Answer, elastic: ElasticClass, group: np.ndarray
) -> tuple[Task, Answer]:
    """Positions added where the index of some materials of a group is largest; the answer stays the lead's."""
    if not of_lead.refined:
        return task, answer
    scene = task.scene
    before = task.n
    found = answer
    picked = group[np.unique(np.linspace(0, len(group) - 1, LOOKED_AT).round().astype(int))]
    for material in (elastic.materials[k] for k in picked):

        def ask(further: Task, material: Material = material) -> Answer:
            return for_material(of_lead.ask(replace(further, scene=scene)), further.criterion, material)

        looked = replace(task, scene=elastic.of(material))
        looked, found = with_peaks(looked, for_material(answer, task.criterion, material), ask)
        if looked.n > before:
            task, answer = replace(looked, scene=scene), for_material(found, task.criterion, scene.material)
            before = task.n
    return task, answer


def _suffices(question: Question, task: Task, answer: Answer, again: JudgedAgain) -> np.ndarray:
    """For which materials (m,) the evidence stands everywhere, with errors that the method itself would leave."""
    stands = np.asarray(again.stands.all(axis=1))
    if not question.source.serves:
        return stands
    lead = _scaled(answer, np.ones(1))
    if question.facts["method"] != "auto":
        worse = np.maximum(WORSE * answer.error, ENOUGH)
        largest = np.nanmax(again.index, axis=1, initial=0.0)[:, None]
        fine = ~(again.index >= MATTERS * largest) | ~(again.error > worse)
        return np.asarray(stands & fine.all(axis=1))
    return np.asarray(
        stands & (_settled(again, task.tolerance) | ~_settled(lead, task.tolerance)).all(axis=1)
    )


def _settled(judged: JudgedAgain, tolerance: float) -> np.ndarray:
    """Where (m, n) method auto would be content, see `slmm.initiation.by_choice`."""
    index, error = judged.index, judged.index_error
    at_least = np.where(judged.method == BOUNDS, index * (1 - judged.error), index)
    largest = np.nanmax(at_least, axis=1, initial=0.0)[:, None]
    with np.errstate(invalid="ignore"):
        within = error <= tolerance * np.maximum(np.nan_to_num(index), MATTERS * largest)
        return within | (index + error < NEGLIGIBLE * largest)
