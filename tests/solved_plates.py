"""Plane finite element models for tests: structured plates with a hole, in any element type, solved right here."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.results.field import DisplacementField

SIDE = 20.0


def ring(around, across, radius=2.0, at=(10.0, 10.0)):
    """Nodes (n, 2) and quadrilaterals of a square plate with a hole; ``around`` is a multiple of four."""
    angle = np.arange(around) * 2 * np.pi / around + np.pi / 4
    corners = np.array([[SIDE, SIDE], [0.0, SIDE], [0.0, 0.0], [SIDE, 0.0]])
    along = np.arange(around // 4)[:, None] / (around // 4)
    edge = np.concatenate([corners[k] + along * (corners[(k + 1) % 4] - corners[k]) for k in range(4)])
    hole = at + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    depth = np.concatenate([[0.0], np.cumsum(1.3 ** np.arange(across))])
    points = np.concatenate([hole + (edge - hole) * share for share in depth / depth[-1]])
    i, j = np.meshgrid(np.arange(around), np.arange(across))
    after = (i + 1) % around
    corners_of = (j * around + i, (j + 1) * around + i, (j + 1) * around + after, j * around + after)
    return points, np.stack(corners_of, axis=-1).reshape(-1, 4)


def with_middles(points, quads, radius=None, at=(10.0, 10.0)):
    """The same with nodes in the middle of edges, those of the hole on it where its radius is given."""
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    unique, place = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    middles = points[unique].mean(axis=1)
    if radius is not None:
        ends = points[unique] - at
        on = (np.abs(np.hypot(ends[..., 0], ends[..., 1]) - radius) < 1e-9).all(axis=1)
        away = middles[on] - at
        middles[on] = at + radius * away / np.hypot(*away.T)[:, None]
    return np.concatenate([points, middles]), np.hstack([quads, len(points) + place.reshape(-1, 4)])


def triangles(quads):
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def stiffness(points, cells, material, reduced=False):
    E, nu = material.plane_stress_equivalent
    D = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
    rows, columns, values = [], [], []
    for kind, nodes in cells.items():
        known = ELEMENT_TYPES[kind]
        element = known.reduced if reduced and known.reduced is not None else known.element
        gradient = element.gradient_at_points
        jacobian = np.einsum("eni,pnj->epij", points[nodes], gradient)
        by_x = np.einsum("pnj,epji->epni", gradient, np.linalg.inv(jacobian))
        B = np.zeros((*by_x.shape[:2], 3, 2 * nodes.shape[1]))
        B[:, :, 0, 0::2] = B[:, :, 2, 1::2] = by_x[..., 0]
        B[:, :, 1, 1::2] = B[:, :, 2, 0::2] = by_x[..., 1]
        K = np.einsum("epai,ab,epbj,ep->eij", B, D, B, np.linalg.det(jacobian) * element.weights)
        dofs = np.stack([2 * nodes, 2 * nodes + 1], axis=-1).reshape(len(nodes), -1)
        rows.append(np.repeat(dofs, dofs.shape[1], axis=1).ravel())
        columns.append(np.tile(dofs, (1, dofs.shape[1])).ravel())
        values.append(K.ravel())
    place = (np.concatenate(rows), np.concatenate(columns))
    return sp.csc_array((np.concatenate(values), place), shape=(2 * len(points),) * 2)


def solved(points, cells, material, held, moved, force=None, reduced=False):
    """A field with some degrees of freedom (2 node + direction) held at displacements, under forces (n, 2)."""
    K = stiffness(points, cells, material, reduced)
    u = np.zeros(2 * len(points))
    u[held] = moved
    f = np.zeros(len(u)) if force is None else force.ravel()
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    free = np.setdiff1d(np.concatenate([2 * used, 2 * used + 1]), held)
    u[free] = spsolve(K[free][:, free], (f - K @ u)[free])
    return DisplacementField(points, cells, u.reshape(-1, 2))


def stretched(points, cells, material, by=0.05, reduced=False):
    """The top edge of the plate moved up, the bottom edge held in y, the sides free."""
    bottom, top = (np.flatnonzero(np.abs(points[:, 1] - y) < 1e-9) for y in (0.0, SIDE))
    held = np.concatenate([2 * bottom + 1, 2 * top + 1, 2 * bottom[:1]])
    moved = np.concatenate([np.zeros(len(bottom)), np.full(len(top), by), [0.0]])
    return solved(points, cells, material, held, moved, reduced=reduced)
