"""What a failure index is off by because its notch was traced in a picture.

Along a smooth stretch, waves of the outline change the stress; the coupled criterion feels them as far as they reach
into the material beside the critical crack. At a corner, and at a bend so tight that the picture hardly tells it from
one, the index lies between those of the radii that the picture allows: asymptotics of sharp and blunted V-notches
give their ratio, which depends on opening, radius and material alone. And the whole outline may lie a little too far
inside or outside.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.spatial import cKDTree

from slmm.criteria.coupled import critical_load, stress_over_crack
from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.path_curves import path_points
from slmm.initiation.asymptotics import critical_intensity, sharp_curves
from slmm.initiation.blunted import blunted_curves
from slmm.initiation.task import Answer, Task
from slmm.initiation.v_notch_table import load_v_notches
from slmm.mechanics.material import Material
from slmm.mechanics.williams import singular_exponent
from slmm.part.accuracy import Accuracy

#: standard deviations that cover nineteen of twenty; computed
DEVIATIONS = 2.0
#: how far a narrow notch's tip may lie from where it is in the outline, in largest radii: where its flanks meet
#: (chosen), and where they were not followed to a corner (fitted to drawn notches of 3 to 6 degrees, which then end
#: 10 to 20 pixels before their tip, with a largest radius of 2: validation/fit_outline_errors.py)
FARTHEST_OF_CORNER, FARTHEST_OF_BEND = 2.0, 12.0
#: longest crack at a tip, in Irwin's lengths and in radii of the root: the critical one is shorter; both chosen
IN_IRWIN_LENGTHS, IN_RADII = 3.0, 4.0


def add_outline_error(task: Task, answer: Answer) -> None:
    """Add to the errors of an answer what is open about the outlines, and note it."""
    of_outline = outline_error(task, answer)
    answer.column("outline_error")[:] = of_outline
    # where there is no tension, its error is no relative one
    answer.error = answer.error + np.where(np.isinf(answer.load_factor), 0.0, of_outline)


def outline_error(task: Task, answer: Answer) -> np.ndarray:
    """Relative errors (n,) of the failure indices for what is open about the outlines; 0 where these are exact."""
    where, material = task.where, task.scene.material
    result = np.zeros(task.n)
    for k, outline in enumerate(task.scene.outlines):
        rows = np.flatnonzero(where.hole == k)
        if outline.accuracy is None or not len(rows):
            continue
        accuracy, points = outline.accuracy, where.points[rows]
        of_waves = waves_error(accuracy, points, np.nan_to_num(answer.crack_length[rows]))
        radius = outline.length / (2 * np.pi)
        of_tips = tips_error(accuracy, points, radius, material, task.criterion == Coupled(average=True))
        # stress rises at most as the root of the notch's size, and as the ligament becomes thinner
        of_offset = accuracy.offset * (
            0.5 / radius + 1 / np.maximum(task.paths.ligament[rows], accuracy.offset)
        )
        result[rows] = np.minimum(np.hypot(of_waves, of_offset) + of_tips, 1.0)
    return result


def waves_error(accuracy: Accuracy, points: np.ndarray, crack: np.ndarray) -> np.ndarray:
    """Relative errors (n,) at points (n, 2) of an outline for its waves, with critical cracks (n,), all in mm.

    What a wave changes decays into the material as exp(-k y); its mean over the crack counts.
    """
    distance, nearest = cKDTree(accuracy.points).query(points)
    wavelength = accuracy.wavelength[nearest]
    reach = 2 * np.pi * crack / wavelength
    decayed = -np.expm1(-reach) / np.maximum(reach, 1e-12)
    error = DEVIATIONS * accuracy.stress[nearest] * np.where(reach > 1e-6, decayed, 1.0)
    # an outline may be traced in one part and exact in another
    return np.where(distance <= wavelength, error, 0.0)


def tips_error(
    accuracy: Accuracy, points: np.ndarray, size: float, material: Material, average: bool
) -> np.ndarray:
    """Relative errors (n,) at points (n, 2) for what corners and tight bends of a notch of some size, mm, may be."""
    error = np.zeros(len(points))
    for tip, turn, spread, radii in zip(
        accuracy.tips, accuracy.turns, accuracy.spreads, accuracy.radii, strict=True
    ):
        if turn <= 0:
            continue  # the material's corner, where there is no tension
        radius, least, largest = (float(r) for r in radii)
        at_tip = rounding_error(float(np.pi - turn), radius, least, largest, material, average)
        at_tip += angle_error(float(np.pi - turn), DEVIATIONS * float(spread), size, material)
        distance = np.maximum(np.hypot(*(points - tip).T), 1e-300)
        error = np.maximum(error, at_tip * np.minimum(1.0, largest / distance))
        farthest = FARTHEST_OF_CORNER if spread > 0 else FARTHEST_OF_BEND
        beside = place_error(float(np.pi - turn), largest, farthest * largest, distance)
        error = np.maximum(error, np.where(distance > largest, beside, 0.0))
    return error


def place_error(opening: float, largest: float, farthest: float, distance: np.ndarray) -> np.ndarray:
    """Relative errors (n,) at distances (n,) from a tip because it may lie elsewhere by up to farthest, all in mm.

    The root of an arc of the largest radius and the corner in its place are apart, and a picture does not show the
    last and thinnest part of a slit. Beside a corner the stress goes with the power lambda - 1 of the distance.
    """
    half = np.sin(0.5 * opening)
    apart = min(largest * (1 / half - 1), farthest) if half > 0 else farthest
    return np.minimum((1 - singular_exponent(opening)) * apart / distance, 1.0)


def angle_error(opening: float, spread: float, size: float, material: Material) -> float:
    """Relative change of the failure index of a sharp notch when its opening differs by a spread, rad.

    In the same stress, the intensity of a notch of some size (mm) goes with the power 1 - lambda of that.
    """

    def index(angle: float) -> float:
        angle = min(max(angle, 0.0), np.pi)
        return float(size ** (1 - singular_exponent(angle)) / critical_intensity(angle, material).k_1)

    return max(abs(index(opening + side * spread) / index(opening) - 1) for side in (-1, 1))


@lru_cache(maxsize=4096)
def rounding_error(
    opening: float, radius: float, least: float, largest: float, material: Material, average: bool = False
) -> float:
    """Largest relative change of the failure index of a V-notch when its radius lies between two bounds.

    Parameters
    ----------
    opening : float
        Angle between the flanks, rad.
    radius, least, largest : float
        Radius that the index was computed with, and its bounds, mm; 0 is a sharp notch.
    material : Material
    average : bool
        Compare the mean stress over the crack with the strength.

    Examples
    --------
    >>> PMMA = Material.from_name("PMMA")
    >>> [round(rounding_error(np.pi / 2, 0.0, 0.0, r, PMMA), 3) for r in (0.0, 0.05, 0.5)]
    [0.0, 0.029, 0.157]
    """
    here, *others = (
        _index_of(opening, r, material, average) for r in dict.fromkeys((radius, least, largest))
    )
    return max((abs(other / here - 1) for other in others), default=0.0)


def _index_of(opening: float, radius: float, material: Material, average: bool) -> float:
    """Failure index of a V-notch under the intensity at which the sharp one cracks."""
    E = material.plane_stress_equivalent[0]
    k_1 = critical_intensity(opening, material).k_1
    a = path_points(np.array([IN_IRWIN_LENGTHS * material.irwin_length + IN_RADII * radius]))[0]
    if radius > 0:
        G, sigma = blunted_curves(a, k_1, radius, opening, E, load_v_notches())
    else:
        G, sigma = sharp_curves(a[1:], k_1, 0.0, opening, E)
        G, sigma = np.append(0.0, G), np.append(np.inf, sigma)
    strength = stress_over_crack(a[None], sigma[None], average)[0]
    return 1 / critical_load(a, G, strength, material.G_c, material.sigma_c)[0]
