"""What the surroundings answer to an open crack: dipoles' tractions and displacements on a model's true boundary."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from slmm.fem.boundary_stiffness import BoundaryOfModel, BoundaryStiffness
from slmm.fem.plate_model import PlateModel
from slmm.initiation.dipole import dipoles_on_boundary
from slmm.mechanics.stress import kolosov, shear_modulus

#: dipoles that sample D, Chebyshev points over the longest crack but for its first part: D is smooth, and a mesh
#: resolves it best where the depth is not small; both chosen
DIPOLES, FIRST_DEPTH = 8, 0.07
#: cracks longer than this many radii of the notch take more, the first within a part of the radius; all chosen
LONG, MORE_DIPOLES, FIRST_OF_RADIUS, LEAST_FIRST_DEPTH = 2.0, 16, 0.15, 0.01
#: depths of the path stress: enough for a crack that is many times as long as the notch's radius; chosen
STRESS_POINTS = 40


class Boundary:
    """A model's boundary: its stiffness, and Gauss points on its curved edges for what acts there.

    Parameters
    ----------
    model : PlateModel
        Of the uncracked part.
    condensed : bool
        To the boundary: dear, and cheap for each position then.
    """

    def __init__(self, model: PlateModel, condensed: bool = True):
        """Condense the model and gather its outer edges, the body on their left."""
        self.stiffness = BoundaryStiffness(model) if condensed else BoundaryOfModel(model)
        nodes = self.stiffness.nodes
        self.at = np.ascontiguousarray(model.points[nodes])
        self.supports = model.load.supports[nodes]
        self.mu, self.kappa = shear_modulus(model.E, model.nu), kolosov(model.nu)
        mesh = model.mesh
        facets = mesh.boundary_facets()
        ends = mesh.facets[:, facets].copy()
        inner = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
        a, b = mesh.p[:, ends[0]], mesh.p[:, ends[1]]
        turned = (b - a)[0] * (inner - a)[1] < (b - a)[1] * (inner - a)[0]
        ends[:, turned] = ends[::-1, turned]
        edges = np.stack([ends[0], mesh.nvertices + facets, ends[1]], axis=1)
        x, w = legendre.leggauss(4)
        self.shape = np.stack([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2], axis=1)
        slope = np.stack([x - 0.5, -2 * x, x + 0.5], axis=1)
        along = np.einsum("qn,eni->eqi", slope, model.points[edges])
        self.points = np.einsum("qn,eni->eqi", self.shape, model.points[edges]).reshape(-1, 2)
        self.normals = (np.stack([along[..., 1], -along[..., 0]], axis=-1) * w[:, None]).reshape(-1, 2)
        self.edges = np.searchsorted(nodes, edges)

    def nodal_forces(self, traction: np.ndarray) -> np.ndarray:
        """Consistent forces (b, 2, k) on the boundary nodes from forces (q, 2, k) at the Gauss points."""
        k = traction.shape[-1]
        per_edge = np.einsum("qn,eqik->enik", self.shape, traction.reshape(len(self.edges), -1, 2, k))
        force = np.zeros((len(self.at), 2, k))
        np.add.at(force, self.edges, per_edge)
        return force


class Trial(NamedTuple):
    """A trial path and the unbounded body it is compared with."""

    origin: np.ndarray  # mouth (2,), mm
    along: np.ndarray  # unit vector into the material
    longest: float  # crack, mm
    radius: float  # of the body's hole, mm; inf for a straight edge
    curvature: float  # of the notch, 1/mm, negative at a hole

    @property
    def depths(self) -> np.ndarray:
        """Where dipoles sample the answer of the surroundings, mm."""
        n, first, in_radii = DIPOLES, FIRST_DEPTH, self.longest * abs(self.curvature)
        if in_radii > LONG:
            n, first = MORE_DIPOLES, np.clip(FIRST_OF_RADIUS / in_radii, LEAST_FIRST_DEPTH, FIRST_DEPTH)
        chebyshev = 0.5 * (1 - np.cos(np.pi * (np.arange(n) + 0.5) / n))
        return self.longest * (first + (1 - first) * chebyshev)

    @property
    def eta(self) -> np.ndarray:
        """Depths of the path stress, mm."""
        return self.longest * (1 - np.cos(np.pi * np.arange(STRESS_POINTS) / (STRESS_POINTS - 1))) / 2


def answers_of_surroundings(boundary: Boundary, trials: Sequence[Trial]) -> list[np.ndarray]:
    """Stress on each path by what answers dipoles at its k depths: (2 k, 2 k), opening before sliding, MPa/mm^2.

    By reciprocity it is the work of one dipole's tractions and displacements on the boundary with the other's
    answer: the answer's stress inside the body is not needed.
    """
    force, moved = [], []
    for trial in trials:
        traction, u = dipoles_on_boundary(
            boundary.points,
            boundary.normals,
            boundary.at,
            trial.origin,
            trial.along,
            trial.depths,
            trial.radius,
            boundary.mu,
            boundary.kappa,
        )
        force.append(boundary.nodal_forces(traction))
        moved.append(u)
    all_moved = np.concatenate(moved, axis=-1)
    # supports that only fix the rigid motion carry no reaction
    value = np.where(boundary.supports[..., None], 0.0, -all_moved)
    u, reaction = boundary.stiffness.response(-np.concatenate(force, axis=-1), value)
    result = []
    ends = np.cumsum([f.shape[-1] for f in force])
    for end, f, v in zip(ends, force, moved, strict=True):
        mine = slice(end - f.shape[-1], end)
        work = np.einsum("bik,bil->kl", f, u[..., mine]) - np.einsum("bik,bil->kl", v, reaction[..., mine])
        result.append(-(work + work.T) / 2)
    return result
