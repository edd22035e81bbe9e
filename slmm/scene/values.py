"""The values that tables of a scene file hold: numbers within bounds, points, files; and what all tables have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo

from slmm.mechanics.material import LEAST, MOST
from slmm.running.encoding import without_control
from slmm.running.input_file import input_problem

#: characters; chosen
LONGEST_TITLE = 1000


def _at_least(least: float) -> AfterValidator:
    """Of a positive number, so that what is negative or zero is told that first."""

    def check(value: float) -> float:
        if value < least:
            raise ValueError(f"must be at least {least:g}")
        return value

    return AfterValidator(check)


# Strict: a number in quotes, or true for 1, is a mistake and not a number. Coordinates have a bound so that
# squares and products of them stay finite, and lengths one below which these would vanish.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Coordinate = Annotated[Number, Field(ge=-1e9, le=1e9)]
Length = Annotated[Number, Field(gt=0, le=1e9), _at_least(1e-9)]
Radius = Annotated[Number, Field(ge=0, le=1e9)]
Angle = Annotated[Number, Field(ge=-1e6, le=1e6)]
Constant = Annotated[Number, Field(gt=0, le=MOST), _at_least(LEAST)]
Count = Annotated[int, Field(strict=True)]
PlanePoint = tuple[Coordinate, Coordinate]


def as_lists(value: object) -> object:
    """What a table takes, of an array too."""
    return value.tolist() if isinstance(value, np.ndarray) else value


PlanePoints = Annotated[tuple[PlanePoint, ...], BeforeValidator(as_lists)]


def _printable(title: str) -> str:
    if without_control(title) != title:
        raise ValueError("must not have control characters")
    if len(title) > LONGEST_TITLE:
        raise ValueError(f"has {len(title)} characters; must have at most {LONGEST_TITLE}")
    return title


Title = Annotated[str, Field(strict=True), AfterValidator(_printable)]


def _in_folder(file: str, info: ValidationInfo) -> str:
    folder = Path((info.context or {}).get("folder", "."))
    if problem := input_problem(folder / file):
        raise ValueError(f"{problem}, in {folder.resolve()}")
    return str((folder / file).resolve())


File = Annotated[str, Field(strict=True, min_length=1), AfterValidator(_in_folder)]


class Table(BaseModel):
    """A table of the scene file: immutable, and no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def exactly_one(table: Table, keys: tuple[str, ...]) -> None:
    """Refuse a table unless just one of some keys is given."""
    given = [key for key in keys if getattr(table, key) is not None]
    if len(given) != 1:
        found = f"has {' and '.join(given)}" if given else "has none"
        raise ValueError(f"needs exactly one of {', '.join(keys)}; it {found}")
