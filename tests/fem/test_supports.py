"""Elements are small where supports end, in corners held on one side alone, and where the stress is not smooth."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fem.supports import at_supports, at_unsmooth_stress
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.part.span import Span
from slmm.scene.loading import Affine, Condition, Loading, plate_loading

PMMA = Material.from_name("PMMA")
CLAMPED, ROLLER = (Affine(), Affine()), (None, Affine())
W, H = 40.0, 30.0


def held(start, end, displacement=CLAMPED):
    return Loading((Condition(start, end, displacement),))


def places(loading, part=None):
    return sorted(map(tuple, at_supports(part or Part.plate(W, H), loading)[0].tolist()))


def test_a_clamped_stretch_has_two_ends_and_a_clamped_edge_two_corners():
    assert places(held((10.0, 0.0), (25.0, 0.0))) == [(10.0, 0.0), (25.0, 0.0)]
    assert places(held((0.0, 0.0), (W, 0.0))) == [(0.0, 0.0), (W, 0.0)]


def test_a_roller_is_a_mirror_at_corners_and_none_on_an_edge():
    assert places(held((0.0, 0.0), (W, 0.0), ROLLER)) == []
    assert places(held((10.0, 0.0), (W, 0.0), ROLLER)) == [(10.0, 0.0)]


def test_edges_that_are_all_held_or_only_pulled_leave_nothing_singular():
    assert places(plate_loading(W, H, strain=(1e-3, 0.0, 1e-3))) == []
    assert places(plate_loading(W, H, stress=1.0)) == []


def test_sizes_are_shares_of_the_shorter_side():
    points, sizes = at_supports(Part.plate(W, H), held((10.0, 0.0), (25.0, 0.0)), SizePolicy(at_tips=0.01))
    assert dict(zip(points[:, 0].tolist(), sizes.tolist(), strict=True)) == pytest.approx(
        {10.0: 0.1, 25.0: 0.15}
    )


def test_with_them_stiffness_and_stress_beside_a_foot_converge():
    """Without them the whole plate is too stiff by what is missed at the ends, which falls with the size alone."""
    part = Part.plate(W, H, [Outline.through(circle((20.0, 15.0), 4.0))])
    foot = Condition((10.0, 0.0), (25.0, 0.0), CLAMPED)
    top = Condition((W, H), (0.0, H), (Affine(), Affine(0.1)))
    loading = Loading((foot, top))
    fine = BoundaryModel(part, PMMA, loading, p=12)
    beside = np.array([[5.0, 0.0], [9.0, 0.0], [11.0, 0.0], [18.0, 0.0], [24.0, 0.0], [0.0, 28.0]])
    stress, force = fine.stress(beside), fine.reaction(foot)[1]
    off = {}
    for name, sizes in (("graded", at_supports(part, loading)), ("even", None)):
        model = PlateModel(plate_mesh(part, None, None, sizes, loading.ends).refined(), PMMA, loading)
        of_stress = np.abs(model.stress(beside) - stress).max() / np.abs(stress).max()
        off[name] = abs(model.reaction(foot)[1] / force - 1), of_stress
    assert off["graded"][0] < 2e-4
    assert off["graded"][1] < 0.02
    assert off["even"][0] > 5 * off["graded"][0]


HOLE = Outline.through(circle((20.0, 15.0), 4.0))


def unsmooth(loading, part=None):
    return sorted(map(tuple, at_unsmooth_stress(part or Part.plate(W, H), loading)[0].round(6).tolist()))


def on_hole(**acts):
    at = tuple(HOLE.points(0.0).tolist())
    return Loading((Condition(at, at, span=Span(HOLE, HOLE.length, 0.0), **acts),))


def test_a_pressure_ends_in_two_jumps_and_that_of_a_pin_in_two_kinks():
    assert unsmooth(Loading((Condition((10.0, 0.0), (25.0, 0.0), pressure=2.0),))) == [
        (10.0, 0.0),
        (25.0, 0.0),
    ]
    part = Part.plate(W, H, [HOLE])
    assert unsmooth(on_hole(bearing=(5.0, 0.0)), part) == [(20.0, 11.0), (20.0, 19.0)]
    assert unsmooth(on_hole(pressure=5.0), part) == []


def test_one_pressure_on_two_stretches_is_smooth_where_they_meet():
    stretches = (Condition((a, 0.0), (b, 0.0), pressure=2.0) for a, b in ((0.0, 15.0), (15.0, W)))
    assert unsmooth(Loading(tuple(stretches))) == []


def test_plates_that_are_pulled_need_none_and_the_mouths_of_v_notches_do():
    part = Part.plate(W, H, [HOLE])
    assert unsmooth(plate_loading(W, H, stress=1.0), part) == []
    notch = Outline.of_pieces(
        [[(25.0, -5.0), (20.0, 8.0)], [(20.0, 8.0), (15.0, -5.0)], [(15.0, -5.0), (25.0, -5.0)]]
    )
    x = 20.0 - 5.0 * 8.0 / 13.0
    found = unsmooth(plate_loading(W, H, stress=1.0), Part.plate(W, H, [notch]))
    np.testing.assert_allclose(found, [(x, 0.0), (40.0 - x, 0.0)], atol=1e-5)


def test_with_them_the_stress_at_the_kink_of_a_pins_pressure_is_that_of_boundary_integrals():
    """Without them it falls with less than the square of the size, and an estimate from two meshes is too small."""
    part, kink = Part.plate(W, H, [HOLE]), np.array([[20.0, 19.0]])
    left = Condition((0.0, H), (0.0, 0.0), (Affine(), None))
    loading = Loading((*on_hole(bearing=(5.0, 0.0)), left))
    wanted = BoundaryModel(part, PMMA, loading, p=14).stress(kink)[0, 0]
    policy = SizePolicy()
    off = {}
    for name, sizes in (("graded", at_unsmooth_stress(part, loading)), ("even", None)):
        meshes = [plate_mesh(part, None, policy, sizes, loading.ends)]
        meshes.append(meshes[0].refined())
        off[name] = [PlateModel(mesh, PMMA, loading).stress(kink)[0, 0] / wanted - 1 for mesh in meshes]
    assert abs(off["graded"][1]) < 1e-3
    assert off["even"][1] / off["even"][0] > 0.25
    assert off["even"][1] / off["graded"][1] > 10
