"""Parts of any outline by boundary integrals: against formulas, high-order values, body-fitted models, and turned."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.mechanics.cubics import closed_through
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.part.span import Span
from slmm.scene.loading import Affine, Condition, Loading, plate_loading
from slmm.scene.scene import Scene

STEEL = Material(3000.0, 0.3, 50.0, 1.0)
INNER, OUTER = 10.0, 20.0
RING = Part.within(Outline.through(circle((0, 0), OUTER)), [Outline.through(circle((0, 0), INNER))])
HELD = Affine(), Affine()


def all_of(outline, **acts):
    at = tuple(outline.points(0.0).tolist())
    return Condition(at, at, span=Span(outline, outline.length, 0.0), **acts)


def test_a_rectangle_as_a_part_is_the_plate():
    corners = [(0, 0), (40, 0), (40, 60), (0, 60)]
    outline = Outline.of_pieces([[a, b] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)])
    hole, crack = Outline.through(circle((20, 30), 8.0)), [[(0, 15), (6, 15)]]
    loading = plate_loading(40.0, 60.0, displacement=0.1)
    plate, part = (
        BoundaryModel(each, STEEL, loading)
        for each in (Part.plate(40.0, 60.0, [hole], crack), Part.within(outline, [hole], crack))
    )
    assert part.part.cracks[0].start == ("surface", 1)
    np.testing.assert_allclose(part.stress_intensities(), plate.stress_intensities(), rtol=1e-9)
    np.testing.assert_allclose(
        part.reaction(loading.conditions[1]), plate.reaction(loading.conditions[1]), rtol=1e-9
    )


def ring_of(pieces):
    """The ring, its circles cubic splines of so many pieces."""

    def through(radius):
        angle = np.linspace(0.0, 2 * np.pi, pieces + 1)
        spline = closed_through(radius * angle, radius * np.column_stack([np.cos(angle), np.sin(angle)])[:-1])
        return Outline(spline.breaks, spline.coefficients)

    return Part.within(through(OUTER), [through(INNER)])


def hoop_error(ring, p, pressure=5.0):
    """Largest along a sixth of the hole, over Lamé's stress."""
    model = BoundaryModel(ring, STEEL, Loading((all_of(ring.holes[0], pressure=pressure),)), p)
    angle = np.linspace(0.0, np.pi / 3, 37)
    points = INNER * np.column_stack([np.cos(angle), np.sin(angle)])
    across = np.column_stack([-np.sin(angle), np.cos(angle)])
    xx, yy, xy = model.stress(points).T
    hoop = xx * across[:, 0] ** 2 + yy * across[:, 1] ** 2 + 2 * xy * across[:, 0] * across[:, 1]
    wanted = pressure * (OUTER**2 + INNER**2) / (OUTER**2 - INNER**2)
    return np.abs(hoop / wanted - 1).max()


def test_pressure_in_a_ring():
    """Lamé: displacement to 1e-5, and the hoop stress converges by the order."""
    E, nu, pressure = STEEL.E, STEEL.nu, 5.0
    model = BoundaryModel(RING, STEEL, Loading((all_of(RING.holes[0], pressure=pressure),)), 8)
    A = pressure * INNER**2 / (OUTER**2 - INNER**2)
    wanted = [(A / E) * ((1 - nu) * r + (1 + nu) * OUTER**2 / r) for r in (INNER, OUTER)]
    # a rigid motion is free: the hole's width
    ends = model.displacement(np.array([[INNER, 0.0], [-INNER, 0.0], [OUTER, 0.0], [-OUTER, 0.0]]))[:, 0]
    assert 0.5 * (ends[::2] - ends[1::2]) == pytest.approx(wanted, rel=1e-5)
    errors = [hoop_error(ring_of(2560), p) for p in (6, 8, 10, 12)]
    assert errors[-1] < 1e-6
    assert (np.divide(errors[:-1], errors[1:]) > 10).all()


def test_stress_is_as_good_as_the_curvature_of_the_spline():
    """A circle of pieces that turn by h has a curvature good to h^2/12; a quarter of h leaves less than twice 1/16."""
    coarse, fine = (hoop_error(ring_of(pieces), 12) for pieces in (320, 1280))
    assert fine < coarse / 8
    assert hoop_error(RING, 12) < (2 * np.pi / 320) ** 2 / 12


def test_a_hole_that_is_held_and_a_rim_that_is_pressed():
    E, nu = STEEL.E, STEEL.nu
    loading = Loading((all_of(RING.holes[0], displacement=HELD), all_of(RING.rim, pressure=3.0)))
    model = BoundaryModel(RING, STEEL, loading, 10)
    # u = C r + D/r, 0 at the hole
    ratio = -(INNER**2)
    C = -3.0 / (E / (1 - nu**2) * ((1 + nu) - (1 - nu) * ratio / OUTER**2))
    u = model.displacement(np.array([[OUTER, 0.0], [0.0, 15.0]]))
    assert u[0, 0] == pytest.approx(C * (OUTER + ratio / OUTER), rel=1e-6)
    assert u[1, 1] == pytest.approx(C * (15.0 + ratio / 15.0), rel=1e-6)
    radial = E / (1 - nu**2) * C * ((1 + nu) - (1 - nu) * ratio / INNER**2)
    assert model.stress(np.array([[INNER, 0.0]]))[0, 0] == pytest.approx(radial, rel=1e-4)


