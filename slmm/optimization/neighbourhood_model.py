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
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from slmm.optimization.ask import Flipped
from slmm.optimization.cantilever import Cantilever
from slmm.optimization.changed_cells import (
    sag_changes,
    strains,
    strains_of_cells,
    strains_of_pairs,
    touching,
)
from slmm.optimization.near_inverse import NearInverse, places

#: neighbours whose cells span more columns and rows than this, added up and less two, are solved directly
WIDEST = 8
#: share of the stiffness against a strain of a removed cell that must be left without it, over the largest flexibility
#: in those of a cell: with less, digits are lost
LEAST = 3e-8
#: error of displacements over the largest one, in units of round-off times the largest flexibility in those of a cell;
#: three times the largest seen in trials
ROUND_OFF = 2000.0


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
    error : float
        An estimate of round-off in the sag of neighbours that are no more flexible than the centre, mm.

    Examples
    --------
    >>> beam = Cantilever(8, 5)
    >>> model = NeighbourhoodModel(beam, np.ones((5, 8), dtype=bool))
    >>> flipped = np.ones((5, 8), dtype=bool)
    >>> flipped[2, 3] = flipped[2, 4] = False
    >>> float(abs(model.evaluate(np.array([[19, 20]]))[0] - beam.endpoint_displacement([flipped])[0])) < 1e-12
    True
    """

    def __init__(self, beam: Cantilever, centre: np.ndarray) -> None:
        """Eliminate the centre's columns."""
        self.beam, self.centre = beam, np.ascontiguousarray(centre, dtype=bool)
        self._strains = np.vstack([strains(beam.cell[0]), beam.cell[1]])
        self._inverse = NearInverse(beam, self.centre)
        self.sag = float(self._inverse.displacements[-1, self._inverse.corner, 0])
        #: the largest one in those of a cell
        self._flexibility = self._inverse.near[0].diagonal(axis1=1, axis2=2).max() * beam.cell[0].max()
        largest = np.abs(self._inverse.displacements[:, :, 0]).max()
        self.error = float(ROUND_OFF * np.finfo(float).eps * self._flexibility * largest)
        self._own = strains_of_cells(self._strains, self._inverse.displacements, *places(beam.rows))
        self._touching = touching(self.centre)
        #: products of strains of pairs of cells that are not farther apart than the reach
        self._reach, self._pairs = -1, np.empty(0)

    def evaluate(self, flips: np.ndarray) -> np.ndarray:
        """Sag (n,) of the valid designs in which these cells (n, k) of the centre are flipped, mm.

        Cells are counted row after row, ``row * columns + column``. Cells far apart are solved directly, and those
        which have held some of the rest nearly alone.
        """
        flips = np.atleast_2d(np.asarray(flips, dtype=np.int64))
        reach = _reach(flips, self.beam.columns)
        near = reach <= WIDEST
        result = np.full(len(flips), np.nan)
        if near.any():
            self._extend(int(reach[near].max()))
            result[near] = self.sag + sag_changes(
                flips[near],
                self.centre,
                self._touching,
                self._pairs,
                self._own,
                self._strains,
                LEAST * self._flexibility,
            )
        if (left := np.isnan(result)).any():
            result[left] = self.beam.endpoint_displacement(Flipped(self.centre, flips[left])[:])
        return result

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
