"""Pieces that come loose: which they are, and a simulation that goes on as if there had been a hole."""

import numpy as np
import pytest
import xarray as xr

from slmm.fracture import simulate
from slmm.fracture.critical_state import critical_state, part_before
from slmm.fracture.history import Outcome
from slmm.fracture.loose_pieces import carrying_piece
from slmm.optimization import HolePattern
from slmm.part.part import Part
from slmm.scene.gallery import tensile_plate
from slmm.scene.loading import plate_loading
from slmm.scene.scene import Scene

PLATE = Part.plate(40.0, 40.0)
PULLED = plate_loading(40.0, 40.0, displacement=1.0)
STRESSED = plate_loading(40.0, 40.0, stress=1.0)
#: the model resolves so much of U_T at tolerance 0.01, see `slmm.fracture.boundary_engine.ORDERS`
RESOLVED = 2e-3
#: two cracks from one hole to the other, and what they cut out with them as one hole
BETWEEN = [[(36.0, y), (44.0, y)] for y in (54.0, 58.0)]
HOLES = [(34.0, 56.0, 4.0), (46.0, 56.0, 4.0)]


@pytest.mark.parametrize(
    ("loading", "crack", "area"),
    [
        (PULLED, [(0.0, 15.0), (12.0, 15.0), (12.0, 25.0), (0.0, 25.0)], 1480.0),
        (PULLED, [(0.0, 10.0), (10.0, 0.0)], 1550.0),
        (STRESSED, [(0.0, 15.0), (12.0, 15.0), (12.0, 25.0), (0.0, 25.0)], 1480.0),
    ],
    ids=["a piece of the side", "a corner on the support", "a piece of the side under a stress"],
)
def test_what_is_cut_off_and_carries_nothing_is_loose(loading, crack, area):
    assert carrying_piece(PLATE.with_crack(crack), loading).area == pytest.approx(area)


@pytest.mark.parametrize("loading", [PULLED, STRESSED])
def test_halves_carry_nothing(loading):
    assert carrying_piece(PLATE.with_crack([(0.0, 20.0), (40.0, 22.0)]), loading) is None


def test_a_loaded_corner_that_nothing_holds_falls_off():
    assert carrying_piece(PLATE.with_crack([(0.0, 10.0), (10.0, 0.0)]), STRESSED) is None


@pytest.mark.parametrize("turned", [False, True], ids=["level", "upright"])
@pytest.mark.parametrize("beside", [0.0, 3.0], ids=["at the load", "beside it"])
def test_a_beam_on_knife_edges_is_severed_by_a_crack_through_it(turned, beside):
    """The one half that is loaded has but one knife edge, which holds no moment."""

    def at(x, y):
        return [20.0 - y, x] if turned else [x, y]

    held = [0.0, "free"] if turned else ["free", 0.0]
    edges = [{"at": at(x, 0.0), "width": 0.5, "displacement": held} for x in (10.0, 90.0)]
    load = {"at": at(50.0, 20.0), "width": 0.5, "force": [100.0, 0.0] if turned else [0.0, -100.0]}
    crack = [at(x, y) for x, y in ((47.0, 0.0), (48.1, 9.0), (50.0 - beside, 20.0))]
    sides = (20.0, 100.0) if turned else (100.0, 20.0)
    scene = Scene.from_dict(
        {
            "plate": dict(zip(("width", "height"), sides, strict=True)),
            "material": {"name": "PMMA"},
            "boundary": [*edges, load],
        }
    )
    assert carrying_piece(scene.part.with_crack(crack), scene.loading) is None


def test_two_that_carry_are_told():
    part = PLATE.with_crack([(15.0, 0.0), (15.0, 40.0)])
    with pytest.raises(ValueError, match=r"2 pieces, of which those at .* carry loads, each by itself"):
        carrying_piece(part, PULLED)


def cut_out(holes=HOLES, between=BETWEEN):
    """A plate with a crack and holes, and what is between them cut out by cracks of its own."""
    lines = [[[0.0, 40.0], [10.0, 40.0]], *between]
    return tensile_plate(holes).with_(cracks=[{"points": line} for line in lines])


