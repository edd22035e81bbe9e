"""An increment that is turned until J points along it."""

import numpy as np
import pytest

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fracture.kink_correction import corrected_kink
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")
WIDTH, CRACK = 300.0, np.array([[143.0, 143.0], [157.0, 157.0]])


def solver(strain):
    loading = plate_loading(WIDTH, WIDTH, strain=strain)
    return lambda crack: (
        PlateModel(plate_mesh(Part.plate(WIDTH, WIDTH, cracks=[crack])), PMMA, loading).results
    )


def test_the_increment_of_an_inclined_crack_turns_to_the_exact_kink():
    """Stresses 1 and 1/3 on a crack at 45 degrees: K_II/K_I = 0.5 and no stress along the crack."""
    lateral = 1 / 3
    solve = solver(((lateral - PMMA.nu) / PMMA.E, (1 - PMMA.nu * lateral) / PMMA.E, 0.0))
    kink = corrected_kink(solve, CRACK, 0.1, start=np.radians(-38.0))
    assert kink.converged
    assert abs(kink.off[-1]) <= np.radians(0.1) < abs(kink.off[0])
    assert kink.angles[-1] == kink.angle
    assert np.degrees(kink.angle) == pytest.approx(-42.03, abs=0.5)  # Amestoy and Leblond
    same = corrected_kink(solve, CRACK, 0.1, start=np.radians(-38.0))
    assert same.angle == kink.angle


def test_a_crack_in_even_tension_does_not_turn():
    crack = np.array([[140.0, 150.0], [160.0, 150.0]])
    kink = corrected_kink(solver((0.0, 0.001, 0.0)), crack, 0.2)
    assert kink.converged
    assert len(kink.angles) == 1
    assert kink.angle == 0.0


def test_too_few_models_are_not_called_converged():
    kink = corrected_kink(solver((0.0, 0.001, 0.0)), CRACK, 0.1, start=0.5, most=1)
    assert not kink.converged


def test_a_crack_under_pressure_is_refused_with_the_angle():
    with pytest.raises(ValueError, match=r"increment of 0 degrees: K_I is negative"):
        corrected_kink(solver((0.0, -0.001, 0.0)), np.array([[140.0, 150.0], [160.0, 150.0]]), 0.2)
