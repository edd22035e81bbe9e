"""Failure indices along the notches of a scene: the library's main entry."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slmm.initiation.bounds import upper_bounds
from slmm.initiation.labelled_answer import labelled
from slmm.initiation.question import posed
from slmm.initiation.settings import Settings
from slmm.running.labelled import LabelledArrays
from slmm.running.progress import Progress, silent
from slmm.scene.plausible import UnusualValueWarning, unusual_values
from slmm.scene.scene import Scene
from slmm.scene.variants import Values

if TYPE_CHECKING:
    import xarray as xr

    from slmm.mechanics.material import Material


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
    direction: str | None = None,
    model: Any = None,
    material: Material | str | None = None,
    vary: Mapping[str, Values] | None = None,
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
    direction : {"normal", "best"}, optional
        Cracks run normal to the surface, along the bisector of a corner and straight on from a tip, or turned into the
        direction that needs the least load (method "boundary"). By default what the scene asks for.
    model : path, DisplacementField or (points, cells, u), optional
        A solved finite element model of a part without cracks, in place of a scene: outlines and load follow from it,
        see `slmm.initiation.solved_scene`. The method is then "boundary", unless another one is given.
    material : Material or str, optional
        Of the model, or its name.
    vary : mapping of str to values, optional
        Keys of the scene and what they take, as ``{"load.strain": [0.01, 0.02], "material.sigma_c": "50:80:4"}``, see
        `slmm.scene.variants.variants_of`: the most critical place of each combination, see `slmm.initiation.sweep`.
    symmetry : sequence of str
        Sides of the model's box ("left", "right", "bottom", "top") at which it is half a part.

    Returns
    -------
    xarray.Dataset
        Dimension ``position`` (and ``crack`` with curves). ``failure_index`` is NaN where ``status`` is not "ok"
        and says why; it is 0 where the path carries no tension. ``failure_index_error`` is what the method estimates
        as its error, in the same unit; NaN where it has no estimate. ``failure_index_bound`` is what the index is at
        most: value and error, or, where there is no value, what the strength allows; infinite where nothing is known.
        With ``vary`` its keys are the dimensions, without positions.

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
    if vary is not None:
        from slmm.initiation.sweep import sweep_arrays

        if curves or model is not None or displacements is not None:
            given = "curves" if curves else "a model" if model is not None else "displacements"
            raise ValueError(f"vary: goes with a scene alone, not with {given}")
        return sweep_arrays(
            scene,
            vary,
            method,
            positions,
            settings,
            database,
            average,
            tolerance,
            progress,
            criterion,
            direction,
        ).dataset()
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
    direction: str | None = None,
) -> LabelledArrays:
    """What `failure_indices` makes a dataset of, for who only prints it and need not wait for xarray to load."""
    for text in unusual_values(scene):
        warnings.warn(text, UnusualValueWarning, stacklevel=3)  # at the caller of failure_indices
    question = posed(
        scene,
        method,
        positions,
        settings,
        database,
        average,
        tolerance,
        displacements,
        progress,
        field,
        criterion,
        direction,
    )
    task, answer = question.answered()
    if any(outline.accuracy is not None for outline in scene.outlines):
        from slmm.initiation.outline_error import add_outline_error  # imports asymptotics

        # behind the method, which need not be dearer for what the picture of the notch leaves open
        add_outline_error(task, answer)
    if scene.plate is None and scene.part_table is None:  # a `SolvedScene`
        from slmm.initiation.solved_error import add_solved_error  # imports the kernels

        add_solved_error(task, answer)
    bound = upper_bounds(task, answer)
    facts = dict(question.facts)
    if scene.part.is_severed:
        facts["pieces"] = len(scene.part.pieces)
    if answer.cost:
        facts["cost"] = "; ".join(
            f"{name}: {count} positions in {seconds:.2g} s" for name, (count, seconds) in answer.cost.items()
        )
    if task.displacements is not None:
        described = task.displacements.described
        facts["displacements"] = described.get("displacements", described["local_model"])
    progress(1.0, "done")
    return labelled(task, answer, bound, curves, facts)
