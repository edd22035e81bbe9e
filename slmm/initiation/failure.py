"""Failure indices along the notches of a scene: the library's main entry."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.criterion import CRITERIA, Criterion
from slmm.criteria.status import Status
from slmm.initiation.bounds import upper_bounds
from slmm.initiation.labelled_answer import labelled
from slmm.initiation.meta_model import shipped_database
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS, SOURCES
from slmm.initiation.paths import trial_paths
from slmm.initiation.peaks import LEAST_RISE, find_peaks, positions_at, tops
from slmm.initiation.positions import FEW, Positions, find_positions, positions_on
from slmm.initiation.settings import DEFAULT, PUBLISHED, Settings
from slmm.initiation.task import Answer, Task
from slmm.initiation.uncracked import UncrackedField
from slmm.running.labelled import LabelledArrays
from slmm.running.progress import Progress, silent
from slmm.scene.plausible import UnusualValueWarning, unusual_values
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

    from slmm.mechanics.material import Material

#: times that positions are added where the index is largest; chosen
ROUNDS = 4

#: where cracks go
DIRECTIONS = ("normal", "best")

SETTINGS = {"default": DEFAULT, "published": PUBLISHED}


def failure_indices(
    scene: Scene | None = None,
    method: str | None = None,
    positions: int | None = None,
    curves: bool = False,
    settings: str | Settings | None = None,
    database: Path | str | None = None,
    average: bool | None = None,
    tolerance: float | None = None,
    displacements: Any = None,
    progress: Progress = silent,
    field: str | None = None,
    criterion: str | None = None,
    direction: str = "normal",
    model: Any = None,
    material: Material | str | None = None,
    symmetry: Sequence[str] = (),
) -> xr.Dataset:
    """Failure index at positions along every notch of a scene, by the coupled criterion or another one.

    Parameters
    ----------
    scene : Scene, optional
        Plate, notches, material, load; or else a ``model`` and a ``material``.
    method : str, optional
        One of `METHODS`: a strength criterion ("rankine", "mises"), a critical distance ("point", "line"), or the
        coupled criterion on crack cells ("slmm", "slmm+ac"), at corners, round V-notches and crack tips by matched
        asymptotics ("asymptotics"), with the crack as dislocations ("dislocations") or on a model with a slit for
        every position ("full-fea"); at crack tips also Griffith's ("griffith"). All but those on stresses and cells
        need the extra ``fea``. By default what the scene asks for.
    positions : int, optional
        Positions on each hole, equally spaced; by default what the scene asks for. From eight on, further ones are
        added where the index is largest, until its estimated error covers what lies between two of them.
    curves : bool
        Also give G_inc and sigma_I along the crack paths.
    settings : {"default", "published"} or Settings, optional
        How cells are chosen, fitted and relaxed; "published" is Paper A's way. By default what the scene asks for.
    database : path, optional
        Crack-cell database in place of the shipped one.
    average : bool, optional
        Compare the mean stress over the crack with the strength (thesis Eq. 3.21). By default what the scene asks for.
    tolerance : float, optional
        Relative error of the failure index that method "auto" aims at; of indices below a quarter of the largest it
        is that of the quarter. By default what the scene asks for.
    displacements : path, DisplacementField, (points, cells, u) or UncrackedField, optional
        Displacements of the uncracked part, mm, from any finite element model of the whole plate in the scene's
        coordinates and material, in place of the local model; see `slmm.initiation.given_field`. A model that has been
        solved, as by `slmm.initiation.body_fitted.solve_body_fitted`, is taken as it is. Only the methods
        `ON_DISPLACEMENTS` take them. Load factors are then factors on the load of that model; of the scene's load
        only the kind counts, which tells how the plate's edges are held.
    progress : callable
        Called with the finished fraction and what is being done.
    field : str, optional
        Which nodal data of a file of displacements they are, see `slmm.results.results.read_displacements`.
    criterion : str, optional
        One of `CRITERIA` ("rankine", "point", "line", "griffith") in place of the coupled one, on what a method finds
        that is no criterion itself: ("dislocations", criterion="point"). By default what the scene asks for.
    direction : {"normal", "best"}
        Cracks run normal to the surface, along the bisector of a corner and straight on from a tip, or turned into the
        direction that needs the least load (method "boundary").
    model : path, DisplacementField or (points, cells, u), optional
        A solved finite element model of a part without cracks, in place of a scene: outlines and load follow from it,
        see `slmm.initiation.solved_scene`. The method is then "boundary", unless another one is given.
    material : Material or str, optional
        Of the model, or its name.
    symmetry : sequence of str
        Sides of the model's box ("left", "right", "bottom", "top") at which it is half a part.

    Returns
    -------
    xarray.Dataset
        Dimension ``position`` (and ``crack`` with curves). ``failure_index`` is NaN where ``status`` is not "ok"
        and says why; it is 0 where the path carries no tension. ``failure_index_error`` is what the method estimates
        as its error, in the same unit; NaN where it has no estimate. ``failure_index_bound`` is what the index is at
        most: value and error, or, where there is no value, what the strength allows; infinite where nothing is known.

    Warns
    -----
    UnusualValueWarning
        For values that no solid or part has, as they come from a mistaken unit; ``attrs["warnings"]`` has them, too.

    Raises
    ------
    ValueError
        When the method or the settings are unknown, the scene has neither hole nor crack, the method takes no
        displacements, or they are not those of the scene's plate.
    OSError
        When there is no file of displacements.
    DatabaseError
        When the database cannot be used.

    Examples
    --------
    >>> from slmm.scene.gallery import circular_hole
    >>> result = failure_indices(circular_hole(analysis={"points": [[70, 50]], "voxels": 40000}), "slmm+ac")
    >>> round(float(result.failure_index[0]), 1)
    9.3
    """
    if (scene is None) == (model is None):
        raise ValueError(
            "failure_indices: takes a scene or a model, " + ("one" if scene is None else "not both")
        )
    if scene is None:
        if material is None:
            raise ValueError("failure_indices: a model needs its material")
        from slmm.initiation.solved_scene import solved_scene  # imports the readers of result files

        scene, field = solved_scene(model, material, field, symmetry=symmetry), None
    elif material is not None or symmetry:
        wrong = "symmetry" if material is None else "material"
        raise ValueError(f"failure_indices: {wrong} belongs to a model; a scene has its own")
    return failure_arrays(
        scene,
        method,
        positions,
        curves,
        settings,
        database,
        average,
        tolerance,
        displacements,
        progress,
        field,
        criterion,
        direction,
    ).dataset()


def failure_arrays(
    scene: Scene,
    method: str | None = None,
    positions: int | None = None,
    curves: bool = False,
    settings: str | Settings | None = None,
    database: Path | str | None = None,
    average: bool | None = None,
    tolerance: float | None = None,
    displacements: Any = None,
    progress: Progress = silent,
    field: str | None = None,
    criterion: str | None = None,
    direction: str = "normal",
) -> LabelledArrays:
    """What `failure_indices` makes a dataset of, for who only prints it and need not wait for xarray to load."""
    for text in unusual_values(scene):
        warnings.warn(text, UnusualValueWarning, stacklevel=3)  # at the caller of failure_indices
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
    source = SOURCES[METHODS[method].source]
    if direction not in DIRECTIONS:
        raise ValueError(f"direction = {direction!r}: must be one of {', '.join(DIRECTIONS)}")
    ask = source.answer
    if direction == "best":
        if not source.turns:
            raise ValueError(f"direction = 'best': the method {method} turns no cracks; boundary does")
        from slmm.initiation.turned import in_best_direction

        ask = in_best_direction(ask)
    if severed := scene.part.is_severed:
        answer = Answer.empty(task.n, "none")
        answer.status[:] = Status.SEVERED
    else:
        answer = ask(task)
    if refined and not severed:
        task, answer = with_peaks(task, answer, ask)
    if any(outline.accuracy is not None for outline in scene.outlines):
        from slmm.initiation.outline_error import add_outline_error  # imports asymptotics

        # behind the method, which need not be dearer for what the picture of the notch leaves open
        add_outline_error(task, answer)
    if scene.plate is None and scene.part_table is None:  # a `SolvedScene`
        from slmm.initiation.solved_error import add_solved_error  # imports the kernels

        add_solved_error(task, answer)
    bound = upper_bounds(task, answer)
    facts: dict[str, object] = {"method": method}
    if criterion is not None:
        facts["criterion"] = criterion
    if severed:
        facts["pieces"] = len(scene.part.pieces)
    if answer.cost:
        facts["cost"] = "; ".join(
            f"{name}: {count} positions in {seconds:.2g} s" for name, (count, seconds) in answer.cost.items()
        )
    if given is not None:
        facts["displacements"] = given.described.get("displacements", given.described["local_model"])
    progress(1.0, "done")
    return labelled(task, answer, bound, curves, facts)


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
