"""Configurational forces: the published tool's numbers, and the derivative of the energy that they are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from random_elements import neo_hooke, random_elements

from slmm.fracture.configurational_forces import (
    METHODS,
    compute_CF,
    compute_CS,
    compute_F,
    compute_P,
    nodal_configurational_forces,
)
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.elements import ALIASES, ELEMENTS

PUBLISHED = ("mbf", "dbf")


@pytest.mark.parametrize("name", [name for name in ELEMENTS if name.startswith("C")])
def test_every_quantity_is_that_of_the_published_tool(name):
    conforce = pytest.importorskip("conforce.cf_c")
    X, U, S, e = random_elements(name, 50)

    def agree(ours, theirs):
        assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()

    agree(compute_F(X, U, name), conforce.compute_F(X, U, name))
    agree(compute_P(X, U, S, name), conforce.compute_P(X, U, S, name))
    for method in PUBLISHED:
        agree(compute_CS(X, U, S, e, name, method), conforce.compute_CS(e, X, U, S, name, method))
        agree(compute_CF(X, U, S, e, name, method), conforce.compute_CF(e, X, U, S, name, method))


def energy_of(X, U, name):
    """Of each element (el,)."""
    element = ELEMENTS[name]
    density, _ = neo_hooke(compute_F(X, U, name))
    jacobian = np.einsum("eni,qnj->eqij", X, element.gradient_at_points)
    return (density * np.linalg.det(jacobian)) @ element.weights


def derivative_by_places(energy, X, U, kept_place=False):
    """Of an element's energy by the places of its nodes (n, d), with their displacements or their new places kept."""
    result, step = np.empty(X.shape[1:]), 1e-3
    for node, i in np.ndindex(*result.shape):
        W = []
        for h in (-2, -1, 1, 2):
            moved, displaced = X.copy(), U.copy()
            moved[0, node, i] += h * step
            if kept_place:
                displaced[0, node, i] -= h * step
            W.append(energy(moved, displaced))
        result[node, i] = (W[0] - 8 * W[1] + 8 * W[2] - W[3]) / (12 * step)
    return result


@pytest.mark.parametrize("method", PUBLISHED)
@pytest.mark.parametrize("name", ELEMENTS)
def test_force_is_the_derivative_of_the_energy_by_the_place_of_the_node(name, method):
    """At fixed displacement (dbf) or at fixed place in the deformed body (mbf)."""
    X, U, _, _ = random_elements(name, 1, seed=3)
    energy, S = neo_hooke(compute_F(X, U, name))
    forces = compute_CF(X, U, S, energy, name, method)[0]
    expected = derivative_by_places(lambda X, U: energy_of(X, U, name)[0], X, U, kept_place=method == "mbf")
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-8 * np.abs(forces).max() + 1e-9)


@pytest.mark.parametrize("name", ELEMENTS)
def test_linear_force_is_the_derivative_of_the_linear_elastic_energy(name):
    X, U, _, _ = random_elements(name, 1, seed=4)
    element, material = ELEMENTS[name], Elasticity(2.3, 0.3)

    def energy(X, U):
        H = compute_F(X, U, name)[0] - np.eye(element.dimension)
        density = np.einsum("qij,qij->q", material.stress(H), H) / 2
        return density * np.linalg.det(np.einsum("ni,qnj->qij", X[0], element.gradient_at_points))

    H = compute_F(X, U, name) - np.eye(element.dimension)
    S = material.stress(H)
    forces = compute_CF(X, U, S, np.einsum("eqij,eqij->eq", S, H) / 2, name, "linear")[0]
    expected = derivative_by_places(lambda X, U: energy(X, U) @ element.weights, X, U)
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-8 * np.abs(forces).max())


