"""The same model assembled and solved directly: what the matrix-free solver is compared with."""

from types import SimpleNamespace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from slmm.scene.load_checks import Load
from slmm.voxels.element import element_matrix


def load(**given) -> Load:
    return SimpleNamespace(**{"strain": None, "displacement": None, "stress": None, **given})  # type: ignore[return-value]


def assemble(stiffness, width, height, nu):
    ny, nx = stiffness.shape
    node = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    corners = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, :-1], node[1:, 1:]], -1).reshape(-1, 4)
    dofs = np.stack([2 * corners, 2 * corners + 1], -1).reshape(-1, 8)
    K = element_matrix(width / nx, height / ny, nu)
    values = K * stiffness.astype(np.float32).astype(float).reshape(-1, 1, 1)
    rows, columns = np.repeat(dofs, 8, axis=1), np.tile(dofs, (1, 8))
    return sp.coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(2 * node.size,) * 2).tocsr()


def without_rigid_motion(u, width, height, rotation):
    u = u.copy()
    u[..., 0] -= u[..., 0].mean()
    if rotation:
        u[..., 1] -= u[..., 1].mean()
        x = np.linspace(-width / 2, width / 2, u.shape[1])
        y = np.linspace(-height / 2, height / 2, u.shape[0])[:, None]
        angle = np.sum(x * u[..., 1] - y * u[..., 0]) / np.sum(x**2 + y**2)
        u += angle * np.stack(np.broadcast_arrays(y, -x), -1)
    return u


def solve_directly(stiffness, width, height, nu, loaded, E=1.0):
    ny, nx = stiffness.shape
    A = assemble(stiffness, width, height, nu)
    u, f = np.zeros((2, ny + 1, nx + 1, 2))
    free = np.ones((ny + 1, nx + 1, 2), bool)
    if loaded.strain is not None:
        e_xx, e_yy, g_xy = loaded.strain
        x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1))
        u = np.stack([e_xx * x + g_xy / 2 * y, g_xy / 2 * x + e_yy * y], -1)
        free[[0, -1]] = False
        free[:, [0, -1]] = False
    elif loaded.displacement is not None:
        u[-1, :, 1] = loaded.displacement
        free[[0, -1], :, 1] = False
        free[0, 0, 0] = False
    else:
        for row, edge, sign in ((-1, stiffness[-1], 1), (0, stiffness[0], -1)):
            f[row, :-1, 1] += sign * loaded.stress / E * width / nx / 2 * edge
            f[row, 1:, 1] += sign * loaded.stress / E * width / nx / 2 * edge
        free[0, 0] = False
        free[0, -1, 1] = False
    i = free.ravel()
    solution, known = u.ravel().copy(), u.ravel()[~i]
    factors = splu(A[i][:, i].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    solution[i] = factors.solve(f.ravel()[i] - A[i][:, ~i] @ known)
    solution = solution.reshape(u.shape)
    if loaded.strain is None:
        solution = without_rigid_motion(solution, width, height, rotation=loaded.stress is not None)
    return solution
