"""Boundary integrals against closed forms, published stress intensities and laws that hold for any part."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.boundary.model import BoundaryModel
from slmm.boundary.panelling import TooManyPointsError
from slmm.boundary.stretches import COARSE
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, ellipse, polygon
from slmm.scene.loading import Affine, Condition, Loading, plate_edges, plate_loading

PMMA = Material.from_name("PMMA")
STRAINED = Material(PMMA.E, PMMA.nu, PMMA.sigma_c, PMMA.G_c, "plane strain")
INSIDE = np.array([[10.0, 20.0], [20.0, 30.0], [39.99, 59.9], [0.001, 0.002], [33.0, 60.0]])


def hole(x, y, r):
    return Outline.through(circle((x, y), r))


def intensities(part, loading, **orders):
    return BoundaryModel(part, PMMA, loading, **orders).stress_intensities()


@pytest.mark.parametrize("material", [PMMA, STRAINED])
@pytest.mark.parametrize("load", [{"strain": (0.001, 0.002, 0.003)}, {"displacement": 0.1}, {"stress": 7.0}])
def test_a_plate_without_notches_is_uniform_up_to_its_edges(material, load):
    model = BoundaryModel(Part.plate(40.0, 60.0), material, plate_loading(40.0, 60.0, **load))
    stress = model.stress(INSIDE)
    assert stress == pytest.approx(
        np.tile(stress[0], (len(INSIDE), 1)), rel=1e-4, abs=5e-5 * np.abs(stress).max()
    )
    E, nu = material.plane_stress_equivalent
    if "strain" in load:
        e_xx, e_yy, g_xy = load["strain"]
        exact = [
            E / (1 - nu**2) * (e_xx + nu * e_yy),
            E / (1 - nu**2) * (e_yy + nu * e_xx),
            E / 2 / (1 + nu) * g_xy,
        ]
        x, y = INSIDE.T
        u = np.column_stack([e_xx * x + g_xy * y / 2, g_xy * x / 2 + e_yy * y])
        assert model.displacement(INSIDE) == pytest.approx(u, abs=1e-9)
    else:
        exact = [0.0, load.get("stress", E * 0.1 / 60.0), 0.0]
    assert stress[0] == pytest.approx(exact, rel=1e-6, abs=1e-5)


def test_kirschs_stress_at_any_depth():
    """Half width 1000 radii, which leaves 2.5e-6."""
    W = 2000.0
    model = BoundaryModel(
        Part.plate(W, W, [hole(W / 2, W / 2, 1.0)]), PMMA, plate_loading(W, W, stress=1.0), p=10
    )
    depth = np.array([0.0, 1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.5, 2.0])
    stress = model.stress(np.column_stack([W / 2 + 1 + depth, np.full(8, W / 2)]))
    q = 1 / (1 + depth)
    assert stress[:, 1] == pytest.approx(1 + q**2 / 2 + 1.5 * q**4, rel=1e-5)
    assert stress[:, 0] == pytest.approx(1.5 * (q**2 - q**4), abs=3e-5)


def test_inglis_stress_at_the_end_of_an_ellipse():
    W = 8000.0
    slot = Outline.through(ellipse((W / 2, W / 2), (4.0, 1.0), 0.0))
    model = BoundaryModel(Part.plate(W, W, [slot]), PMMA, plate_loading(W, W, stress=1.0), p=10)
    assert model.stress(np.array([[W / 2 + 4.0, W / 2]]))[0, 1] == pytest.approx(9.0, rel=1e-4)


def test_an_edge_crack_a_centre_crack_and_inclined_ones():
    edge = Part.plate(40.0, 240.0, cracks=[[(0, 120), (20, 120)]])
    K = intensities(edge, plate_loading(40.0, 240.0, stress=1.0))
    assert K[0, 0] / np.sqrt(20 * np.pi) == pytest.approx(2.824578, rel=1e-5)
    assert abs(K[0, 1]) < 1e-8
    centre = Part.plate(40.0, 120.0, cracks=[[(10, 60), (30, 60)]])
    K = intensities(centre, plate_loading(40.0, 120.0, stress=1.0))
    assert K[:, 0] / np.sqrt(10 * np.pi) == pytest.approx(1.1867, rel=1e-4)
    W, angle = 2000.0, np.radians(37.0)
    arm = np.array([np.cos(angle), np.sin(angle)])
    inclined = Part.plate(W, W, cracks=[[W / 2 - arm, W / 2 + arm]])
    K = intensities(inclined, plate_loading(W, W, stress=1.0)) / np.sqrt(np.pi)
    assert K[:, 0] == pytest.approx(np.cos(angle) ** 2, rel=5e-6)
    assert np.abs(K[:, 1]) == pytest.approx(np.sin(angle) * np.cos(angle), rel=5e-6)


@pytest.mark.parametrize(("length", "F"), [(0.01, 3.2932), (0.1, 2.7727), (0.5, 1.7279), (2.0, 1.0307)])
def test_one_crack_at_a_circular_hole(length, F):
    W = 200.0
    part = Part.plate(2 * W, 2 * W, [hole(W, W, 1.0)], [[(W + 1, W), (W + 1 + length, W)]])
    K = intensities(part, plate_loading(2 * W, 2 * W, stress=1.0))
    assert K[0, 0] / np.sqrt(np.pi * length) == pytest.approx(F, rel=2e-4)


def test_a_star_of_cracks_that_meet_or_cross():
    a, side = 5.0, 800.0
    c = side / 2
    along, up, down = [(c - a, c), (c + a, c)], [(c, c), (c, c + a)], [(c, c), (c, c - a)]
    bottom, right, top, left = plate_edges(side, side)
    pulls = ((bottom, (0.0, -1.0)), (right, (1.0, 0.0)), (top, (0.0, 1.0)), (left, (-1.0, 0.0)))
    loading = Loading(tuple(Condition(*edge, traction=traction) for edge, traction in pulls))
    for cracks in ([along, up, down], [along, [up[1], down[1]]]):
        K = intensities(Part.plate(side, side, cracks=cracks), loading)
        assert K[:, 0] / np.sqrt(np.pi * a) == pytest.approx(0.8636, rel=1e-4)


@pytest.mark.parametrize(
    ("ratio", "angle", "share", "G"),
    [
        (0.25, 25.86, 1e-3, 1.10119),
        (0.25, 25.86, 1e-4, 1.10762),
        (0.5, 42.03, 1e-3, 1.31475),
        (0.5, 42.03, 1e-4, 1.32774),
    ],
)
def test_a_short_kink_releases_what_amestoy_and_leblond_say(ratio, angle, share, G):
    W, slope = 2000.0, np.arctan(ratio)
    arm = np.array([np.cos(slope), np.sin(slope)])
    loading = plate_loading(W, W, stress=1.0)
    tip = W / 2 + arm
    straight = intensities(Part.plate(W, W, cracks=[[W / 2 - arm, tip]]), loading)[1]
    turned = slope - np.sign(straight[1]) * np.radians(angle)
    kink = tip + share * np.array([np.cos(turned), np.sin(turned)])
    kinked = intensities(Part.plate(W, W, cracks=[[W / 2 - arm, tip, kink]]), loading)[1]
    assert (kinked @ kinked) / (straight @ straight) == pytest.approx(G, rel=3e-4)


THREE = [hole(28, 44, 6.0), hole(46, 30, 5.0), hole(70, 60, 7.0)]


def test_orders_converge_and_reactions_balance():
    part = Part.plate(100.0, 100.0, THREE, [[(0, 50), (15, 50)]])
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    models = [BoundaryModel(part, PMMA, loading, p, c) for p, c in ((6, 4), (8, 6), (12, 8))]
    K = np.array([model.stress_intensities()[0] for model in models])
    assert np.abs(K[0] - K[2]).max() < 2e-4 * K[2, 0] and np.abs(K[1] - K[2]).max() < 1e-6 * K[2, 0]
    bottom, top = loading
    force = [model.reaction(top)[1] for model in models]
    assert force[1] == pytest.approx(force[2], rel=1e-7)
    assert models[2].reaction(bottom) == pytest.approx(-models[2].reaction(top), rel=1e-5)


def test_the_energy_that_growth_releases_is_that_of_the_intensities():
    """G = -1/2 u^2 dS/da at a given displacement."""
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    top = loading.conditions[1]
    forces, step = [], 0.05
    for a in (15.0 - step, 15.0, 15.0 + step):
        model = BoundaryModel(Part.plate(100.0, 100.0, THREE, [[(0, 50), (a, 50)]]), PMMA, loading, 10, 8)
        forces.append(model.reaction(top)[1])
        if a == 15.0:
            K = model.stress_intensities()[0]
    released = 0.5 * 0.1 * (forces[0] - forces[2]) / (2 * step)
    assert released == pytest.approx(K @ K / PMMA.E, rel=1e-4)


@settings(max_examples=5, deadline=None)
@given(
    x=st.floats(20, 80),
    y=st.floats(20, 80),
    radius=st.floats(3, 12),
    e=st.tuples(*[st.floats(-1e-2, 1e-2)] * 3),
)
def test_turning_mirroring_and_scaling_do_the_same_to_the_stress(x, y, radius, e):
    def stress(part, loading, points):
        return BoundaryModel(part, PMMA, loading).stress(np.atleast_2d(points))[0]

    if max(np.abs(e)) < 1e-4:
        return
    at = np.array([x + 1.3 * radius, y])
    e_xx, e_yy, g = e
    own = stress(Part.plate(100.0, 100.0, [hole(x, y, radius)]), plate_loading(100.0, 100.0, e), at)
    turned = stress(
        Part.plate(100.0, 100.0, [hole(100 - y, x, radius)]),
        plate_loading(100.0, 100.0, (e_yy, e_xx, -g)),
        [100 - at[1], at[0]],
    )
    scale = 1e-5 * PMMA.E * np.abs(e).max()
    assert turned[[1, 0, 2]] * [1, 1, -1] == pytest.approx(own, abs=scale)
    mirrored = stress(
        Part.plate(100.0, 100.0, [hole(100 - x, y, radius)]),
        plate_loading(100.0, 100.0, (e_xx, e_yy, -g)),
        [100 - at[0], at[1]],
    )
    assert mirrored * [1, 1, -1] == pytest.approx(own, abs=scale)
    larger = stress(
        Part.plate(700.0, 700.0, [hole(7 * x, 7 * y, 7 * radius)]), plate_loading(700.0, 700.0, e), 7 * at
    )
    assert larger == pytest.approx(own, abs=scale)


def test_half_a_plate_with_its_plane_of_symmetry_is_the_whole():
    whole = Part.plate(80.0, 100.0, [hole(20, 30, 6.0), hole(60, 30, 6.0)])
    half = Part.plate(40.0, 100.0, [hole(20, 30, 6.0)])
    bottom, _, top, _ = plate_edges(40.0, 100.0)
    right = ((40.0, 0.0), (40.0, 100.0))
    pulled = (Condition(*bottom, traction=(0.0, -1.0)), Condition(*top, traction=(0.0, 1.0)))
    symmetric = Loading((Condition(*right, (Affine(), None)), *pulled))
    points = np.array([[26.0, 30.0], [39.0, 60.0], [5.0, 90.0]])
    one = BoundaryModel(half, PMMA, symmetric).stress(points)
    both = BoundaryModel(whole, PMMA, plate_loading(80.0, 100.0, stress=1.0)).stress(points)
    assert one == pytest.approx(both, abs=2e-5)


def test_a_sharp_corner_has_its_power_law():
    """Stress goes with r^(0.5445 - 1) on the bisector of a right angle."""
    square = Outline.of_pieces(polygon(np.array([[35.0, 35], [65, 35], [65, 65], [35, 65]]), 0.0))
    model = BoundaryModel(
        Part.plate(100.0, 100.0, [square]), PMMA, plate_loading(100.0, 100.0, (1e-3, 1e-3, 0.0))
    )
    r = np.array([0.01, 0.02])
    stress = model.stress(65 + r[:, None] / np.sqrt(2) * [1, 1])[:, 1]
    assert np.log(stress[1] / stress[0]) / np.log(2) == pytest.approx(-0.4555, abs=0.005)


def test_a_crack_that_grows_keeps_the_factorised_body_and_gives_what_a_new_one_does():
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    part = Part.plate(100.0, 100.0, THREE, [[(0, 50), (5, 50)]])
    model = BoundaryModel(part, PMMA, loading)
    for tip in ((7, 50.2), (9, 50.3), (11, 50.1), (13, 50)):
        part = part.grown(0, tip)
        before, model = model, model.with_cracks_of(part)
        assert model.body is before.body
        fresh = BoundaryModel(part, PMMA, loading)
        assert model.stress_intensities() == pytest.approx(fresh.stress_intensities(), rel=1e-5, abs=1e-4)
    # next to a hole panels there have to be shorter
    near = part.grown(0, (21.5, 46))
    assert model.with_cracks_of(near).body is not model.body
    # so they have where a crack gets a new mouth
    assert model.with_cracks_of(part.with_crack([(100, 20), (90, 20)])).body is not model.body


def test_notches_across_the_edges():
    """A half circle in the edge of half a plane (3.065), and beside a plane of symmetry, where it is Kirsch's hole."""
    W = 400.0
    notched = Part.plate(W, 2 * W, [hole(0, W, 1.0)])
    model = BoundaryModel(notched, PMMA, plate_loading(W, 2 * W, stress=1.0), p=10)
    assert model.stress(np.array([[1.0, W]]))[0, 1] == pytest.approx(3.065, rel=2e-3)
    # with a plane of symmetry in place of the free edge it is Kirsch's hole
    bottom, _, top, left = plate_edges(W, 2 * W)
    symmetric = Loading(
        (
            Condition(*left, (Affine(), None)),
            Condition(*bottom, traction=(0.0, -1.0)),
            Condition(*top, traction=(0.0, 1.0)),
        )
    )
    model = BoundaryModel(notched, PMMA, symmetric, p=10)
    assert model.stress(np.array([[1.0, W]]))[0, 1] == pytest.approx(3.0, rel=1e-4)


