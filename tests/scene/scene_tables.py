"""A scene as tables, and holes to put into it."""

import copy

import numpy as np

from slmm.part import shapes

CIRCLE = {"shape": "circle", "center": [50.0, 50.0], "radius": 20.0}
ELLIPSE = {"shape": "ellipse", "center": [50.0, 50.0], "semi_axes": [20.0, 10.0]}
RECTANGLE = {"shape": "rectangle", "center": [50.0, 50.0], "size": [30.0, 20.0], "corner_radius": 5.0}
POLYGON = {"shape": "polygon", "points": [[40.0, 40.0], [60.0, 40.0], [60.0, 60.0]]}
SQUARE = {"shape": "rectangle", "center": [50.0, 50.0], "size": [20.0, 20.0], "corner_radius": 0}
DIAMOND = {"shape": "polygon", "points": [[60, 50], [50, 60], [40, 50], [50, 40]], "corner_radius": 2.0}
V_NOTCH = {"shape": "v-notch", "tip": [10.0, 50.0], "direction": 0.0, "opening": 60.0}
BASE = {
    "plate": {"width": 100.0, "height": 100.0},
    "holes": [CIRCLE],
    "material": {"name": "PMMA"},
    "load": {"strain": [0.0, 0.1, 0.0]},
}
USER = {"E": 3000.0, "nu": 0.3, "sigma_c": 50.0}


def scene_with(**tables):
    return {**copy.deepcopy(BASE), **tables}


def outline_of(points):
    return {"holes": [{"shape": "points", "points": np.asarray(points).tolist()}]}


RING = shapes.circle((50.0, 50.0), 20.0)[::10]