def one_hole():
    """The same with one hole, which is as much."""
    between = {"shape": "rectangle", "center": [40.0, 56.0], "size": [8.0, 4.0], "corner_radius": 0.0}
    circles = [{"shape": "circle", "center": [x, y], "radius": radius} for x, y, radius in HOLES]
    return tensile_plate().with_(holes=[*circles, between])


@pytest.fixture(scope="module")
def pattern(tmp_path_factory):
    """A random hole pattern in which a piece comes loose in the seventh step, its result and its journal."""
    rows = (
        "...oo.o... ...o....o. o.o.....o. .o...ooo.o ..ooo...o. "
        ".......o.o .ooo.o..o. ...o..o.o. ..o......o ..o...o.oo"
    )
    design = [[cell == "o" for cell in row] for row in rows.split()]
    scene, path = HolePattern(10, "full").scene(design, 1), tmp_path_factory.mktemp("loose") / "run.jsonl"
    return scene, simulate(scene, 2.0, first_length=1.0, errors=False, journal=path), path


def test_a_piece_that_comes_loose_on_the_way_is_told_and_the_plate_breaks_later(pattern):
    _, result, _ = pattern
    assert result.attrs["outcome"] == Outcome.SEVERED and result.loose_step.values.tolist() == [6]
    work = float(np.trapezoid(result.F, result.u))
    assert float(result.released.sum()) == pytest.approx(work, rel=1e-9)
    assert float(result.released.min()) > -RESOLVED * work


@pytest.mark.parametrize("steps", [7, 9], ids=["as it comes loose", "later"])
def test_it_is_resumed_to_the_bit(pattern, tmp_path, steps):
    scene, result, journal = pattern
    path = tmp_path / "run.jsonl"
    path.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[: 1 + steps]))
    again = simulate(scene, 2.0, first_length=1.0, errors=False, journal=path, resume=True)
    xr.testing.assert_identical(again, result)


def test_states_behind_it_know_of_it(pattern):
    scene, result, _ = pattern
    before, behind = (part_before(scene, result, k) for k in (6, 7))
    area = float(result.loose_area[0])
    along_its_edge = 4 * np.sqrt(area) * before.tolerance
    assert before.body.area - behind.body.area == pytest.approx(area, abs=along_its_edge)
    state = critical_state(scene, result, 7)
    assert state.F / state.u == pytest.approx(float(result.stiffness[7]), rel=1e-3)


@pytest.mark.parametrize("engine", ["boundary", "fem"])
def test_a_plate_breaks_as_if_a_hole_were_where_the_piece_was(engine):
    ours, hole = (simulate(scene, 4.0, engine=engine, errors=False) for scene in (cut_out(), one_hole()))
    assert ours.attrs["outcome"] == hole.attrs["outcome"] == Outcome.SEVERED
    assert float(ours.U_T) == pytest.approx(float(hole.U_T), rel=RESOLVED)
    assert ours.loose_step.values.tolist() == [-1]
    assert (float(ours.loose_x[0]), float(ours.loose_y[0])) == pytest.approx((40.0, 56.0))


def test_a_piece_of_the_edge_leaves_a_notch():
    """And cracks of the part stay what they are: the one that ran on behind the piece begins at the notch."""
    lines = [[[80.0, 44.0], [74.0, 44.0], [74.0, 30.0]], [[80.0, 36.0], [70.0, 36.0]]]
    scene = cut_out([], lines)
    notch = {"shape": "rectangle", "center": [79.0, 40.0], "size": [10.0, 8.0], "corner_radius": 0.0}
    tables = [[[0.0, 40.0], [10.0, 40.0]], [[74.0, 36.0], [74.0, 30.0]], [[74.0, 36.0], [70.0, 36.0]]]
    alike = tensile_plate().with_(holes=[notch], cracks=[{"points": line} for line in tables])
    ours, other = (simulate(each, 4.0, errors=False) for each in (scene, alike))
    assert float(ours.stiffness[0]) == pytest.approx(float(other.stiffness[0]), rel=1e-5)
    assert float(ours.U_T) == pytest.approx(float(other.U_T), rel=RESOLVED)
    assert ours.sizes["crack"] == 3 + int((ours.event == "start").sum())
