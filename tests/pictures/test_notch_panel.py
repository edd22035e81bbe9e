"""The notches, their stress and the cracks that are and that start."""

import numpy as np
from made_up_result import made_up
from pictured import PLATE, cracked, panel, plate_of_the_data

from slmm.initiation.failure import failure_indices
from slmm.pictures.initiation import plot_initiation


def test_cracks_are_drawn_and_new_ones_go_straight_on(coarse):
    scene = cracked()
    result = made_up(scene)
    result["failure_index"][-1] = 5.0  # the tip of the kinked one
    axes = panel(plot_initiation(scene, result), "notch")
    drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
    np.testing.assert_array_equal(drawn["initial crack"], scene.cracks[0].points)
    (new,) = (xy for label, xy in drawn.items() if label.startswith("crack, "))
    np.testing.assert_allclose(new[0], [25.0, 16.0])
    np.testing.assert_allclose((new[1] - new[0]) / np.linalg.norm(new[1] - new[0]), [0.0, 1.0], atol=1e-12)


def test_a_result_on_given_displacements_is_not_drawn_on_another_stress(coarse):
    scene = plate_of_the_data()
    result = failure_indices(scene, "slmm+ac", 8, curves=True, displacements=PLATE)
    assert not panel(plot_initiation(scene, result), "notch").images
    assert panel(plot_initiation(scene, result, PLATE), "notch").images
