"""Where surfaces crack beside singular stresses at supports."""

import numpy as np
import pytest

from slmm.criteria.distances import point_distance
from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.fracture.initiation_sites import critical_sites
from slmm.mechanics.stress import principal_stress
from slmm.scene.scene import Scene


@pytest.mark.parametrize("width", [0.05, 0.2, 1.0])
def test_a_notch_is_found_however_narrow_the_supports_are(width):
    """Where a support ends the stress is as large as the points there are near; the root of the notch is not."""
    supports = [{"at": [x, 0.0], "width": width, "displacement": ["free", 0.0]} for x in (2.0, 42.0)]
    notch = {"shape": "v-notch", "tip": [22.0, 3.0], "direction": 90.0, "opening": 0.0, "radius": 0.5}
    scene = Scene.from_dict(
        {
            "plate": {"width": 44.0, "height": 10.0, "thickness": 5.0},
            "holes": [notch],
            "material": {"name": "PMMA"},
            "boundary": [*supports, {"at": [22.0, 10.0], "width": 0.2, "force": [0.0, -300.0]}],
        }
    )
    model = BoundaryEngine(scene.material, scene.loading, 0.01).solve(scene.part).model
    site = critical_sites(model, 0.0)[0]
    assert site.point == pytest.approx([22.0, 3.0], abs=0.01)
    below = np.array([[22.0, 3.0 + point_distance(scene.material)]])
    assert site.stress == pytest.approx(float(principal_stress(model.stress(below))[0]), rel=1e-4)
