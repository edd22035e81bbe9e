"""Methods as pairs of a source and a criterion: every criterion on every source that gives what it needs."""

from dataclasses import dataclass
from typing import ClassVar, get_args

import numpy as np
import pytest

from slmm import failure_indices
from slmm.criteria.criterion import CRITERIA
from slmm.criteria.path_curves import Critical, PathCurves, path_points
from slmm.initiation import by_choice
from slmm.initiation.methods import METHODS, SOURCES, Method, Source
from slmm.initiation.task import Answer
from slmm.scene import gallery
from slmm.scene.tables import Criterion

HOLE = gallery.circular_hole(analysis={"points": [[70, 50]]}, load={"strain": [0.0, 0.01, 0.0]})


def index(scene, method, **options):
    result = failure_indices(scene, method, **options)
    assert result.status.values.tolist() == ["ok"], (method, options, result.status.values)
    return float(result.failure_index[0]), float(result.failure_index_error[0])


def test_names_in_the_scene_file_are_those_of_criteria_and_sources_exist():
    assert set(get_args(Criterion)) == set(CRITERIA) - {"mises"}
    for method in METHODS.values():
        assert CRITERIA[method.criterion].needs <= SOURCES[method.source].gives


@pytest.mark.parametrize("criterion", ["rankine", "point", "line"])
def test_a_criterion_is_the_same_on_every_source(criterion):
    """On the stress of cells, of dislocations and of full FEA, within their estimates."""
    pytest.importorskip("netgen")
    exact, own = index(HOLE, "full-fea", criterion=criterion)
    assert index(HOLE, "slmm", criterion=criterion)[0] == pytest.approx(
        exact, rel=0.01
    )  # which has no estimate
    for method in ("slmm+ac", "dislocations", "auto"):
        value, error = index(HOLE, method, criterion=criterion)
        assert abs(value - exact) <= error + own, method
    value, error = index(HOLE, criterion)
    assert abs(value - exact) <= error + own
    assert value == pytest.approx(exact, rel=0.03)


def test_the_point_method_applies_at_corners_where_the_asymptotics_give_the_stress():
    pytest.importorskip("netgen")
    scene = gallery.square_hole(analysis={"points": [[65, 65]]}, load={"strain": [0.0, 0.003, 0.0]})
    near, error = index(scene, "full-fea", criterion="point")
    value, own = index(scene, "asymptotics", criterion="point")
    assert value == pytest.approx(near, abs=error + own)
    refused = failure_indices(scene, "asymptotics", criterion="rankine")
    assert "no strength criterion applies" in str(refused.status.values[0])


def test_griffith_on_full_fea_is_griffith_by_intensities():
    pytest.importorskip("netgen")
    scene = gallery.edge_crack(10.0)
    value, _ = index(scene, "full-fea", criterion="griffith")
    own, _ = index(scene, "griffith")
    assert value == pytest.approx(own, rel=2e-3)


def test_the_scene_may_ask_for_the_criterion_and_the_result_says_which():
    scene = HOLE.with_(analysis={"criterion": "point"})
    result = failure_indices(scene, "slmm+ac")
    assert result.attrs["criterion"] == "point"
    assert float(result.failure_index[0]) == index(HOLE, "slmm+ac", criterion="point")[0]
    assert "criterion" not in failure_indices(HOLE, "slmm+ac").attrs
    # a method that is a criterion itself stays what it is
    assert index(scene, "rankine") == index(HOLE, "rankine")


@pytest.mark.parametrize(
    ("method", "options", "says"),
    [
        ("slmm+ac", {"criterion": "tresca"}, "criterion = 'tresca': available are coupled, rankine"),
        ("slmm+ac", {"criterion": "mises"}, "the method slmm\\+ac gives no equivalent stress"),
        ("rankine", {"criterion": "point"}, "the method rankine is one itself"),
        ("slmm+ac", {"criterion": "point", "average": True}, "average: belongs to the coupled criterion"),
    ],
)
def test_what_does_not_go_together_is_refused(method, options, says):
    with pytest.raises(ValueError, match=says):
        failure_indices(HOLE, method, **options)


def test_one_more_criterion_is_one_class_and_a_line(monkeypatch):
    """The stress at half Irwin's length: judged on any source, without a word elsewhere."""

    @dataclass(frozen=True)
    class Deep:
        needs: ClassVar[frozenset[str]] = frozenset({"stress"})
        bounded_by: ClassVar[str] = "path"

        def depth(self, material):
            return 0.05 * material.irwin_length

        def judge(self, curves, material, complete=None):
            found = Critical.empty(len(curves.a))
            for i in np.flatnonzero(np.isfinite(curves.a[:, -1])):
                value = float(np.interp(self.depth(material), curves.a[i], curves.sigma_I[i]))
                found.put_stress(i, value, 0.0, material.sigma_c)
            return found

    monkeypatch.setitem(CRITERIA, "deep", Deep())
    value, _ = index(HOLE, "slmm+ac", criterion="deep")
    low, high = (index(HOLE, "slmm+ac", criterion=name)[0] for name in ("point", "rankine"))
    assert low < value < high


def test_one_more_source_is_one_function_and_a_line(monkeypatch):
    """Kirsch's stress and a crack's energy beside a straight edge, for any criterion."""

    def kirsch(task):
        answer = Answer.empty(task.n, "kirsch")
        a = path_points(task.paths.longest)
        E = task.scene.material.plane_stress_equivalent[0]
        q = 20.0 / (20.0 + a)
        sigma = 0.01 * E * (1 + 0.5 * q**2 + 1.5 * q**4)
        zero = np.zeros_like(a)
        curves = PathCurves(a, 1.98 * sigma**2 * a / E, sigma, zero, zero)
        answer.judge(np.arange(task.n), curves, task, "too short")
        return answer

    monkeypatch.setitem(SOURCES, "kirsch", Source(kirsch, frozenset({"stress", "energy"})))
    monkeypatch.setitem(METHODS, "kirsch", Method("kirsch", "coupled"))
    material = HOLE.material
    assert index(HOLE, "kirsch", criterion="rankine")[0] == pytest.approx(
        0.03 * material.E / material.sigma_c
    )
    assert index(HOLE, "kirsch")[0] < index(HOLE, "kirsch", criterion="rankine")[0]


def test_under_auto_the_result_tells_what_each_method_was_made_with(monkeypatch):
    pytest.importorskip("netgen")
    scene = gallery.square_hole(analysis={"points": [[65, 65], [65, 50]]})
    attrs = failure_indices(scene, "auto").attrs
    assert attrs["local_model"].startswith("boundary: boundary; full-fea: ")
    assert attrs["boundary_points"] > 0 and attrs["tolerance"] == 0.02
    monkeypatch.setattr(by_choice, "POINTS_AFFORDED", 0)
    attrs = failure_indices(scene, "auto").attrs
    assert attrs["local_model"].startswith("slmm+ac: voxels; asymptotics: body-fitted")
    assert attrs["voxels"] > 0 and attrs["tolerance"] == 0.02
    assert failure_indices(scene, "asymptotics").attrs["local_model"] == "body-fitted"
