"""Faces of cracks: T-stress, opening, and contact without friction."""

import numpy as np
import pytest

from slmm.boundary.faces import lengths_of
from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading
from slmm.scene.scene import Scene

PMMA = Material.from_name("PMMA")
SIDE = 2000.0


def inclined(degrees, stress=1.0, contact=False):
    along = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    part = Part.plate(SIDE, SIDE, cracks=[[SIDE / 2 - 5 * along, SIDE / 2 + 5 * along]])
    return BoundaryModel(part, PMMA, plate_loading(SIDE, SIDE, stress=stress), contact=contact)


@pytest.mark.parametrize("degrees", [0, 30, 50])
def test_t_stress_of_an_inclined_crack_is_the_difference_of_the_stresses_along_and_across(degrees):
    angle = np.radians(degrees)
    T = inclined(degrees).t_stresses()
    assert pytest.approx(np.sin(angle) ** 2 - np.cos(angle) ** 2, abs=1e-4) == T


@pytest.mark.parametrize(("depth", "T"), [(0.3, -0.61033), (0.5, -0.42168)])
def test_t_stress_of_an_edge_crack(depth, T):
    """Sham, Int. J. Fract. 48 (1991) 81, a long strip under tension, to his digits."""
    strip = Part.plate(40.0, 480.0, cracks=[[(0.0, 240.0), (40 * depth, 240.0)]])
    model = BoundaryModel(strip, PMMA, plate_loading(40.0, 480.0, stress=1.0))
    assert model.t_stresses() == pytest.approx(T, abs=2e-5)


def test_energy_release_rate_is_that_of_both_intensities():
    model = inclined(30)
    assert model.energy_release_rates() == pytest.approx(
        (model.stress_intensities() ** 2).sum(axis=1) / PMMA.E
    )


def test_a_crack_under_compression_overlaps_unless_it_is_held_and_then_slides():
    free, held = inclined(30, -1.0), inclined(30, -1.0, contact=True)
    opening = free.opening()[1]
    assert opening.max() < 0
    assert held.touching.all() and np.abs(held.opening()[1]).max() < 1e-9 * -opening.min()
    # without friction: the shear alone is left
    K = held.stress_intensities()
    assert K[:, 0].tolist() == [0.0, 0.0]
    assert K[:, 1] == pytest.approx(-np.sqrt(5 * np.pi) * np.sin(np.pi / 6) * np.cos(np.pi / 6), rel=1e-4)


def test_under_bending_a_crack_closes_over_a_part_and_the_other_tip_feels_it():
    couple = [
        {"from": a, "to": b, "traction": [0.0, t]}
        for a, b, t in (
            ([20, 120], [0, 120], 1.0),
            ([40, 120], [20, 120], -1.0),
            ([0, 0], [20, 0], -1.0),
            ([20, 0], [40, 0], 1.0),
        )
    ]
    scene = Scene.from_dict(
        {
            "plate": {"width": 40.0, "height": 120.0},
            "cracks": [{"points": [[5.0, 60.0], [35.0, 60.0]]}],
            "material": {"name": "PMMA"},
            "boundary": couple,
        }
    )
    free, held = (BoundaryModel(scene.part, PMMA, scene.loading, contact=c) for c in (False, True))
    assert free.stress_intensities()[1, 0] == pytest.approx(-free.stress_intensities()[0, 0])
    K = held.stress_intensities()[:, 0]
    assert K[1] == 0.0
    assert 1.05 < K[0] / free.stress_intensities()[0, 0] < 1.25
    assert held.opening()[1].min() > -1e-12
    assert 0 < held.touching.sum() < len(held.touching)


def test_K_of_the_other_tip_does_not_depend_on_where_points_lie_that_begin_to_touch():
    """Faces open as the power 3/2 there, which no panel across it knows: panels are halved."""
    ends = (([20, 120], [0, 120]), ([40, 120], [20, 120]), ([0, 0], [20, 0]), ([20, 0], [40, 0]))
    couple = [
        {"from": a, "to": b, "traction": [0.0, t]}
        for (a, b), t in zip(ends, (1.0, -1.0, -1.0, 1.0), strict=True)
    ]
    plate = {"plate": {"width": 40.0, "height": 120.0}, "material": {"name": "PMMA"}, "boundary": couple}
    scene = Scene.from_dict({**plate, "cracks": [{"points": [[5.0, 60.0], [30.0, 60.0]]}]})
    few, many = (BoundaryModel(scene.part, PMMA, scene.loading, 8, p, contact=True) for p in (5, 12))
    assert few.stress_intensities()[0, 0] == pytest.approx(many.stress_intensities()[0, 0], rel=1e-4)
    assert few.work == pytest.approx(many.work, rel=1e-6)


def test_every_point_of_a_crack_stands_for_a_length_of_it():
    cracks = inclined(30).cracks
    lengths = lengths_of(cracks)
    assert lengths.min() > 0 and lengths.sum() == pytest.approx(10.0)
    panels = np.abs(cracks.ends - cracks.starts)
    assert lengths.reshape(-1, cracks.p).sum(axis=1) == pytest.approx(panels)


def test_where_all_is_open_contact_changes_nothing():
    assert inclined(30).c == pytest.approx(inclined(30, contact=True).c, rel=1e-9)
