"""Matched asymptotics and Griffith's criterion against fracture mechanics and full FEA."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation.full_fea import full_fea_curves
from slmm.mechanics.williams import release_coefficient, singular_exponent
from slmm.scene import gallery

E, NU, SIGMA_C = 2960.0, 0.35, 70.5


def material(l_ch, **more):
    """PMMA with another Irwin's length, mm."""
    return {"E": E, "nu": NU, "sigma_c": SIGMA_C, "G_c": l_ch * SIGMA_C**2 / E, **more}


def notch(opening, radius=0.0, l_ch=0.773, **changes):
    """A V-notch, 10 mm deep, looked at in its root alone."""
    changes = {"analysis": {"points": [[10.0, 60.0]]}, "material": material(l_ch), **changes}
    return gallery.v_notch(opening=opening, radius=radius, **changes)


def crack(*points, **changes):
    return gallery.edge_crack(cracks=[{"points": [list(point) for point in points]}], **changes)


def answer(scene, method="asymptotics", **kwargs):
    return failure_indices(scene, method, **kwargs).isel(position=0)


def difference(scene, method="asymptotics"):
    """Relative difference of the failure index to full FEA, the error that is estimated, and a_c."""
    ours, reference = answer(scene, method), answer(scene, "full-fea")
    assert (str(ours.status.values), str(reference.status.values)) == ("ok", "ok")
    index = float(ours.failure_index)
    return (
        index / float(reference.failure_index) - 1,
        float(ours.failure_index_error) / index,
        float(reference.crack_length),
    )


@pytest.mark.parametrize(("share", "F"), [(0.1, 1.1892), (0.3, 1.6599), (0.5, 2.8246)])
def test_edge_crack_has_the_stress_intensity_of_the_handbook(share, F):
    a = 40.0 * share
    found = answer(crack((0.0, 80.0), (a, 80.0), plate={"height": 160.0}), "griffith")
    K = F * 10.0 * np.sqrt(np.pi * a)  # high-order finite elements, good to 1e-4
    assert float(found.stress_intensity_I) == pytest.approx(K, rel=3e-4)
    assert abs(float(found.stress_intensity_II)) < 1e-4 * K
    assert float(found.energy_release_rate) == pytest.approx(K**2 / E, rel=6e-4)


@pytest.mark.parametrize(
    "points",
    [((0.0, 60.0), (10.0, 60.0)), ((0.0, 60.0), (6.0, 60.0), (10.0, 64.0))],
    ids=["straight", "kinked"],
)
def test_short_crack_at_a_tip_releases_griffiths_energy(points):
    """Thesis 3.3.4.3: G_inc(0) is the differential energy release rate of a crack."""
    scene = crack(*points)
    found = answer(scene, "griffith")
    tip, before = np.array(points[-1]), np.array(points[-2])
    fea = full_fea_curves(
        scene, start=tip, direction=tip - before, a_max=0.5, a_min=0.05, n_lengths=6, singular=True
    )
    at_tip = np.polynomial.Polynomial.fit(fea.a, fea.G_inc, 3)(0.0)
    assert float(found.energy_release_rate) == pytest.approx(at_tip, rel=5e-4)
    assert float(found.failure_index) == pytest.approx(np.sqrt(at_tip / scene.material.G_c), rel=2.5e-4)
    assert (float(found.crack_length), str(found.governed_by.values)) == (0.0, "energy")


def test_at_a_crack_tip_asymptotics_says_what_griffith_says():
    scene = crack((0.0, 60.0), (6.0, 60.0), (10.0, 64.0))
    one, other = answer(scene, curves=True), answer(scene, "griffith")
    assert float(one.failure_index) == pytest.approx(float(other.failure_index), rel=1e-9)
    assert (float(one.crack_length), str(one.governed_by.values)) == (0.0, "energy")
    assert float(one.G_inc[0]) == pytest.approx(float(other.energy_release_rate), rel=1e-9)


def test_tip_of_a_crack_is_asymptotic_only_when_the_crack_is_long():
    """The coupled criterion lets a new crack run over l_ch/2 pi; the energy of that is K^2/E up to l_ch/a."""
    apart, estimated, a_c = difference(crack((0.0, 60.0), (5.0, 60.0)))
    assert a_c == pytest.approx(0.773 / (2 * np.pi), rel=0.01)
    assert abs(apart) < estimated < 0.02
    short = answer(crack((0.0, 60.0), (1.0, 60.0)))
    assert "longer than 0.1 of the clear distance around the notch, 1 mm" in str(short.status.values)
    assert np.isnan(float(short.failure_index))


def test_plane_strain_has_the_same_stress_intensity_and_less_energy():
    scene = crack((0.0, 60.0), (10.0, 60.0))
    stress, strain = (
        answer(scene.with_(material=material(0.773, state=state)), "griffith")
        for state in ("plane stress", "plane strain")
    )
    assert float(strain.stress_intensity_I) == pytest.approx(float(stress.stress_intensity_I), rel=5e-5)
    ratio = float(strain.energy_release_rate / stress.energy_release_rate)
    assert ratio == pytest.approx(1 - NU**2, rel=1e-4)


