"""Panels along segments of cracks: by what these end at and come near, whatever their numbers are rounded to."""

import numpy as np
import pytest

from slmm.boundary.crack_division import AT_TIP, PER_CRACK, PER_DISTANCE, Segments, divided

NOWHERE = np.empty(0, dtype=complex)


def segments(*lines, grade=1.0):
    """Segments of cracks along lines, with tips at their ends."""
    lengths = [np.abs(np.diff(z)) for z in lines]
    m = sum(map(len, lengths))
    tips = np.full((m, 2), -1)
    last = np.cumsum([len(length) for length in lengths]) - 1
    tips[last, 1] = np.arange(len(lines))
    return Segments(
        np.concatenate([z[:-1] for z in lines]),
        np.concatenate([z[1:] for z in lines]),
        np.repeat(np.arange(len(lines)), [len(length) for length in lengths]),
        np.concatenate([np.cumsum(length) - length for length in lengths]),
        tips,
        np.zeros((m, 2), dtype=bool),
        np.full((m, 2), grade),
    )


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.3])
def test_a_mild_kink_is_no_place_that_a_crack_comes_back_to(turn):
    # points of its two sides meet there after ways that differ by rounding alone; the surface beside the first segment
    # has that one divided, but not towards the kink
    line = (
        29.57394626
        + 48.98370869j
        + np.cumsum(np.array([0.0, 1.0, 2.0, 2.0]) * np.exp(1j * turn * np.arange(4)))
    )
    beside = np.array([line[0] - 0.05])
    for shift in np.linspace(0.0, 1.0, 20):
        starts, ends, _ = divided(segments(line + shift), beside + shift)
        last = np.abs(ends - line[1] - shift) < 1e-9
        assert np.abs(ends - starts)[last] == pytest.approx(0.5)


@pytest.mark.parametrize("sharpness", [2.2, 2.8])
def test_a_crack_that_folds_back_has_panels_as_short_as_it_is_near(sharpness):
    line = np.array([0.0, 4.0, 4.0 + 4.0 * np.exp(1j * sharpness)], dtype=complex)
    starts, ends, _ = divided(segments(line, grade=0.01), NOWHERE)
    on_first = np.abs(ends.imag) + np.abs(starts.imag) == 0
    away = np.abs(np.sin(sharpness)) * (4.0 - np.maximum(starts.real, ends.real))[on_first]
    size = np.abs(ends - starts)[on_first]
    assert on_first.sum() > 3
    assert (size <= np.maximum(PER_CRACK * away * 1.2, 0.04 + 1e-9)).all()


def test_panels_cover_their_segments_and_those_at_tips_come_first():
    line = np.array([0.0, 3.0, 6.0 + 1.0j])
    starts, ends, tip = divided(segments(line, grade=0.1), NOWHERE)
    assert np.abs(ends - starts).sum() == pytest.approx(np.abs(np.diff(line)).sum(), rel=1e-14)
    assert np.count_nonzero(tip == 0) == 1 and ends[tip == 0] == line[-1]
    assert np.abs(ends - starts)[tip == 0] == pytest.approx(AT_TIP * abs(line[2] - line[1]))


@pytest.mark.parametrize("away", [0.5, 1.0, 2.0])
def test_a_panel_is_no_longer_than_its_distance_allows(away):
    surface = np.linspace(-10.0, 20.0, 2000) + 1j * away
    starts, ends, _ = divided(segments(np.array([0.0, 8.0], dtype=complex)), surface)
    assert np.abs(ends - starts).max() <= PER_DISTANCE * away * (1 + 1e-3)
    other = np.array([3.0 + 1j * away, 5.0 + 1j * away])
    starts, ends, _ = divided(segments(np.array([0.0, 8.0], dtype=complex), other), NOWHERE)
    low, high = np.minimum(starts.real, ends.real), np.maximum(starts.real, ends.real)
    beside = (starts.imag == 0) & (low < 5) & (high > 3)
    assert np.abs(ends - starts)[beside].max() <= PER_CRACK * away * (1 + 1e-3)
