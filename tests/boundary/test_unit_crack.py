"""A crack from a line or a circular hole in an endless plane: stress intensities of the literature."""

import numpy as np
import pytest

from slmm.boundary.mirrored import Tangent
from slmm.boundary.unit_crack import unit_crack


def intensities(tangent, mouth, direction, length, traction):
    """K_I and K_II over sqrt(pi length) by tractions (n,) along the crack and across."""
    unit = unit_crack()
    n = len(unit.x)
    matrix = unit.own / length + unit.reflected(tangent, mouth, direction, length)
    jump = np.linalg.solve(matrix, -np.stack([traction.real, traction.imag], axis=1).ravel()).reshape(n, 2)
    return unit.at_tip @ jump[:, ::-1] / np.sqrt(np.pi) / length, jump


def test_an_edge_crack_has_koiters_intensity_and_energy():
    unit = unit_crack()
    found, jump = intensities(Tangent.line(0j, 1j), 0j, 1j, 1.0, np.full(len(unit.x), 1j))
    assert found == pytest.approx([1.1215222, 0.0], abs=2e-6)
    # half the traction times the jump, with E = 4 for jumps of this scale, is the integral of K^2/E
    assert 0.5 * unit.weight @ jump[:, 1] == pytest.approx(1.1215222**2 * np.pi / 8, rel=2e-6)


def test_an_inclined_edge_crack():
    """45 degrees: 0.705 and 0.364 of sigma sqrt(pi a) (Murakami, Stress intensity factors handbook, 1987)."""
    unit = unit_crack()
    # sigma along the surface, on a crack that leaves it at 45 degrees
    found, _ = intensities(
        Tangent.line(0j, 1j), 0j, np.exp(0.25j * np.pi), 1.0, np.full(len(unit.x), -0.5 + 0.5j)
    )
    assert np.abs(found) == pytest.approx([0.705, 0.364], abs=1e-3)


@pytest.mark.parametrize(("L", "factor"), [(0.01, 3.29323), (0.1, 2.77277), (0.2, 2.37464), (1.0, 1.30613)])
def test_one_crack_at_a_hole(L, factor):
    """The values of tests/boundary/test_trial_cracks.py, of a plate that bounds them by 5e-5 at most."""
    r = 1 + L * unit_crack().x
    found, _ = intensities(
        Tangent.circle(1 + 0j, 1 + 0j, -1.0), 1 + 0j, 1 + 0j, L, 1j * (1 + 0.5 / r**2 + 1.5 / r**4)
    )
    assert found == pytest.approx([factor, 0.0], abs=1e-4)
