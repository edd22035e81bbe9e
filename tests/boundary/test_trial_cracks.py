"""Energy set free by trial cracks: known stress intensities, and any length on one factorised body."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.boundary.trial_cracks import TrialCracks
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, polygon, rectangle_corners
from slmm.scene.loading import plate_loading

MATERIAL = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1, state="plane stress")
SIGMA, WIDTH = 10.0, 1000.0
RIGHT = np.array([1.0, 0.0])


def plate(*holes):
    part = Part.plate(WIDTH, WIDTH, holes=holes)
    return BoundaryModel(part, MATERIAL, plate_loading(WIDTH, WIDTH, stress=SIGMA))


def energy_release_rate(a, factor):
    return factor**2 * np.pi * a * SIGMA**2 / MATERIAL.E


@pytest.fixture(scope="module")
def at_hole():
    """One crack from a hole of radius 1, which the plate hardly bounds."""
    model = plate(Outline.through(circle((500.0, 500.0), 1.0)))
    return model, np.array([501.0, 500.0])


@pytest.mark.parametrize(("L", "factor"), [(0.01, 3.29323), (0.1, 2.77277), (0.2, 2.37464), (1.0, 1.30613)])
def test_one_crack_at_a_hole(at_hole, L, factor):
    """K over sigma sqrt(pi L), a prototype of high order."""
    model, mouth = at_hole
    trial = TrialCracks(model, mouth, RIGHT, 1.02 * L)
    # dG_inc a / da is G
    a, da = L, 1e-4 * L
    slope = (np.array([-1, 1]) * trial.incremental(np.array([a - da, a + da])) * [a - da, a + da]).sum()
    assert slope / (2 * da) == pytest.approx(energy_release_rate(L, factor), rel=2e-3)


def test_an_edge_crack_sets_half_of_G_free():
    """1.12152, Koiter's edge crack: G grows in proportion to its length."""
    model = plate()
    a = np.array([0.01, 0.3, 1.0])
    G_inc = TrialCracks(model, np.array([0.0, 500.0]), RIGHT, 1.0).incremental(a)
    assert G_inc == pytest.approx(0.5 * energy_release_rate(a, 1.12152), rel=5e-4)


def test_what_the_part_stores_less(at_hole):
    """Energy by energy: half the work under a given traction, before and after."""
    model, mouth = at_hole
    trial = TrialCracks(model, mouth, RIGHT, 2.0)
    cracked = model.with_cracks_of(model.part.with_crack([mouth, mouth + 2.0 * RIGHT]))
    assert trial.incremental(np.array([2.0]))[0] == pytest.approx(
        0.5 * (cracked.work - model.work) / 2.0, rel=5e-3
    )


def test_at_a_corner_its_own_exponent_decides():
    """Twice as many lengths change nothing where the power of the corner is taken out."""
    model = plate(Outline.of_pieces(polygon(rectangle_corners((500.0, 500.0), (4.0, 4.0), 45.0))))
    outline = model.part.outlines[0]
    at = outline.points(outline.corners)
    mouth = at[at[:, 0].argmax()]
    a = np.array([0.01, 0.1, 0.4])
    by_power = TrialCracks(model, mouth, RIGHT, 0.4, 2 * 0.5445 - 1).incremental(a)
    longer = TrialCracks(model, mouth, RIGHT, 0.8, 2 * 0.5445 - 1).incremental(a)
    assert by_power == pytest.approx(longer, rel=2e-3)


def test_a_mouth_inside_is_refused(at_hole):
    with pytest.raises(ValueError, match="must lie on a surface"):
        TrialCracks(at_hole[0], np.array([510.0, 500.0]), RIGHT, 1.0)
