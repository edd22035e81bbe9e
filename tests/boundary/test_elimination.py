"""Cracks beside a factorised body, at places where its own points are in the way."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-7, 1e-3])
def test_a_mouth_may_lie_on_a_point_of_the_body(off):
    part = Part.plate(100.0, 100.0, [Outline.through(circle((50.0, 50.0), 10.0))])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, stress=5.0))
    on_hole = model.panels.z[np.abs(np.abs(model.panels.z - (50 + 50j)) - 10.0) < 1e-6]
    point = on_hole[np.abs(on_hole - (60 + 50j)).argmin()]
    mouth = 50 + 50j + 10.0 * np.exp(1j * (np.angle(point - (50 + 50j)) + off / 10.0))
    tip = 50 + 50j + 1.3 * (mouth - (50 + 50j))
    cracked = part.with_crack([(mouth.real, mouth.imag), (tip.real, tip.imag)])
    K = model.with_cracks_of(cracked).stress_intensities()
    own = BoundaryModel(cracked, PMMA, plate_loading(100.0, 100.0, stress=5.0)).stress_intensities()
    assert pytest.approx(own, abs=1e-5 * np.abs(own).max()) == K