def test_what_it_does_not_do_is_refused(monkeypatch):
    loading = plate_loading(100.0, 100.0, stress=1.0)
    with pytest.raises(ValueError, match="the cracks sever the part, in 2 pieces"):
        BoundaryModel(Part.plate(100.0, 100.0, cracks=[[(0, 50), (100, 50)]]), PMMA, loading)
    with monkeypatch.context() as lower, pytest.raises(TooManyPointsError, match="at most 100 can be solved"):
        lower.setattr("slmm.boundary.panelling.MOST_POINTS", 100)
        BoundaryModel(
            Part.plate(40.0, 40.0, [hole(20, 20, 5.0)]), PMMA, plate_loading(40.0, 40.0, stress=1.0)
        )
    bottom, *_ = plate_edges(100.0, 100.0)
    one_sided = Loading((Condition(*bottom, traction=(0.0, -1.0)),))
    with pytest.raises(ValueError, match=r"does not balance: forces of \(0, -100\) N"):
        BoundaryModel(Part.plate(100.0, 100.0), PMMA, one_sided)


HELD_BELOW = Loading(
    (
        Condition((0.0, 0.0), (100.0, 0.0), (Affine(), Affine())),
        Condition((100.0, 60.0), (100.0, 80.0), traction=(3.0, 1.0)),
    )
)


