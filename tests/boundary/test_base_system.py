"""Iterations and factors of the whole matrix solve the same equations."""

import numpy as np
import pytest

from slmm.boundary import base_system
from slmm.boundary.model import BoundaryModel
from slmm.boundary.solvers import Factorised, Iterative
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.part.span import Span
from slmm.scene.loading import Affine, Condition, Loading, plate_loading

PMMA = Material.from_name("PMMA")
HOLES = [
    Outline.through(circle((x, y), r)) for x, y, r in ((9, 9, 4.5), (20, 11, 5.5), (28, 25, 6), (10, 24, 7))
]
PINNED = Span(HOLES[1], HOLES[1].length, 0.0)
LOADINGS = {
    "stress": plate_loading(36.0, 34.0, stress=1.0),
    "strain": plate_loading(36.0, 34.0, strain=(1e-3, 2e-3, -1e-3)),
    "displacement": plate_loading(36.0, 34.0, displacement=0.1),
    "pin in a hole": Loading(
        (
            Condition((0.0, 0.0), (36.0, 0.0), (Affine(), Affine())),
            Condition((25.5, 11.0), (25.5, 11.0), bearing=(3.0, 4.0), span=PINNED),
        )
    ),
}


def both(monkeypatch, part, loading, p=6):
    factorised = BoundaryModel(part, PMMA, loading, p)
    monkeypatch.setattr(base_system, "MOST_FACTORISED", 0)
    iterative = BoundaryModel(part, PMMA, loading, p)
    assert isinstance(factorised.body.base.solver, Factorised)
    assert isinstance(iterative.body.base.solver, Iterative)
    return factorised, iterative


@pytest.mark.parametrize("loading", LOADINGS.values(), ids=LOADINGS)
def test_densities_and_stresses_are_the_same(monkeypatch, loading):
    one, other = both(monkeypatch, Part.plate(36.0, 34.0, HOLES), loading)
    assert np.abs(other.g - one.g).max() < 1e-8 * np.abs(one.g).max()
    assert np.abs(other.hoop - one.hoop).max() < 1e-6 * np.abs(one.hoop).max()


def test_cracks_feel_the_same_and_go_on_from_what_was_searched(monkeypatch):
    part = Part.plate(36.0, 34.0, HOLES, [[(0.0, 16.0), (5.0, 15.5)]])
    one, other = both(monkeypatch, part, LOADINGS["displacement"])
    np.testing.assert_allclose(other.stress_intensities(), one.stress_intensities(), rtol=1e-7)
    grown = part.grown(0, (6.0, 15.5))
    assert other.body.serves(grown)
    K = other.with_cracks_of(grown).stress_intensities()
    np.testing.assert_allclose(K, one.with_cracks_of(grown).stress_intensities(), rtol=1e-7)


def test_loads_that_do_not_balance_are_refused(monkeypatch):
    monkeypatch.setattr(base_system, "MOST_FACTORISED", 0)
    pulled = Loading((Condition((36.0, 0.0), (36.0, 34.0), traction=(1.0, 0.0)),))
    with pytest.raises(ValueError, match="does not balance"):
        BoundaryModel(Part.plate(36.0, 34.0, HOLES), PMMA, pulled, 6)
