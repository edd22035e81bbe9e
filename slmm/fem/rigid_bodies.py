"""Rigid bodies on the surface of a body-fitted model: their nodes follow three displacements at most, the masters."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from slmm.fem.loads import NodalLoad


class Followers:
    """How displacements follow from unknowns, among which those of a rigid body stand in place of some of its nodes'.

    Parameters
    ----------
    load : NodalLoad
    points : ndarray, shape (n, 2)
        The model's nodes, mm.
    jumps : ndarray of int
        Displacements that count from the other face of a path; they do not follow.

    Attributes
    ----------
    all : ndarray of bool (2 n,)
        Displacements that follow.
    masters : ndarray of int (m,)
        Numbers of the unknowns that are motions of bodies, mm.
    from_unknowns : sparse array, shape (2 n, 2 n)
    given : ndarray, shape (2 n,)
        What of the bodies' motion is given, mm.
    """

    def __init__(self, load: NodalLoad, points: np.ndarray, jumps: np.ndarray) -> None:
        """Choose the masters."""
        n = 2 * len(points)
        self.given, self._resultants = np.zeros(n), np.zeros(n)
        self.all = np.zeros(n, dtype=bool)
        masters, rows, columns, entries = [], [], [], []
        for body, nodes, given in load.bodies:
            place = np.ravel(2 * nodes[:, None] + np.arange(2))
            motions = body.motions(points[nodes]).reshape(len(place), -1)
            follows = ~np.isin(place, jumps)
            place, motions = place[follows], motions[follows]
            self.given[place] = given.ravel()[follows]
            own = place[: motions.shape[1]]
            self.all[place] = True
            self._resultants[own] = body.resultants
            masters.append(own)
            rows.append(np.repeat(place, len(own)))
            columns.append(np.tile(own, len(place)))
            entries.append(motions.ravel())
        self.masters = np.concatenate(masters)
        follow = sp.csr_array(
            (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)
        )
        self.from_unknowns = (sp.diags_array(1.0 * ~self.all) + follow).tocsr()

    def stiffness(self, K: sp.csr_array) -> sp.csr_array:
        """Stiffness in the unknowns."""
        return (self.from_unknowns.T @ K @ self.from_unknowns).tocsr()

    def force(self, K: sp.csr_array, force: np.ndarray) -> np.ndarray:
        """Forces (2 n,) in the unknowns, from those on the nodes and the displacements that are given."""
        return np.asarray(self.from_unknowns.T @ (force - K @ self.given)) + self._resultants

    def displacements(self, unknowns: np.ndarray) -> np.ndarray:
        """Displacements (2 n,) from unknowns."""
        return np.asarray(self.from_unknowns @ unknowns) + self.given