@pytest.mark.parametrize("p", [7, 8])
def test_what_holds_a_plate_beside_a_deep_notch_balances_its_load(p):
    """Forces in the corners of a held edge, which hardly any point feels, once made a tenth of the reaction."""
    notch = Outline.of_pieces(polygon([(5.5, 101.0), (39.5, 7.0), (41.5, 7.0), (75.5, 101.0)], 0.9))
    plate = Part.plate(100.0, 100.0, [notch])
    model = BoundaryModel(plate, PMMA, HELD_BELOW, p)
    assert model.reaction(HELD_BELOW.conditions[0]) == pytest.approx([-60.0, -20.0], abs=2e-3)
    at = np.array([[80.0, 70.0], [80.0, 30.0]])
    assert model.stress(at) == pytest.approx(BoundaryModel(plate, PMMA, HELD_BELOW, 12).stress(at), abs=5e-5)
    # tractions grow towards the clamped corners and nowhere else
    middle = np.abs(model.panels.z - 70.0) < 20.0
    assert np.abs(model.t[middle]).max() < 20.0


def test_a_clamped_corner_leaves_intensities_exact():
    cracked = Part.plate(100.0, 100.0).with_crack(np.array([[26.0, 43.2], [32.4, 50.3]]))
    wanted = intensities(cracked, HELD_BELOW, p=12, crack_p=10)
    assert intensities(cracked, HELD_BELOW) == pytest.approx(wanted, abs=1e-5 * np.abs(wanted).max())


