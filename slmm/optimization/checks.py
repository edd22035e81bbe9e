"""Refusals of settings out of range."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def check_whole(name: str, value: Any, least: int, most: float = math.inf) -> None:
    """Refuse what is no whole number or does not lie between these.

    Raises
    ------
    ValueError
    """
    if isinstance(value, bool) or not (isinstance(value, int | np.integer) and least <= value <= most):
        wanted = f"from {least} to {most}" if most < math.inf else f"of at least {least}"
        raise ValueError(f"{name} = {value!r}: must be a whole number {wanted}")


def check_between(name: str, value: Any, least: float, most: float = math.inf) -> None:
    """Refuse what is no number or does not lie between these.

    Raises
    ------
    ValueError
    """
    if not (isinstance(value, int | float | np.number) and least <= value <= most):
        wanted = f"lie between {least} and {most}" if most < math.inf else f"be a number of at least {least}"
        raise ValueError(f"{name} = {value!r}: must {wanted}")
