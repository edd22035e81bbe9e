"""The one error of a scene: every problem with its key, its value and what would be right."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

MAX_LISTED = 20  # chosen
MAX_KEY = 120  # characters; chosen

_TYPES = {
    "missing": "is missing",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be a text in quotes",
    "tuple_type": "must be a list",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "dict_type": "must be a table",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "literal_error": "must be one of {expected}",
    "union_tag_invalid": "must be one of {expected_tags}",
    "union_tag_not_found": "is missing",
    "string_too_short": "must not be empty",
}

#: units in which the keys are read; what is not here is a number alone
_UNITS = {
    "E": "MPa",
    "sigma_c": "MPa",
    "K_Ic": "MPa sqrt(m)",
    "G_c": "N/mm",
    **dict.fromkeys(("angle", "direction", "opening"), "degrees"),
    **dict.fromkeys(("width", "height", "thickness", "center", "radius", "semi_axes", "size"), "mm"),
    **dict.fromkeys(("corner_radius", "points", "tip", "depth", "pixel_size", "from", "to", "at"), "mm"),
}
#: what pydantic calls a number out of its range
_LIMITS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


class SceneError(ValueError):
    """A scene that cannot be computed.

    Parameters
    ----------
    problems : sequence of str
        What is wrong, each as ``key = value: what would be right``.
    source : str
        The file the scene comes from; empty when there is none.

    Examples
    --------
    >>> print(SceneError(["holes[0].radius = -3: must be greater than 0"], "plate.toml"))
    plate.toml: holes[0].radius = -3: must be greater than 0
    """

    def __init__(self, problems: Sequence[str], source: str = "") -> None:
        """List the problems."""
        self.problems = tuple(problems)
        self.source = source
        listed = list(self.problems[:MAX_LISTED])
        if len(self.problems) > MAX_LISTED:
            listed.append(f"and {len(self.problems) - MAX_LISTED} more")
        if len(listed) == 1:
            message = f"{source}: {listed[0]}" if source else listed[0]
        else:
            message = "\n  ".join([f"{source or 'scene'}: {len(self.problems)} problems", *listed])
        super().__init__(message)


def problems_of(error: ValidationError, known_keys: Mapping[tuple[str, ...], Sequence[str]]) -> list[str]:
    """Sentences for an engineer from what pydantic reports.

    Parameters
    ----------
    error : pydantic.ValidationError
        The report.
    known_keys : mapping
        Keys that are known in each table: () is the scene itself, ("plate",) a table,
        ("holes", "circle") one kind in a list of tables.
    """
    problems: list[str] = []
    for item in error.errors(include_url=False):
        cause = item.get("ctx", {}).get("error")
        problems += cause.problems if isinstance(cause, SceneError) else [_sentence(item, known_keys)]
    return problems


def _sentence(item: ErrorDetails, known_keys: Mapping[tuple[str, ...], Sequence[str]]) -> str:
    loc = list(item["loc"])
    kind = item["type"]
    context: dict[str, Any] = item.get("ctx", {})
    tables = tuple(str(part) for part in loc if isinstance(part, str))
    if loc and loc[0] == "holes" and len(loc) > 2:
        del loc[2]  # pydantic puts the shape there
    if loc[:2] == ["part", "outline"] and len(loc) > 2:
        del loc[2]
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        loc.append("shape")
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc).lstrip(".")
    if len(key) > MAX_KEY:
        key = f"{key[: MAX_KEY // 2]}...{key[-MAX_KEY // 2 :]}"

    if kind == "extra_forbidden":
        known = known_keys.get(tables[:-1], ())
        return f"{key} = {_shown(item['input'])}: is not a known key; known here: {', '.join(known)}"
    if kind in ("missing", "union_tag_not_found"):
        wanted = f"; {_one_of_shapes(known_keys)}" if kind == "union_tag_not_found" else ""
        in_list = " (needs more numbers)" if loc and isinstance(loc[-1], int) else ""
        return f"{key}: is missing{in_list}{wanted}"
    value = item["input"]
    if kind == "union_tag_invalid":
        value = value.get("shape") if isinstance(value, Mapping) else value
    if kind in ("too_short", "too_long"):
        limit = context.get("min_length", context.get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return f"{key}: has {context['actual_length']} entries; must have {bound} {limit}"
    if kind == "value_error":
        says = str(context["error"])
        if isinstance(value, int | float):
            says += _unit(tables)
        shown = "" if isinstance(value, Mapping | Sequence) and not isinstance(value, str) else _shown(value)
        return f"{key} = {shown}: {says}" if shown else f"{key}: {says}".removeprefix(": ")
    says = _TYPES[kind].format(**context) if kind in _TYPES else item["msg"]
    if kind in _LIMITS:
        says += _unit(tables)
    return f"{key} = {_shown(value)}: {says}"


def _unit(tables: tuple[str, ...]) -> str:
    """The unit of a key, to follow a number; empty where it has none."""
    unit = _UNITS.get(tables[-1], "") if tables else ""
    return f" {unit}" if unit else ""


def _one_of_shapes(known_keys: Mapping[tuple[str, ...], Sequence[str]]) -> str:
    *others, last = [key[1] for key in known_keys if len(key) == 2 and key[0] == "holes"]
    return f"{', '.join(others)} or {last}"


class _Short(reprlib.Repr):
    """Values as they are in Python, without what could not be shown anyway: endless numbers, bottomless tables."""

    maxlevel = 6
    maxlist = maxtuple = maxdict = maxset = 60
    maxstring = maxother = 60

    def repr_int(self, value: int, level: int) -> str:
        """A whole number; Python itself refuses to write those of more than 4300 digits."""
        if value.bit_length() > 200:
            return f"a whole number of some {int(value.bit_length() * 0.30103)} digits"
        return repr(value)


_SHORT = _Short()


def _shown(value: object) -> str:
    text = f'"{value}"' if isinstance(value, str) else _SHORT.repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
