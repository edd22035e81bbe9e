"""The meta-model: crack cells between the stored ones (Paper A, section 2.3.4).

The database is interpolated to one Poisson's ratio first, then to the curvature of each cell. Between Poisson's ratios
not the stiffnesses but the flexibilities are interpolated: a part is loaded by stresses, and the displacements that a
given stress causes, the stress and the energy that it brings to the crack path, hardly depend on Poisson's ratio,
whereas stiffnesses grow without bound towards both ends. Psi stays positive semi-definite: what interpolation leaves
below zero is cut off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial.chebyshev import chebvander

from slmm.initiation.placement import CELL_LENGTH
from slmm.mechanics.cubics import Cubics, through
from slmm.running.cell_file import read_cells, shipped_database
from slmm.running.labelled import LabelledArrays
from slmm.running.model_file import DatabaseError

if TYPE_CHECKING:
    import xarray as xr

#: eigenvalues of K below this fraction of the largest belong to rigid motions and repeated modes; round-off
RIGID = 1e-7


class PoissonNotHeldError(DatabaseError):
    """The database is sound, but Poisson's ratio lies beyond those that it holds."""


@dataclass(frozen=True)
class MetaModel:
    """Crack cells for one effective Poisson's ratio, for E = 1 MPa and a thickness of 1 mm.

    Attributes
    ----------
    curvature : ndarray (n_c,)
        c' of the stored cells, 1/mm.
    lengths : ndarray (n_a,)
        Crack lengths a' > 0, mm.
    eta : ndarray (n_eta,)
        Points of the path stress, mm.
    powers : ndarray (m, 3)
        Direction (0: xi, 1: eta) and powers p, q of each mode.
    K0 : ndarray (n_c, m, m)
        Stiffness without a crack, N/mm.
    Psi : ndarray (n_c, n_a, m, m)
        Loss of stiffness by a crack, N/mm (Eq. 9).
    stress : ndarray (n_c, m, 3, n_eta)
        Path stress of each mode: xi-xi, eta-eta, xi-eta, MPa.
    compliance : ndarray (n_c, 2, n_a, k, k)
        Compliance of the crack faces in an unbounded body over a'^2, for opening and sliding, 1/MPa.
    nu : float
        Effective Poisson's ratio.
    checksum : str
        Of the database, for provenance.
    """

    curvature: np.ndarray
    lengths: np.ndarray
    eta: np.ndarray
    powers: np.ndarray
    K0: np.ndarray
    Psi: np.ndarray
    stress: np.ndarray
    compliance: np.ndarray
    nu: float
    checksum: str = ""

    def select(self, keep: np.ndarray) -> MetaModel:
        """The meta-model with only some of the modes (indices or booleans), those along xi first."""
        keep = np.flatnonzero(keep) if keep.dtype == bool else keep
        keep = keep[np.argsort(self.powers[keep, 0], kind="stable")]
        return MetaModel(
            self.curvature,
            self.lengths,
            self.eta,
            self.powers[keep],
            self.K0[:, keep][:, :, keep],
            self.Psi[:, :, keep][..., keep],
            self.stress[:, keep],
            self.compliance,
            self.nu,
            self.checksum,
        )

    @cached_property
    def _stress_spline(self) -> Cubics:
        return through(self.curvature, self.stress)

    @cached_property
    def _K0_spline(self) -> Cubics:
        return through(self.curvature, self.K0)

    @cached_property
    def _compliance_splines(self) -> list[Cubics]:
        # at c' = 0 the unbounded body changes from a hole to a bulge, with a kink
        concave, convex = self.curvature <= 0, self.curvature >= 0
        if min(concave.sum(), convex.sum()) < 2:
            return [through(self.curvature, self.compliance)] * 2
        return [through(self.curvature[side], self.compliance[side]) for side in (concave, convex)]

    def _compliance(self, curvature: np.ndarray) -> np.ndarray:
        concave, convex = (spline(curvature) for spline in self._compliance_splines)
        return np.where((curvature <= 0)[:, None, None, None, None], concave, convex)

    @cached_property
    def _Psi_spline(self) -> Cubics:
        return through(self.curvature, self.Psi)

    @property
    def symmetric(self) -> np.ndarray:
        """Which modes are their own mirror image about the crack line."""
        return _symmetric(self.powers)

    def path_stress(self, curvature: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """Stress xi-xi, eta-eta, xi-eta at ``eta`` (n, 3, n_eta) for amplitudes (n, m), MPa (Eq. 11)."""
        return np.einsum("nm,nmce->nce", modes, self._stress_spline(curvature))

    def stiffness(self, curvature: np.ndarray) -> np.ndarray:
        """Stiffness without a crack (n, m, m), N/mm."""
        return self._K0_spline(curvature)

    def stiffness_loss(self, curvature: np.ndarray, lengths: slice = slice(None)) -> np.ndarray:
        """Psi (n, n_a, m, m) for some of the crack lengths, positive semi-definite, N/mm."""
        Psi = self._Psi_spline(curvature)[:, lengths]
        result = np.zeros_like(Psi)
        # symmetric and antisymmetric modes do not couple; two small problems are cheaper than one
        for block in (self.symmetric, ~self.symmetric):
            which = np.flatnonzero(block)
            values, vectors = np.linalg.eigh(Psi[:, :, which[:, None], which])
            scaled = vectors * np.sqrt(np.maximum(values, 0))[..., None, :]
            result[:, :, which[:, None], which] = scaled @ scaled.swapaxes(-1, -2)
        return result

    @cached_property
    def _projection(self) -> np.ndarray:
        """From values at ``eta`` to Legendre coefficients over each crack length, (n_a, k, n_eta)."""
        k = self.compliance.shape[-1]
        x, w = legendre.leggauss(k + len(self.eta))
        P = legendre.legvander(x, k - 1)
        norm = (2 * np.arange(k) + 1) / 2
        result = []
        for a in self.lengths:
            values = polynomial_matrix(self.eta, a * (x + 1) / 2)
            result.append(norm[:, None] * ((P * w[:, None]).T @ values))
        return np.array(result)

    def unbounded_release(self, curvature: np.ndarray, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the path stress releases in an unbounded body.

        Parameters
        ----------
        curvature : ndarray (n,)
            c', 1/mm.
        stress : ndarray (n, 3, n_eta)
            Path stress, MPa.

        Returns
        -------
        G_inc : ndarray (n, n_a)
            Incremental energy release rate, N/mm.
        opening : ndarray (n, n_a, k)
            Work of the opening on Legendre tractions over the length, see `contact.tip_opening`.
        """
        C = self._compliance(curvature)
        normal, shear = stress[:, 0], stress[:, 2]
        p = np.einsum("ake,ne->nak", self._projection, normal)
        q = np.einsum("ake,ne->nak", self._projection, shear)
        opened = np.einsum("nakl,nal->nak", C[:, 0], p)
        slid = np.einsum("nakl,nal->nak", C[:, 1], q)
        energy = np.einsum("nak,nak->na", opened, p) + np.einsum("nak,nak->na", slid, q)
        return 0.5 * energy * self.lengths, opened


def polynomial_matrix(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """From values at ``nodes`` to those of the polynomial through them at ``at``, (len(at), len(nodes)).

    Examples
    --------
    >>> polynomial_matrix(np.array([0.0, 1.0, 2.0]), np.array([0.5])) @ np.array([0.0, 1.0, 4.0])
    array([0.25])
    """
    middle, half = 0.5 * (nodes[0] + nodes[-1]), 0.5 * (nodes[-1] - nodes[0])
    degree = len(nodes) - 1
    basis = chebvander((nodes - middle) / half, degree)
    return np.linalg.solve(basis.T, chebvander((np.atleast_1d(at) - middle) / half, degree).T).T


@lru_cache(maxsize=4)
def _cells(path: Path, _modified: float) -> LabelledArrays:
    return read_cells(path)


@lru_cache(maxsize=8)
def _meta_model(path: Path, modified: float, nu: float) -> MetaModel:
    return interpolate_poisson(_cells(path, modified), nu, path)


def load_meta_model(nu: float, database: Path | str | None = None) -> MetaModel:
    """Meta-model for an effective Poisson's ratio, from the shipped or another database.

    Parameters
    ----------
    nu : float
        nu in plane stress, nu/(1 - nu) in plane strain.
    database : path, optional
        A file that slmm-precompute made.

    Raises
    ------
    DatabaseError
        When the file cannot be used.
    PoissonNotHeldError
        When it does not hold this Poisson's ratio.
    """
    path = Path(database) if database is not None else shipped_database()
    if not path.is_file():
        read_cells(path)  # says what is wrong
    return _meta_model(path.resolve(), path.stat().st_mtime, round(nu, 12))


def interpolate_poisson(
    cells: LabelledArrays | xr.Dataset, nu: float, path: Path | str = "database"
) -> MetaModel:
    """Interpolate a database to one effective Poisson's ratio."""
    depth = CELL_LENGTH + cells["curvature"].values
    if not np.allclose(cells["right_edge"].values, depth):
        raise DatabaseError(
            f"{path}: its cells are not {CELL_LENGTH:g} mm long as the placed ones; make it anew"
        )
    stored = cells["poisson"].values
    K, T = cells["K"].values, cells["stress"].values
    powers = np.stack([cells[name].values for name in ("mode_direction", "mode_p", "mode_q")], axis=1)
    nearest = int(np.argmin(np.abs(stored - nu)))
    if abs(stored[nearest] - nu) < 1e-9:
        K0, Psi, stress = _without_rigid(
            K[:, nearest, 0], K[:, nearest, :1] - K[:, nearest, 1:], T[:, nearest]
        )
    elif not (len(stored) > 3 and stored[0] <= nu <= stored[-1]):
        held = f"{stored[0]:g} to {stored[-1]:g}" if len(stored) > 3 else ", ".join(f"{v:g}" for v in stored)
        raise PoissonNotHeldError(
            f"{path}: holds the effective Poisson's ratios {held}, not {nu:.6g}; "
            f"make a table for it: slmm-precompute --poisson {nu:.6g} -o FILE.nc"
        )
    else:
        K0, Psi, stress = _between(stored, K, T, nu, _symmetric(powers))
    return MetaModel(
        cells["curvature"].values,
        cells["crack_length"].values[1:],
        cells["eta"].values,
        powers,
        K0,
        Psi,
        stress,
        cells["compliance"].values,
        nu,
        str(cells.attrs.get("checksum", "")),
    )


def _without_rigid(K0, Psi, stress):
    """Free rigid and repeated modes of the round-off that a large translation would amplify."""
    Q = [_elastic(stiffness) for stiffness in K0]
    project = np.array([q @ q.T for q in Q])
    return (
        project @ K0 @ project,
        project[:, None] @ Psi @ project[:, None],
        np.einsum("cmk,ckse->cmse", project, stress),
    )


def _elastic(K0: np.ndarray) -> np.ndarray:
    """Orthonormal amplitudes (m, r) that deform the cell; rigid motions and repeated modes are left out."""
    values, vectors = np.linalg.eigh(K0)
    return vectors[:, values > RIGID * values[-1]]


def _symmetric(powers: np.ndarray) -> np.ndarray:
    """Which modes (m, 3) are their own mirror image about the crack line."""
    direction, p = powers[:, 0], powers[:, 1]
    return (p % 2 == 1) == (direction == 0)


def _between(stored, K, T, nu, symmetric):
    """Interpolate flexibility, path stress and released energy of given modal forces over atanh(nu).

    With the flexibilities F_p of the stored ratios and F between them, modes that bear the same forces at a stored
    ratio as at nu are F_p/F times those at nu: what these release, and their stress, is what is interpolated.
    """
    n_c, n_p, n_a, m, _ = K.shape
    between = polynomial_matrix(np.arctanh(stored), np.array([math.atanh(nu)]))[0]
    K0 = np.zeros((n_c, m, m))
    Psi = np.zeros((n_c, n_a - 1, m, m))
    stress = np.zeros((n_c, *T.shape[2:]))
    middle = nearest_middle(stored)
    # symmetric and antisymmetric modes do not couple
    for half in (np.flatnonzero(symmetric), np.flatnonzero(~symmetric)):
        pairs = np.ix_(half, half)
        for i in range(n_c):
            stiffness = K[i][:, :, half[:, None], half]
            Q = _elastic(stiffness[middle, 0])  # rigid motions and repeated modes are those of every nu
            flexibility = np.linalg.inv(Q.T @ stiffness[:, 0] @ Q)
            F = np.tensordot(between, flexibility, axes=1)
            stiff = np.linalg.inv(0.5 * (F + F.T))
            same_forces = Q @ flexibility @ stiff @ Q.T
            # sums over the stored ratios as one product of matrices each
            weighted = (between[:, None, None] * same_forces).reshape(n_p * len(half), -1).T
            loss = (stiffness[:, :1] - stiffness[:, 1:]).reshape(n_p, -1, len(half)) @ same_forces
            loss = loss.reshape(n_p, n_a - 1, len(half), -1).swapaxes(1, 2)
            released = (weighted @ loss.reshape(n_p * len(half), -1)).reshape(len(half), n_a - 1, -1)
            K0[i][pairs] = Q @ stiff @ Q.T
            Psi[i][:, half[:, None], half] = 0.5 * (released.transpose(1, 0, 2) + released.transpose(1, 2, 0))
            carried = weighted @ T[i][:, half].reshape(n_p * len(half), -1)
            stress[i, half] = carried.reshape(len(half), *T.shape[3:])
    return K0, Psi, stress


def nearest_middle(stored: np.ndarray) -> int:
    """Index of the stored Poisson's ratio nearest to 0.3, far from both degenerate ends."""
    return int(np.argmin(np.abs(stored - 0.3)))
