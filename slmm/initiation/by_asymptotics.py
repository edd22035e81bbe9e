"""Methods asymptotics and griffith: stress intensities at corners, round roots and crack tips (thesis 3.3.4.3)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from slmm.criteria.griffith import energy_release_rate
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.fem.plate_model import PlateModel
from slmm.fem.triangulation import MesherError
from slmm.initiation.asymptotics import GeneralisedIntensity, generalised_intensity, sharp_curves
from slmm.initiation.blunted import blunted_curves, intensity_from_root_stress
from slmm.initiation.body_fitted import BodyFitted, solve_body_fitted
from slmm.initiation.evidence import Stands
from slmm.initiation.task import Answer, Task
from slmm.initiation.v_notch_table import load_v_notches
from slmm.initiation.v_notches import VNotch, notch_at
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.stress import principal_stress
from slmm.mechanics.williams import exponents, singular_exponent
from slmm.part.checks import TOLERANCE

#: annulus on which Williams' series is fitted, in clear distances: nearer to the tip the mesh is poor, farther away
#: the series converges slowly; chosen
ANNULUS = (0.05, 0.2)
#: exponents of either symmetry; the next one of a crack has 0.2^4 of the first one's weight at the annulus'
#: rim; chosen
TERMS = 8
#: size of the coarser mesh's elements at a sharp tip, in clear distances, and along a round root, in its
#: radii; both chosen (validation/chart.py)
TIP_SIZE, ROOT_SIZE = 1e-3, 0.1
#: longest crack that meets the notch alone, in clear distances: up to here the failure index is good to 5 %; chosen
ASYMPTOTIC = 0.1
#: by how much the stress beside a root may exceed the root's before the load counts as mixed; chosen
BESIDE_ROOT = 0.01
#: stress across the bisector over all stress there at which a notch or crack closes; above, it is round-off
CLOSES = -1e-3

ROOT_2_PI = float(np.sqrt(2 * np.pi))


class Intensities(NamedTuple):
    """Generalised stress intensities and estimates of their errors, MPa mm^(1 - lambda)."""

    k_1: float
    k_2: float
    error_1: float
    error_2: float


def by_asymptotics(task: Task) -> Answer:
    """Answer of matched asymptotics.

    At a corner of an outline and at a crack tip, Williams' series is fitted to the displacements around it. At the
    root of a rounded V- or U-notch, k_1 follows from the stress there, if the root is where it is largest. Energy and
    stress along the bisector are then those of the notch alone. That holds while the crack is short against the
    notch's clear distance: the energy errs by about the ratio of the two, the failure index by half of it. Where the
    crack is longer than `ASYMPTOTIC` clear distances, there is a status in place of a value. At a crack tip the length
    that counts is that over which the stress exceeds the strength; a material with a higher strength has a shorter one.
    """
    answer = Answer.empty(task.n, "asymptotics")
    notches = find_notches(task, answer, range(task.n))
    model = notch_model(task, answer, notches)
    if model is not None:
        for k, (i, notch) in enumerate(notches.items()):
            task.progress(0.5 + 0.5 * k / len(notches), f"notch {k + 1} of {len(notches)}")
            curves = (_at_root if notch.radius else _at_tip)(task, answer, i, model, notch)
            if curves is not None:
                _judge(task, answer, i, notch, curves)
    for k, outline in enumerate(task.scene.outlines):
        smooth = task.smooth & (task.where.hole == k)
        answer.column("curvature")[smooth] = 0.5 * outline.curvatures(task.where.s[smooth])
    return answer


def by_griffith(task: Task) -> Answer:
    """Answer of Griffith's criterion with Irwin's G = (K_I^2 + K_II^2)/E at crack tips.

    Where K_I is negative the faces press on each other. Contact and friction then also decide about K_II, and the
    model has neither: such a tip gets a status.
    """
    answer = Answer.empty(task.n, "griffith")
    answer.status[:] = Status.NO_CRACK
    material = task.scene.material
    notches = find_notches(task, answer, np.flatnonzero(task.where.tip >= 0).tolist())
    model = notch_model(task, answer, notches)
    if model is not None:
        for i, notch in notches.items():
            found = intensities(model, notch, task)
            note_intensities(answer, i, notch, found)
            if is_closed(found, notch):
                answer.status[i] = Status.CLOSES
                continue
            K = ROOT_2_PI * np.array([max(found.k_1, 0.0), found.k_2])
            change = ROOT_2_PI * np.array([found.error_1, found.error_2])
            G = energy_release_rate(float(K[0]), float(K[1]), material)
            answer.column("energy_release_rate")[i] = G
            error = 2 * np.abs(K) @ change / (K @ K)
            mouth = np.zeros((1, 1))
            curves = PathCurves(mouth, mouth + G, mouth + np.inf, mouth + error, mouth)
            answer.weigh(np.array([i]), curves, task, Status.NO_CRACK)
    return answer


def find_notches(task: Task, answer: Answer, rows: Iterable[int]) -> dict[int, VNotch]:
    """The notches at some of the positions; those without one get their status."""
    found = {}
    for i in rows:
        try:
            notch = notch_at(task.scene, task.where, i)
        except ValueError as error:
            answer.status[i] = str(error)
            continue
        if notch.clear <= TOLERANCE * task.scene.size:
            answer.status[i] = Status.TOUCHED
        else:
            found[i] = notch
    return found


def notch_model(task: Task, answer: Answer, notches: dict[int, VNotch]) -> BodyFitted | None:
    """The uncracked part on meshes that are fine at the notches; None where there are none or the mesher fails."""
    if not notches:
        return None
    task.progress(0.0, "body-fitted model")
    points, sizes = [], []
    for notch in notches.values():
        points.append(notch.on_root(np.linspace(-1.0, 1.0, 17)))
        size = ROOT_SIZE * notch.radius if notch.radius else TIP_SIZE * notch.clear
        sizes.append(np.full(len(points[-1]), size))
    try:
        model = solve_body_fitted(task.scene, fine_at=(np.concatenate(points), np.concatenate(sizes)))
    except MesherError as error:
        answer.status[list(notches)] = Status.NO_MESH.of(error)
        return None
    answer.note(**model.described)
    return model


def intensities(model: BodyFitted, notch: VNotch, task: Task) -> Intensities:
    """Intensities of a sharp notch or a crack, from Williams' series in the displacements of both meshes."""

    def fitted(plate: PlateModel) -> GeneralisedIntensity:
        inner, outer = (share * notch.clear for share in ANNULUS)
        E, nu = task.scene.material.plane_stress_equivalent
        return generalised_intensity(
            plate.displacement, notch.root, notch.direction, notch.opening, E, nu, inner, outer, terms=TERMS
        )

    coarse, fine = fitted(model.coarse), fitted(model.fine)
    # the displacements' error is cubic in the element size, but for a small part that comes from the tip and is linear
    (k_1, k_2), change = extrapolated(
        np.array([coarse.k_1, coarse.k_2]), np.array([fine.k_1, fine.k_2]), order=3
    )
    error_1, error_2 = 7 / 4 * np.abs(change) + [fine.error_1, fine.error_2]
    return Intensities(float(k_1), float(k_2), float(error_1), float(error_2))


