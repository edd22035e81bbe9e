"""Simulations that were stopped end as they would have ended, to the bit."""

import pytest
import xarray as xr

from slmm.fracture import simulate
from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.fracture.history import Outcome
from slmm.fracture.journal import digest_of
from slmm.scene.gallery import circular_hole, tensile_plate

INCREMENT = 8.0


def plate():
    return tensile_plate([(38.0, 44.0, 7.0)])


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A journal, and the result that it led to."""
    path = tmp_path_factory.mktemp("journal") / "calm.jsonl"
    return path, simulate(plate(), INCREMENT, journal=path)


@pytest.fixture
def solves(monkeypatch):
    """Parts that are solved."""
    solve, parts = BoundaryEngine.solve, []

    def counted(self, part):
        parts.append(part)
        return solve(self, part)

    monkeypatch.setattr(BoundaryEngine, "solve", counted)
    return parts


def test_a_journal_changes_nothing(undisturbed):
    xr.testing.assert_identical(undisturbed[1], simulate(plate(), INCREMENT))


def test_stopped_after_any_step_it_ends_as_if_undisturbed(undisturbed, tmp_path):
    path, result = undisturbed
    lines = path.read_bytes().splitlines(keepends=True)
    assert len(lines) == result.sizes["step"] + 2
    for k in range(len(lines)):
        cut = tmp_path / f"{k}.jsonl"
        cut.write_bytes(b"".join(lines[:k]) + lines[k][:20])
        xr.testing.assert_identical(simulate(plate(), INCREMENT, journal=cut, resume=True), result)
        assert cut.read_bytes() == path.read_bytes()


def test_from_any_step_it_ends_as_if_undisturbed_and_what_followed_is_gone(undisturbed, tmp_path):
    path, result = undisturbed
    again = tmp_path / "again.jsonl"
    for k in range(result.sizes["step"] + 1):
        again.write_bytes(path.read_bytes())
        resumed = simulate(plate(), INCREMENT, journal=again, resume=True, from_step=k)
        xr.testing.assert_identical(resumed, result)
        assert again.read_bytes() == path.read_bytes()


def test_from_a_step_the_rest_is_solved_anew(undisturbed, tmp_path, monkeypatch):
    """A simulation that failed goes on behind a step before the failure."""
    path, result = undisturbed
    failing, solve, left = tmp_path / "failing.jsonl", BoundaryEngine.solve, [5]

    def fails(self, part):
        left[0] -= 1
        if left[0] < 0:
            raise ValueError("boundary integrals: too many points")
        return solve(self, part)

    monkeypatch.setattr(BoundaryEngine, "solve", fails)
    failed = simulate(plate(), INCREMENT, journal=failing)
    assert failed.attrs["outcome"].startswith(Outcome.FAILED) and failed.sizes["step"] == 5
    left[0] = 100
    assert simulate(plate(), INCREMENT, journal=failing, resume=True).sizes["step"] == 5
    mended = simulate(plate(), INCREMENT, journal=failing, resume=True, from_step=3)
    xr.testing.assert_identical(mended, result)
    assert failing.read_bytes() == path.read_bytes()


def test_steps_that_are_not_there_are_refused_and_nothing_is_lost(undisturbed, tmp_path):
    path, result = undisturbed
    steps, again, missing = result.sizes["step"], tmp_path / "again.jsonl", tmp_path / "missing.jsonl"
    again.write_bytes(path.read_bytes())
    with pytest.raises(ValueError, match=rf"holds {steps} steps, and cannot go on behind step {steps + 1}"):
        simulate(plate(), INCREMENT, journal=again, resume=True, from_step=steps + 1)
    assert again.read_bytes() == path.read_bytes()
    with pytest.raises(ValueError, match=r"missing\.jsonl: is not there, and holds no 2 steps"):
        simulate(plate(), INCREMENT, journal=missing, resume=True, from_step=2)
    assert not missing.exists()
    with pytest.raises(ValueError, match="from_step = 2: needs resume = True"):
        simulate(plate(), INCREMENT, journal=again, from_step=2)
    for value in (-1, 1.5):
        with pytest.raises(ValueError, match=f"from_step = {value}: must be a number of steps, 0 or more"):
            simulate(plate(), INCREMENT, journal=again, resume=True, from_step=value)


def test_what_has_ended_is_read_back_without_a_solve(undisturbed, solves):
    path, result = undisturbed
    xr.testing.assert_identical(simulate(plate(), INCREMENT, journal=path, resume=True), result)
    assert not solves


def test_solved_again_is_what_the_engine_keeps_something_of(undisturbed, solves, tmp_path):
    path, result = undisturbed
    last = result.sizes["step"] - 1
    cut = tmp_path / "cut.jsonl"
    cut.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[: 1 + last]))
    simulate(plate(), INCREMENT, journal=cut, resume=True)
    assert len(solves) == last + 1


@pytest.mark.parametrize(
    "settings",
    [{"largest_displacement": 0.4}, {"errors": False}],
    ids=["the largest displacement", "without errors"],
)
def test_other_ends_are_resumed_too(settings, tmp_path, solves):
    path = tmp_path / "run.jsonl"
    result = simulate(plate(), INCREMENT, journal=path, **settings)
    lines = path.read_bytes().splitlines(keepends=True)
    for content in (lines, lines[:-1], lines[:2]):
        path.write_bytes(b"".join(content))
        solves.clear()
        again = simulate(plate(), INCREMENT, journal=path, resume=True, **settings)
        xr.testing.assert_identical(again, result)
        assert not solves or content is not lines


def test_what_severs_a_part_is_told_after_a_stop_there(tmp_path):
    path = tmp_path / "run.jsonl"
    result = simulate(plate(), INCREMENT, journal=path, errors=False)
    assert result.attrs["outcome"] == Outcome.SEVERED
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:-1]))
    again = simulate(plate(), INCREMENT, journal=path, resume=True, errors=False)
    xr.testing.assert_identical(again, result)


def test_another_scene_and_other_settings_are_refused_by_name(undisturbed):
    path, _ = undisturbed
    with pytest.raises(ValueError, match=r"with increment = 8.0, .* has increment = 4.0"):
        simulate(plate(), 4.0, journal=path, resume=True)
    with pytest.raises(
        ValueError, match=r"scene = Tensile plate, 1 hole \(.* has scene = Tensile plate, 0 holes"
    ):
        simulate(tensile_plate(), INCREMENT, journal=path, resume=True)
    with pytest.raises(ValueError, match="resume = True: needs the journal"):
        simulate(plate(), INCREMENT, resume=True)


def test_a_step_that_would_lead_elsewhere_is_refused(undisturbed, tmp_path, monkeypatch):
    path, _ = undisturbed
    cut = tmp_path / "cut.jsonl"
    cut.write_bytes(path.read_bytes())
    monkeypatch.setattr("slmm.fracture.growth.THIN", 30.0)
    with pytest.raises(ValueError, match=r"step \d+ of the journal leads crack 0 to .* begin anew"):
        simulate(plate(), INCREMENT, journal=cut, resume=True)


def test_a_digest_knows_all_that_breaks_and_nothing_else():
    scene = circular_hole()
    changed = [
        scene,
        scene.with_(plate={"thickness": 2.0}),
        scene.with_(holes=[{"shape": "circle", "center": [50.0, 50.0], "radius": 20.1}]),
        scene.with_(material={"name": "PS"}),
        scene.with_(material={"state": "plane strain"}),
        scene.with_(load={"stress": 1.0}),
        scene.with_(load={"stress": 2.0}),
        scene.with_(cracks=[{"points": [[0.0, 30.0], [10.0, 30.0]]}]),
    ]
    assert len({digest_of(one) for one in changed}) == len(changed)
    assert digest_of(scene.with_(analysis={"positions": 7}, title="x")) == digest_of(scene)


def test_trial_cracks_do_not_show_after_a_stop(tmp_path):
    path = tmp_path / "run.jsonl"
    result = simulate(plate(), INCREMENT, "coupled", journal=path)
    lines = path.read_bytes().splitlines(keepends=True)
    for k in range(2, len(lines) - 1, 3):
        path.write_bytes(b"".join(lines[:k]))
        xr.testing.assert_identical(
            simulate(plate(), INCREMENT, "coupled", journal=path, resume=True), result
        )
