"""Panels along cracks: as many as mouths, kinks and what is near ask for, however a crack is cut into segments."""

import numpy as np
import pytest

from slmm.boundary.crack_panels import AT_KINK, crack_panels
from slmm.boundary.model import BoundaryModel
from slmm.boundary.stretches import COARSE
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")


def samples(part):
    """Of the edges of a plate."""
    corners = part.outer[:, 0] + 1j * part.outer[:, 1]
    share = np.linspace(0.0, 1.0, 2000)
    return np.concatenate([a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1), strict=True)])


def lengths_on(panels, a, b):
    """Of panels on a segment, from its start on."""
    way = ((0.5 * (panels.starts + panels.ends) - a) / (b - a)).real
    on = (abs((panels.starts - a) / (b - a)) < 2) & (way > 0) & (way < 1)
    return np.abs(panels.ends - panels.starts)[on][np.argsort(way[on])]


@pytest.mark.parametrize("seed", range(10))
def test_where_segments_meet_nothing_is_near(seed):
    """The way along a crack and the distance are equal there but for rounding."""
    rng = np.random.default_rng(seed)
    turns = rng.normal(0.0, 0.05, 12)
    steps = rng.uniform(1.5, 2.5, 12) * np.exp(1j * np.cumsum(turns))
    z = 50j * rng.uniform(0.9, 1.1) + np.concatenate([[0.0], np.cumsum(steps)])
    part = Part.plate(100.0, 100.0, cracks=[np.column_stack([z.real, z.imag])])
    panels = crack_panels(part, samples(part), 5, COARSE.crack)
    assert np.abs(panels.ends - panels.starts).min() > 0.25


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_the_last_panel_at_a_mouth_is_a_share_of_the_crack(is_mirrored):
    for total, first in ((3.0, 0.5), (9.0, 1.0), (31.0, 1.0)):
        x = np.append([0.0], np.arange(1.0, total + 1.0, 2.0))
        points = np.column_stack([100.0 - x if is_mirrored else x, np.full(len(x), 50.0)])
        part = Part.plate(100.0, 100.0, cracks=[points])
        panels = crack_panels(part, samples(part), 5, COARSE.crack)
        found = lengths_on(panels, *(points[:2, 0] + 1j * points[:2, 1]))
        assert found == pytest.approx([first] * round(1 / first))


def test_panels_at_a_slanted_mouth_are_as_short_as_the_surface_is_near():
    way = np.array([0.0, 1.0, 9.0]) * np.exp(1j * np.radians(20.0))
    part = Part.plate(100.0, 100.0, cracks=[np.column_stack([way.real + 50.0, way.imag])])
    panels = crack_panels(part, samples(part), 5, COARSE.crack)
    found = lengths_on(panels, 50.0 + 0j, 50.0 + way[1])
    assert found[0] == pytest.approx(AT_KINK, rel=0.5)
    assert (np.diff(found) >= -1e-12).all()


def test_segments_of_a_straight_crack_change_nothing():
    loading = plate_loading(100.0, 100.0, displacement=0.1)
    found = []
    for x in ([0.0, 15.0], [0.0, 1.0, *np.arange(3.0, 16.0, 2.0)]):
        part = Part.plate(100.0, 100.0, cracks=[np.column_stack([x, np.full(len(x), 50.0)])])
        model = BoundaryModel(part, PMMA, loading, 6, 5, grading=COARSE)
        found.append((model.stress_intensities()[0, 0], model.work))
    assert found[1] == pytest.approx(found[0], rel=1e-4)


def test_a_crack_whose_ends_are_one_place_is_refused():
    """Where cracks meet, points nearer to each other than the part's tolerance are one."""
    meeting = [[(0.0, 20.0), (10.0, 20.0)], [(10.0, 20.0), (15.0, 25.0)]]
    part = Part.plate(80.0, 80.0, cracks=meeting)
    short = part.with_short_crack(np.array([0.0, 60.0]), np.array([0.5 * part.tolerance, 60.0]))
    with pytest.raises(
        ValueError, match=r"a segment of 0.0004 mm is one place; it must be longer than 0.0008"
    ):
        crack_panels(short, np.array([0.0 + 0.0j]), 4, 0.2)