def test_a_rim_that_turns_about_a_hole_that_is_held_is_in_shear():
    angle = 1e-3
    turned = Affine(0.0, 0.0, -angle), Affine(0.0, angle, 0.0)
    loading = Loading((all_of(RING.holes[0], displacement=HELD), all_of(RING.rim, displacement=turned)))
    model = BoundaryModel(RING, STEEL, loading, 10)
    D = angle * OUTER / (1 / OUTER - OUTER / INNER**2)
    G = STEEL.E / (2 * (1 + STEEL.nu))
    shear = model.stress(np.array([[INNER, 0.0], [15.0, 0.0]]))[:, 2]
    np.testing.assert_allclose(shear, -2 * G * D / np.array([INNER, 15.0]) ** 2, rtol=1e-4)


def compact_tension(depth, force=600.0):
    return Scene.from_dict(
        {
            "part": {
                "outline": {
                    "shape": "rectangle",
                    "center": [15, 0],
                    "size": [50, 48],
                    "corner_radius": 0.0,
                },
                "thickness": 10.0,
            },
            "holes": [{"shape": "circle", "center": [0, y], "radius": 5.0} for y in (11, -11)],
            "cracks": [{"points": [[-10, 0], [40 * depth, 0]]}],
            "material": {"name": "PMMA"},
            "boundary": [{"on": "hole 0", "pin": [0, force]}, {"on": "hole 1", "pin": [0, -force]}],
        }
    )


@pytest.mark.parametrize(("depth", "f"), [(0.45, 8.3116), (0.55, 11.3202)])
def test_compact_tension_has_its_high_order_value(depth, f):
    """A slit in place of the notch, pins as cosine pressure: ../shared/boundary_integrals.md."""
    scene = compact_tension(depth)
    K, error = BoundaryModel(scene.part, scene.material, scene.loading).with_error(
        BoundaryModel.stress_intensities
    )
    factor = 10.0 * np.sqrt(40.0) / 600.0
    assert K[0, 0] * factor == pytest.approx(f, rel=3e-5)
    assert abs(K[0, 1]) < 1e-6 * K[0, 0]
    assert error[0] * factor < 1e-4 * f


def half_disk(turn=0.0, mirror=False, size=1.0):
    """Semi-circular bend, supports half a diameter apart, a crack of half the radius; turned, mirrored or larger."""
    R = 50.0

    def placed(*points):
        z = np.array([complex(*point) for point in points]) * size
        z = (-z.conj() if mirror else z) * np.exp(1j * turn)
        return np.column_stack([z.real, z.imag]).tolist()

    force = complex(0.0, -1.0) * size * np.exp(1j * turn)
    outline = {
        "shape": "polygon",
        "points": placed((-R, 0), (R, 0), (R, R), (-R, R)),
        "corner_radii": [0.0, 0.0, R * size, R * size],
    }
    if mirror:
        outline["corner_radii"] = [0.0, 0.0, R * size, R * size]
    ((left, right, top),) = (placed((-25.0, 0.0), (25.0, 0.0), (0.0, R)),)
    up = [-0.5 * force.real / size, -0.5 * force.imag / size]
    return Scene.from_dict(
        {
            "part": {"outline": outline},
            "cracks": [{"points": placed((0.0, 0.0), (2.0, 25.0))}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"at": left, "width": 0.5 * size, "force": [size * t for t in up]},
                {"at": right, "width": 0.5 * size, "force": [size * t for t in up]},
                {"at": top, "width": 0.5 * size, "force": [force.real, force.imag]},
            ],
        }
    )


def intensities(scene):
    return BoundaryModel(scene.part, scene.material, scene.loading).stress_intensities()[0]


def test_a_part_turned_mirrored_or_larger_has_the_same_crack():
    K = intensities(half_disk())
    np.testing.assert_allclose(intensities(half_disk(turn=0.7)), K, rtol=1e-8)
    np.testing.assert_allclose(intensities(half_disk(mirror=True)), [K[0], -K[1]], rtol=1e-8)
    # the same traction on three times as large a part
    np.testing.assert_allclose(intensities(half_disk(size=3.0)), np.sqrt(3.0) * K, rtol=1e-8)


