"""Scenes that are drawn in several tests, and the panels of a picture."""

from pathlib import Path

from slmm.scene import gallery
from slmm.scene.scene import Scene

PLATE = Path(__file__).parents[1] / "data" / "plate.vtu"


def cracked() -> Scene:
    """A hole and two cracks, the second one kinked."""
    cracks = [[[0.0, 30.0], [12.0, 33.0]], [[20.0, 0.0], [25.0, 8.0], [25.0, 16.0]]]
    return gallery.circular_hole(cracks=[{"points": points} for points in cracks])


def panel(figure, name):
    (axes,) = (axes for axes in figure.axes if axes.get_label() == name)
    return axes


def plate_of_the_data() -> Scene:
    holes = [{"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}]
    plate = {"width": 20.0, "height": 20.0}
    return gallery.circular_hole(plate=plate, holes=holes, load={"strain": [0.0, 0.01, 0.0]})
