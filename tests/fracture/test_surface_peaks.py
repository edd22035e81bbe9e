"""Peaks of the stress below surfaces: between points, not beside mouths, corners and supports, and at corners."""

import numpy as np
import pytest

from slmm.boundary.contour import Places
from slmm.fracture.surface_peaks import (
    MOST_PEAKS,
    NARROWER,
    Sampled,
    at_corners,
    at_peaks,
    held,
    may_start,
    mouths,
)
from slmm.scene.gallery import tensile_plate, v_notch


class Circle:
    """A circle about the origin, the body inside it."""

    length = 2 * np.pi * 10.0

    def at(self, way):
        angle = way / 10.0
        out = np.column_stack([np.cos(angle), np.sin(angle)])
        return Places(10.0 * out, -out, np.zeros(len(way), dtype=int))


def around(circle, count, stress, allowed=None):
    way = np.arange(count) * circle.length / count
    every = np.ones(count, dtype=bool)
    return Sampled(circle, way, every if allowed is None else allowed, stress(circle.at(way)))


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.2])
def test_peaks_are_where_the_stress_is_largest_whatever_the_points_are(turn):
    def stress(where):
        angle = np.arctan2(where.points[:, 1], where.points[:, 0]) - turn
        return 1 + np.cos(2 * angle) + 0.05 * np.cos(angle)

    sites = sorted(at_peaks([around(Circle(), 24, stress)], stress, 0.5), key=lambda site: -site.stress)
    # cos 2a + 0.05 cos a has its largest value at 0, and a peak at pi that is 0.1 lower
    assert sites[0].stress == pytest.approx(2.05, abs=1e-5)
    assert sites[0].point == pytest.approx(10 * np.array([np.cos(turn), np.sin(turn)]), abs=0.03)
    assert sites[0].inward == pytest.approx(-sites[0].point / 10)
    assert len(sites) == 2 and sites[1].stress == pytest.approx(1.95, abs=1e-5)


def test_what_is_not_allowed_is_not_reached_from_beside_it():
    def stress(where):
        return where.points[:, 0]

    step = 2 * np.pi / 24
    allowed = np.abs((np.arange(24) + 12) % 24 - 12) > 2
    sampled = around(Circle(), 24, stress, allowed)
    sampled = sampled._replace(below=np.where(allowed, sampled.below, -np.inf))
    sites = at_peaks([sampled], stress, 1.0)
    # the second round reaches beyond the last point by a share of half a step
    assert 10 * np.cos(3 * step) <= sites[0].stress <= 10 * np.cos(3 * step - NARROWER * step / 2)


def test_a_uniform_stress_has_not_more_peaks_than_are_followed():
    def stress(where):
        return np.ones(len(where.points))

    assert len(at_peaks([around(Circle(), 50, stress)], stress, 0.5)) == MOST_PEAKS
    assert at_peaks([around(Circle(), 50, stress)], stress, 2.0) == []


def test_no_crack_starts_beside_a_mouth_or_the_end_of_a_support():
    supports = [
        {"on": "bottom", "displacement": [0.0, 0.0]},
        {"at": [40.0, 80.0], "width": 10.0, "displacement": ["free", 1.0]},
    ]
    scene = tensile_plate(boundary=supports)
    assert mouths(scene.part).tolist() == [[0.0, 40.0]]
    points = np.array([[0.0, 40.2], [0.0, 40.3], [35.1, 80.0], [34.6, 80.0], [80.0, 40.0]])
    assert may_start(scene.part, scene.loading, points, 0.1).tolist() == [False, True, False, True, True]
    places = np.array([[40.0, 0.0], [38.0, 80.0], [20.0, 80.0], [0.0, 10.0]])
    assert held(scene.loading, places).tolist() == [True, True, False, False]


def test_corners_that_point_into_the_material_count_until_a_crack_begins_there():
    def stress(where):
        return np.full(len(where.points), 7.0)

    scene = v_notch()
    [site] = at_corners(scene.part, scene.loading, stress, 0.1)
    assert site.point == pytest.approx([10.0, 60.0]) and site.inward == pytest.approx([1.0, 0.0])
    assert (site.hole, site.stress) == (0, 7.0)
    cracked = scene.part.with_crack([(10.0, 60.0), (14.0, 60.0)])
    assert at_corners(cracked, scene.loading, stress, 0.1) == []
