"""The algorithms that stay on one grid, by name, and their settings.

A new one is a file beside this one, as `slmm.optimization.algorithms.free_shape` is, and a line in the table below:
searches, several grids and journals take it from there, and its settings from its keywords. How it asks for values
stands in `slmm.optimization.ask`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from slmm.optimization.algorithms.annealing import sa
from slmm.optimization.algorithms.breadth_first import bfsl, tbfsl
from slmm.optimization.algorithms.free_shape import fs
from slmm.optimization.algorithms.genetic import ga
from slmm.optimization.algorithms.restarts import ils
from slmm.optimization.algorithms.sampling import bf, rs
from slmm.optimization.algorithms.tabu import tabu
from slmm.optimization.ask import Asking

#: called with a problem, a start (or None), a random generator, and its settings by name
Algorithm = Callable[..., Asking]

ON_ONE_GRID: dict[str, Algorithm] = {
    "bf": bf,
    "bfsl": bfsl,
    "fs": fs,
    "ga": ga,
    "ils": ils,
    "rs": rs,
    "sa": sa,
    "tabu": tabu,
    "tbfsl": tbfsl,
}


def chosen(algorithms: Mapping[str, Algorithm], name: str) -> Algorithm:
    """The algorithm of this name.

    Raises
    ------
    ValueError
        When there is none.
    """
    if name not in algorithms:
        raise ValueError(f"algorithm = {name!r}: must be one of {', '.join(sorted(algorithms))}")
    return algorithms[name]


def completed(algorithm: Algorithm, settings: Mapping[str, Any]) -> dict[str, Any]:
    """All settings of an algorithm: the given ones, and its own for the others.

    Raises
    ------
    ValueError
        When the algorithm has no setting of a name, or needs one that is not given.

    Examples
    --------
    >>> completed(tbfsl, {"radius": 3})
    {'depth': 4, 'radius': 3}
    """
    parameters = inspect.signature(algorithm).parameters.values()
    its = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}
    for name in settings:
        if name not in its:
            known = f"must be one of {', '.join(its)}" if its else "it has none"
            raise ValueError(f"{name}: is no setting; {known}")
    result = its | dict(settings)
    for name, value in result.items():
        if value is inspect.Parameter.empty:
            raise ValueError(f"{name}: must be given")
    # plain numbers, which JSON can hold
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in result.items()}
