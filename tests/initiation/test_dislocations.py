"""Cracks as dislocations in a model of the uncracked part: as good as full FEA, and true to the laws it obeys."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from slmm import failure_indices
from slmm.criteria.status import Status
from slmm.initiation.body_fitted import solve_body_fitted
from slmm.initiation.by_dislocations import SAFETY
from slmm.initiation.dislocations import DislocationModel
from slmm.initiation.full_fea import full_fea_curves
from slmm.initiation.meta_model import polynomial_matrix
from slmm.initiation.surroundings import Boundary, Trial, answers_of_surroundings
from slmm.mechanics.stress import principal_stress
from slmm.scene import gallery

pytest.importorskip("netgen")

LOBED = gallery.lobed_notch().outlines[0]
CURVATURES = LOBED.curvatures(np.linspace(0, LOBED.length, 2000))
LOBE, BETWEEN = (LOBED.points(LOBED.length / 1999 * k) for k in (CURVATURES.argmin(), CURVATURES.argmax()))
EDGE_NOTCH = {"holes": [{"shape": "circle", "center": [0.0, 50.0], "radius": 12.0}]}
SHEARED = (50 + 20 * np.cos(0.6), 50 - 20 * np.sin(0.6))

#: scene, mouth, longest crack, and the limits of the errors of G_inc and sigma_I
CASES = {
    "circle, edges held": (
        gallery.circular_hole(load={"strain": [0.0, 0.05, 0.1]}),
        SHEARED,
        6.0,
        2e-3,
        1.5e-3,  # from mesh to mesh 0.02 to 0.11 %
    ),
    "circle, top moved": (gallery.circular_hole(load={"displacement": 1.0}), (70, 50), 6.0, 2e-3, 1e-3),
    "circle, edges pulled": (gallery.circular_hole(load={"stress": 10.0}), (70, 50), 6.0, 2e-3, 1e-3),
    "ellipse, tip": (gallery.elliptic_hole(), (70, 50), 3.0, 2e-3, 1e-3),
    "between two holes": (gallery.two_holes(10.0), (45, 50), 4.0, 2e-3, 1e-3),
    "notch in the edge": (
        gallery.circular_hole(load={"displacement": 1.0}, **EDGE_NOTCH),
        (12, 50),
        15.0,
        2e-3,
        1e-3,
    ),
    "lobe": (gallery.lobed_notch(), LOBE, 3.0, 2e-3, 1e-3),
    # where the surface is flat or bends the other way a straight edge is corrected, and its bend to first order
    "ellipse, flat side": (
        gallery.elliptic_hole(load={"strain": [0.1, 0.0, 0.0]}),
        (50, 60),
        10.0,
        6e-3,
        1e-3,
    ),
    "between lobes": (gallery.lobed_notch((0.1, 0.1, 0.0)), BETWEEN, 1.9, 6e-3, 1e-3),
}


def model_of(scene, angle_max=0.12):
    return DislocationModel(scene, solve_body_fitted(scene, angle_max=angle_max))


def curves_at(model, mouth, a_max, outline=0):
    outline = model.scene.outlines[outline]
    s = float(outline.project(np.array([mouth], dtype=float))[0])
    return model.curves([model.trial(outline, s, a_max)])[0]


def G_at(curves, a):
    """G_inc at lengths a, through G_inc/a."""
    return CubicSpline(np.log(curves.a), curves.G_inc / curves.a)(np.log(a)) * a


def sigma_at(curves, eta):
    return principal_stress(polynomial_matrix(curves.eta, eta) @ curves.sigma)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_curves_are_those_of_full_fea(case):
    scene, mouth, a_max, of_G, of_sigma = CASES[case]
    ours = curves_at(model_of(scene), mouth, a_max)
    assert ours.a[-1] == pytest.approx(a_max)
    s = float(scene.outlines[0].project(np.array([mouth], dtype=float))[0])
    reference = full_fea_curves(scene, 0, s, a_max, n_lengths=5, a_min=a_max / 8)
    error = np.abs(G_at(ours, reference.a) / reference.G_inc - 1)
    assert error.max() < of_G
    stress = np.abs(sigma_at(ours, reference.eta) - reference.sigma_I) / np.abs(reference.sigma_I).max()
    assert stress.max() < of_sigma
    # what the curves say about themselves
    estimate = np.interp(reference.a, ours.a, ours.G_inc_change / ours.G_inc)
    assert np.all(error < SAFETY * estimate + 5e-4)


def test_one_crack_at_a_hole_in_a_large_plate_has_the_published_stress_intensity():
    model = model_of(gallery.circular_hole(1.0, 300.0, load={"stress": 1.0}))
    curves = curves_at(model, (151, 150), 2.5)
    L = np.array([0.1, 0.2, 0.5, 1.0, 2.0])
    energy = CubicSpline(np.log(curves.a), np.log(curves.a * curves.G_inc))
    K2 = model.model.fine.E * np.exp(energy(np.log(L))) * energy(np.log(L), 1) / L
    published = [2.7727, 2.3746, 1.7279, 1.3061, 1.0307]  # high-order finite elements, 1e-4
    assert np.sqrt(K2 / (np.pi * L)) == pytest.approx(published, rel=2e-3)


@pytest.fixture(scope="module")
def lobed():
    return model_of(gallery.lobed_notch((0.02, 0.1, 0.05)), 0.25)


def test_the_answer_of_the_surroundings_is_symmetric_and_small_in_a_large_plate():
    model = solve_body_fitted(gallery.circular_hole(1.0, 200.0, load={"stress": 1.0}), angle_max=0.25)
    trial = Trial(np.array([101.0, 100.0]), np.array([1.0, 0.0]), 1.0, 1.0, -1.0)
    (D,) = answers_of_surroundings(Boundary(model.fine), [trial])
    # symmetric by reciprocity; beside what a dipole does at its own distance, E/(4 pi d^2), nothing
    assert np.abs(D).max() < 3e-3 * model.fine.E / (4 * np.pi * trial.depths.max() ** 2)
    assert np.array_equal(D, D.T)


def test_supports_that_hold_the_edges_answer_an_opening_with_pressure():
    """Held edges keep a crack from opening, free ones let it; the lateral edges are free in neither comparison."""
    trial = Trial(np.array([70.0, 50.0]), np.array([1.0, 0.0]), 6.0, 20.0, -0.05)
    opening = {}
    for load in ({"strain": [0.0, 0.1, 0.0]}, {"displacement": 1.0}, {"stress": 1.0}):
        model = solve_body_fitted(gallery.circular_hole(load=load), angle_max=0.25)
        (D,) = answers_of_surroundings(Boundary(model.coarse), [trial])
        opening[next(iter(load))] = np.diag(D)[: len(trial.depths)]
    assert np.all(opening["strain"] < opening["displacement"])
    assert np.all(opening["displacement"] < opening["stress"])


@pytest.mark.parametrize("factor", [0.01, 7.0])
def test_scaling_the_part_scales_the_crack(factor):
    one, other = (
        curves_at(model_of(gallery.circular_hole(10.0 * k, 60.0 * k), 0.25), (40 * k, 30 * k), 4.0 * k)
        for k in (1.0, factor)
    )
    assert other.a == pytest.approx(factor * one.a)
    # the mesher's own tolerances do not scale: the meshes differ
    assert other.G_inc == pytest.approx(factor * one.G_inc, rel=1e-3)
    assert other.sigma == pytest.approx(one.sigma, rel=1e-3, abs=1e-3 * np.abs(one.sigma).max())


def test_turning_the_part_turns_the_stress_and_leaves_the_energy():
    holes = [[{"shape": "ellipse", "center": [50, 50], "semi_axes": axes}] for axes in ((20, 10), (10, 20))]
    loads = [{"strain": [0.02, 0.1, 0.03]}, {"strain": [0.1, 0.02, -0.03]}]
    upright, turned = (
        curves_at(model_of(gallery.elliptic_hole(holes=h, load=load)), mouth, 4.0)
        for h, load, mouth in zip(holes, loads, ((69.0, 53.0), (47.0, 69.0)), strict=True)
    )
    assert turned.G_inc == pytest.approx(upright.G_inc, rel=1e-3)
    scale = np.abs(upright.sigma).max()
    assert turned.sigma[:, [1, 0, 2]] * [1, 1, -1] == pytest.approx(upright.sigma, abs=1e-3 * scale)


def test_energy_is_a_quadratic_form_of_the_load():
    """G(1 + 2) + G(1 - 2) = 2 G(1) + 2 G(2), as long as no faces meet."""

    def G(*strain):
        scene = gallery.lobed_notch(strain)
        return curves_at(model_of(scene, 0.3), LOBE, 3.0)

    one, two = np.array([0.01, 0.1, 0.0]), np.array([0.0, 0.02, 0.06])
    plus, minus, first, second = (G(*load) for load in (one + two, one - two, one, two))
    assert min(curves.G_inc.min() for curves in (plus, minus, first, second)) > 0
    assert plus.G_inc + minus.G_inc == pytest.approx(2 * first.G_inc + 2 * second.G_inc, rel=1e-9)
    assert plus.sigma - minus.sigma == pytest.approx(
        2 * second.sigma, rel=1e-9, abs=1e-9 * np.abs(plus.sigma).max()
    )


def test_twice_the_load_releases_four_times_the_energy_and_its_opposite_none():
    def curves(e_yy):
        return curves_at(model_of(gallery.circular_hole(10.0, 60.0, e_yy), 0.25), (40, 30), 4.0)

    one, double, opposite = (curves(e_yy) for e_yy in (0.1, 0.2, -0.1))
    assert double.G_inc == pytest.approx(4 * one.G_inc, rel=1e-9)
    assert np.all(opposite.G_inc == 0) and opposite.sigma == pytest.approx(-one.sigma)


def test_stiffness_and_thickness_only_scale_the_energy(lobed):
    scene = lobed.scene.with_(
        material={"E": 1000.0, "nu": 0.35, "sigma_c": 1.0, "G_c": 1.0}, plate={"thickness": 9.0}
    )
    soft, hard = (curves_at(model_of(s, 0.25), LOBE, 3.0) for s in (scene, lobed.scene))
    assert soft.G_inc * 2.96 == pytest.approx(hard.G_inc, rel=1e-6)


def test_the_change_covers_what_a_finer_mesh_changes():
    """At nineteen of twenty lengths, as of every estimate, and nearly at the others."""
    used = []
    for mouth in (LOBE, (50.0, 50.0 + 22.0), (28.0, 50.0)):
        rough, fine = (curves_at(model_of(gallery.lobed_notch(), angle), mouth, 3.0) for angle in (0.2, 0.06))
        assert rough.a[-1] == fine.a[-1]
        allowed = SAFETY * (rough.G_inc_change + fine.G_inc_change) + 1e-3 * fine.G_inc
        used.append(np.abs(rough.G_inc - fine.G_inc) / allowed)
        assert np.all(fine.G_inc_change <= rough.G_inc_change.max())
    assert np.quantile(used, 0.95) <= 1 and np.max(used) < 1.1


def test_a_notch_is_compared_with_its_osculating_circle_or_with_a_straight_edge(lobed):
    def radius(scene, mouth):
        model = lobed if scene is None else DislocationModel(scene, lobed.model)
        outline = model.scene.outlines[0]
        s = float(outline.project(np.array([mouth], dtype=float))[0])
        return model.trial(outline, s, 1.0).radius

    assert radius(gallery.circular_hole(), (70, 50)) == pytest.approx(20.0, rel=1e-4)
    assert radius(gallery.elliptic_hole(), (70, 50)) == pytest.approx(5.0, rel=1e-3)
    # the osculating circle of the flat side, 40 mm, does not fit into the hole
    assert np.isinf(radius(gallery.elliptic_hole(), (50, 60)))
    assert radius(None, LOBE) == pytest.approx(-1 / CURVATURES.min(), rel=1e-3)
    assert np.isinf(radius(None, BETWEEN))


def test_a_crack_reaches_no_farther_than_its_mirror_has_room():
    """The mirrored crack of a flat side has to lie in the notch; a slot of 3 mm has room for 2 mm of it."""
    slot = [{"shape": "rectangle", "center": [50.0, 50.0], "size": [40.0, 3.0], "corner_radius": 1.0}]
    scene = gallery.circular_hole(holes=slot, load={"strain": [0.1, 0.0, 0.0]})
    model = model_of(scene, 0.3)
    curves = curves_at(model, (50.0, 51.5), 10.0)
    assert np.isinf(curves.radius) and 1.0 < curves.a[-1] <= 2.0
    short, long = (
        failure_indices(
            scene.with_(
                material={"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "G_c": l_ch * 70.5**2 / 2960},
                analysis={"points": [[50.0, 51.5]]},
            ),
            "dislocations",
        ).isel(position=0)
        for l_ch in (0.3, 20.0)
    )
    assert str(short.status.values) == "ok" and short.crack_length < 2.0
    assert str(long.status.values) == Status.BEYOND_DISLOCATIONS and np.isnan(long.failure_index)


def test_corners_and_crack_tips_get_a_status():
    result = failure_indices(
        gallery.square_hole(analysis={"points": [[65.0, 65.0], [65.0, 50.0]]}), "dislocations"
    )
    assert str(result.status.values[0]) == Status.NO_DISLOCATIONS and np.isnan(result.failure_index[0])
    assert str(result.status.values[1]) == "ok" and np.isnan(result.reference_radius[0])
    tip = failure_indices(gallery.edge_crack(), "dislocations").isel(position=0)
    assert str(tip.status.values) == Status.NO_DISLOCATIONS


@pytest.mark.slow
def test_failure_indices_of_a_notch_are_those_of_full_fea():
    scene = gallery.lobed_notch(analysis={"points": [LOBE.tolist(), [28.0, 50.0]]})
    ours, reference = (failure_indices(scene, method) for method in ("dislocations", "full-fea"))
    difference = np.abs(ours.failure_index - reference.failure_index)
    # the second index is a sixth of the first: errors do not fall with it
    assert np.all(difference < 3e-4 * reference.failure_index.max())
    assert np.all(difference < ours.failure_index_error + reference.failure_index_error)
    assert ours.crack_length.values == pytest.approx(reference.crack_length.values, rel=5e-3)
    assert np.all(ours.failure_index_error > 0)
    assert np.all(ours.failure_index_error < 3e-3 * ours.failure_index)


def test_where_a_notch_leaves_a_held_edge_dislocations_are_right_or_have_no_value():
    """There the body is a wedge that is held on one side; by full FEA the index is 26.85 at 0.1 mm, 30.7 beside it."""
    material = {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "G_c": 0.3 * 70.5**2 / 2960.0}
    scene = gallery.v_notch(60.0, 0.5, material=material, load={"strain": [0.1, 0.1, 0.0]})
    outline = scene.outlines[0]
    s = np.linspace(0.0, outline.length, 100_001)
    leaves = s[np.flatnonzero(np.diff(np.sign(outline.points(s)[:, 0])) > 0)[0]]
    points = outline.points(leaves + np.array([0.3, 0.1, 0.03, 0.01, 0.003]))
    assert np.all(points[:, 0] > 0)
    result = failure_indices(scene.with_(analysis={"points": points.tolist()}), "dislocations")
    truth = np.array([15.4544, 26.8537, 29.5377, 30.3411, 30.6292])
    index, error = result.failure_index.values, result.failure_index_error.values
    assert np.all(np.isnan(index) | (np.abs(index - truth) <= error + 1e-3 * truth))
    assert np.isfinite(index[0])
