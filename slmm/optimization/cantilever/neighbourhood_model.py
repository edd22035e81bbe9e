"""All neighbours of a design on a fine grid, each by a few unknowns.

A neighbour differs from the centre in a few cells. The stiffness of a cell is L' L with twelve strains L of its 16
unknowns, so that the change is known from the stresses of these cells alone (Woodbury). With the inverse H of the
centre's stiffness, its displacements u under the weight and t under a unit force at the corner, and df the weight that
is added less that which is removed,

    (1 + L_a H L_a') s_a - P v - L_a H L_r' s_r = L_a (u + H df)      cells that are added,
                      P' s_a                    = f_p                 nodes that come with them,
    L_r H L_a' s_a + (1 - L_r H L_r') s_r       = L_r (u + H df)      cells that are removed,

    sag' = sag + t df - L_a t s_a + L_r t s_r,

where P are the strains of added cells by nodes that have had no material, and v the displacements of these. Nodes that
lose all their material leave stresses of removed cells open which do not matter, and are set to zero.

Strains, not displacements, because most of a displacement is that of everything to its left, which strains nothing.
H is made once for a design, and only near its diagonal (near_inverse).

An error dH changes the sag by s' dH s_t, where s are the stresses of these cells under the weight and s_t those under
the unit force. So round-off is multiplied by |s| |s_t|: by much where a removed cell has held some of the rest nearly
alone, since the strains it would have now are large.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from slmm.optimization.cantilever.changed_cells import (
    sag_changes,
    strains,
    strains_of_cells,
    strains_of_pairs,
    touching,
)
from slmm.optimization.cantilever.near_inverse import NearInverse, places

if TYPE_CHECKING:
    from slmm.optimization.cantilever.beam import Cantilever

#: of neighbours whose cells span more columns and rows than this, added up and less two, nothing is known
WIDEST = 8
#: error of products of strains, and of displacements over the largest one, in units of round-off times the largest
#: flexibility in strains of a cell; and the same for each hundred cells of the grid. Five times the largest of trials
ROUND_OFF = 100.0
#: so many times this error must be left of the flexibility in strains of a removed cell
LEAST = 30.0


class NeighbourhoodModel:
    """Approximate values of the designs around one.

    Parameters
    ----------
    beam : Cantilever
    centre : ndarray of bool (rows, columns)
        A valid design.

    Attributes
    ----------
    sag : float
        Of the centre, mm.

    Examples
    --------
    >>> from slmm.optimization.cantilever.beam import Cantilever
    >>> beam = Cantilever(8, 5)
    >>> model = NeighbourhoodModel(beam, np.ones((5, 8), dtype=bool))
    >>> flipped = np.ones((5, 8), dtype=bool)
    >>> flipped[2, 3] = flipped[2, 4] = False
    >>> (value,), (error,) = model.evaluate(np.array([[19, 20]]))
    >>> bool(abs(value - beam.endpoint_displacement([flipped])[0]) < error < 1e-9)
    True
    """

    def __init__(self, beam: Cantilever, centre: np.ndarray) -> None:
        """Eliminate the centre's columns."""
        self.beam, self.centre = beam, np.ascontiguousarray(centre, dtype=bool)
        self._strains = np.vstack([strains(beam.cell[0]), beam.cell[1]])
        self._inverse = NearInverse(beam, self.centre)
        self.sag = float(self._inverse.displacements[-1, self._inverse.corner, 0])
        #: error of the inverse in strains of a cell
        self._error = float(
            ROUND_OFF
            * (1 + self.centre.size / 100)
            * np.finfo(float).eps
            * self._inverse.near[0].diagonal(axis1=1, axis2=2).max()
            * beam.cell[0].max()
        )
        self._largest = float(np.abs(self._inverse.displacements[:, :, 0]).max())
        self._own = strains_of_cells(self._strains, self._inverse.displacements, *places(beam.rows))
        self._touching = touching(self.centre)
        #: products of strains of pairs of cells that are not farther apart than the reach
        self._reach, self._pairs = -1, np.empty(0)

    def evaluate(self, flips: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sag (n,) of the valid designs in which these cells (n, k) of the centre are flipped, and its error (n,), mm.

        Cells are counted row after row, ``row * columns + column``. NaN where cells are far apart, and where removed
        ones have held some of the rest so nearly alone that nothing is known.
        """
        flips = np.atleast_2d(np.asarray(flips, dtype=np.int64))
        reach = _reach(flips, self.beam.columns)
        near = reach <= WIDEST
        value, error = np.full(len(flips), np.nan), np.full(len(flips), np.nan)
        if near.any():
            self._extend(int(reach[near].max()))
            change, gain = sag_changes(
                flips[near],
                self.centre,
                self._touching,
                self._pairs,
                self._own,
                self._strains,
                LEAST * self._error,
            )
            value[near] = self.sag + change
            error[near] = self._error * (self._largest + gain)
        return value, error

    def _extend(self, reach: int) -> None:
        """Know all pairs of cells in this reach."""
        if reach > self._reach:
            self._inverse.extend(reach + 1)
            self._pairs = strains_of_pairs(self._strains, self._inverse.near, reach, *places(self.beam.rows))
            self._reach = reach


@lru_cache(maxsize=1)
def model_around(beam: Cantilever, design: bytes) -> NeighbourhoodModel:
    """The model around a design (its cells as bytes), kept while the same one is asked for."""
    return NeighbourhoodModel(beam, np.frombuffer(design, dtype=bool).reshape(beam.shape))


def _reach(flips: np.ndarray, columns: int) -> np.ndarray:
    """How many columns and rows the cells (n, k) are apart, added up (n,)."""
    return sum(np.ptp(place, axis=1) for place in np.divmod(flips, columns))
