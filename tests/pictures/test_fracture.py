"""The picture of a fracture process shows its cracks and its curve."""

import numpy as np

from slmm.fracture import simulate
from slmm.pictures.fracture import plot_fracture
from slmm.scene.gallery import tensile_plate


def test_cracks_and_curve_are_drawn():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    result = simulate(scene, increment=8.0)
    figure = plot_fracture(scene, result)
    part, curve = figure.axes[:2]
    assert [text.get_text() for text in part.texts] == ["1"]
    drawn = sum(len(lines.get_segments()) for lines in part.collections if lines.get_array() is not None)
    assert drawn == result.sizes["step"]
    assert np.array_equal(curve.lines[0].get_xydata(), np.column_stack([result.u, result.F]))


def test_a_part_that_nothing_happens_to_is_drawn():
    scene = tensile_plate(displacement=-1.0, cracks=[])
    plot_fracture(scene, simulate(scene, errors=False)).canvas.draw()