@pytest.mark.parametrize("method", ["griffith", "asymptotics"])
def test_closed_crack_gets_no_value(method):
    found = answer(crack((0.0, 60.0), (10.0, 60.0), load={"stress": -10.0}), method)
    assert "its faces would touch" in str(found.status.values)
    assert np.isnan(float(found.failure_index)) and float(found.stress_intensity_I) < 0


def test_griffith_needs_a_crack_tip():
    scene = notch(60.0, cracks=[{"points": [[40.0, 30.0], [30.0, 30.0]]}])
    scene = scene.with_(analysis={"points": [[10.0, 60.0], [30.0, 30.0]]})
    found = failure_indices(scene, "griffith")
    assert [str(status) for status in found.status.values] == [
        "no crack: Griffith's criterion needs a crack tip",
        "ok",
    ]


@pytest.mark.parametrize("opening", [30.0, 60.0, 90.0, 120.0])
def test_sharp_notch_fails_as_in_full_fea_while_the_crack_is_short(opening):
    # a_c = G_c/(B sigma_c^2) is to be 3 % of the depth
    l_ch = 0.3 * release_coefficient(np.radians(opening))
    apart, estimated, a_c = difference(notch(opening, l_ch=l_ch))
    assert a_c == pytest.approx(0.3, rel=0.05)
    assert abs(apart) < estimated < 0.03


def test_corner_under_mixed_mode_fails_as_in_full_fea():
    scene = gallery.square_hole(analysis={"points": [[65.0, 65.0]]})
    found = answer(scene)
    assert abs(float(found.k_2)) > 0.2 * float(found.k_1)
    apart, estimated, _ = difference(scene)
    assert abs(apart) < estimated < 0.01


@pytest.mark.parametrize(("opening", "radius"), [(0.0, 2.0), (90.0, 0.5)])
def test_rounded_notch_fails_as_in_full_fea(opening, radius):
    apart, estimated, _ = difference(notch(opening, radius))
    assert abs(apart) < estimated < 0.03


def test_rounded_notch_turns_into_the_sharp_one():
    sharp = float(answer(notch(60.0, l_ch=2.0)).failure_index)
    less = [1 - float(answer(notch(60.0, radius, l_ch=2.0)).failure_index) / sharp for radius in (0.4, 0.1)]
    assert 0 < less[1] < less[0] / 2 < 0.06


def test_crack_beyond_asymptotics_gets_no_value():
    found = answer(notch(90.0, l_ch=8.0))
    assert "longer than 0.1 of the clear distance around the notch, 10 mm" in str(found.status.values)
    assert np.isnan(float(found.failure_index))


def test_scaling_the_part_and_the_material_scales_the_crack():
    small = answer(notch(90.0))
    tip = [30.0, 180.0]
    large = answer(
        gallery.v_notch(
            plate={"width": 120.0, "height": 360.0},
            holes=[{"shape": "v-notch", "tip": tip, "direction": 0.0, "opening": 90.0}],
            material=material(3 * 0.773),
            analysis={"points": [tip]},
        )
    )
    assert float(large.failure_index) == pytest.approx(float(small.failure_index), rel=1e-4)
    assert float(large.crack_length) == pytest.approx(3 * float(small.crack_length), rel=1e-3)
    grown = 3 ** (1 - singular_exponent(np.pi / 2))
    assert float(large.k_1) == pytest.approx(grown * float(small.k_1), rel=2e-4)


def test_sheared_square_hole_fails_at_the_corners_that_open():
    corners = [[65.0, 65.0], [35.0, 65.0], [35.0, 35.0], [65.0, 35.0]]
    scene = gallery.square_hole(load={"strain": [0.0, 0.0, 0.01]}, analysis={"points": corners})
    found = failure_indices(scene, "asymptotics")
    assert (found.status == "ok").all()
    index = found.failure_index.values
    assert index[0] == pytest.approx(index[2], abs=1e-3) and index[1] == pytest.approx(index[3], rel=1e-3)
    larger = index.max()
    assert larger > 1 and index.min() == 0.0


def test_root_that_is_not_stressed_most_is_refused():
    """A square hole pulled along its sides: its round corners are stressed most beside their bisectors."""
    corner = 65.0 - 6.0 * (1 - np.sqrt(0.5))
    found = answer(gallery.rounded_square(analysis={"points": [[corner, corner]]}))
    assert str(found.status.values).startswith("mixed mode")
    assert np.isnan(float(found.failure_index))


def test_corner_that_a_crack_starts_from_is_no_notch_any_more():
    scene = gallery.square_hole(
        cracks=[{"points": [[65.0, 65.0], [68.0, 68.0]]}], analysis={"points": [[65.0, 65.0], [68.0, 68.0]]}
    )
    touched, tip = failure_indices(scene, "asymptotics").status.values
    assert "something else touches" in str(touched) and str(tip) == "ok"