def test_semi_circular_bend_has_its_high_order_value():
    R, width = 50.0, 0.1
    scene = half_disk().with_(
        cracks=[{"points": [[0.0, 0.0], [0.0, 25.0]]}],
        boundary=[
            {"at": [-25.0, 0.0], "width": width, "force": [0.0, 0.5]},
            {"at": [25.0, 0.0], "width": width, "force": [0.0, 0.5]},
            {"at": [0.0, R], "width": width, "force": [0.0, -1.0]},
        ],
    )
    assert intensities(scene)[0] * 2 * R / np.sqrt(np.pi * 25.0) == pytest.approx(3.6119, rel=2e-5)


def test_a_lug_agrees_with_a_body_fitted_model_and_carries_its_pin():
    scene = Scene.from_dict(
        {
            "part": {
                "outline": {
                    "shape": "polygon",
                    "points": [[0, -15], [60, -15], [60, 15], [0, 15]],
                    "corner_radii": [0.0, 15.0, 15.0, 0.0],
                },
                "thickness": 8.0,
            },
            "holes": [{"shape": "circle", "center": [45, 0], "radius": 6.0}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"from": [0, 15], "to": [0, -15], "displacement": [0.0, 0.0]},
                {"on": "hole 0", "pin": [4000.0, 0.0]},
            ],
        }
    )
    held, pin = scene.loading
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    np.testing.assert_allclose(model.reaction(held), [-500.0, 0.0], atol=1e-4)
    np.testing.assert_allclose(model.reaction(pin), [500.0, 0.0], atol=1e-4)
    fitted = PlateModel(
        plate_mesh(scene.part, nodes_at=scene.loading.ends).refined(), scene.material, scene.loading
    )
    np.testing.assert_allclose(fitted.reaction(held), [-500.0, 0.0], atol=1e-2)
    points = np.array(
        [[51.0, 0.0], [45.0, 6.0], [45 + 6 * np.cos(0.6), 6 * np.sin(0.6)], [30.0, 15.0], [55.0, 0.0]]
    )
    np.testing.assert_allclose(model.stress(points), fitted.stress(points), atol=1.0)
    inside = np.array([[30.0, 2.0], [53.0, 8.0]])
    np.testing.assert_allclose(model.displacement(inside), fitted.displacement(inside), atol=8e-5)


def test_ahead_of_a_sharp_notch_the_stress_is_symmetric():
    """There the nearest point of the surface is the corner, at right angles to neither flank."""
    scene = Scene.from_dict(
        {
            "plate": {"width": 80.0, "height": 14.0},
            "holes": [{"shape": "v-notch", "tip": [40.0, 7.0], "direction": 90.0, "opening": 60.0}],
            "material": {"name": "PMMA"},
            "load": {"strain": [0.001, 0.0, 0.0]},
        }
    )
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    right = np.array(
        [[40 + r * np.sin(a), 7 + r * np.cos(a)] for r in (0.1, 1.0, 3.0) for a in (0.0, 0.4, 0.9, 1.2)]
    )
    left = [80.0, 0.0] + right * [-1, 1]
    np.testing.assert_allclose(model.stress(right), model.stress(left) * [1, 1, -1], rtol=1e-5, atol=1e-6)


def test_ends_of_a_clamped_stretch_do_not_reach_a_crack():
    """Stresses grow with r^-1/2 there: panels that are not graded to them leave K wrong by their length."""
    part = Part.plate(100.0, 80.0, cracks=[[(0.0, 40.0), (12.0, 44.0)]])
    foot = Condition((20.0, 0.0), (60.0, 0.0), (Affine(), Affine()))
    loading = Loading((foot, Condition((100.0, 30.0), (100.0, 55.0), traction=(1.0, 0.5))))
    K, fine = (
        BoundaryModel(part, Material.from_name("PMMA"), loading, *orders).stress_intensities()[0]
        for orders in ((8, 8), (12, 10))
    )
    assert np.abs(K - fine).max() < 2e-5 * np.linalg.norm(fine)


def test_a_crack_of_many_segments_past_a_hole_has_panels_as_short_as_its_distance():
    """Along a quarter circle 0.3 mm off a hole: K converges with the order; far away each segment is one panel."""
    turn = np.linspace(0.75 * np.pi, 0.25 * np.pi, 21)
    loading = plate_loading(40.0, 40.0, stress=1.0)
    K, panels = {}, {}
    for radius in (6.3, 12.0):
        line = 20 + radius * np.column_stack([np.cos(turn), np.sin(turn)])
        part = Part.plate(40.0, 40.0, [Outline.through(circle((20.0, 20.0), 6.0))], [line])
        for orders in ((8, 4), (8, 8), (12, 12)):
            model = BoundaryModel(part, STEEL, loading, *orders)
            K[radius, orders[1]], panels[radius] = model.stress_intensities(), len(model.cracks.starts)
    assert panels[12.0] <= 20 + 4
    assert panels[6.3] < 6 * 20
    off = {p: np.abs(K[6.3, p] - K[6.3, 12]).max() / np.abs(K[6.3, 12]).max() for p in (4, 8)}
    assert off[8] < 1e-3
    assert off[8] < off[4] / 4
