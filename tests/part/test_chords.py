"""Chords lie on their outline, and nowhere farther beside it than is said."""

import numpy as np
import pytest

from slmm.part.chords import CHORDS, OFF, chords
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, ellipse


def wavy(waves):
    """Points around a circle of 30 mm with waves of 0.3 mm."""
    way = np.linspace(0, 2 * np.pi, 40 * waves, endpoint=False)
    radius = 30 + 0.3 * np.cos(waves * way)
    return 40 + radius[:, None] * np.column_stack([np.cos(way), np.sin(way)])


@pytest.mark.parametrize(
    "points", [circle((40, 40), 8.0), ellipse((40, 40), (20.0, 2.0)), wavy(60), wavy(100)]
)
def test_no_chord_is_farther_off_than_is_said(points):
    outline = Outline.through(points)
    ring = chords(outline)
    middle = 0.5 * (ring + np.roll(ring, -1, axis=0))
    off = np.linalg.norm(outline.points(outline.project(middle)) - middle, axis=1)
    assert len(ring) >= CHORDS and off.max() < 1.1 * OFF * outline.length


def test_a_short_crack_in_a_small_bend_lies_in_the_material():
    """A random pattern's: 2000 equal chords of a long outline cut off a bend of 0.4 mm by 0.014 mm."""
    outline = Outline.through(wavy(100))
    s = outline.length * np.linspace(0, 1, 5000)
    sharpest = s[outline.curvatures(s).argmax()]
    mouth, inward = outline.points(sharpest), outline.normals(sharpest)
    part = Part.plate(80.0, 80.0, [outline]).with_crack([mouth, mouth + 0.01 * inward])
    assert part.cracks[0].start.kind == "surface" and part.cracks[0].end.kind == "tip"
