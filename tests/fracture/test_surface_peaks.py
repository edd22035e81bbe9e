"""Peaks of the stress below surfaces: between points, not beside mouths, corners and supports, and at corners."""

import numpy as np
import pytest

from slmm.boundary.contour import Places
from slmm.fracture.exclusion import Exclusion
from slmm.fracture.surface_peaks import (
    MOST_PEAKS,
    Sampled,
    at_corners,
    at_peaks,
)
from slmm.scene.gallery import v_notch
from slmm.scene.loading import Loading

EVERYWHERE = Exclusion(np.empty((0, 2)), [], 0.0, Loading(()))


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

    sites = sorted(
        at_peaks([around(Circle(), 24, stress)], stress, 0.5, EVERYWHERE), key=lambda site: -site.stress
    )
    # cos 2a + 0.05 cos a has its largest value at 0, and a peak at pi that is 0.1 lower
    assert sites[0].stress == pytest.approx(2.05, abs=1e-5)
    assert sites[0].point == pytest.approx(10 * np.array([np.cos(turn), np.sin(turn)]), abs=0.03)
    assert sites[0].inward == pytest.approx(-sites[0].point / 10)
    assert len(sites) == 2 and sites[1].stress == pytest.approx(1.95, abs=1e-5)


def test_a_peak_moves_no_farther_than_rounding_moves_the_stress():
    rng = np.random.default_rng(0)

    def place(noise):
        def stress(where):
            angle = np.arctan2(where.points[:, 1], where.points[:, 0]) - 0.1
            return 2 + np.cos(angle) + noise * rng.standard_normal(len(angle))

        [site] = at_peaks([around(Circle(), 24, stress)], stress, 0.5, EVERYWHERE)
        return site.point

    # from one of the points that are compared to the next one, 2e-3 mm away, the stress falls by 2e-8
    exact = place(0.0)
    assert max(np.linalg.norm(place(1e-14) - exact) for _ in range(20)) < 1e-6


def excluding(count, angle, stress):
    """A circle without what is nearer to (10, 0) than a chord of an angle."""
    exclusion = Exclusion(np.array([[10.0, 0.0]]), ["a mark"], 20 * np.sin(angle / 2), Loading(()))
    sampled = around(Circle(), count, stress)
    allowed = exclusion.free(Circle().at(sampled.way).points)
    return sampled._replace(allowed=allowed, below=np.where(allowed, sampled.below, -np.inf)), exclusion


@pytest.mark.parametrize("count", [24, 37, 90])
def test_what_rises_up_to_an_end_is_no_peak_and_is_told_at_the_end_whatever_the_points_are(count):
    def stress(where):
        return where.points[:, 0]

    sampled, exclusion = excluding(count, 0.5, stress)
    sites = at_peaks([sampled], stress, 1.0, exclusion)
    assert [site.excluded for site in sites] == ["beside a mark at (10, 0)"] * 2
    assert [site.stress for site in sites] == pytest.approx([10 * np.cos(0.5)] * 2, abs=1e-6)


@pytest.mark.parametrize("beyond", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("count", [24, 37, 90])
def test_a_peak_beside_an_end_is_one_though_no_point_lies_between(count, beyond):
    def stress(where):
        angle = np.arctan2(where.points[:, 1], where.points[:, 0])
        return 5 - (np.abs(angle) - 0.5 - beyond) ** 2

    sampled, exclusion = excluding(count, 0.5, stress)
    sites = at_peaks([sampled], stress, 1.0, exclusion)
    assert [site.excluded for site in sites] == [""] * 2
    assert [site.stress for site in sites] == pytest.approx([5.0] * 2, abs=1e-5)


def test_what_is_excluded_hides_no_lower_peak_elsewhere():
    def stress(where):
        x, y = where.points.T / 10.0
        return 10 * x**9 + 1 - x - y**2  # a third as high at (-10, 0) as at the end of what is excluded

    sampled, exclusion = excluding(60, 0.3, stress)
    sites = at_peaks([sampled], stress, 0.5, exclusion)
    free = [site for site in sites if not site.excluded]
    assert max(site.stress for site in sites if site.excluded) > 3 * max(site.stress for site in free)
    assert any(site.point == pytest.approx(on_circle(free_peak(stress)), abs=0.05) for site in free)


def free_peak(stress):
    """Angle of the highest stress away from (10, 0), by very many points."""
    angle = np.linspace(np.pi / 2, np.pi, 100_001)
    return angle[stress(Circle().at(10.0 * angle)).argmax()]


def on_circle(angle):
    return 10 * np.array([np.cos(angle), np.sin(angle)])


def test_a_uniform_stress_has_not_more_peaks_than_are_followed():
    def stress(where):
        return np.ones(len(where.points))

    assert len(at_peaks([around(Circle(), 50, stress)], stress, 0.5, EVERYWHERE)) == MOST_PEAKS
    assert at_peaks([around(Circle(), 50, stress)], stress, 2.0, EVERYWHERE) == []


def test_corners_that_point_into_the_material_count_until_a_crack_begins_there():
    def stress(where):
        return np.full(len(where.points), 7.0)

    scene = v_notch()
    [site] = at_corners(scene.part, scene.loading, stress, 0.1)
    assert site.point == pytest.approx([10.0, 60.0]) and site.inward == pytest.approx([1.0, 0.0])
    assert (site.hole, site.stress) == (0, 7.0)
    cracked = scene.part.with_crack([(10.0, 60.0), (14.0, 60.0)])
    assert at_corners(cracked, scene.loading, stress, 0.1) == []


@pytest.mark.parametrize("above", [1e-9, 0.0, -1e-9], ids=["one", "neither", "the other"])
def test_of_two_equal_peaks_between_two_points_both_are_found_whichever_round_off_favours(above):
    def stress(where):
        angle = np.arctan2(where.points[:, 1], where.points[:, 0])
        return 2 - 20 * (angle**2 - 0.15**2) ** 2 + above * angle

    sites = at_peaks([around(Circle(), 12, stress)], stress, 1.0, EVERYWHERE)
    assert sorted(np.arctan2(*site.point[::-1]) for site in sites) == pytest.approx([-0.15, 0.15], abs=2e-3)
    assert [site.stress for site in sites] == pytest.approx([2.0, 2.0], rel=1e-6)
