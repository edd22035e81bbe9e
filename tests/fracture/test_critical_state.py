"""States at critical loads, from the result alone: supports, forces, and faces of cracks that open."""

import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.critical_state import critical_state, number_of_states, part_before
from slmm.scene.gallery import edge_crack, tensile_plate


@pytest.fixture(scope="module")
def one_hole():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    return scene, simulate(scene, increment=4.0, errors=False)


def test_the_part_before_each_step_has_what_grew_till_then(one_hole):
    scene, result = one_hole
    for k in range(result.sizes["step"] + 1):
        part = part_before(scene, result, k)
        length = sum(np.linalg.norm(np.diff(crack.points, axis=0), axis=1).sum() for crack in part.cracks)
        dissipated = float(result.dissipated.values[:k].sum())
        assert length == pytest.approx(10.0 + dissipated / scene.material.G_c, rel=1e-9)
    assert part.is_severed


def test_forces_and_displacements_are_those_of_the_steps(one_hole):
    scene, result = one_hole
    for k in range(0, result.sizes["step"], 4):
        state = critical_state(scene, result, k)
        assert state.u == float(result.u_c[k])
        assert pytest.approx(float(result.stiffness[k]) * state.u, rel=2e-4) == state.F
        top, bottom = state.displacement(np.array([[40.0, 80.0], [40.0, 0.0]]))
        assert (top[1], bottom[1]) == pytest.approx((state.u, 0.0), abs=1e-6)


def test_under_forces_too():
    scene = edge_crack()
    result = simulate(scene, increment=8.0, errors=False)
    state = critical_state(scene, result, 1)
    F = float(result.stiffness[1] * result.u_c[1])
    assert pytest.approx(F, rel=1e-3) == state.F
    # sigma_yy on the upper edge carries it: 40 x 5 mm2
    stress = state.stress(np.column_stack([np.linspace(2.0, 38.0, 10), np.full(10, 119.0)]))
    assert stress[:, 1].mean() == pytest.approx(F / 200, rel=0.01)


def test_faces_open_as_far_as_the_jumps_say(one_hole):
    scene, result = one_hole
    state = critical_state(scene, result, 8)
    points, opening = state.model.opening()
    found = np.concatenate([faces.points[1:-1] for faces in state.faces])
    assert len(found) == len(points)
    for faces in state.faces:
        apart = np.linalg.norm(faces.left - faces.right, axis=1)[1:-1]
        nearest = [np.abs(points - point).sum(axis=1).argmin() for point in faces.points[1:-1]]
        assert apart == pytest.approx(state.factor * opening[nearest], rel=1e-3, abs=1e-6)


def test_the_face_on_the_left_of_the_way_moves_up_and_tips_are_closed(one_hole):
    scene, result = one_hole
    (faces,) = critical_state(scene, result, 2).faces
    assert (np.diff(faces.points[:, 0]) > 0).all()
    assert (faces.left[:-1, 1] > faces.right[:-1, 1]).all()
    assert faces.left[-1].tolist() == faces.right[-1].tolist()


def test_a_crack_near_its_tip_opens_as_the_root_of_the_distance(one_hole):
    """u = 8 K_I/E' sqrt(r/(2 pi)), E' = E/(1 - nu^2)."""
    scene, result = one_hole
    state = critical_state(scene, result, 1)
    (faces,) = state.faces
    r = np.linalg.norm(faces.points - faces.points[-1], axis=1)
    near = (r > 0) & (r < 0.1)
    K_I, material = float(result.K_I[1]), scene.material
    exact = 8 * K_I * (1 - material.nu**2) / material.E * np.sqrt(r[near] / (2 * np.pi))
    assert near.any()
    assert (faces.left - faces.right)[near, 1] == pytest.approx(
        exact, rel=0.015
    )  # the next term is of the order r/a


def test_a_part_that_was_loaded_on_has_one_more_state():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    result = simulate(scene, increment=8.0, largest_displacement=0.4, errors=False)
    last = number_of_states(result) - 1
    assert last == result.sizes["step"]
    state = critical_state(scene, result, last)
    assert state.u == 0.4
    assert pytest.approx(float(result.F[-1]), rel=1e-3) == state.F


def test_what_is_no_state_is_refused(one_hole):
    scene, result = one_hole
    assert number_of_states(result) == result.sizes["step"]
    for step in (-1, result.sizes["step"]):
        with pytest.raises(ValueError, match=f"step = {step}: the simulation has"):
            critical_state(scene, result, step)
    nothing = simulate(tensile_plate(displacement=-1.0, cracks=[]), errors=False)
    assert number_of_states(nothing) == 0
