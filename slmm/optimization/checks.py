"""Refusals of settings out of range."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def check_whole(name: str, value: Any, least: int) -> None:
    """Refuse what is no whole number or less than this.

    Raises
    ------
    ValueError
    """
    if not (isinstance(value, int | np.integer) and value >= least):
        raise ValueError(f"{name} = {value!r}: must be a whole number of at least {least}")


def check_between(name: str, value: Any, least: float, most: float = math.inf) -> None:
    """Refuse what is no number or does not lie between these.

    Raises
    ------
    ValueError
    """
    if not (isinstance(value, int | float | np.number) and least <= value <= most):
        wanted = f"lie between {least} and {most}" if most < math.inf else f"be a number of at least {least}"
        raise ValueError(f"{name} = {value!r}: must {wanted}")