@pytest.mark.parametrize("opening", [5.0, 20.0, 60.0])
def test_a_crack_that_is_folded_back_tells_its_error(opening):
    turn = np.deg2rad(180.0 - opening)
    back = np.array([50.0 + 6.0 * np.cos(turn), 40.0 + 6.0 * np.sin(turn)])
    cracked = Part.plate(100.0, 100.0).with_crack(np.array([[40.0, 40.0], [50.0, 40.0], back]))
    model = BoundaryModel(cracked, PMMA, HELD_BELOW)
    K, error = model.with_error(BoundaryModel.stress_intensities)
    true = intensities(cracked, HELD_BELOW, p=12, crack_p=12)
    assert np.all(np.linalg.norm(K - true, axis=1) < error)
    assert error.max() < 0.02 * np.abs(true).max()


def test_the_estimated_error_covers_a_low_order_and_is_not_far_too_wide():
    part = Part.plate(10.0, 40.0).with_crack(np.array([[0.0, 20.0], [5.0, 20.0]]))
    model = BoundaryModel(part, PMMA, plate_loading(10.0, 40.0, stress=1.0), p=4, crack_p=3)
    K, error = model.with_error(BoundaryModel.stress_intensities)
    off = abs(K[0, 0] / np.sqrt(5.0 * np.pi) - 2.8246) * np.sqrt(5.0 * np.pi)
    assert off < error[0] < 10 * off


