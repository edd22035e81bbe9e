"""The journal of a simulation: steps as records that are read back to the bit, and what the run is.

A simulation that is resumed lets happen again what is in it. An engine that keeps panels and equations from one
solution to the next solves every step again, for the last digits of what comes next depend on them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from slmm import __version__
from slmm.fracture.events import Event, Kind
from slmm.fracture.history import Candidate, Excluded, History, Outcome, Step
from slmm.part.outline import Outline
from slmm.scene.scene import Scene


def run_of(scene: Scene, settings: Mapping[str, Any]) -> dict[str, Any]:
    """What a simulation is: another scene, setting or version gives another history."""
    return {
        "scene": f"{scene.title or 'untitled'} ({digest_of(scene)[:16]})",
        **settings,
        "version": __version__,
    }


def digest_of(scene: Scene) -> str:
    """SHA-256 of what breaks: geometry, material and loading; not of title, analysis and names of files.

    Examples
    --------
    >>> from slmm.scene.gallery import tensile_plate
    >>> plate = tensile_plate()
    >>> digest_of(plate) == digest_of(plate.with_(title="The same"))
    True
    >>> digest_of(plate) == digest_of(plate.with_(material={"sigma_c": 70.0}))
    False
    """
    digest = hashlib.sha256()

    def take(*values: Any) -> None:
        for value in values:
            array = np.ascontiguousarray(value, dtype="<f8")
            digest.update(str(array.shape).encode() + array.tobytes())

    def take_outline(outline: Outline) -> None:
        take(outline.breaks, outline.coefficients, outline.corners)

    part, material = scene.part, scene.material
    take(part.outer, part.thickness, *(crack.points for crack in part.cracks))
    for outline in part.outlines:
        take_outline(outline)
    take(material.E, material.nu, material.sigma_c, material.G_c)
    digest.update(material.state.encode())
    for condition in scene.loading:
        take(condition.start, condition.end, condition.traction, condition.pressure, condition.bearing)
        digest.update(str(condition.displacement).encode())
        if condition.span is not None:
            take_outline(condition.span.outline)
            take(condition.span.first, condition.span.last)
    return digest.hexdigest()


def record_of(step: Step) -> dict[str, Any]:
    """A step, of what JSON can hold."""
    event = asdict(step.event)
    event |= {name: event[name].tolist() for name in ("point", "direction")}
    return {
        **{name: getattr(step, name) for name in Step.__dataclass_fields__},
        "event": event,
        "candidates": [list(candidate) for candidate in step.candidates],
        "excluded": [list(excluded) for excluded in step.excluded],
    }


def step_of(record: Mapping[str, Any]) -> Step:
    """A step from its record.

    Raises
    ------
    ValueError
        When it is none.
    """
    try:
        event = dict(record["event"])
        event |= {name: np.array(event[name]) for name in ("point", "direction")}
        event |= {"kind": Kind(event["kind"]), "K": tuple(event["K"])}
        pairs = {name: tuple(record[name]) for name in ("end", "finer")}
        candidates = tuple(Candidate(u_c, Kind(kind), *where) for u_c, kind, *where in record["candidates"])
        excluded = tuple(Excluded(*values) for values in record["excluded"])
        lists = {"candidates": candidates, "excluded": excluded}
        return Step(**{**record, **pairs, **lists, "event": Event(**event)})
    except (KeyError, TypeError) as error:
        raise ValueError(f"a step of a simulation is damaged: {error}") from error


def end_of(history: History) -> dict[str, Any]:
    """How a simulation ended, of what JSON can hold."""
    return {name: getattr(history, name) for name in History.__dataclass_fields__ if name != "steps"}


def history_of(steps: list[Step], record: Mapping[str, Any]) -> History:
    """A history from its steps and the record of its end."""
    return History(steps, **{**record, "outcome": Outcome(record["outcome"])})
