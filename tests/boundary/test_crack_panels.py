"""Panels along cracks: what they refuse."""

import numpy as np
import pytest

from slmm.boundary.crack_panels import crack_panels
from slmm.part.part import Part


def test_a_crack_whose_ends_are_one_place_is_refused():
    """Beside another crack ends nearer than the part's tolerance are joined."""
    part = Part.plate(80.0, 80.0, cracks=[[(0.0, 20.0), (10.0, 20.0)]])
    short = part.with_short_crack(np.array([0.0, 60.0]), np.array([0.5 * part.tolerance, 60.0]))
    with pytest.raises(
        ValueError, match=r"a segment of 0.0004 mm is one place; it must be longer than 0.0008"
    ):
        crack_panels(short, np.array([0.0 + 0.0j]), 4, 0.2)
