"""Methods that look at the stress alone: right where they apply, and a status where they do not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from slmm import Material, failure_indices
from slmm.criteria.distances import line_distance, line_stress, point_distance, point_stress
from slmm.criteria.status import Status
from slmm.initiation.by_stress import distance_to_tips
from slmm.scene import gallery

pytest.importorskip("netgen")

PMMA = Material.from_name("PMMA")
#: l_ch of thesis Eq. 3.16, in which Taylor's distances are a half and two
L_CH = PMMA.irwin_length / np.pi

METHODS = ("rankine", "mises", "point", "line")


def bending(h):
    """Stress over the height of a beam in bending, 1 at its lower side."""
    eta = np.linspace(0.0, h, 801)
    return eta, 1 - 2 * eta / h


def test_distances_are_half_and_twice_the_characteristic_length():
    assert point_distance(PMMA) == pytest.approx(L_CH / 2)
    assert line_distance(PMMA) == pytest.approx(2 * L_CH)


def point(eta, sigma):
    return float(point_stress(eta, sigma, np.array([point_distance(PMMA)]))[0])


def line(eta, sigma):
    return float(line_stress(eta, sigma, np.array([line_distance(PMMA)]))[0])


@pytest.mark.parametrize(("method", "height"), [(point, 1.0), (line, 2.0)])
def test_beams_that_a_critical_distance_never_breaks_get_no_value(method, height):
    """Cornetti et al.: the point lies on the neutral axis, or tension and compression cancel (thesis 3.3.1)."""
    assert np.isnan(method(*bending(height * L_CH)))
    assert np.isnan(method(*bending(0.9 * height * L_CH)))


@given(height=st.floats(4.1, 100.0))
def test_in_high_beams_the_critical_distances_give_their_closed_forms(height):
    eta, sigma = bending(height * L_CH)
    assert point(eta, sigma) == pytest.approx(1 - 1 / height)
    assert line(eta, sigma) == pytest.approx(1 - 2 / height)


@given(low=st.floats(0.1, 1.0), high=st.floats(1.0, 10.0))
def test_both_lie_between_the_stresses_on_the_path(low, high):
    eta = np.linspace(0.0, 3 * L_CH, 50)
    sigma = np.linspace(high, low, 50)
    for method in (point, line):
        assert low <= method(eta, sigma) <= high


def test_a_path_that_ends_before_the_distance_gives_no_value():
    eta = np.linspace(0.0, 0.4 * L_CH, 20)
    assert np.isnan(point(eta, np.ones(20))) and np.isnan(line(eta, np.ones(20)))


@pytest.fixture(scope="module")
def hole():
    """A hole in a wide plate under 10 MPa, whose stresses Kirsch knows; stress on a mesh."""
    r = 2.0
    points = [[200 + r, 200.0], [200.0, 200.0 + r]]
    return gallery.circular_hole(
        r, 400.0, load={"stress": 10.0}, analysis={"points": points, "local_model": "body-fitted"}
    )


def test_each_method_gives_kirschs_stress(hole):
    def kirsch(eta):
        q = 2.0 / (2.0 + eta)
        return 10.0 * (1 + q**2 / 2 + 1.5 * q**4)

    depth = np.linspace(0.0, line_distance(hole.material), 401)
    expected = {
        "rankine": kirsch(0.0),
        "mises": kirsch(0.0),
        "point": kirsch(point_distance(hole.material)),
        "line": np.trapezoid(kirsch(depth), depth) / depth[-1],
    }
    for method in METHODS:
        side = failure_indices(hole, method).isel(position=0)
        assert float(side.failure_index) == pytest.approx(expected[method] / 70.5, rel=5e-3), method
        true = abs(float(side.failure_index) - expected[method] / 70.5)
        assert true < float(side.failure_index_error) + 1e-3 * float(side.failure_index)


def test_the_pole_is_in_compression_which_only_mises_minds(hole):
    index, status = {}, {}
    for method in METHODS:
        pole = failure_indices(hole, method).isel(position=1)
        index[method], status[method] = float(pole.failure_index), str(pole.status.values)
    # the free surface carries a little, as a share of the stress at the sides, on any mesh
    assert index["mises"] == pytest.approx(10.0 / 70.5, rel=0.01)
    assert index["rankine"] == pytest.approx(0.0, abs=1e-3 * 30.0 / 70.5)
    # below it there is compression
    for method in ("point", "line"):
        assert index[method] == 0 or status[method] == Status.TOO_DEEP


def test_in_plane_strain_the_stress_out_of_the_plane_lowers_mises():
    material = {"E": 2960.0, "nu": 0.3, "sigma_c": 70.5, "K_Ic": 1.96, "state": "plane strain"}
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]]}, material=material)
    index = {m: float(failure_indices(scene, m).failure_index[0]) for m in ("rankine", "mises")}
    # uniaxial along the surface: sqrt(1 - nu + nu^2)
    assert index["mises"] / index["rankine"] == pytest.approx(np.sqrt(0.79), rel=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_corners_and_crack_tips_have_no_strength(method):
    for scene in (
        gallery.edge_crack(),
        gallery.square_hole(analysis={"points": [[65.0, 65.0]], "local_model": "body-fitted"}),
    ):
        result = failure_indices(scene, method)
        assert result.status.values.tolist() == [Status.SINGULAR] and np.isnan(result.failure_index[0])


def test_beside_a_corner_the_stress_of_the_mesh_is_no_value():
    points = [[65.0, 65.0 - d] for d in (0.01, 5.0)]
    scene = gallery.square_hole(analysis={"points": points, "local_model": "body-fitted"})
    near, far = failure_indices(scene, "rankine").status.values
    assert near == Status.NEAR_SINGULAR and far == "ok"


def test_distance_to_corners_and_tips():
    points = np.array([[65.0, 60.0], [10.0, 61.0]])
    assert distance_to_tips(gallery.square_hole(), points)[0] == pytest.approx(5.0)
    assert distance_to_tips(gallery.edge_crack(10.0), points)[1] == pytest.approx(1.0)
    assert np.all(np.isinf(distance_to_tips(gallery.circular_hole(), points)))


def test_a_distance_longer_than_the_ligament_does_not_apply():
    tough = {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "G_c": 2 * 70.5**2 / 2960}
    scene = gallery.two_holes(
        0.5, material=tough, analysis={"points": [[49.75, 50.0]], "local_model": "body-fitted"}
    )
    assert line_distance(scene.material) > 0.5
    result = failure_indices(scene, "line")
    assert result.status.values.tolist() == [Status.TOO_DEEP]


@hypothesis_settings(max_examples=4)
@given(factor=st.floats(0.01, 100.0))
def test_indices_follow_the_load(hole, factor):
    one, other = (
        failure_indices(hole.with_(load={"stress": stress}), "line").failure_index.values
        for stress in (10.0, 10.0 * factor)
    )
    assert other == pytest.approx(factor * one, rel=1e-6, nan_ok=True)
