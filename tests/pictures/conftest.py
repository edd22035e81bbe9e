"""What the tests of pictures share."""

import pytest

from slmm.pictures import stress_field


@pytest.fixture
def coarse(monkeypatch):
    """The stress behind the notches on a coarse grid."""
    monkeypatch.setattr(stress_field, "ACROSS", 40)
