"""A bar between a wall and a rigid body, straight or turned, with a hole or without."""

import numpy as np

from slmm.scene.scene import Scene

LENGTH, HEIGHT, THICKNESS = 60.0, 10.0, 2.0


def bar(turn=0.0, hole=False, length=LENGTH, **moved):
    """Scene, and a function that places points of the straight bar."""

    def placed(*points):
        z = np.array([complex(*point) for point in points]) * np.exp(1j * turn)
        return np.column_stack([z.real, z.imag])

    corners = placed((0, 0), (length, 0), (length, HEIGHT), (0, HEIGHT)).tolist()
    holes = [{"shape": "circle", "center": placed((0.5 * length, 5.5))[0].tolist(), "radius": 2.5}]
    scene = Scene.from_dict(
        {
            "part": {"outline": {"shape": "polygon", "points": corners}, "thickness": THICKNESS},
            "holes": holes if hole else [],
            "material": {"name": "PMMA"},
            "boundary": [
                {"from": corners[3], "to": corners[0], "displacement": [0.0, 0.0]},
                {"from": corners[1], "to": corners[2], "stiff": True, **moved},
            ],
        }
    )
    return scene, placed
