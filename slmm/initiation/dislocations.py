"""Crack initiation from the uncracked part alone: the trial crack as dislocations in a body-fitted model.

By superposition the energy released by a crack is half the work of the stress on its path, in the uncracked part, on
the opening of its faces. The opening follows from the compliance of the faces. For a crack at a circular hole, or at
a straight edge, of an unbounded body it is known (`face_compliance`). The part differs from such a body:
its outline has another shape further away, it has edges, supports and other notches. What these answer to an open
crack is the field that brings the closed-form field of the crack's dislocations (`dipole`) into line with the part's
true boundary; it has no singularity, and back substitutions in the model of the uncracked part give it:

    C^-1 = C_unbounded^-1 - D,    D(eta, eta') = stress at eta by what answers a dipole at eta'

This replaces the auto control's mix of two bounds by the true stiffness of the surroundings, and needs no cell that
fits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.polynomial import legendre

from slmm.fem.boundary_stiffness import BoundaryOfModel, BoundaryStiffness
from slmm.fem.plate_model import PlateModel
from slmm.initiation.body_fitted import BodyFitted
from slmm.initiation.contact import tip_opening, until_closed
from slmm.initiation.dipole import dipoles_on_boundary, mirror_stress
from slmm.initiation.face_compliance import LONGEST, face_compliance, legendre_coefficients
from slmm.initiation.meta_model import polynomial_matrix
from slmm.mechanics.stress import kolosov, shear_modulus

#: dipoles that sample D, Chebyshev points over the longest crack but for its first part: D is smooth, and a mesh
#: resolves it best where the depth is not small
DIPOLES, FIRST_DEPTH = 8, 0.07
#: cracks longer than this many radii of the notch take more, the first within a part of the radius
LONG, MORE_DIPOLES, FIRST_OF_RADIUS, LEAST_FIRST_DEPTH = 2.0, 16, 0.15, 0.01
#: depths of the path stress: enough for a crack that is many times as long as the notch's radius
STRESS_POINTS = 40
#: from so many positions on a model is condensed to its boundary; measured: the costs are then equal
MANY = 16
#: crack lengths at which the energy is computed, evenly spaced in log(a), and the shortest over the longest
LENGTHS, SHORTEST = 24, 1 / 100
#: longest crack over the radius of a surface that is compared with a straight edge
LONGEST_BESIDE_EDGE = 0.5
#: what the bend of such a surface leaves of the energy beyond first order, which two meshes do not see, over the bend
#: along the crack; nineteen errors of twenty lie below
BEND_UNSEEN = 0.02
#: a notch bends by less than this along the longest crack: straight, and closed forms of bends would cancel
STRAIGHT = 1e-5
#: a point of the path keeps a distance from all boundaries of this share of its depth
AWAY = 0.4
#: longest crack over the distance to where a notch leaves the plate, from which on the body beside the mouth is a wedge
#: whose answer polynomials do not follow; chosen: beside corners the distances above leave about as much
FROM_END = 1.5
#: a mirrored crack keeps a distance from the material of this share of its depth, and the hole's centre of its radius
CLEARANCE = 0.5


@dataclass(frozen=True)
class DislocationCurves:
    """Curves along one trial path, extrapolated from two meshes, with the last change beside.

    Attributes
    ----------
    a : ndarray (LENGTHS,)
        Crack lengths, mm.
    G_inc : ndarray (LENGTHS,)
        Incremental energy release rate, N/mm; 0 where the crack would be closed.
    G_inc_change : ndarray (LENGTHS,)
        What the extrapolation changed, what the shallowest sample of D or the highest degree of the polynomial
        through them adds, and what the bend of a surface that is compared with a straight edge leaves, N/mm.
    eta : ndarray (STRESS_POINTS,)
        Depths, mm.
    sigma, sigma_change : ndarray (STRESS_POINTS, 3)
        Stress xx, yy, xy of the uncracked part, MPa, and what the extrapolation changed.
    radius : float
        Of the hole of the unbounded body that was corrected, mm; inf for a straight edge.
    """

    a: np.ndarray
    G_inc: np.ndarray
    G_inc_change: np.ndarray
    eta: np.ndarray
    sigma: np.ndarray
    sigma_change: np.ndarray
    radius: float


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


class DislocationModel:
    """Curves at any position of a part, from one body-fitted model of it.

    Parameters
    ----------
    scene : Scene
        ``plate``, ``part`` and ``material`` are used.
    model : BodyFitted
        Of the uncracked part.
    positions : int, optional
        How many will be asked for, if that is known.
    """

    def __init__(self, scene: Any, model: BodyFitted, positions: int = MANY):
        """Gather the boundaries of both meshes."""
        self.scene, self.model = scene, model
        condensed = positions >= MANY
        self.boundaries = Boundary(model.coarse, condensed), Boundary(model.fine, condensed)
        self.body = scene.part.body
        shapely.prepare(self.body)
        self.ends = _ends(self.body, scene.plate.width, scene.plate.height)

    def reference_radius(self, origin: np.ndarray, along: np.ndarray, curvature: float) -> float:
        """Radius of the hole that stands for the notch, mm; inf where a straight edge does better.

        The osculating circle, if its centre lies well within the notch: there its mirrored cracks end.
        """
        if curvature >= 0:
            return np.inf
        radius = -1 / curvature
        clear = shapely.distance(self.body, shapely.Point(origin - radius * along)) >= CLEARANCE * radius
        return radius if clear else np.inf

    def reach(
        self, origin: np.ndarray, along: np.ndarray, radius: float, curvature: float, a_max: float
    ) -> float:
        """Longest crack up to a_max, mm, that its surroundings allow.

        It is not too long for the radius, its mirror stays in the notch, and it keeps away from other boundaries, whose
        answer would change within a part of its length, and from where the notch leaves the plate.
        """
        if np.isfinite(radius):
            a_max = min(a_max, LONGEST * radius)
        elif curvature != 0:
            a_max = min(a_max, LONGEST_BESIDE_EDGE / abs(curvature))
        a_max = min(a_max, FROM_END * np.linalg.norm(self.ends - origin, axis=1).min(initial=np.inf))
        depths = a_max * np.linspace(0.05, 1.0, 20)
        away = shapely.distance(shapely.points(origin + depths[:, None] * along), self.body.boundary)
        near = np.flatnonzero(away < AWAY * depths)
        if len(near):
            a_max = float(depths[max(near[0] - 1, 0)])
        while True:
            mirror = a_max if np.isinf(radius) else radius * a_max / (radius + a_max)
            distance = shapely.distance(self.body, shapely.Point(origin - mirror * along))
            if distance >= CLEARANCE * mirror:
                return a_max
            a_max *= 0.8

    def trial(self, outline: Any, s: float, a_max: float) -> Trial:
        """The path normal to an outline at the arc length s, for cracks up to a_max, mm, or as far as they can go."""
        origin, along, curvature = outline.points(s), outline.normals(s), float(outline.curvatures(s))
        if abs(curvature) * a_max < STRAIGHT:
            curvature = 0.0
        radius = self.reference_radius(origin, along, curvature)
        return Trial(origin, along, self.reach(origin, along, radius, curvature, a_max), radius, curvature)

    def curves(self, trials: Sequence[Trial]) -> list[DislocationCurves]:
        """Curves of some paths."""
        coarse, fine = (
            self._of_mesh(model, boundary, trials)
            for model, boundary in zip((self.model.coarse, self.model.fine), self.boundaries, strict=True)
        )
        result = []
        for trial, (before, stress_before), (G, stress) in zip(trials, coarse, fine, strict=True):
            # the energy's error follows that of the stress, which is cubic in the element size
            change, stress_change = (G[0] - before[0]) / 7, (stress - stress_before) / 7
            a = _lengths(trial)
            unseen = BEND_UNSEEN * abs(trial.curvature) * a if np.isinf(trial.radius) else 0.0
            result.append(
                DislocationCurves(
                    a,
                    np.maximum(G[0] + change, 0.0),
                    np.abs(change) + np.abs(G[1:] - G[0]).max(axis=0) + unseen * np.abs(G[0]),
                    trial.eta,
                    stress + stress_change,
                    stress_change,
                    trial.radius,
                )
            )
        return result

    def _of_mesh(
        self, model: PlateModel, boundary: Boundary, trials: Sequence[Trial]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """G_inc (2 or 3, LENGTHS) and stress (STRESS_POINTS, 3) of each path from one of the meshes.

        The second row of G_inc is that of D without its highest degree, the third, of long cracks, that without its
        shallowest sample.
        """
        points = np.concatenate([trial.origin + trial.eta[:, None] * trial.along for trial in trials])
        stress = model.stress(points).reshape(len(trials), -1, 3)
        result = []
        for trial, sigma, D in zip(trials, stress, answers_of_surroundings(boundary, trials), strict=True):
            a = _lengths(trial)
            C = face_compliance()(a, trial.radius) / model.E
            across = np.array([-trial.along[1], trial.along[0]])
            traction = np.stack([_component(sigma, across, across), _component(sigma, trial.along, across)])
            bend = _Bend(trial.curvature if np.isinf(trial.radius) else 0.0, boundary)
            samples = [(D, trial.depths), (_one_degree_less(D), trial.depths)]
            if len(trial.depths) > DIPOLES:
                deeper = np.tile(np.arange(len(trial.depths)) > 0, 2)
                samples.append((D[np.ix_(deeper, deeper)], trial.depths[1:]))
            G = [released(a, C, d, depths, trial.eta, traction, bend) for d, depths in samples]
            result.append((np.array(G), sigma))
        return result


def _ends(body: shapely.Polygon, width: float, height: float) -> np.ndarray:
    """Where notches leave a plate, (n, 2), mm: vertices on its edges that are none of its corners."""
    vertices, size = np.unique(shapely.get_coordinates(body), axis=0), np.array([width, height])
    on_side = np.minimum(np.abs(vertices), np.abs(vertices - size)) < 1e-9 * size
    return vertices[on_side.any(axis=1) & ~on_side.all(axis=1)]


def _one_degree_less(D: np.ndarray) -> np.ndarray:
    """Samples (2 m, 2 m) at Chebyshev points without the highest degree of the polynomial through them."""
    m = len(D) // 2
    highest = np.cos((m - 1) * np.pi * (np.arange(m) + 0.5) / m)
    keep = np.eye(m) - np.outer(highest, highest) / (highest @ highest)
    keep = np.kron(np.eye(2), keep)
    return keep @ D @ keep.T


def _lengths(trial: Trial) -> np.ndarray:
    return np.geomspace(SHORTEST * trial.longest, trial.longest, LENGTHS)


class _Bend:
    """What a notch's curvature adds to a straight edge: near the mouth not smooth, but known.

    To leading order a surface that bends the other way adds the opposite.
    """

    def __init__(self, curvature: float, boundary: Boundary):
        self.curvature = curvature
        self.mu, self.kappa = boundary.mu, boundary.kappa

    def __call__(self, at: np.ndarray) -> np.ndarray:
        """Stress (2, n, n) at depths by dipoles at the same depths (n,), opening and sliding, MPa/mm^2."""
        if self.curvature == 0:
            return np.zeros((2, len(at), len(at)))
        hole = mirror_stress(at, at, 1 / abs(self.curvature), self.mu, self.kappa)
        edge = mirror_stress(at, at, np.inf, self.mu, self.kappa)
        return -np.sign(self.curvature) * (hole - edge)


def released(
    a: np.ndarray,
    C: np.ndarray,
    D: np.ndarray,
    depths: np.ndarray,
    eta: np.ndarray,
    traction: np.ndarray,
    bend: _Bend,
) -> np.ndarray:
    """Incremental energy release rate (n,), N/mm, of cracks of lengths a (n,).

    Parameters
    ----------
    a : ndarray (n,)
        Crack lengths, mm.
    C : ndarray (n, 2, k, k)
        Compliance of the faces in the unbounded body for Legendre tractions, mm^2/MPa.
    D : ndarray (2 m, 2 m)
        Stress by what the surroundings answer, sampled at depths (m,), MPa/mm^2.
    depths, eta : ndarray (m,), (q,)
        Where D and the stress are sampled, mm.
    traction : ndarray (2, q)
        Normal and shear stress on the uncracked path, MPa.
    bend : _Bend
        The part of D that is not smooth.
    """
    n, k, m = len(a), C.shape[-1], len(depths)
    t, w = legendre.leggauss(24)
    # dense towards the mouth, where the bend is singular
    x, w = 2 * ((t + 1) / 2) ** 2 - 1, w * (t + 1)
    project = legendre_coefficients(k, x, w)
    at = a[:, None] * (x + 1) / 2
    smooth, near = D.copy(), bend(depths)
    smooth[:m, :m] -= near[0]
    smooth[m:, m:] -= near[1]
    p = np.einsum("kq,nqe,de->ndk", project, _polynomials(eta, at), traction).reshape(n, 2 * k)
    basis = project @ _polynomials(depths, at)
    lift, compliance = np.zeros((n, 2 * k, 2 * m)), np.zeros((n, 2 * k, 2 * k))
    lift[:, :k, :m] = lift[:, k:, m:] = basis
    compliance[:, :k, :k], compliance[:, k:, k:] = C.swapaxes(0, 1)
    answer = lift @ smooth @ lift.swapaxes(1, 2)
    bent = project @ np.stack([bend(points) for points in at]) @ project.T
    answer[:, :k, :k] += bent[:, 0]
    answer[:, k:, k:] += bent[:, 1]
    opening = np.linalg.solve(np.eye(2 * k) - compliance @ answer, compliance @ p[..., None])[..., 0]
    energy = 0.5 * np.einsum("nk,nk->n", p, opening)
    return until_closed(energy, tip_opening(opening[:, :k])) / a


def _polynomials(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """From values at ``nodes`` (k,) to those of the polynomial through them at ``at`` (n, q), shape (n, q, k)."""
    return polynomial_matrix(nodes, at.ravel()).reshape(*at.shape, len(nodes))


def _component(sigma: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Component (n,) of stresses (n, 3) xx, yy, xy in two directions."""
    xx, yy, xy = sigma.T
    return (
        xx * first[0] * second[0]
        + yy * first[1] * second[1]
        + xy * (first[0] * second[1] + first[1] * second[0])
    )
