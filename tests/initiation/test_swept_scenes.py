"""Sweeps: each variant is what it would be alone, for much less than it would cost alone."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation import sweep
from slmm.initiation.peaks import LEAST_RISE
from slmm.initiation.question import Question
from slmm.scene import gallery
from slmm.scene.variants import variants_of

VARY = {"load.strain": [0.004, 0.02], "material.sigma_c": "50:90:3", "material.K_Ic": [0.8, 1.6]}
#: some of these, with the shortest and the longest Irwin's length
SOME = [2, 4, 7, 11]


def alone(scene, vary, some=slice(None), **asked):
    """The largest index of variants on their own, with its error and crack length (n, 3)."""
    variants = variants_of(scene, vary)
    found = []
    for i, j in zip(variants.load[some], variants.material[some], strict=True):
        table = variants.made_of[j].material_table.model_dump(exclude_none=True)
        result = failure_indices(variants.loaded[i].with_(material=table), **asked)
        worst = result.isel(position=int(np.nanargmax(result.failure_index)))
        found.append(
            [float(worst[name]) for name in ("failure_index", "failure_index_error", "crack_length")]
        )
    return np.array(found)


@pytest.fixture
def asked(monkeypatch):
    """For how many materials a method is asked itself."""
    count, answered = [], Question.answered

    def counted(question):
        count.append(1)
        return answered(question)

    monkeypatch.setattr(Question, "answered", counted)
    return count


@pytest.mark.parametrize("method", ["slmm+ac", "slmm", "rankine", "mises"])
def test_where_the_curves_are_the_same_so_is_the_index(method, asked):
    scene = gallery.circular_hole(analysis={"positions": 8, "voxels": 10_000})
    result = failure_indices(scene, method, vary=VARY)
    assert result.failure_index.dims == tuple(VARY) and result.failure_index.shape == (2, 3, 2)
    assert len(asked) == result.attrs["answered"] == 1
    expected = alone(scene, VARY, SOME, method=method)
    found = result.stack(variant=tuple(VARY)).isel(variant=SOME)
    np.testing.assert_allclose(found.failure_index, expected[:, 0], rtol=1e-9)
    np.testing.assert_allclose(found.load_factor, 1 / expected[:, 0], rtol=1e-9)
    np.testing.assert_allclose(found.failure_index_error, expected[:, 1], rtol=1e-6)
    np.testing.assert_allclose(found.crack_length, expected[:, 2], rtol=1e-9)
    assert (result.status == "ok").all()


@pytest.mark.parametrize("method", ["auto", "boundary", "point", "line"])
def test_where_curves_reach_farther_the_index_is_the_same_within_its_error(method, asked):
    scene = gallery.elliptic_hole(analysis={"positions": 8, "voxels": 10_000})
    result = failure_indices(scene, method, vary=VARY)
    # Irwin's lengths over 13
    assert len(asked) <= 2
    expected = alone(scene, VARY, SOME, method=method)
    found = result.stack(variant=tuple(VARY)).isel(variant=SOME)
    assert np.all(np.abs(found.failure_index - expected[:, 0]) <= found.failure_index_error + expected[:, 1])
    # much nearer than that, for curves are smooth: within what may lie between two positions
    np.testing.assert_allclose(found.failure_index, expected[:, 0], rtol=LEAST_RISE)


def test_over_decades_of_toughness_curves_reach_far_enough(asked):
    """From cracks far shorter than the hole to such as do not fit any more."""
    scene = gallery.circular_hole(analysis={"positions": 8})
    vary = {"material.K_Ic": "0.05:5:7:log"}
    result = failure_indices(scene, "boundary", vary=vary)
    assert len(asked) == 7  # each is more than four times as long as the one before
    expected = alone(scene, vary, method="boundary")
    told = result.failure_index_error.values + expected[:, 1]
    assert np.all(np.abs(result.failure_index.values - expected[:, 0]) <= told)
    assert np.all(np.diff(result.failure_index) < 0) and np.all(np.diff(result.crack_length) > 0)


def test_a_load_that_is_varied_alone_needs_one_answer(asked):
    scene = gallery.v_notch(60.0, 1.0, analysis={"positions": 8})
    result = failure_indices(scene, "boundary", vary={"load.stress": "1:20:20"})
    assert len(asked) == 1
    critical = result.load_factor * result["load.stress"]
    np.testing.assert_allclose(critical, float(critical[0]), rtol=1e-12)


def test_stiffness_under_a_given_strain_and_under_a_stress():
    """sigma = E epsilon: a stiffer part cracks at a lower strain, and at the same stress where strength decides."""
    vary = {"material.E": [1000.0, 4000.0]}
    settings = {"positions": 8, "voxels": 10_000}
    strained = failure_indices(gallery.circular_hole(analysis=settings), "rankine", vary=vary)
    np.testing.assert_allclose(strained.failure_index[1], 4 * strained.failure_index[0], rtol=1e-9)
    loaded = gallery.circular_hole(analysis=settings, load={"stress": 10.0})
    pulled = failure_indices(loaded, "rankine", vary=vary)
    np.testing.assert_allclose(pulled.failure_index[1], pulled.failure_index[0], rtol=1e-9)


@pytest.mark.parametrize("method", ["slmm+ac", "boundary"])
def test_several_loads_are_each_of_their_combinations(method):
    scene = gallery.circular_hole(analysis={"points": [[66.0, 62.0], [70.0, 50.0]], "voxels": 10_000})
    # sums of load cases are as good as the solver of voxels, 1e-8
    vary = {"load.strain.0": [-0.01, 0.02], "load.strain.1": [0.01, 0.02]}
    result = failure_indices(scene, method, vary=vary)
    np.testing.assert_allclose(
        result.failure_index.values.ravel(), alone(scene, vary, method=method)[:, 0], rtol=1e-6
    )
    assert result.attrs["elastic_fields"] == 4


@pytest.mark.parametrize("method", ["auto", "slmm+ac"])
def test_no_bound_lies_below_the_index_and_its_error(method):
    scene = gallery.circular_hole(analysis={"positions": 12, "voxels": 10_000})
    result = failure_indices(scene, method, vary=VARY)
    reached = result.failure_index + result.failure_index_error
    assert (result.failure_index_bound >= reached * (1 - 1e-12)).all()


def test_a_variant_without_a_value_says_why():
    scene = gallery.square_hole(analysis={"positions": 4, "voxels": 10_000})
    result = failure_indices(scene, "slmm+ac", vary={"load.strain": [0.01, 0.1]})
    assert result.failure_index.isnull().all() and np.isinf(result.failure_index_bound).all()
    assert all("no cell" in str(status) for status in result.status.values)


def test_a_lateral_contraction_that_cells_do_not_know_is_told_by_the_variants_that_have_it():
    scene = gallery.circular_hole(
        analysis={"points": [[70.0, 50.0]], "voxels": 10_000}, load={"stress": 10.0}
    )
    result = failure_indices(scene, "slmm+ac", vary={"material.nu": [-0.95, 0.3]})
    assert str(result.status[1].values) == "ok"
    assert "holds the effective Poisson's ratios" in str(result.status[0].values)
    assert np.isnan(result.failure_index[0]) and np.isinf(result.failure_index_bound[0])


def test_positions_without_a_value_leave_it_open():
    scene = gallery.square_hole(analysis={"positions": 12, "voxels": 10_000})
    result = failure_indices(scene, "slmm+ac", vary={"load.strain": [0.01, 0.1]})
    assert result.failure_index.notnull().all()
    assert all(
        "may be higher at 10 positions without a value: no cell" in str(status)
        for status in result.status.values
    )


def test_turned_cracks_are_looked_for_anew_with_each_length():
    angle = np.radians(25.0)
    point = [50.0 + 20.0 * np.cos(angle), 50.0 + 20.0 * np.sin(angle)]
    scene = gallery.circular_hole(analysis={"points": [point], "method": "boundary", "direction": "best"})
    vary = {"load.strain": [0.05, 0.1], "material.K_Ic": [0.5, 1.5]}
    result = failure_indices(scene, vary=vary)
    assert result.attrs["direction"] == "best" and result.attrs["answered"] == 2
    np.testing.assert_allclose(result.failure_index.values.ravel(), alone(scene, vary)[:, 0], rtol=1e-9)
    assert np.all(result.turned < -1.0)


def test_results_are_labelled():
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]], "voxels": 10_000})
    result = failure_indices(scene, "slmm+ac", vary={"material.name": "PMMA,PS", "load.strain": [0.1]})
    assert result["material.name"].values.tolist() == ["PMMA", "PS"]
    for name, variable in result.variables.items():
        assert variable.attrs["units"] and variable.attrs["long_name"], name
    assert {"version", "method", "title", "answered", "elastic_fields"} <= set(result.attrs)


def test_what_sweeps_do_not_take_is_named():
    scene = gallery.circular_hole()
    with pytest.raises(ValueError, match="not with curves"):
        failure_indices(scene, curves=True, vary=VARY)
    with pytest.raises(ValueError, match="not with displacements"):
        failure_indices(scene, "slmm", displacements="plate.vtu", vary=VARY)
    with pytest.raises(ValueError, match="available are"):
        failure_indices(scene, "slmm-ac", vary=VARY)
    with pytest.warns(sweep.UnusualValueWarning, match="and 1 more among 3 materials"):
        failure_indices(
            gallery.circular_hole(analysis={"points": [[70.0, 50.0]], "voxels": 10_000}),
            "slmm+ac",
            vary={"material.E": [1e7, 2e7, 3000.0]},
        )
