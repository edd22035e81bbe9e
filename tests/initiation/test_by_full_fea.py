"""Method full-fea: paths that are long enough, up to those that sever the ligament."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from slmm import failure_indices
from slmm.criteria.status import Status
from slmm.initiation import by_boundary, by_full_fea
from slmm.initiation.by_full_fea import sampled
from slmm.initiation.full_fea import FullFEA, full_fea_curves
from slmm.initiation.methods import SOURCES
from slmm.scene import gallery

pytest.importorskip("netgen")

E, SIGMA_C = 2960.0, 70.5


def between_holes(l_ch, **changes):
    """The middle of a ligament of 2 mm, in a material with this Irwin's length, mm."""
    material = {"E": E, "nu": 0.35, "sigma_c": SIGMA_C, "G_c": l_ch * SIGMA_C**2 / E}
    return gallery.two_holes(2.0, analysis={"points": [[49.0, 50.0]]}, material=material, **changes)


def test_a_tough_ligament_breaks_at_once_and_its_index_is_that_of_the_energy():
    """Both materials are too tough for any shorter crack; the energy grows with the load squared."""
    one, other = (failure_indices(between_holes(l_ch), "full-fea").isel(position=0) for l_ch in (20.0, 80.0))
    for result in (one, other):
        assert result.status == "ok" and result.governed_by == "energy"
        assert float(result.crack_length) == pytest.approx(2.0, rel=1e-4)
        assert float(result.failure_index_error) < 0.01 * float(result.failure_index)
    assert float(one.failure_index) == pytest.approx(2 * float(other.failure_index), rel=1e-6)


def test_what_short_paths_say_stays_where_no_path_goes_through_the_ligament(monkeypatch):
    def fails(*arguments):
        raise ValueError("the path ends at a crack")

    monkeypatch.setattr(by_full_fea, "ligament_end", fails)
    monkeypatch.setattr(by_boundary, "through", fails)
    result = failure_indices(between_holes(20.0), "full-fea", curves=True).isel(position=0)
    assert result.status == Status.BEYOND_PATH and np.isnan(result.failure_index)
    assert float(result.a[-1]) == pytest.approx(1.6, rel=1e-4)
    bounded = failure_indices(between_holes(20.0), "auto").isel(position=0)
    assert bounded.used_method == "bounds" and bounded.status == "ok"
    monkeypatch.undo()
    truth = failure_indices(between_holes(20.0), "full-fea").isel(position=0)
    assert abs(float(bounded.failure_index - truth.failure_index)) <= float(bounded.failure_index_error)
    assert float(bounded.failure_index_error) < float(bounded.failure_index)


def test_a_load_that_carries_the_severed_part_away_needs_the_strength_alone():
    """Between two notches under a stress: however tough, the energy has no end as the crack reaches the other one."""
    notch = {"shape": "v-notch", "opening": 60.0, "radius": 1.0}
    scene = gallery.circular_hole(
        plate={"width": 20.0, "height": 40.0},
        holes=[notch | {"tip": [x, 20.0], "direction": angle} for x, angle in ((5.0, 0.0), (15.0, 180.0))],
        load={"stress": 10.0},
        material={"E": E, "nu": 0.35, "sigma_c": SIGMA_C, "G_c": 1e4 * SIGMA_C**2 / E},
        analysis={"points": [[5.0, 20.0]]},
    )
    result = failure_indices(scene, "full-fea", curves=True).isel(position=0)
    assert result.status == "ok" and float(result.crack_length) > 9.0
    least = float(result.sigma_I.min()) / SIGMA_C
    assert 1.0 < least * SIGMA_C / 10.0 < 2.0  # in the middle, less than the mean of 20 MPa
    assert float(result.failure_index) == pytest.approx(least, rel=0.01)


@pytest.mark.parametrize("corner", [False, True])
def test_two_meshes_do_where_they_meet_the_tolerance(monkeypatch, corner):
    """Their estimate covers what three meshes differ by, and a small tolerance asks for the third."""
    scene = (
        gallery.v_notch(analysis={"points": [[10.0, 60.0]]})
        if corner
        else gallery.circular_hole(analysis={"points": [[70.0, 50.0]]})
    )
    truth = failure_indices(scene, "full-fea").isel(position=0)
    asked = []

    def noted(*arguments, levels, **keywords):
        asked.append(levels)
        return full_fea_curves(*arguments, levels=levels, **keywords)

    monkeypatch.setattr(by_full_fea, "full_fea_curves", noted)
    two = replace(SOURCES["full FEA"], answer=partial(by_full_fea.by_full_fea, least=0.0))
    monkeypatch.setitem(SOURCES, "full FEA", two)
    for tolerance, levels in ((0.02, [2]), (0.0005, [2, 3])):
        asked.clear()
        result = failure_indices(scene, "full-fea", tolerance=tolerance).isel(position=0)
        assert asked == levels
        off = abs(float(result.failure_index - truth.failure_index))
        assert off <= float(result.failure_index_error) <= 0.02 * float(truth.failure_index)
    # three meshes are those of the method by its own name
    assert off == 0


def test_energy_of_a_narrow_notch_does_not_rise_towards_its_tip():
    """Its power law has an exponent near zero, whose sign round-off may turn: 0.1 % were an infinite index."""
    a = np.geomspace(0.01, 1.0, 20)
    model = FullFEA(
        a=a,
        G_inc=a**-0.001,
        G_inc_error=0.001 * a,
        eta=a,
        sigma=np.zeros((20, 3)),
        sigma_I=a**-0.5,
        sigma_I_error=0.001 * a,
        start=np.zeros(2),
        direction=np.array([1.0, 0.0]),
    )
    curves = sampled(model, np.radians(5.0))
    assert curves.G_inc.max() == pytest.approx(0.01**-0.001, rel=1e-6)


def test_what_is_known_to_end_too_early_is_not_tried_again(monkeypatch):
    """Trial cracks reach to 0.8 of a ligament that breaks at once: full FEA starts with the whole of it."""
    scene, ends = between_holes(20.0), []

    def fails(*arguments):
        raise ValueError("no trial crack goes through")

    def noted(*arguments, end=None, **keywords):
        ends.append(end)
        return full_fea_curves(*arguments, end=end, **keywords)

    monkeypatch.setattr(by_boundary, "through", fails)
    monkeypatch.setattr(by_full_fea, "full_fea_curves", noted)
    result = failure_indices(scene, "auto").isel(position=0)
    assert result.status == "ok" and result.used_method == "full-fea"
    assert ends and all(end is not None for end in ends)
