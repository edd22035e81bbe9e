"""Iterations, skeletons and factors of the whole matrix solve the same equations."""

import numpy as np
import pytest

from slmm.boundary import base_system, skeletonised
from slmm.boundary.iterative import Iterative
from slmm.boundary.model import BoundaryModel
from slmm.boundary.skeletonised import Skeletonised
from slmm.boundary.solvers import Factorised
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


def both(monkeypatch, part, loading, way, p=6):
    factorised = BoundaryModel(part, PMMA, loading, p)
    monkeypatch.setattr(base_system, "MOST_FACTORISED", 0)
    if way is Iterative:
        monkeypatch.setattr(base_system, "MOST_SKELETONISED", 0)
    # so few that there are several levels of clusters
    monkeypatch.setattr(skeletonised, "LEAF", 60)
    monkeypatch.setattr(skeletonised, "MOST_LEFT", 300)
    other = BoundaryModel(part, PMMA, loading, p)
    assert isinstance(factorised.body.base.solver, Factorised)
    assert isinstance(other.body.base.solver, way)
    return factorised, other


@pytest.mark.parametrize("way", [Iterative, Skeletonised])
@pytest.mark.parametrize("loading", LOADINGS.values(), ids=LOADINGS)
def test_densities_and_stresses_are_the_same(monkeypatch, loading, way):
    one, other = both(monkeypatch, Part.plate(36.0, 34.0, HOLES), loading, way)
    assert np.abs(other.g - one.g).max() < 1e-8 * np.abs(one.g).max()
    assert np.abs(other.hoop - one.hoop).max() < 1e-6 * np.abs(one.hoop).max()


@pytest.mark.parametrize("way", [Iterative, Skeletonised])
def test_cracks_feel_the_same_and_go_on_from_what_was_searched(monkeypatch, way):
    part = Part.plate(36.0, 34.0, HOLES, [[(0.0, 16.0), (5.0, 15.5)]])
    one, other = both(monkeypatch, part, LOADINGS["displacement"], way)
    np.testing.assert_allclose(other.stress_intensities(), one.stress_intensities(), rtol=1e-7)
    grown = part.grown(0, (6.0, 15.5))
    assert other.body.serves(grown) == (way is Iterative)
    K = other.with_cracks_of(grown).stress_intensities()
    np.testing.assert_allclose(K, one.with_cracks_of(grown).stress_intensities(), rtol=1e-7)


@pytest.mark.parametrize("apart", [1.0, 1e-3])
def test_skeletons_feel_thin_ligaments(monkeypatch, apart):
    pair = [Outline.through(circle((x, 17.0), 6.0)) for x in (12.0 - apart / 2, 24.0 + apart / 2)]
    one, other = both(monkeypatch, Part.plate(36.0, 34.0, pair), LOADINGS["displacement"], Skeletonised)
    assert np.abs(other.hoop - one.hoop).max() < 1e-6 * np.abs(one.hoop).max()


def test_loads_that_do_not_balance_are_refused(monkeypatch):
    monkeypatch.setattr(base_system, "MOST_FACTORISED", 0)
    pulled = Loading((Condition((36.0, 0.0), (36.0, 34.0), traction=(1.0, 0.0)),))
    with pytest.raises(ValueError, match="does not balance"):
        BoundaryModel(Part.plate(36.0, 34.0, HOLES), PMMA, pulled, 6)
