"""Criteria on bare curves: closed forms, what they refuse, and what they leave to curves that end too early."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import Material
from slmm.criteria.coupled import GOVERNED_BY
from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.criterion import CRITERIA
from slmm.criteria.distances import CriticalDistance, line_distance, point_distance
from slmm.criteria.griffith import energy_release_rate
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.criteria.surface import mises_stress

PMMA = Material.from_name("PMMA")
POINT, LINE = point_distance(PMMA), line_distance(PMMA)


def curves(stress, a_max, energy=lambda a: a, error=0.01):
    a = path_points(np.atleast_1d(a_max))
    with np.errstate(divide="ignore"):
        sigma, G = stress(a), energy(a)
    return PathCurves(a, G, sigma, np.full(a.shape, error), np.full(a.shape, error))


def test_uniform_stress_is_the_same_to_all_that_know_no_energy():
    found = curves(lambda a: np.full(a.shape, 35.25), 3 * LINE)
    for name in ("rankine", "mises", "point", "line"):
        critical = CRITERIA[name].judge(found, PMMA)
        assert critical.load_factor[0] == pytest.approx(2.0)
        assert critical.error[0] == pytest.approx(0.01)
        assert GOVERNED_BY[critical.governed_by[0]] == "stress"


@given(scale=st.floats(0.1, 10.0))
def test_critical_distances_of_a_singular_stress_have_closed_forms(scale):
    """sigma = K/sqrt(2 pi r): both give Griffith's load where Irwin's length decides, K = K_Ic."""
    K = scale * np.sqrt(PMMA.G_c * PMMA.plane_stress_equivalent[0])
    found = curves(
        lambda r: np.where(r > 0, K / np.sqrt(2 * np.pi * np.maximum(r, 1e-300)), np.inf),
        2 * LINE,
        energy=lambda a: np.full(a.shape, K**2 / PMMA.plane_stress_equivalent[0]),
    )
    for name, tolerance in (("point", 2e-3), ("line", 2e-3), ("griffith", 1e-12)):
        assert CRITERIA[name].judge(found, PMMA).load_factor[0] == pytest.approx(1 / scale, rel=tolerance), (
            name
        )
    assert CRITERIA["rankine"].judge(found, PMMA).refused[0] == Status.SINGULAR


def test_curves_that_end_before_the_distance_have_no_value_and_no_reason():
    found = curves(lambda a: np.full(a.shape, 10.0), 0.5 * POINT)
    for line in (False, True):
        critical = CriticalDistance(line).judge(found, PMMA)
        assert np.isnan(critical.load_factor[0]) and critical.refused[0] == ""
        complete = CriticalDistance(line).judge(found, PMMA, np.array([True]))
        assert complete.refused[0] == Status.TOO_DEEP


def test_a_stress_that_sinks_to_zero_within_the_distance_is_refused():
    found = curves(lambda a: 10.0 - 10.0 * a / POINT, 3 * LINE)
    assert [CRITERIA[name].judge(found, PMMA).refused[0] for name in ("point", "line")] == [
        Status.TOO_DEEP
    ] * 2
    assert CRITERIA["rankine"].judge(found, PMMA).refused[0] == ""


def test_compression_all_along_needs_no_load_at_all():
    found = curves(lambda a: -10.0 + 0 * a, 3 * LINE, error=2.0)
    for name in ("rankine", "point", "line"):
        critical = CRITERIA[name].judge(found, PMMA)
        assert np.isinf(critical.load_factor[0])
        assert critical.error[0] == pytest.approx(10.0 / PMMA.sigma_c)  # what the error of the stress allows


def test_griffith_needs_a_crack():
    assert CRITERIA["griffith"].judge(curves(lambda a: 10 + a, 1.0), PMMA).refused[0] == Status.NO_CRACK
    assert energy_release_rate(3.0, 4.0, PMMA) == pytest.approx(25.0 / PMMA.E)


def test_mises_of_uniaxial_equibiaxial_and_shear_stress():
    one, zero = np.array([7.0]), np.zeros(1)
    assert mises_stress(one, zero, zero, PMMA) == pytest.approx(7.0)
    assert mises_stress(one, one, zero, PMMA) == pytest.approx(7.0)
    assert mises_stress(zero, zero, one, PMMA) == pytest.approx(7.0 * np.sqrt(3))
    strained = Material(PMMA.E, 0.25, PMMA.sigma_c, PMMA.G_c, "plane strain")
    assert mises_stress(one, one, zero, strained) == pytest.approx(3.5)


@pytest.mark.parametrize("name", CRITERIA)
def test_every_criterion_says_what_it_needs_and_skips_what_has_no_curves(name):
    criterion = CRITERIA[name]
    assert criterion.needs <= {"stress", "energy", "equivalent stress"} and criterion.needs
    assert criterion.bounded_by in ("surface", "path", "nothing")
    critical = criterion.judge(PathCurves.empty(3), PMMA)
    assert np.isnan(critical.load_factor).all() and (critical.refused == "").all()


def test_the_coupled_criterion_is_the_one_with_the_least_stress_unless_asked():
    assert CRITERIA["coupled"] == Coupled() != Coupled(average=True)
    assert (Coupled().bounded_by, Coupled(average=True).bounded_by) == ("surface", "path")
