"""Saddles of the function through support points: where its holes meet or part."""

from dataclasses import replace

import numpy as np
import pytest

from slmm.part.level_set import LevelSet

CENTRE, SPACING = (40.0, 40.0), 10.0


def drawn(seed):
    values = (np.random.default_rng(seed).random((5, 5)) < 0.4).astype(float)
    return LevelSet(values, CENTRE, SPACING)


@pytest.mark.parametrize("seed", range(6))
def test_the_function_is_level_at_saddles_and_falls_one_way_and_rises_the_other(seed):
    level_set = drawn(seed)
    places, values = level_set.saddles()
    np.testing.assert_allclose(level_set(places), values, atol=1e-12)
    h = 1e-3 * SPACING
    steps = h * np.array([[1, 0], [0, 1], [1, 1], [1, -1]]) / np.array([[1, 1, 2**0.5, 2**0.5]]).T
    for place, value in zip(places, values, strict=True):
        up, down = level_set(place + steps), level_set(place - steps)
        assert np.abs(up - down).max() < 1e-5  # of second order: no slope
        xx, yy, plus, minus = (up + down - 2 * value) / h**2
        xy = (plus - minus) / 2
        assert xx * yy < xy**2


@pytest.mark.parametrize("length_scale", [1.5, 2.0, 2.5, 3.0])
def test_two_holes_are_one_where_their_saddle_is_above_the_threshold(length_scale):
    two = LevelSet(np.eye(2), CENTRE, SPACING, length_scale)
    places, values = two.saddles()
    between = np.flatnonzero(np.abs(places - CENTRE).max(axis=1) < 1e-6)
    (value,) = values[between]
    counts = [len(replace(two, threshold=value + by).outlines()) for by in (-1e-3, 1e-3)]
    assert counts == [1, 2]


def test_mirrored_patterns_have_mirrored_saddles_and_one_margin():
    one = drawn(1)
    other = replace(one, values=one.values[:, ::-1])
    places, values = one.saddles()
    mirrored, same = other.saddles()
    np.testing.assert_allclose(np.sort(values), np.sort(same), atol=1e-12)
    np.testing.assert_allclose(
        np.sort(places[:, 0]), np.sort(2 * CENTRE[0] - mirrored[:, 0]), atol=1e-6 * SPACING
    )
    assert one.margin() == pytest.approx(other.margin(), abs=1e-12) == np.abs(values - 0.5).min()


def test_no_hole_has_no_saddle():
    places, values = LevelSet(np.zeros((3, 3)), CENTRE, SPACING).saddles()
    assert places.shape == (0, 2) and values.shape == (0,)
