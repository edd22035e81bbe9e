"""The methods by their names; what one needs is loaded when it is asked."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from slmm.initiation.task import Answer, Task


def _from(module: str, function: str, **options: Any) -> Callable[[Task], Answer]:
    """A method that stands in a module of this folder."""

    def method(task: Task) -> Answer:
        found: Callable[..., Answer] = getattr(import_module(f"slmm.initiation.{module}"), function)
        return found(task, **options)

    return method


METHODS: dict[str, Callable[[Task], Answer]] = {
    "rankine": _from("by_stress", "by_stress", method="rankine"),
    "mises": _from("by_stress", "by_stress", method="mises"),
    "point": _from("by_stress", "by_stress", method="point"),
    "line": _from("by_stress", "by_stress", method="line"),
    "slmm": _from("by_cells", "by_cells", auto_control=False),
    "slmm+ac": _from("by_cells", "by_cells", auto_control=True),
    "asymptotics": _from("by_asymptotics", "by_asymptotics"),
    "griffith": _from("by_asymptotics", "by_griffith"),
    "dislocations": _from("by_dislocations", "by_dislocations"),
    "full-fea": _from("by_full_fea", "by_full_fea"),
    "auto": _from("by_choice", "by_choice"),
}

#: methods that can take the uncracked part from the user's own displacements
ON_DISPLACEMENTS = ("rankine", "mises", "point", "line", "slmm", "slmm+ac", "auto")
