"""Loaded crack faces: J and K are those of the loads put on the outer edges in their place (superposition)."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cracked_square import CRACK, MIDDLE, STEEL, loaded, on_faces, square, tension

from slmm.fracture.loading import AGREE, OK, crack_tip_loading
from slmm.mechanics.element_results import linear_elastic
from slmm.mechanics.elements import element_named
from slmm.results.read_results import read_element_results

CASES = Path(__file__).parents[3] / "shared" / "cases"
SHEAR, BENDING = 40.0, 3.0


def of_case(name):
    return read_element_results(CASES / name, elasticity=STEEL)


def less_stress(results, sigma):
    """The results less the field of a uniform stress xx, yy, xy: its tractions then act on the faces, turned round."""
    xx, yy, xy = sigma
    E, nu = STEEL.E, STEEL.nu
    e_xx = ((1 - nu**2) * xx - nu * (1 + nu) * yy) / E
    e_yy = ((1 - nu**2) * yy - nu * (1 + nu) * xx) / E
    H = np.array([[e_xx, xy / STEEL.mu], [0.0, e_yy]])
    return linear_elastic(results.points, results.cells, results.u - results.points @ H.T, results.elasticity)


def averaged(results):
    """The results with stresses and energies as files have them: means at the nodes, carried to the points."""
    stress, energy = {}, {}
    for name, nodes in results.cells.items():
        element = element_named(name)
        bilinear = [
            np.column_stack([np.ones(len(a)), a, a.prod(axis=1)]) for a in (element.points, element.nodes)
        ]
        outwards = bilinear[1] @ np.linalg.pinv(bilinear[0])
        for given, found in ((results.stress, stress), (results.energy, energy)):
            values = np.einsum("np,ep...->en...", outwards, given[name])
            total, count = np.zeros((len(results.points), *values.shape[2:])), np.bincount(nodes.ravel())
            np.add.at(total, nodes, values)
            mean = total / count.reshape(-1, *[1] * (total.ndim - 1))
            found[name] = np.einsum("pn,en...->ep...", element.shape(element.points), mean[nodes])
    return replace(results, stress=stress, energy=energy)


def test_the_case_with_pressure_on_its_faces_has_the_loading_of_the_case_in_tension():
    tip = crack_tip_loading(of_case("06-face-pressure/facepressure.vtu")).isel(tip=0)
    whole = crack_tip_loading(of_case("05-half-model/whole.vtu")).isel(tip=0)
    assert tip.status.item() == OK
    assert float(tip.G) == pytest.approx(23.68, abs=0.005)
    assert float(tip.K_I) == pytest.approx(2320.0, abs=0.5)
    assert float(tip.spread) < 2e-4
    np.testing.assert_allclose(tip.J_x, whole.J_x, rtol=1e-6)
    np.testing.assert_allclose(tip.K_I, whole.K_I, rtol=1e-6)


@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE4R", "CPE6", "CPE8", "CPE8R"])
@pytest.mark.parametrize("sigma", [(0.0, 100.0, 0.0), (30.0, 0.0, 40.0), (50.0, 100.0, -60.0)])
def test_a_uniform_stress_may_act_on_the_faces_or_outside_in_all_elements(kind, sigma):
    outside = loaded(*square(kind, 40 if kind == "CPE3" else 20), tension())
    inside = less_stress(outside, sigma)
    one, other = (crack_tip_loading(results).isel(tip=0) for results in (outside, inside))
    # one point an element does not integrate a uniform stress times the field of the tip exactly
    tolerance = 3e-4 if kind in ("CPE3", "CPE4R") else 1e-6
    np.testing.assert_allclose(other.K_I, one.K_I, rtol=tolerance)
    np.testing.assert_allclose(other.K_II, one.K_II, atol=tolerance * float(one.K_I))
    # J's own strains next to the tip are those of the elements, and quadratic in them: not to round-off
    np.testing.assert_allclose(other.G, one.G, rtol=2e-3 if kind[3] in "68" else 3e-2)
    assert other.status.item() == OK


def test_in_mixed_mode_j_across_the_crack_has_the_tractions_part_too():
    points, cells = square("CPE8", 40)
    both = loaded(points, cells, tension(), (lambda X: not on_faces(X), lambda x, y, n: SHEAR * n[:, ::-1]))
    one = crack_tip_loading(both).isel(tip=0)
    other = crack_tip_loading(less_stress(both, (20.0, 100.0, SHEAR))).isel(tip=0)
    exact = np.array([one.K_I**2 + one.K_II**2, -2 * one.K_I * one.K_II]) / STEEL.E_prime
    assert abs(exact[1]) > 0.2 * exact[0]
    for tip in (one, other):
        np.testing.assert_allclose([tip.G, tip.J_across], exact, atol=0.01 * exact[0])
    np.testing.assert_allclose([other.K_I, other.K_II], [one.K_I, one.K_II], rtol=1e-6)


@pytest.mark.parametrize("kind", ["CPE4", "CPE6", "CPE8"])
def test_a_linear_pressure_is_a_bending_outside(kind):
    """sigma_yy = a (x - 10 mm) on the top and the bottom, or the same as pressure on the faces."""
    points, cells = square(kind, 24)
    a = BENDING

    def bending(x, y, n):
        return a * (x - CRACK / 2) * n * [0, 1]

    def pressure(x, y, n):
        return -a * (x - CRACK / 2) * n

    outside = loaded(points, cells, tension(), (tension()[0], bending))
    inside = loaded(points, cells, tension(), (on_faces, pressure))
    one, other = (crack_tip_loading(results).isel(tip=0) for results in (outside, inside))
    # both are discretised: the field between them is quadratic in u
    tolerance = 2e-2 if kind == "CPE4" else 3e-3
    np.testing.assert_allclose(other.K_I, one.K_I, rtol=tolerance)
    np.testing.assert_allclose(other.G, one.G, rtol=2 * tolerance)
    assert float(other.spread) < tolerance
    assert other.status.item() == OK


@pytest.mark.parametrize("begin", [0.0, 6.3, 12.0])
@pytest.mark.parametrize("kind", ["CPE4", "CPE6", "CPE8"])
def test_contours_agree_when_a_part_of_the_faces_is_loaded(kind, begin):
    """Pressure and shear behind a place that may lie within an edge: inner contours know nothing of it."""
    points, cells = square(kind, 40)

    def some(x, y, n):
        here = (CRACK - x > begin) & (CRACK - x < begin + 5.0)
        return np.where(here, -80.0 * n + 30.0 * n[:, ::-1] * [1, -1], 0.0)

    tip = crack_tip_loading(loaded(points, cells, (on_faces, some)), contours=8).isel(tip=0)
    assert tip.status.item() == OK
    assert float(tip.K_I) > 100.0
    assert float(tip.spread) < (2e-2 if kind == "CPE4" else 5e-3)
    Irwin = float(tip.K_I**2 + tip.K_II**2) / STEEL.E_prime
    assert float(tip.G) == pytest.approx(Irwin, rel=3e-2 if kind == "CPE4" else 2e-2)


def test_friction_along_the_faces_alone_makes_mode_two():
    points, cells = square("CPE8", 40)
    outside = loaded(points, cells, (lambda X: not on_faces(X), lambda x, y, n: SHEAR * n[:, ::-1]))
    faces = loaded(points, cells, (on_faces, lambda x, y, n: -SHEAR * n[:, ::-1]))
    one, other = (crack_tip_loading(results).isel(tip=0) for results in (outside, faces))
    assert abs(float(one.K_II)) > 100.0
    np.testing.assert_allclose(other.K_II, one.K_II, rtol=1e-6)
    np.testing.assert_allclose(other.G, one.G, rtol=2e-3)


@pytest.mark.parametrize("method", ["linear", "dbf"])
def test_stresses_that_are_means_of_nodes_serve_as_well(method):
    """They are not in balance around the tip: taken as they are, they made G 0.2 N/mm."""
    for case in ("05-half-model/whole.vtu", "06-face-pressure/facepressure.vtu"):
        tip = crack_tip_loading(replace(averaged(of_case(case)), method=method)).isel(tip=0)
        assert float(tip.G) == pytest.approx(23.68, rel=5e-3)
        assert float(tip.K_I) == pytest.approx(2320, rel=3e-3)
        assert float(tip.spread) < 5e-3


def test_contours_in_a_field_of_body_forces_say_that_they_differ():
    """Displacements of a crack and of a body force, as thermal strains look from outside, too."""
    results = of_case("05-half-model/whole.vtu")
    x = results.points[:, :1] - 20.0
    u = results.u + 3e-5 * x**2 * [1.0, 0.0] + 6e-5 * x * (results.points[:, 1:] - MIDDLE) * [0.0, 1.0]
    tip = crack_tip_loading(linear_elastic(results.points, results.cells, u, STEEL)).isel(tip=0)
    assert float(tip.spread) > AGREE
    assert tip.status.item().startswith("contours differ by ")
    assert "body forces" in tip.status.item()