def neo_hooke_in_plane_stress(F):
    """Energy density, Cauchy stress and stretch across the plate, at which nothing pulls there."""
    mu, lame = 1.3, 2.1
    det = np.linalg.det(F)
    stretch = np.ones_like(det)
    for _ in range(30):
        across = mu * (stretch**2 - 1) + lame * np.log(det * stretch)
        stretch = stretch - across / (2 * mu * stretch + lame / stretch)
    full = np.zeros((*F.shape[:-2], 3, 3))
    full[..., :2, :2], full[..., 2, 2] = F, stretch
    energy, S = neo_hooke(full)
    assert np.abs(S[..., 2, 2]).max() < 1e-14
    return energy, S[..., :2, :2], stretch


@pytest.mark.parametrize("method", PUBLISHED)
@pytest.mark.parametrize("name", [name for name in ELEMENTS if ELEMENTS[name].dimension == 2])
def test_force_in_plane_stress_is_the_derivative_of_the_energy_of_a_plate_that_thins(name, method):
    X, U, _, _ = random_elements(name, 1, seed=3)
    element, cells = ELEMENTS[name], {name: np.arange(len(ELEMENTS[name].nodes))[None]}

    def energy(X, U):
        density, _, _ = neo_hooke_in_plane_stress(compute_F(X, U, name))
        volume = np.linalg.det(np.einsum("eni,qnj->eqij", X, element.gradient_at_points))
        return 2.5 * (density * volume)[0] @ element.weights

    density, S, stretch = neo_hooke_in_plane_stress(compute_F(X, U, name))
    assert np.ptp(stretch) > 0.01 or len(element.points) == 1
    stress, of_type, across = {name: S}, {name: density}, {name: stretch}
    forces = nodal_configurational_forces(X[0], cells, U[0], stress, of_type, method, 2.5, across)
    expected = derivative_by_places(energy, X, U, kept_place=method == "mbf")
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-8 * np.abs(forces).max())
    # as if it kept its thickness it is something else
    without = nodal_configurational_forces(X[0], cells, U[0], stress, of_type, method, 2.5)
    assert np.abs(without - expected).max() > 1e-3 * np.abs(forces).max()


def test_stretch_belongs_to_large_strains_of_plane_elements():
    X, U, S, e = random_elements("CPE4", 1)
    of_plane = X[0], {"CPE4": [[0, 1, 2, 3]]}, U[0], {"CPE4": S}, {"CPE4": e}
    with pytest.raises(ValueError, match="leave it out with method 'linear' and in 3D"):
        nodal_configurational_forces(*of_plane, "linear", stretch={"CPE4": np.ones((1, 4))})
    with pytest.raises(ValueError, match="stretch has no values of CPE4, of which there are 1 elements"):
        nodal_configurational_forces(*of_plane, "dbf", stretch={})
    X, U, S, e = random_elements("C3D4", 1)
    of_solid = X[0], {"C3D4": [[0, 1, 2, 3]]}, U[0], {"C3D4": S}, {"C3D4": e}
    with pytest.raises(ValueError, match="leave it out with method 'linear' and in 3D"):
        nodal_configurational_forces(*of_solid, "mbf", stretch={"C3D4": np.ones((1, 1))})


@pytest.mark.parametrize("name", ELEMENTS)
def test_linear_and_displacement_based_forces_become_one_with_vanishing_displacements(name):
    X, U, _, _ = random_elements(name, 3, seed=6)
    material, gap = Elasticity(2.3, 0.3), []
    for scale in (1e-3, 1e-4):
        H = compute_F(X, scale * U, name) - np.eye(X.shape[-1])
        S = material.stress(H)
        data = X, scale * U, S, np.einsum("eqij,eqij->eq", S, H) / 2, name
        linear = compute_CF(*data, "linear")
        gap.append(np.abs(compute_CF(*data, "dbf") - linear).max() / np.abs(linear).max())
    assert gap[0] < 2e-3
    assert gap[1] == pytest.approx(gap[0] / 10, rel=0.02)


