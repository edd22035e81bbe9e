"""Evidence that is kept, and judged once more for other materials."""

import numpy as np
import pytest

from slmm.criteria.coupled_curves import Coupled
from slmm.criteria.path_curves import PathCurves, path_points
from slmm.criteria.status import Status
from slmm.initiation.evidence import Evidence, Stands
from slmm.initiation.judged_again import for_material, judged_again
from slmm.initiation.task import Answer
from slmm.mechanics.material import Material

E = 1000.0


def material(l_ch, sigma_c=10.0):
    return Material(E=E, nu=0.3, sigma_c=sigma_c, G_c=l_ch * sigma_c**2 / E)


def straight_edge(a_max, n=1):
    """Curves of n straight edges under 20 MPa: a crack starts with 0.506 l_ch (1.1215^2 pi/2 = 1.976)."""
    a = path_points(np.full(n, a_max))
    sigma = np.full(a.shape, 20.0) - 1e-6 * a
    error = np.full(a.shape, 0.01)
    return PathCurves(a, 1.976 * 400.0 * a / E, sigma, error, error)


class Asked:
    """What `Answer.judge` wants of a task."""

    criterion = Coupled()

    def __init__(self, material):
        self.scene = self
        self.material = material


def answered(*pieces, l_ch=1.0):
    """An answer of one position with pieces of evidence (longest crack, stands)."""
    answer = Answer.empty(1, "boundary")
    for a_max, stands in pieces:
        answer.judge(
            np.array([0]), straight_edge(a_max), Asked(material(l_ch)), Status.BEYOND_PATH, stands=stands
        )
    return answer


def test_one_more_judgement_is_the_first_one_of_another_material():
    other = material(0.3, sigma_c=15.0)
    again = for_material(answered((2.0, None)), Coupled(), other)
    expected = Answer.empty(1, "boundary")
    expected.judge(np.array([0]), straight_edge(2.0), Asked(other), Status.BEYOND_PATH)
    for name in ("load_factor", "crack_length", "error", "status", "governed_by"):
        assert getattr(again, name)[0] == getattr(expected, name)[0], name
    assert again.crack_length[0] == pytest.approx(0.506 * 0.3, rel=1e-3)


def test_what_did_not_suffice_stays_and_serves_shorter_cracks():
    answer = answered((0.2, None), (2.0, None))
    assert [evidence.curves.a[0, -1] for evidence, _ in answer.evidence[0]] == [0.2, 2.0]
    found = judged_again(answer, Coupled(), [material(1.0), material(0.1)])
    np.testing.assert_allclose(found.crack_length[:, 0], [0.506, 0.0506], rtol=2e-3)
    assert found.stands.all()


def test_what_sufficed_gives_way_to_what_is_better():
    answer = answered((1.0, None), (2.0, None))
    assert len(answer.evidence[0]) == 1


def test_longer_cracks_than_all_evidence_are_for_the_method_itself():
    found = judged_again(answered((2.0, None)), Coupled(), [material(10.0)])
    assert found.status[0, 0] == Status.BEYOND_PATH and not found.stands[0, 0]
    # but where there was no value either, it would find none again
    found = judged_again(answered((0.2, None)), Coupled(), [material(0.9)])
    assert found.status[0, 0] == Status.BEYOND_PATH and found.stands[0, 0]


def test_curves_stand_for_cracks_between_two_lengths():
    stands = Stands(np.array([0.05]), np.array([0.4]), np.array(["beyond {} mm"], dtype=object))
    answer = answered((2.0, stands), l_ch=0.5)
    assert answer.status[0] == Status.OK
    found = judged_again(answer, Coupled(), [material(0.5), material(1.0), material(0.05)])
    assert found.status[:, 0].tolist() == [Status.OK, "beyond 0.506 mm", Status.OK]
    assert found.stands[:, 0].tolist() == [True, False, False]
    assert np.isnan(found.load_factor[1, 0])


def test_a_position_without_evidence_is_the_same_only_if_its_reason_lasts():
    answer = Answer.empty(3, "slmm+ac")
    answer.status[:] = [Status.CORNER, Status.NO_CELL.of("undercut"), Status.NO_TRIAL.of("too long")]
    found = judged_again(answer, Coupled(), [material(1.0)])
    assert found.stands[0].tolist() == [True, True, False]
    assert found.status[0].tolist() == answer.status.tolist()


def test_where_energy_alone_decides_the_longest_crack_that_the_stress_allows_counts():
    """At a crack tip G is the same for any length, and the stress falls as the root of the distance."""
    a = path_points(np.array([1.0]))
    with np.errstate(divide="ignore"):
        sigma = 1.0 / np.sqrt(a)
    G = np.full(a.shape, 1e-3)
    curves = PathCurves(a, G, sigma, 0.1 * a, 0.0 * a)
    stands = Stands.below(np.array([0.5]), "beyond", any_length=True)
    evidence = Evidence(curves, stands, np.array([False]), Status.BEYOND_PATH, "asymptotics")
    G_c = 0.016
    judged = evidence.judged(Coupled(), [Material(E, 0.3, 10.0, G_c), Material(E, 0.3, 5.0, G_c)])
    # the load factor is 4: stresses of 10 MPa reach 0.16 mm, of 5 MPa 0.64 mm
    assert judged.critical.load_factor[0, 0] == pytest.approx(4.0)
    assert judged.length[:, 0] == pytest.approx([0.16, 0.64], rel=0.05)
    assert judged.critical.error[0, 0] == pytest.approx(0.5 * 0.1 * judged.length[0, 0])
    assert judged.status[:, 0].tolist() == [Status.OK, "beyond"]
