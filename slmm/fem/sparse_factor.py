"""Factors of sparse stiffnesses: the order of their unknowns, and what is left of the last ones."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu


def nested_dissection(K: sp.csr_array, free: np.ndarray) -> np.ndarray:
    """Order of some unknowns that keeps their factor sparse: METIS on the graph of the nodes.

    Without METIS, which has no wheels for some systems, SuperLU's minimum degree, whose factors take longer.
    """
    nodes, of_node = np.unique(free // 2, return_inverse=True)
    graph = K[::2, ::2][nodes][:, nodes].tocoo()
    other = graph.row != graph.col
    graph = sp.csr_array(
        (np.ones(other.sum(), dtype=np.int8), (graph.row[other], graph.col[other])), graph.shape
    )
    try:
        import pymetis
    except ImportError:
        rank = _minimum_degree(graph)
    else:
        rank = np.asarray(pymetis.nested_dissection(pymetis.CSRAdjacency(graph.indptr, graph.indices))[1])
    return np.argsort(rank[of_node], kind="stable")


def _minimum_degree(graph: sp.csr_array) -> np.ndarray:
    """Place (n,) of each node of a graph in the order that SuperLU would take."""
    n = graph.shape[0]
    heavy = sp.eye_array(n) * (graph.sum(axis=1).max() + 1.0) - graph.astype(float)
    return splu(heavy.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).perm_c


def factorised(K: sp.csr_array, order: np.ndarray) -> SuperLU:
    """LU of a symmetric positive definite part of a matrix, its unknowns in the given order, without pivoting."""
    return splu(
        K[order][:, order].tocsc(),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def last_block(factor: SuperLU, m: int) -> np.ndarray:
    """Stiffness (m, m) condensed to the last m unknowns of a factorisation.

    Ten times faster than solving with one right-hand side for each of them.
    """
    # SuperLU reorders columns by their elimination tree, within the last block, too
    last = factor.perm_c[-m:] - (factor.shape[0] - m)
    L, U = (block[-m:, -m:].toarray() for block in (factor.L, factor.U))
    S = (L @ U)[np.ix_(last, last)]
    return (S + S.T) / 2
