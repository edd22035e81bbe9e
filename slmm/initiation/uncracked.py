"""The part without the new crack: what crack cells and criteria want to know of it, whatever solved it.

A voxel model, a body-fitted one, the user's own results, and later others are such fields; one that has been solved can
be given in place of a scene's load.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Raster(NamedTuple):
    """The material's share of rectangular pieces of the part's box.

    Attributes
    ----------
    density : (ny, nx) array
        0 in a hole to 1; row 0 is the lowest.
    hx, hy : float
        Sides of a piece, mm.
    origin : (float, float)
        Its lower left corner, mm.
    """

    density: Array
    hx: float
    hy: float
    origin: tuple[float, float] = (0.0, 0.0)


@runtime_checkable
class UncrackedField(Protocol):
    """Displacements of the part without the new crack."""

    @property
    def raster(self) -> Raster:
        """Where the material is."""
        ...

    @property
    def coarser(self) -> UncrackedField | None:
        """The same from elements twice as large, for estimates of the error; None where there is none."""
        ...

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        ...

    def displacement(self, points: Array) -> Array:
        """Displacements (n, 2) at points (n, 2), mm."""
        ...

    def resolution(self, points: Array) -> Array:
        """Size (n,) of the voxels that would resolve the displacements at points (n, 2) as well, mm."""
        ...


@runtime_checkable
class WithStress(Protocol):
    """What a field has besides, if its stress is as good as its displacements, also at surfaces."""

    def stress(self, points: Array) -> tuple[Array, Array]:
        """Stress xx, yy, xy (n, 3) at points (n, 2), an estimate of its error (n,), MPa; NaN beside the material."""
        ...

    def element_size(self, points: Array) -> Array:
        """Size (n,) of the elements at points (n, 2), mm."""
        ...
