"""A plate model seen from its boundary: displacements and forces there under any other load.

For many loads the stiffness is condensed to the boundary, and each is a small dense solve. For a few it is cheaper to
solve the whole model, which is factorised in any case.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from slmm.fem.plate_model import PlateModel
from slmm.fem.sparse_factor import factorised, last_block, nested_dissection


class BoundaryStiffness:
    """A plate model seen from its boundary, under the scene's kind of support.

    The inner unknowns are eliminated by one sparse factorisation that takes those of the boundary last; the rest of the
    work for any number of loads is dense and small.

    Parameters
    ----------
    model : PlateModel

    Attributes
    ----------
    nodes : ndarray (b,)
        Nodes of the boundary, crack faces among them.
    """

    def __init__(self, model: PlateModel):
        """Condense and factorise."""
        self.nodes = boundary_nodes(model)
        unknowns = np.ravel(2 * self.nodes[:, None] + np.arange(2))
        inner = np.setdiff1d(np.arange(2 * len(model.points)), unknowns)
        order = np.concatenate([inner[nested_dissection(model.K, inner)], unknowns])
        prescribed = model.load.prescribed.ravel()
        # without springs on what is held, the plate could move as a whole; they are taken off again below
        spring = np.where(prescribed, model.K.diagonal().max(), 0.0)
        factor = factorised((model.K + sp.diags_array(spring)).tocsr(), order)
        S = last_block(factor, len(unknowns)) - np.diag(spring[unknowns])
        self.held = prescribed[unknowns]
        free = ~self.held
        self._free = la.cho_factor(S[np.ix_(free, free)])
        self._held_by_free = S[np.ix_(self.held, free)]
        self._held = S[np.ix_(self.held, self.held)]

    def response(self, force: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements and nodal forces (b, 2, k) of the boundary under k loads; many at once are much cheaper.

        Parameters
        ----------
        force, value : ndarray (b, 2, k)
            Nodal forces, N, and, where the scene's load prescribes any, displacements, mm.
        """
        k = force.shape[-1]
        free = ~self.held
        u, f = value.reshape(-1, k).copy(), force.reshape(-1, k).copy()
        u[free] = la.cho_solve(self._free, f[free] - self._held_by_free.T @ u[self.held])
        f[self.held] = self._held_by_free @ u[free] + self._held @ u[self.held]
        return u.reshape(-1, 2, k), f.reshape(-1, 2, k)


class BoundaryOfModel:
    """A plate model seen from its boundary, under the scene's kind of support, by a solve of all of it for each load.

    Parameters and attributes are those of `BoundaryStiffness`.
    """

    def __init__(self, model: PlateModel):
        """Find the boundary."""
        self.nodes, self._model = boundary_nodes(model), model
        self._unknowns = np.ravel(2 * self.nodes[:, None] + np.arange(2))
        self.held = model.load.prescribed.ravel()[self._unknowns]
        self._held_rows = model.K[self._unknowns[self.held]]

    def response(self, force: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements and nodal forces (b, 2, k) of the boundary under k loads, see `BoundaryStiffness.response`."""
        model, k = self._model, force.shape[-1]
        f = force.reshape(-1, k).copy()
        u, load = np.zeros((2, 2 * len(model.points), k))
        u[self._unknowns[self.held]] = value.reshape(-1, k)[self.held]
        load[self._unknowns] = f
        u[model.order] = model.factor.solve((load - model.K @ u)[model.order])
        f[self.held] = self._held_rows @ u
        return u[self._unknowns].reshape(-1, 2, k), f.reshape(-1, 2, k)


def boundary_nodes(model: PlateModel) -> np.ndarray:
    """Nodes (b,) of the boundary, crack faces among them."""
    facets = model.mesh.boundary_facets()
    ends = model.mesh.facets[:, facets].ravel()
    return np.unique(np.concatenate([ends, model.mesh.nvertices + facets]))
