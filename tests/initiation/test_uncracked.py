"""A field that has been solved goes into a prediction without being solved again."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation import by_cells
from slmm.initiation.local_model import solve_local_model
from slmm.initiation.uncracked import UncrackedField, WithStress
from slmm.scene import gallery

HOLE = gallery.circular_hole(analysis={"points": [[70, 50], [50, 70]]}, load={"strain": [0.0, 0.01, 0.0]})


def test_a_voxel_model_that_was_solved_serves_cells(monkeypatch):
    local = solve_local_model(HOLE, 62_500)
    assert isinstance(local, UncrackedField) and not isinstance(local, WithStress)
    expected = failure_indices(HOLE.with_(analysis={"voxels": 62_500}), "slmm").failure_index.values

    def never(*arguments, **options):
        raise AssertionError("it has been solved")

    monkeypatch.setattr(by_cells, "solve_local_model", never)
    result = failure_indices(HOLE, "slmm", displacements=local)
    np.testing.assert_allclose(result.failure_index.values, expected, rtol=1e-12)
    assert result.attrs["displacements"] == "voxels" and result.attrs["voxels"] == 62_500


def test_a_body_fitted_model_that_was_solved_serves_cells_and_gives_its_own_stress(monkeypatch):
    pytest.importorskip("netgen")
    from slmm.initiation import body_fitted

    model = body_fitted.solve_body_fitted(HOLE)
    assert isinstance(model, UncrackedField) and isinstance(model, WithStress)
    asked = HOLE.with_(analysis={"local_model": "body-fitted"})
    expected = {m: failure_indices(asked, m).failure_index.values for m in ("slmm+ac", "rankine", "point")}

    def never(*arguments, **options):
        raise AssertionError("it has been solved")

    monkeypatch.setattr(body_fitted, "PlateModel", never)
    for method, values in expected.items():
        found = failure_indices(HOLE, method, displacements=model)
        np.testing.assert_array_equal(found.failure_index.values, values)
        assert found.attrs["nodes"] == len(model.fine.points)


def test_methods_with_models_of_their_own_take_no_field():
    with pytest.raises(ValueError, match="method = 'full-fea': takes no displacements"):
        failure_indices(HOLE, "full-fea", displacements=solve_local_model(HOLE, 10_000))
    with pytest.raises(ValueError, match="field = 'u': belongs to displacements from a file"):
        failure_indices(HOLE, "slmm", displacements=solve_local_model(HOLE, 10_000), field="u")
