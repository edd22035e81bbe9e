"""`stiff` in `[[boundary]]`: what it means, and what is refused."""

import pytest

from slmm.scene.conditions import Boundary
from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene

BOTTOM = {"on": "bottom", "displacement": [0.0, 0.0]}
PLATE = {"width": 40.0, "height": 20.0, "thickness": 2.0}


def scene(*boundary):
    return Scene.from_dict({"plate": PLATE, "material": {"name": "PMMA"}, "boundary": list(boundary)})


def test_forces_act_through_the_middle_of_the_material():
    notch = {"shape": "rectangle", "center": [0.0, 20.0], "size": [20.0, 4.0], "corner_radius": 0.0}
    tables = {"plate": PLATE, "material": {"name": "PMMA"}, "holes": [notch]}
    top = {"on": "top", "stiff": True, "force": [30.0, 60.0], "moment": 8.0}
    (body,) = Scene.from_dict({**tables, "boundary": [BOTTOM, top]}).loading.stiff
    assert body.middle == pytest.approx((25.0, 20.0))
    assert body.force == pytest.approx((15.0, 30.0, 4.0)) and body.free == (True, True, True)


def test_round_a_corner_it_is_one_body():
    top = {"from": [40, 10], "to": [20, 20], "stiff": True, "force": [0.0, 1.0]}
    loading = scene(BOTTOM, top).loading
    assert len(loading.conditions) == 3 and len(loading.stiff) == 1


def test_what_is_given_of_its_motion():
    loading = scene(
        BOTTOM, {"on": "top", "stiff": True, "displacement": ["free", 0.1], "rotation": 1.0}
    ).loading
    assert loading.stiff[0].free == (True, False, False)
    x, y = loading.conditions[1].displacement
    assert (x.at + 20.0 * x.by_y, y.at + 20.0 * y.by_x) == pytest.approx((0.0, 0.1))


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (
            {"pressure": 1.0, "stiff": True},
            "stiff = true: moves as one body, by a force or with a displacement",
        ),
        ({"force": [0, 1], "moment": 3.0}, "moment = 3: belongs to stiff = true"),
        ({"force": [0, 1], "stiff": True, "moment": 3.0, "rotation": 0.0}, "moment and rotation contradict"),
        ({"force": [0, 1], "stiff": 1}, "stiff"),
    ],
)
def test_what_does_not_go_with_it_is_refused(table, says):
    with pytest.raises(SceneError, match=says):
        scene(BOTTOM, {"on": "top", **table})


def test_a_part_that_could_still_move_is_refused():
    with pytest.raises(SceneError, match="free to move along x, with what is stiff on it"):
        scene({"on": "bottom", "displacement": ["free", 0.0]}, {"on": "top", "stiff": True, "force": [0, 1]})


def test_a_bar_that_nothing_pushes_is_no_load():
    with pytest.raises(SceneError, match="moves and loads nothing"):
        scene(BOTTOM, {"on": "top", "stiff": True, "force": [0, 0]})
    assert Boundary.model_validate({"on": "top", "force": [0, 1]}).stiff is False
