"""Cracks from smooth surfaces, all at once: against cracks as borders, and what does not depend on the frame."""

import numpy as np
import pytest

from slmm.boundary.along_path import AlongPaths
from slmm.boundary.model import BoundaryModel
from slmm.boundary.part_corrections import Starts, corrections, tangents
from slmm.boundary.rules import rule
from slmm.boundary.surface_cracks import SurfaceCracks
from slmm.boundary.trial_cracks import TrialCracks
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, ellipse
from slmm.scene.loading import plate_loading

MATERIAL = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1, state="plane stress")
SHARES = np.array([0.02, 0.1, 0.3, 0.6, 1.0])


def plate(*holes, width=20.0, height=30.0, **load):
    return BoundaryModel(
        Part.plate(width, height, holes=holes),
        MATERIAL,
        plate_loading(width, height, **load or {"stress": 10.0}),
        10,
    )


def starts_at(model, hole, shares, longest, turned=0.0):
    """From an outline at shares of its length, turned from the normal by an angle, rad."""
    outline = model.part.outlines[hole]
    s = np.asarray(shares) * outline.length
    mouth, normal = (v[:, 0] + 1j * v[:, 1] for v in (outline.points(s), outline.normals(s)))
    return Starts(
        mouth, normal * np.exp(1j * turned), normal, outline.curvatures(s), np.full(len(s), longest)
    )


def by_border(model, starts, k, a):
    mouth, e = (np.array([z.real, z.imag]) for z in (starts.mouth[k], starts.direction[k]))
    return TrialCracks(model, mouth, e, float(starts.longest[k])).incremental(a)


MODELS = {
    "one hole": plate(Outline.through(circle((9.0, 14.0), 3.0))),
    "a held plate": plate(Outline.through(circle((9.0, 14.0), 3.0)), strain=(0.002, 0.01, 0.004)),
    "two holes": plate(Outline.through(circle((6.0, 15.0), 3.0)), Outline.through(circle((13.0, 15.0), 2.5))),
    "ellipse": plate(Outline.through(ellipse((10.0, 15.0), (4.0, 2.0), 20.0))),
}


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("turned", [0.0, 0.5])
def test_as_a_crack_that_is_a_border(name, turned):
    """Which has nothing in common with them but the factorised part: 0.05 %, where it is worth speaking of."""
    model = MODELS[name]
    starts = starts_at(model, 0, [0.03, 0.3, 0.55], 0.8, turned)
    a = SHARES * starts.longest[:, None]
    G = SurfaceCracks(model, starts, tangents(model, starts)).incremental(a)
    border = np.array([by_border(model, starts, k, a[k]) for k in range(len(a))])
    assert np.abs(G - border).max(axis=1) == pytest.approx(0.0, abs=5e-4 * border.max())


def test_the_part_adds_what_betti_allows():
    """Jumps feel each other alike: the matrices are symmetric, though no step of theirs is."""
    model = MODELS["ellipse"]
    starts = starts_at(model, 0, [0.1, 0.4], 0.5)
    for S in corrections(model, starts, tangents(model, starts), 6):
        # beside what a jump along the whole path feels of itself
        assert np.abs(S - S.T).max() < 2e-3 / (np.pi * 0.5**2)


def test_in_an_endless_plate_a_round_hole_needs_no_correction():
    model = plate(Outline.through(circle((500.0, 500.0), 1.0)), width=1000.0, height=1000.0)
    starts = starts_at(model, 0, [0.0], 0.5)
    (S,) = corrections(model, starts, tangents(model, starts), 6)
    # beside what the place next to the surface feels of its own image; the outline's curvature is good to 3e-5
    depth = 0.25 * (1 + rule(6)[0][0])
    assert np.abs(S).max() < 3e-5 / (np.pi * (2 * depth) ** 2)


def test_a_mirrored_part_has_mirrored_cracks():
    left = plate(Outline.through(circle((7.0, 14.0), 3.0)))
    right = plate(Outline.through(circle((13.0, 14.0), 3.0)))
    at = np.array([4.0 + 14j]), np.array([16.0 + 14j])
    G = []
    for model, mouth, normal in ((left, at[0], -1.0), (right, at[1], 1.0)):
        inwards = np.array([normal + 0j])
        starts = Starts(mouth, inwards * np.exp(0.4j * normal), inwards, np.array([-1 / 3]), np.ones(1))
        G.append(SurfaceCracks(model, starts, tangents(model, starts)).incremental(SHARES[None]))
    assert G[0] == pytest.approx(G[1], rel=1e-5)


def test_twice_as_large_sets_twice_as_much_free():
    small, large = (
        plate(Outline.through(circle((9.0, 14.0), 3.0))),
        plate(Outline.through(circle((18.0, 28.0), 6.0)), width=40.0, height=60.0),
    )
    G = [
        SurfaceCracks(model, starts, tangents(model, starts)).incremental(a * SHARES[None])
        for model, a in ((small, 0.8), (large, 1.6))
        for starts in (starts_at(model, 0, [0.3], a),)
    ]
    assert G[1] == pytest.approx(2 * G[0], rel=1e-6)


def test_no_circle_stands_for_a_corner_of_the_curvature():
    """Where a straight side goes over into an arc."""
    hole = Outline.of_pieces(
        [
            [(7.0, 12.0), (7.0, 18.0)],
            [(7.0, 18.0), (13.0, 18.0)],
            [(13.0, 18.0), (13.0, 12.0)],
            [(13.0, 12.0), (7.0, 12.0)],
        ]
    )
    model = plate(hole)
    near, away = (starts_at(model, 0, [0.125 + share], 1.0) for share in (0.12, 0.0))
    assert tangents(model, near) == [None]
    assert tangents(model, away)[0].side == 0


def test_between_places_and_beyond_none_are_missed():
    paths = AlongPaths(np.array([2.0, 3.0]), np.array([0.1, 3.0]), 14)
    a = np.linspace(0.0, 1.0, 30) * paths.longest[:, None]

    def near_mouth(x):
        return 1 / (x + 0.1)

    found = (paths.at(a) @ near_mouth(paths.places)[..., None])[..., 0]
    assert found[0] == pytest.approx(near_mouth(a[0]), rel=1e-4)
    assert paths.tail(near_mouth(paths.places))[0] < 1e-3
