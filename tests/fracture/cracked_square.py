"""A square with a slit from its left edge, of any plane elements, loaded on any of its edges and solved directly."""

import sys
from pathlib import Path

import numpy as np

from slmm.fracture.face_traction import edge_shape
from slmm.mechanics.elasticity import Elasticity
from slmm.results.boundary_edges import boundary_edges

sys.path.insert(0, str(Path(__file__).parents[2] / "validation"))
from elastic_model import solved

STEEL = Elasticity(210e3, 0.3)
SIDE, CRACK = 40.0, 20.0
MIDDLE = SIDE / 2


def square(kind="CPE8", n=20, gap=None, one_sided=False):
    """Nodes and cells; ``gap`` (mm) by the distance behind the tip draws the faces apart, with the mesh around them."""
    step = 2 if kind[3] in "68" else 1
    m = step * n + 1
    x, y = np.meshgrid(np.arange(m), np.arange(m))
    points = np.column_stack([x.ravel(), y.ravel()]) * SIDE / (m - 1)
    lower = np.arange(m * m).reshape(m, m)
    upper, behind = lower.copy(), round(CRACK / SIDE * (m - 1))
    upper[m // 2, :behind] = m * m + np.arange(behind)
    points = np.concatenate([points, points[lower[m // 2, :behind]]])
    i, j = (a.ravel() for a in np.meshgrid(step * np.arange(n), step * np.arange(n), indexing="ij"))
    corner = [(0, 0), (0, step), (step, step), (step, 0)]
    middle = [(0, step / 2), (step / 2, step), (step, step / 2), (step / 2, 0)]
    centre = (step / 2, step / 2)
    orders = {
        "4": [corner],
        "8": [corner + middle],
        "3": [corner[:3], [corner[k] for k in (0, 2, 3)]],
        "6": [[*corner[:3], *middle[:2], centre], [*(corner[k] for k in (0, 2, 3)), centre, *middle[2:]]],
    }[kind[3]]
    above = i >= m // 2

    def node(a, b):
        return np.where(above, upper[i + int(a), j + int(b)], lower[i + int(a), j + int(b)])

    cells = {kind: np.concatenate([np.stack([node(*p) for p in order], axis=1) for order in orders])}
    if gap is not None:
        side = np.where(points[:, 1] > MIDDLE, 1.0, -1.0)
        side[m * m :] = 1.0
        apart = np.where(points[:, 0] < CRACK, gap(np.maximum(CRACK - points[:, 0], 0.0)), 0.0)
        fades = 1 - np.abs(points[:, 1] - MIDDLE) / MIDDLE
        points[:, 1] += fades * apart * (np.where(side > 0, 1.0, 0.0) if one_sided else side / 2)
    return points, cells


def on_faces(X):
    """Whether an edge (k, 2) belongs to the crack."""
    return np.abs(X[:, 1] - MIDDLE).max() < 1.0 and X[:, 0].max() <= CRACK + 1e-9 and np.ptp(X[:, 0]) > 0


def on_top_and_bottom(X):
    return np.abs(np.abs(X[:, 1] - MIDDLE) - MIDDLE).max() < 1e-9


def edge_forces(points, cells, *loads):
    """Consistent nodal forces of (which edges, traction by x, y and the outward normal) ..."""
    force = np.zeros_like(points)
    t, w = np.polynomial.legendre.leggauss(6)
    for edge in boundary_edges(points, cells):
        nodes = edge[edge >= 0]
        shape, slope = edge_shape(len(nodes), t)
        at, along = shape @ points[nodes], slope @ points[nodes]
        length = np.hypot(*along.T)
        normal = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
        for here, traction in loads:
            if here(points[nodes]):
                force[nodes] += shape.T @ (traction(at[:, :1], at[:, 1:], normal) * (w * length)[:, None])
    return force


def loaded(points, cells, *loads):
    """Results of the square under loads as in `edge_forces`, held at three components of its right corners."""
    held = np.zeros(points.shape, dtype=bool)
    right = points[:, 0] == points[:, 0].max()
    held[right & (points[:, 1] == points[:, 1].min())] = True
    held[right & (points[:, 1] == points[:, 1].max()), 0] = True
    return solved(points, cells, STEEL, held, np.zeros_like(points), force=edge_forces(points, cells, *loads))


def upper_half(kind="CPE8"):
    """Nodes and cells of the part above the crack, and which nodes are its ligament."""
    points, cells = square(kind)
    nodes = cells[kind][(points[cells[kind]][..., 1] >= MIDDLE - 1e-9).all(axis=1)]
    used, nodes = np.unique(nodes, return_inverse=True)
    points = points[used]
    ligament = (points[:, 0] >= CRACK - 1e-9) & (points[:, 1] <= MIDDLE + 1e-9)
    return points, {kind: nodes.reshape(-1, cells[kind].shape[1])}, ligament


def half_loaded(points, cells, held):
    """Results of the upper half under tension on its upper edge, held where it is said (n, 2)."""
    force = edge_forces(points, cells, (lambda X: X[:, 1].min() > SIDE - 1e-9, tension()[1]))
    return solved(points, cells, STEEL, held, np.zeros_like(points), force=force)


def tension(stress=100.0):
    """On the top and the bottom edge, MPa."""
    return on_top_and_bottom, lambda x, y, n: stress * n * [0, 1]
