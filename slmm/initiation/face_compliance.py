"""Compliance of the faces of a crack that starts from a circular hole, or from a straight edge, of an unbounded body.

The database holds it for several curvatures and crack lengths. Over the length squared it depends on the crack's length
over the hole's radius alone, so that all of them lie on one curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.polynomial import chebyshev, legendre

from slmm.cell_file import read_cells

#: longest crack that the database holds, over the radius of the hole
LONGEST = 2.0
#: crack lengths in the image space from which on the stored mesh resolves the tip best, mm
RESOLVED = 0.1
#: degree of the fitted curve; more of it changes nothing, the stored values scatter by 1e-4
DEGREE = 7
#: ratio a/R at which the scale of the curve turns from linear to logarithmic
TURN = 0.2


@dataclass(frozen=True)
class FaceCompliance:
    """Work of Legendre tractions P_k(2 eta/a - 1) on the opening or sliding that others cause, for E = 1 MPa.

    Attributes
    ----------
    coefficients : ndarray (DEGREE + 1, 2, k, k)
        Chebyshev coefficients of C/a^2, 1/MPa, for opening and sliding, over the scaled ratio a/R.
    """

    coefficients: np.ndarray

    @classmethod
    def from_database(cls, cells: xr.Dataset) -> FaceCompliance:
        """Fit the curve to all holes and lengths of a crack-cell database."""
        curvature, lengths = cells["curvature"].values, cells["crack_length"].values[1:]
        holes, long = np.flatnonzero(curvature <= 0), lengths >= RESOLVED
        ratio = (-2 * curvature[holes, None] * lengths[long]).ravel()
        stored = cells["compliance"].values[holes][:, :, long].swapaxes(1, 2)
        basis = chebyshev.chebvander(_scaled(ratio), DEGREE)
        fitted = np.linalg.lstsq(basis, stored.reshape(len(ratio), -1), rcond=None)[0]
        return cls(fitted.reshape(DEGREE + 1, *stored.shape[2:]))

    @property
    def orders(self) -> int:
        """Number of Legendre polynomials."""
        return self.coefficients.shape[-1]

    def __call__(self, a: np.ndarray, radius: float) -> np.ndarray:
        """Compliance (n, 2, k, k) for crack lengths (n,) at a hole, or an edge (radius = inf), mm^2/MPa."""
        basis = chebyshev.chebvander(_scaled(a / radius), DEGREE)
        return np.tensordot(basis * a[:, None] ** 2, self.coefficients, axes=1)


def _scaled(ratio: np.ndarray) -> np.ndarray:
    """Ratios a/R between 0 and LONGEST, brought to -1 to 1."""
    return 2 * np.log1p(ratio / TURN) / np.log1p(LONGEST / TURN) - 1


@lru_cache(maxsize=4)
def load_face_compliance(database: Path, modified: float) -> FaceCompliance:
    """Compliance from a database file; ``modified`` is its time stamp."""
    return FaceCompliance.from_database(read_cells(database))


def legendre_coefficients(orders: int, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """From values at Gauss points x (q,) in [-1, 1] to coefficients of the first Legendre polynomials, (orders, q)."""
    norm = (2 * np.arange(orders) + 1) / 2
    return norm[:, None] * (legendre.legvander(x, orders - 1) * weights[:, None]).T
