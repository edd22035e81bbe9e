"""Cracks through whole ligaments: against full FEA at the end, convergence, and what severs the part."""

import numpy as np
import pytest

from slmm import Scene, failure_indices
from slmm.boundary.model import BoundaryModel
from slmm.boundary.trial_cracks import SOLVED
from slmm.criteria.status import Status
from slmm.initiation import by_choice
from slmm.initiation.by_boundary import LONGER
from slmm.initiation.through_ligament import LAST, through
from slmm.scene import gallery

GAP = 0.5
SCENE = gallery.two_holes(GAP)
START, END = np.array([50.0 - GAP / 2, 50.0]), np.array([50.0 + GAP / 2, 50.0])
MODEL = BoundaryModel(SCENE.part, SCENE.material, SCENE.loading, 10)


def along(longer=LONGER, model=MODEL, solved=SOLVED):
    return through(model, START, END, 1.0, None, solved, longer)


def test_the_cut_is_the_same_from_either_side():
    there = along()
    back = through(MODEL, END, START, 1.0, None, SOLVED, LONGER)
    assert there.cuts and back.cuts
    assert back.G[-1] == pytest.approx(there.G[-1], rel=1e-5)


def test_few_lengths_do():
    """The energy at every length is good to 0.1 %."""
    fine = along(14)
    inside = fine.a < (1 - LAST) * GAP
    off = [np.abs(along(n).G[inside][1:] / fine.G[inside][1:] - 1).max() for n in (5, LONGER)]
    assert off[1] < 1e-3 < off[0]


def test_as_full_fea_where_the_ligament_goes_at_once(monkeypatch):
    """The crack is the whole ligament: 0.05 %, of which full FEA tells most itself."""
    pytest.importorskip("netgen")
    scene = gallery.two_holes(0.05, analysis={"points": [[49.975, 50.0]]})
    full = failure_indices(scene, "full-fea").isel(position=0)
    monkeypatch.setattr(by_choice, "find_spec", lambda name: None)
    for method in ("boundary", "auto"):
        result = failure_indices(scene, method).isel(position=0)
        assert result.status == "ok" and float(result.crack_length) == pytest.approx(0.05, rel=0.01)
        assert float(result.failure_index) == pytest.approx(float(full.failure_index), rel=5e-4)
        assert result.failure_index_error < 5e-3 * result.failure_index


def test_what_severs_the_part_has_bounds(monkeypatch):
    """A strip pulled by a given displacement, so tough that it breaks at once; full FEA knows what that sets free."""
    notch = {"shape": "circle", "center": [0.0, 30.0], "radius": 5.0}
    scene = Scene.from_dict(
        {
            "plate": {"width": 20.0, "height": 60.0},
            "holes": [notch],
            "material": {"E": 3000.0, "nu": 0.3, "sigma_c": 20.0, "K_Ic": 12.0},
            "load": {"displacement": 1.0},
            "analysis": {"points": [[5.0, 30.0]]},
        }
    )
    alone = failure_indices(scene, "boundary").isel(position=0)
    assert alone.status == Status.SEVERS
    monkeypatch.setattr(by_choice, "find_spec", lambda name: None)
    result = failure_indices(scene, "auto").isel(position=0)
    assert result.status == "ok" and result.used_method == by_choice.BOUNDS
    assert Status.SEVERS in str(result.reason.values)
    assert alone.failure_index_bound >= result.failure_index
