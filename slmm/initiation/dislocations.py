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
from typing import Any

import numpy as np
import shapely

from slmm.fem.plate_model import PlateModel
from slmm.initiation.body_fitted import BodyFitted
from slmm.initiation.dislocation_energy import Bend, one_degree_less, released
from slmm.initiation.face_compliance import LONGEST, face_compliance
from slmm.initiation.surroundings import DIPOLES, Boundary, Trial, answers_of_surroundings
from slmm.mechanics.richardson import extrapolated
from slmm.part.chords import chords

#: from so many positions on a model is condensed to its boundary; measured: the costs are then equal
MANY = 16
#: crack lengths at which the energy is computed, evenly spaced in log(a), and the shortest over the longest;
#: both chosen
LENGTHS, SHORTEST = 24, 1 / 100
#: longest crack over the radius of a surface that is compared with a straight edge; chosen
LONGEST_BESIDE_EDGE = 0.5
#: what the bend of such a surface leaves of the energy beyond first order, which two meshes do not see, over the bend
#: along the crack; chosen such that nineteen errors of twenty lie below (validation/fit_dislocation_errors.py)
BEND_UNSEEN = 0.02
#: a notch bends by less than this along the longest crack: straight, and closed forms of bends would cancel; round-off
NO_BEND = 1e-5
#: a point of the path keeps a distance from all boundaries of this share of its depth; chosen
AWAY = 0.4
#: longest crack over the distance to where a notch leaves the plate, from which on the body beside the mouth is a wedge
#: whose answer polynomials do not follow; chosen: beside corners the distances above leave about as much
FROM_END = 1.5
#: a mirrored crack keeps a distance from the material of this share of its depth, and the hole's centre of its
#: radius; chosen
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
        self.ends = _ends(scene)

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
        if abs(curvature) * a_max < NO_BEND:
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
            energy, change = extrapolated(before[0], G[0], order=3)
            sigma, stress_change = extrapolated(stress_before, stress, order=3)
            a = _lengths(trial)
            unseen = BEND_UNSEEN * abs(trial.curvature) * a if np.isinf(trial.radius) else 0.0
            result.append(
                DislocationCurves(
                    a,
                    np.maximum(energy, 0.0),
                    np.abs(change) + np.abs(G[1:] - G[0]).max(axis=0) + unseen * np.abs(G[0]),
                    trial.eta,
                    sigma,
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
            bend = Bend(trial.curvature if np.isinf(trial.radius) else 0.0, boundary.mu, boundary.kappa)
            samples = [(D, trial.depths), (one_degree_less(D), trial.depths)]
            if len(trial.depths) > DIPOLES:
                deeper = np.tile(np.arange(len(trial.depths)) > 0, 2)
                samples.append((D[np.ix_(deeper, deeper)], trial.depths[1:]))
            G = [released(a, C, d, depths, trial.eta, traction, bend) for d, depths in samples]
            result.append((np.array(G), sigma))
        return result


def _ends(scene: Any) -> np.ndarray:
    """Where notches leave a part, (n, 2), mm: of a plate, vertices on its edges that are none of its corners."""
    part = scene.part
    if part.rim is not None:
        rings = [shapely.LinearRing(chords(hole)) for hole in part.holes]
        crossings = shapely.union_all(rings).intersection(scene.outer.exterior)
        return np.asarray(shapely.get_coordinates(crossings))
    vertices, size = np.unique(shapely.get_coordinates(part.body), axis=0), part.box[1]
    on_side = np.minimum(np.abs(vertices), np.abs(vertices - size)) < 1e-9 * size
    return np.asarray(vertices[on_side.any(axis=1) & ~on_side.all(axis=1)])


def _lengths(trial: Trial) -> np.ndarray:
    return np.geomspace(SHORTEST * trial.longest, trial.longest, LENGTHS)


def _component(sigma: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Component (n,) of stresses (n, 3) xx, yy, xy in two directions."""
    xx, yy, xy = sigma.T
    return (
        xx * first[0] * second[0]
        + yy * first[1] * second[1]
        + xy * (first[0] * second[1] + first[1] * second[0])
    )
