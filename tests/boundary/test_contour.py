"""Surfaces by the points of their panels: stress along them, and places by the way along a closed curve."""

import numpy as np
import pytest

from slmm.boundary.contour import Contour
from slmm.boundary.model import BoundaryModel
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")
THREE = [Outline.through(circle((x, y), r)) for x, y, r in ((28, 44, 6.0), (46, 30, 5.0), (70, 60, 7.0))]


def test_hoop_stress_at_the_points_is_that_of_the_surface():
    part = Part.plate(100.0, 100.0, THREE)
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, stress=1.0))
    on_hole = np.repeat(model.panels.hole >= 0, model.panels.p)
    z = model.panels.z[on_hole]
    stress = model.stress(np.column_stack([z.real, z.imag]))
    assert model.hoop[on_hole] == pytest.approx(stress[:, 0] + stress[:, 1], abs=1e-9)


def test_places_along_a_contour_are_its_points():
    part = Part.plate(100.0, 100.0, THREE, [[(0, 50), (15, 50)]])
    model = BoundaryModel(part, PMMA, plate_loading(100.0, 100.0, stress=1.0))
    for number in range(4):
        contour = Contour(part, model.panels, number)
        where = contour.at(contour.way)
        assert where.points @ [1, 1j] == pytest.approx(model.panels.z[contour.nodes], abs=1e-8)
        inward = 1j * model.panels.tangent[contour.nodes]
        assert where.inward @ [1, 1j] == pytest.approx(inward, abs=1e-8)
