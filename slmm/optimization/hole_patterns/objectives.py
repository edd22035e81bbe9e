"""What is to be large of a plate with holes: a figure of each direction, and what counts of all of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import xarray as xr


class Figure(NamedTuple):
    """A figure of a simulated fracture.

    Attributes
    ----------
    units, long_name : str
    of : callable
        The figure of a result of `slmm.fracture.simulate`.
    largest : float
        Displacement, mm, up to which it is simulated.
    """

    units: str
    long_name: str
    of: Callable[[xr.Dataset], float]
    largest: float


#: largest displacement, mm; published (Paper D)
LARGEST = 2.0
#: so small that nothing breaks, mm; chosen
NOTHING = 1e-9

FIGURES: dict[str, Figure] = {
    "U_T": Figure("mJ", "tensile toughness", lambda result: float(result.U_T), LARGEST),
    "peak force": Figure("N", "peak force", lambda result: float(result.F.max()), LARGEST),
    "stiffness": Figure("N/mm", "stiffness", lambda result: float(result.F[-1] / result.u[-1]), NOTHING),
}


def mean(figures: Sequence[float]) -> float:
    """Of all directions, in whatever order they come.

    Examples
    --------
    >>> mean([0.1, 0.2, 0.3]) == mean([0.3, 0.1, 0.2])
    True
    """
    return math.fsum(figures) / len(figures)


#: what counts of all directions
OVER: dict[str, Callable[[Sequence[float]], float]] = {"least": min, "mean": mean}