def note_intensities(answer: Answer, i: int, notch: VNotch, found: Intensities) -> None:
    """Put what is known of a notch into its columns."""
    is_crack = notch.opening == 0 and notch.radius == 0
    for name, value in (
        ("k_1", found.k_1),
        ("k_2", found.k_2),
        ("singular_exponent", singular_exponent(notch.opening)),
        ("opening_angle", np.degrees(notch.opening)),
        ("stress_intensity_I", ROOT_2_PI * found.k_1 if is_crack else np.nan),
        ("stress_intensity_II", ROOT_2_PI * found.k_2 if is_crack else np.nan),
    ):
        answer.column(name)[i] = value


def is_closed(found: Intensities, notch: VNotch) -> bool:
    """Whether the stress across the bisector is compressive, beyond round-off."""
    r = ANNULUS[1] * notch.clear
    across = found.k_1 * r ** (singular_exponent(notch.opening) - 1)
    shear = found.k_2 * r ** (singular_exponent(notch.opening, symmetric=False) - 1)
    return bool(across < CLOSES * np.hypot(across, shear))


#: curves (1, n) at crack lengths (1, n) from 0, mm
CurvesAt = Callable[[np.ndarray], PathCurves]


def _at_tip(task: Task, answer: Answer, i: int, model: BodyFitted, notch: VNotch) -> CurvesAt | None:
    """Curves at a corner or a crack tip; None where there are none and the status says why."""
    found = intensities(model, notch, task)
    note_intensities(answer, i, notch, found)
    E = task.scene.material.plane_stress_equivalent[0]
    if is_closed(found, notch):
        tension = sharp_curves(notch.clear, found.k_1, found.k_2, notch.opening, E)[1]
        if notch.opening == 0 or tension > 0:
            answer.status[i] = Status.CLOSES if notch.opening == 0 else Status.COMPRESSED
            return None
    return lambda a: tip_curves(a, model, notch, found, E)


def tip_curves(a: np.ndarray, model: BodyFitted, notch: VNotch, found: Intensities, E: float) -> PathCurves:
    """Curves (1, n) on the bisector of a sharp notch or a crack at lengths a (1, n) from 0, mm."""
    crack = a[0, 1:]
    G, sigma = sharp_curves(crack, found.k_1, found.k_2, notch.opening, E)
    k_1, k_2 = found.k_1 + found.error_1, found.k_2 + np.copysign(found.error_2, found.k_2)
    G_changed, sigma_changed = sharp_curves(crack, k_1, k_2, notch.opening, E)
    neglected = neglected_stress(crack, model, notch, found, E)
    with np.errstate(divide="ignore", invalid="ignore"):
        G_error = np.where(G > 0, G_changed / G - 1, 0.0) + np.maximum(neglected, crack / notch.clear)
        sigma_error = np.abs(sigma_changed / sigma - 1) + neglected
    mouth = G[0] if notch.opening == 0 else 0.0  # a crack releases the same at any length
    return PathCurves(
        a,
        np.append(mouth, G)[None],
        np.append(np.copysign(np.inf, sigma[0]), sigma)[None],
        np.append(G_error[0], G_error)[None],
        np.append(sigma_error[0], sigma_error)[None],
    )


