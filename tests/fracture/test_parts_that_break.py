"""Random parts on supports, pins and tractions: they break, and mirrored, turned and larger they break alike."""

from functools import cache

import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.history import Outcome
from slmm.scene.scene import Scene

#: the model resolves so much of U_T at tolerance 0.01, see `slmm.fracture.boundary_engine.ORDERS`
RESOLVED = 2e-3
#: paths lie where directions of the same accuracy lead over the height of a beam, mm
APART = 0.05


def beam(seed, mirrored=False, turned=False, factor=1.0):
    """A bar on three knife edges, a crack aside of the load and a hole, all at random; mirrored, turned, larger."""
    random = np.random.default_rng(seed)
    length, height = 100.0, 20.0
    x, a, load = random.uniform(36.0, 46.0), random.uniform(4.0, 8.0), random.uniform(48.0, 56.0)
    hole = [random.uniform(54.0, 64.0), random.uniform(8.0, 12.0)]

    def at(point):
        px, py = point
        px = length - px if mirrored else px
        return [factor * (height - py), factor * px] if turned else [factor * px, factor * py]

    def along(way, up):
        """A condition across and along the load."""
        return [-up if up != "free" else up, way] if turned else [way, up]

    sides = [factor * length, factor * height]
    plate = sides[::-1] if turned else sides
    edges = {"width": 0.5 * factor}
    return Scene.from_dict(
        {
            "plate": {"width": plate[0], "height": plate[1], "thickness": 5.0},
            "holes": [{"shape": "circle", "center": at(hole), "radius": 3.0 * factor}],
            "cracks": [{"points": [at((x, 0.0)), at((x, a))]}],
            "material": {"E": 3000.0, "nu": 0.36, "sigma_c": 70.0 / np.sqrt(factor), "K_Ic": 1.8},
            "boundary": [
                *(
                    {"at": at((support, 0.0)), "displacement": along("free", 0.0), **edges}
                    for support in (10.0, 90.0)
                ),
                {"at": at((load, 20.0)), "force": along(0.0, -100.0), **edges},
            ],
        }
    ), at


def broken(scene, increment=2.0):
    return simulate(scene, increment, errors=False)


@cache
def broken_beam(seed):
    return broken(beam(seed)[0])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    ("changes", "tougher"),
    [({"mirrored": True}, 1.0), ({"turned": True}, 1.0), ({"factor": 3.0}, 3.0)],
    ids=["mirrored", "turned", "three times as large"],
)
def test_beams_break_alike(seed, changes, tougher):
    """With K_Ic alike U_T grows as the area of a crack, of a given thickness."""
    scene, at = beam(seed, **changes)
    factor = changes.get("factor", 1.0)
    one, two = broken_beam(seed), broken(scene, 2.0 * factor)
    assert two.event.values.tolist() == one.event.values.tolist()
    assert float(two.U_T) == pytest.approx(tougher * float(one.U_T), rel=RESOLVED)
    expected = np.array([at(point) for point in zip(one.x.values, one.y.values, strict=True)])
    off = np.hypot(two.x.values - expected[:, 0], two.y.values - expected[:, 1])
    assert off.max() < APART * factor


def bar(random):
    """A bar under tension with a notch of random depth, opening and root in either side."""
    y = random.uniform(25.0, 35.0, 2)
    notches = [
        {
            "shape": "v-notch",
            "tip": [tip, float(height)],
            "direction": direction,
            "opening": float(random.uniform(20.0, 90.0)),
            "radius": float(random.choice([0.0, 0.5, 2.0])),
        }
        for tip, height, direction in (
            (random.uniform(3, 7), y[0], 0.0),
            (random.uniform(14, 18), y[1], 180.0),
        )
    ]
    return {
        "plate": {"width": 20.0, "height": 60.0, "thickness": 3.0},
        "holes": notches,
        "load": {"stress": 5.0},
    }


def compact_tension(random):
    """A specimen on pins, with a crack of random length and a third hole at a random place."""
    outline = {"shape": "rectangle", "center": [15.0, 0.0], "size": [50.0, 48.0], "corner_radius": 0.0}
    third = [float(random.uniform(24.0, 32.0)), float(random.uniform(-14.0, 14.0))]
    return {
        "part": {"outline": outline, "thickness": 10.0},
        "holes": [
            *({"shape": "circle", "center": [0.0, y], "radius": 5.0} for y in (11.0, -11.0)),
            {"shape": "circle", "center": third, "radius": float(random.uniform(1.5, 4.0))},
        ],
        "cracks": [{"points": [[-10.0, 0.0], [float(random.uniform(8.0, 16.0)), 0.0]]}],
        "boundary": [{"on": f"hole {k}", "pin": [0.0, F]} for k, F in ((0, 600.0), (1, -600.0))],
    }


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", [bar, compact_tension])
def test_notched_bars_and_pinned_parts_are_severed_and_their_energy_is_told(kind, seed):
    tables = kind(np.random.default_rng(seed))
    result = broken(Scene.from_dict({**tables, "material": {"name": "PMMA"}}))
    assert result.attrs["outcome"] == Outcome.SEVERED
    work = float(np.trapezoid(result.F, result.u))
    assert float(result.released.sum()) == pytest.approx(work, rel=1e-9) and float(result.stored) == 0.0
    assert float(result.released.min()) > -RESOLVED * work
