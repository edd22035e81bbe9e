"""Methods by their names: pairs of a source, which gives curves along the paths, and a criterion that judges them.

What a source needs is loaded when it is asked. One more is one file and a line here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from slmm.initiation.task import Answer, Task


#: shortest Irwin's length for which curves still serve, over that of the material they were computed for: trial cracks
#: are as much too long elsewhere (`slmm.initiation.paths.LONGER`); and of the stress alone, which is smoother; chosen
SERVES, STRESS_SERVES = 0.25, 1 / 16


@dataclass(frozen=True)
class Source:
    """Where energy and stress along the paths come from.

    Parameters
    ----------
    answer : callable
        Takes a `Task`, has its criterion judge what it finds, and gives an `Answer`.
    gives : set of str
        Of "stress", "energy", "equivalent stress"; a criterion that needs more cannot be asked.
    on_displacements : bool
        Whether it can take the uncracked part from the user's own displacements.
    turns : bool
        Whether paths may go in any direction.
    serves : float
        Down to which Irwin's length, over that of the material that they were computed for, its curves serve others; 0
        where they do not depend on it.
    """

    answer: Callable[[Task], Answer]
    gives: frozenset[str]
    on_displacements: bool = False
    turns: bool = False
    serves: float = SERVES


def _from(module: str, function: str, **options: Any) -> Callable[[Task], Answer]:
    """A source that stands in a module of this folder."""

    def answer(task: Task) -> Answer:
        found: Callable[..., Answer] = getattr(import_module(f"slmm.initiation.{module}"), function)
        return found(task, **options)

    return answer


CURVES = frozenset({"stress", "energy"})

SOURCES: dict[str, Source] = {
    "stress": Source(
        _from("by_stress", "by_stress"),
        frozenset({"stress", "equivalent stress"}),
        True,
        serves=STRESS_SERVES,
    ),
    "held cells": Source(_from("by_cells", "by_cells", auto_control=False), CURVES, True, serves=0.0),
    "cells": Source(_from("by_cells", "by_cells", auto_control=True), CURVES, True, serves=0.0),
    "asymptotics": Source(_from("by_asymptotics", "by_asymptotics"), CURVES),
    "crack tips": Source(_from("by_asymptotics", "by_griffith"), frozenset({"energy"}), serves=0.0),
    "trial cracks": Source(_from("by_boundary", "by_boundary"), CURVES, turns=True),
    "dislocations": Source(_from("by_dislocations", "by_dislocations"), CURVES),
    "full FEA": Source(_from("by_full_fea", "by_full_fea"), CURVES),
    "auto": Source(_from("by_choice", "by_choice"), CURVES, True),
}


class Method(NamedTuple):
    """A source and the criterion that judges it, by their names."""

    source: str
    criterion: str


METHODS: dict[str, Method] = {
    "rankine": Method("stress", "rankine"),
    "mises": Method("stress", "mises"),
    "point": Method("stress", "point"),
    "line": Method("stress", "line"),
    "slmm": Method("held cells", "coupled"),
    "slmm+ac": Method("cells", "coupled"),
    "asymptotics": Method("asymptotics", "coupled"),
    "griffith": Method("crack tips", "griffith"),
    "boundary": Method("trial cracks", "coupled"),
    "dislocations": Method("dislocations", "coupled"),
    "full-fea": Method("full FEA", "coupled"),
    "auto": Method("auto", "coupled"),
}

#: methods that can take the uncracked part from the user's own displacements
ON_DISPLACEMENTS = tuple(name for name, method in METHODS.items() if SOURCES[method.source].on_displacements)