def neglected_stress(
    a: np.ndarray, model: BodyFitted, notch: VNotch, found: Intensities, E: float
) -> np.ndarray:
    """Share of the stress (n,) that the further terms of Williams' series have at distances a (n,) from a tip.

    It is seen in the model's stress across the annulus; towards the tip it falls as the next term does.
    """
    inner, outer = (share * notch.clear for share in ANNULUS)
    r = np.linspace(inner, outer, 7)
    seen = principal_stress(model.stress(notch.root + r[:, None] * notch.direction)[0])
    first = sharp_curves(r, found.k_1, found.k_2, notch.opening, E)[1]
    following = (exponents(notch.opening, symmetric, 2)[1].real for symmetric in (True, False))
    gap = min(following) - singular_exponent(notch.opening)
    return np.max(np.abs(seen / first - 1) * (outer / r) ** gap) * (a / outer) ** gap


def _at_root(task: Task, answer: Answer, i: int, model: BodyFitted, notch: VNotch) -> CurvesAt | None:
    """Curves at the root of a rounded notch; None where there are none and the status says why."""
    stress, error = root_stress(task, i, model, notch)
    above = stress_above_root(stress)
    if above > BESIDE_ROOT:
        answer.status[i] = Status.MIXED.of(above)
        return None
    table = load_v_notches()
    answer.note(v_notches=table.checksum)
    k_1 = intensity_from_root_stress(stress[1], notch.radius, notch.opening, table)
    k_1_error = error / abs(stress[1])
    note_intensities(answer, i, notch, Intensities(k_1, np.nan, abs(k_1) * k_1_error, np.nan))
    E = task.scene.material.plane_stress_equivalent[0]

    def curves(a: np.ndarray) -> PathCurves:
        G, sigma = blunted_curves(a[0], k_1, notch.radius, notch.opening, E, table)
        seen, seen_error = model.stress(notch.root + a[0, :, None] * notch.direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            sigma_error = np.abs(principal_stress(seen) / sigma - 1) + seen_error / np.abs(sigma)
        G_error = 2 * k_1_error + np.maximum(sigma_error, a[0] / notch.clear)
        return PathCurves(a, G[None], sigma[None], G_error[None], sigma_error[None])

    return curves


def root_stress(task: Task, i: int, model: BodyFitted, notch: VNotch) -> tuple[np.ndarray, float]:
    """Stress along the surface (3,) at a round root and half way from there to either flank, and its error, MPa."""
    outline = task.scene.outlines[task.where.hole[i]]
    s = outline.project(notch.on_root(np.array([-0.5, 0.0, 0.5])))
    sigma, error = model.stress(outline.points(s))
    (xx, yy, xy), (tx, ty) = sigma.T, outline.tangents(s).T
    return xx * tx**2 + yy * ty**2 + 2 * xy * tx * ty, float(error[1])


def stress_above_root(stress: np.ndarray) -> float:
    """By how much the largest stress beside a root exceeds the root's, as a share of that.

    Parameters
    ----------
    stress : ndarray (3,)
        Beside the root, at it and beside it, equally far away, MPa. A parabola goes through them.

    Examples
    --------
    >>> x = np.array([-1.0, 0.0, 1.0])
    >>> round(stress_above_root(10.0 - (x - 0.2) ** 2), 4)
    0.004
    """
    before, root, after = stress
    if root <= 0:
        return 0.0 if max(before, after) <= 0 else float("inf")
    slope, fall = 0.5 * (after - before), root - 0.5 * (before + after)
    return float(slope**2 / (4 * fall) / root) if fall > 0 else float("inf")


def _judge(task: Task, answer: Answer, i: int, notch: VNotch, curves_at: CurvesAt) -> None:
    """Apply the criterion, once more with a longer path where it ends too early; refuse what is not asymptotic."""
    longest = ASYMPTOTIC * notch.clear
    beyond = Status.NOT_ASYMPTOTIC.of("{}", f"{ASYMPTOTIC:g}", f"{notch.clear:.3g}")
    # any crack would do that the stress allows at the critical load: what lies farther inside the body decides which
    stands = Stands.below(np.array([longest]), beyond, any_length=True)
    for paths in (task.paths, task.paths.lengthened()):
        curves = curves_at(path_points(paths.longest[i : i + 1]))
        answer.judge(np.array([i]), curves, task, Status.BEYOND_PATH, stands=stands)
        if answer.status[i] != Status.BEYOND_PATH:
            break
    if answer.status[i] != Status.OK:
        # what the notch alone does say stays, as bounds
        within = min(task.paths.longest[i], longest)
        answer.curves.put(np.array([i]), curves_at(path_points(np.array([within]))))
