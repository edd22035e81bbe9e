"""The field of K_I and K_II: in balance, free faces, and the gradient of its displacements."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture.tip_field import tip_displacement, tip_gradients
from slmm.mechanics.elasticity import Elasticity

STATES = ["plane strain", "plane stress"]


def gradients(x, y, elasticity):
    return tip_gradients(np.array([x, y]), elasticity)


@given(
    r=st.floats(0.1, 10), theta=st.floats(-3.1, 3.1), nu=st.floats(-0.5, 0.45), state=st.sampled_from(STATES)
)
def test_gradients_are_those_of_the_displacements(r, theta, nu, state):
    elasticity = Elasticity(1000.0, nu, state)
    at, h = r * np.array([np.cos(theta), np.sin(theta)]), 1e-4 * r
    for mode, K in enumerate(np.eye(2)):
        numeric = [
            (tip_displacement(at + h * e, K, elasticity) - tip_displacement(at - h * e, K, elasticity))
            / (2 * h)
            for e in np.eye(2)
        ]
        ours = tip_gradients(at, elasticity)[mode]
        np.testing.assert_allclose(ours, np.transpose(numeric), atol=1e-6 * np.abs(ours).max())


@pytest.mark.parametrize("state", STATES)
def test_stresses_ahead_are_the_stress_intensities_and_faces_are_free(state):
    elasticity = Elasticity(210e3, 0.3, state)
    r = 0.37
    ahead = elasticity.stress(tip_gradients(np.array([r, 0.0]), elasticity)) * np.sqrt(2 * np.pi * r)
    assert ahead[0, 1, 1] == pytest.approx(1.0)  # K_I: sigma_yy
    assert ahead[1, 0, 1] == pytest.approx(1.0)  # K_II: sigma_xy
    for y in (0.0, -0.0):
        face = elasticity.stress(tip_gradients(np.array([-r, y]), elasticity))
        assert np.abs(face[:, 1]).max() < 1e-12
        # of K_II, the face's own stress is that of opposite sign on both faces
        assert face[1, 0, 0] * np.sqrt(2 * np.pi * r) == pytest.approx(-2 * np.copysign(1.0, y))