@hypothesis_settings(max_examples=25)
@given(name=st.sampled_from(list(ELEMENTS)), seed=st.integers(0, 1000), method=st.sampled_from(METHODS))
def test_forces_of_an_element_add_up_to_nothing(name, seed, method):
    forces = compute_CF(*random_elements(name, 3, seed), name, method)
    assert np.abs(forces.sum(axis=1)).max() < 1e-12 * max(1.0, np.abs(forces).max())


@pytest.mark.parametrize("name", ELEMENTS)
def test_methods_differ_by_the_internal_nodal_forces(name):
    X, U, S, e = random_elements(name, 4, seed=5)
    element = ELEMENTS[name]
    difference = compute_CF(X, U, S, e, name, "dbf") - compute_CF(X, U, S, e, name, "mbf")
    jacobian = np.einsum("eni,qnj->eqij", X, element.gradient_at_points)
    gradient = np.einsum("qnj,eqji->eqni", element.gradient_at_points, np.linalg.inv(jacobian))
    internal = np.einsum(
        "eqij,eqnj,eq,q->eni",
        compute_P(X, U, S, name),
        gradient,
        np.linalg.det(jacobian),
        element.weights,
    )
    np.testing.assert_allclose(difference, internal, atol=1e-12 * np.abs(internal).max())


@pytest.mark.parametrize(("alias", "name"), ALIASES.items())
def test_aliases_are_the_elements_they_stand_for(alias, name):
    data = random_elements(name, 2)
    assert np.array_equal(compute_CF(*data, alias), compute_CF(*data, name))


def test_lists_are_arrays_and_lower_case_names_are_names():
    X, U, S, e = random_elements("CPE4", 1)
    assert np.array_equal(
        compute_CF(X.tolist(), U.tolist(), S.tolist(), e.tolist(), "cpe4"), compute_CF(X, U, S, e, "CPE4")
    )


def broken(index, value):
    data = list(random_elements("CPE4", 3))
    data[index] = data[index].copy()
    data[index][(1,) + (0,) * (data[index].ndim - 1)] = value
    return data


@pytest.mark.parametrize(
    ("data", "name", "message"),
    [
        (random_elements("CPE4", 1), "CAX4", "element_type = 'CAX4': unknown; known are CPE3"),
        (random_elements("CPE4", 1), "CPE8", r"X_at_nodes has the shape \(1, 4, 2\): CPE8 needs"),
        (broken(0, np.nan), "CPE4", r"X_at_nodes\[1, 0, 0\] = nan: must be finite"),
        (broken(2, np.inf), "CPE4", r"S_at_int_points\[1, 0, 0, 0\] = inf: must be finite"),
        (broken(3, np.nan), "CPE4", r"e_at_int_points\[1, 0\] = nan"),
        (broken(0, 30.0), "CPE4", "element 1 is degenerate or inverted"),
    ],
)
def test_wrong_input_is_named(data, name, message):
    with pytest.raises(ValueError, match=message):
        compute_CF(*data, name)


def test_points_in_another_number_are_refused():
    X, U, S, e = random_elements("C3D8", 2)
    with pytest.raises(ValueError, match=r"S_at_int_points has the shape \(2, 4, 3, 3\): C3D8 needs"):
        compute_CF(X, U, S[:, :4], e[:, :4], "C3D8")
    with pytest.raises(ValueError, match="must be one of mbf, dbf, linear"):
        compute_CF(X, U, S, e, "C3D8", "eshelby")


def test_inverted_elements_are_refused():
    X, U, S, e = random_elements("C3D4", 2)
    X[0, [1, 2]] = X[0, [2, 1]]
    with pytest.raises(ValueError, match=r"element 0 is degenerate or inverted \(det dX/dR = -"):
        compute_CF(X, U, S, e, "C3D4")


@pytest.mark.parametrize("name", ["CPE4R", "C3D8"])
def test_elements_of_no_size_are_refused(name):
    X, U, S, e = random_elements(name, 2)
    X[1] = X[1, 0]
    with pytest.raises(ValueError, match=r"element 1 is degenerate or inverted \(det dX/dR = 0 of its size"):
        compute_CF(X, U, S, e, name)