def test_the_finer_model_of_a_crack_that_grows_keeps_its_body():
    part = Part.plate(10.0, 20.0).with_crack(np.array([[0.0, 10.0], [3.0, 10.0]]))
    model = BoundaryModel(part, PMMA, plate_loading(10.0, 20.0, stress=1.0))
    before = model.finer
    grown = model.with_cracks_of(part.grown(0, (3.5, 10.1)))
    assert grown.finer.body is before.body
    assert grown.finer.cracks.p == before.cracks.p


def test_a_model_that_grew_is_the_one_made_at_once():
    """Rows and columns of panels that stay are those of the panels anew, coarse or fine towards mouths."""
    part = Part.plate(100.0, 100.0, THREE, [[(0, 50), (10, 50)]])
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    grown = BoundaryModel(part, PMMA, loading)
    for end in ((12.0, 50.2), (14.0, 50.1), (16.0, 50.3)):
        part = part.grown(0, end)
        grown = grown.with_cracks_of(part)
    K = grown.stress_intensities()
    assert pytest.approx(BoundaryModel(part, PMMA, loading).stress_intensities(), rel=1e-9) == K
    coarse = BoundaryModel(part, PMMA, loading, grading=COARSE)
    assert coarse.panels.n < grown.panels.n
    assert coarse.stress_intensities() == pytest.approx(K, abs=5e-5 * K[0, 0])


def test_work_is_force_times_displacement_and_cracks_open():
    part = Part.plate(100.0, 100.0, THREE, [[(0, 50), (15, 50)]])
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    model = BoundaryModel(part, PMMA, loading)
    assert model.work == pytest.approx(0.1 * model.reaction(loading.conditions[1])[1], rel=1e-9)
    assert model.opening()[1].min() > 0
