from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import SlitModel
from slmm.initiation.body_fitted import notch_stress, solve_body_fitted
from slmm.initiation.full_fea import FullFEA, full_fea_curves, path_depths
from slmm.mechanics.material import Material
from slmm.mechanics.stress import principal_stress
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, ellipse
from slmm.scene.loading import plate_loading

pytest.importorskip("netgen")

PMMA = Material.from_name("PMMA")


def scene(width, height, outlines=(), material=PMMA, **load):
    return SimpleNamespace(
        plate=SimpleNamespace(width=width, height=height, thickness=1.0),
        outlines=tuple(outlines),
        part=Part.plate(width, height, outlines),
        material=material,
        loading=plate_loading(width, height, **load),
    )


def hole(center=(50, 50), radius=20.0):
    return Outline.through(circle(center, radius))


def stress_intensity(curves: FullFEA, a: np.ndarray) -> np.ndarray:
    """K = sqrt(E G) with the energy release rate G = d(a G_inc)/da."""
    exponent = CubicSpline(np.log(curves.a), np.log(curves.G_inc))
    G = np.exp(exponent(np.log(a))) * (1 + exponent(np.log(a), 1))
    return np.sqrt(PMMA.E * G)


@pytest.mark.parametrize(
    ("load", "sigma"),
    [
        ({"strain": (0.01, 0.02, 0.03)}, None),
        ({"displacement": 0.5}, (0.0, PMMA.E * 0.5 / 30, 0.0)),
        ({"stress": 7.0}, (0.0, 7.0, 0.0)),
    ],
)
def test_uniform_stress_is_reproduced(load, sigma):
    if sigma is None:
        e_xx, e_yy, g_xy = load["strain"]
        factor = PMMA.E / (1 - PMMA.nu**2)
        sigma = factor * np.array([e_xx + PMMA.nu * e_yy, e_yy + PMMA.nu * e_xx, (1 - PMMA.nu) / 2 * g_xy])
    points = np.random.default_rng(0).uniform((0, 0), (20, 30), (50, 2))
    computed, error = solve_body_fitted(scene(20.0, 30.0, **load)).stress(points)
    assert computed == pytest.approx(np.tile(sigma, (50, 1)), rel=1e-8, abs=1e-8)
    assert error.max() < 1e-8


def test_edge_crack_in_tension_has_the_published_stress_intensity():
    W = 10.0
    strip = scene(W, 5 * W, stress=1.0)
    curves = full_fea_curves(
        strip, start=(0, 2.5 * W), direction=(2, 0), a_min=0.6, a_max=5.6, n_lengths=20, size_max=2.0
    )
    a = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    F = stress_intensity(curves, a) / np.sqrt(np.pi * a)
    assert pytest.approx([1.1892, 1.3673, 1.6599, 2.1114, 2.8246], rel=1e-3) == F
    assert np.max(curves.G_inc_error / curves.G_inc) < 1e-3


def test_hole_in_a_large_plate_has_kirsch_stress_and_the_published_crack():
    R = 1.0
    plate = scene(300.0, 300.0, [hole((150, 150), R)], stress=1.0)
    curves = full_fea_curves(plate, 0, 0.0, a_max=2.4, a_min=0.06, n_lengths=16)
    a = np.array([0.1, 0.2, 0.5, 1.0, 2.0])
    F = stress_intensity(curves, a) / np.sqrt(np.pi * a)
    assert pytest.approx([2.7727, 2.3746, 1.7279, 1.3061, 1.0307], rel=1.5e-3) == F
    q = R / (R + curves.eta)
    assert curves.sigma[:, 1] == pytest.approx(1 + q**2 / 2 + 1.5 * q**4, rel=1e-3)
    assert curves.sigma[:, 0] == pytest.approx(1.5 * q**2 - 1.5 * q**4, abs=1e-3)
    assert curves.sigma_I == pytest.approx(curves.sigma[:, 1], rel=1e-6)


def test_released_energy_converges_linearly_and_extrapolated_faster():
    part = scene(100.0, 100.0, [hole()], strain=(0.0, 0.1, 0.0))
    a = np.geomspace(1.0, 8.0, 11)
    path = np.array([70.0, 50.0]) + path_depths(a)[:, None] * [1, 0]
    mesh = plate_mesh(part.part, path, policy=SizePolicy(largest=20.0, turn=0.4))
    W = []
    for level in range(4):
        W.append(SlitModel(mesh, part.material, part.loading).released_energy()[:: 2**level][-len(a) :])
        mesh = mesh.refined()
    assert np.all(np.diff(W, axis=0) > 0)  # coarse elements hold the singular tip too stiffly
    change = np.abs(np.diff(W, axis=0)).sum(axis=1)
    assert np.log2(change[:-1] / change[1:]) == pytest.approx([1.0, 1.0], abs=0.25)
    once = [2 * fine - coarse for coarse, fine in pairwise(W)]
    change = np.abs(np.diff(once, axis=0)).sum(axis=1)
    assert np.log2(change[0] / change[1]) > 2.5


def test_error_estimate_covers_the_error():
    part = scene(100.0, 100.0, [hole()], strain=(0.0, 0.1, 0.0))
    rough = full_fea_curves(part, 0, 0.0, a_max=12.0, a_min=0.75, n_lengths=7)
    fine = full_fea_curves(part, 0, 0.0, a_max=12.0, a_min=0.75, n_lengths=13)
    assert np.all(np.abs(rough.G_inc - fine.G_inc[::2]) < rough.G_inc_error)
    assert np.max(rough.G_inc_error / rough.G_inc) < 0.01
    assert np.abs(rough.G_inc / fine.G_inc[::2] - 1).max() < 2e-3
    assert np.abs(rough.sigma_I / fine.sigma_I[[0, *range(1, 14, 2)]] - 1).max() < 1e-3


def test_scaling_the_part_scales_the_crack():
    curves = [
        full_fea_curves(
            scene(100 * k, 100 * k, [hole((50 * k, 50 * k), 20 * k)], strain=(0.0, 0.1, 0.02)),
            0,
            4.0 * k,
            a_max=6.0 * k,
            n_lengths=8,
            a_min=0.6 * k,
        )
        for k in (1.0, 0.25)
    ]
    assert curves[1].a == pytest.approx(curves[0].a / 4)
    assert curves[1].G_inc == pytest.approx(curves[0].G_inc / 4, rel=1e-3)
    assert curves[1].sigma_I == pytest.approx(curves[0].sigma_I, rel=1e-3)


def test_mirrored_parts_are_equal():
    outlines = [Outline.through(ellipse((40, 50), (20, 10), angle)) for angle in (20.0, -20.0)]
    s = [outline.project(np.array([[60.0, y]]))[0] for outline, y in zip(outlines, (57, 43), strict=True)]
    up, down = (
        full_fea_curves(
            scene(100.0, 100.0, [outline], strain=(0.02, 0.1, shear)),
            0,
            at,
            a_max=8.0,
            a_min=0.8,
            n_lengths=8,
        )
        for outline, at, shear in zip(outlines, s, (0.03, -0.03), strict=True)
    )
    assert up.start[1] + down.start[1] == pytest.approx(100, abs=1e-4)
    assert down.G_inc == pytest.approx(up.G_inc, rel=1e-3)
    assert down.sigma * [1, 1, -1] == pytest.approx(up.sigma, abs=1e-3 * np.abs(up.sigma).max())


def test_stress_along_a_notch():
    plate = scene(1000.0, 1000.0, [hole((500, 500), 10.0)], stress=1.0)
    result = notch_stress(solve_body_fitted(plate), plate.outlines, n=72)
    angle = result[0].s / 10.0
    surface = 1 + 2 * np.cos(2 * angle)
    assert result[0].sigma_I == pytest.approx(np.maximum(surface, 0), abs=0.01)
    assert result[0].sigma_I.argmax() in (0, 36)


def test_stress_outside_the_material_is_missing():
    part = scene(100.0, 100.0, [hole()], strain=(0.0, 0.1, 0.0))
    sigma, error = solve_body_fitted(part).stress(np.array([[50.0, 50.0], [10.0, 50.0], [120.0, 50.0]]))
    assert np.isnan(sigma[[0, 2]]).all() and np.isnan(error[[0, 2]]).all()
    assert np.isfinite(sigma[1]).all()


def test_a_mouth_on_a_held_edge_stays_closed():
    plate = scene(20.0, 20.0, strain=(0.0, 0.1, 0.0))
    curves = full_fea_curves(plate, start=(0, 10), direction=(1, 0), a_max=5.0, a_min=1.0, n_lengths=6)
    assert np.all(np.diff(curves.a * curves.G_inc) > 0)


def test_plane_strain_is_plane_stress_of_another_material():
    strain = Material(3000.0, 0.3, 70.0, 1.0, "plane strain")
    stress = Material(*strain.plane_stress_equivalent, 70.0, 1.0)
    one, other = (
        solve_body_fitted(scene(20.0, 20.0, [hole((10, 10), 3)], material, strain=(0, 0.1, 0))).stress(
            np.array([[14.0, 10.0]])
        )
        for material in (strain, stress)
    )
    assert one[0] == pytest.approx(other[0], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"outline_index": 1, "s": 0.0, "a_max": 1.0}, "outline_index = 1"),
        ({"outline_index": 0, "s": 0.0, "a_max": -1.0}, "a_max = -1.0"),
        ({"outline_index": 0, "s": 0.0, "a_max": 1.0, "a_min": 2.0}, "a_min = 2.0"),
        ({"outline_index": 0, "s": 0.0, "a_max": 1.0, "n_lengths": 1}, "n_lengths = 1"),
        ({"outline_index": 0, "s": 0.0, "a_max": 40.0}, "outside the material"),
        ({"a_max": 1.0}, "outline_index and s, or start and direction"),
    ],
)
def test_bad_input_is_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        full_fea_curves(scene(100.0, 100.0, [hole()], strain=(0.0, 0.1, 0.0)), **arguments)


def test_forces_that_do_not_balance_are_refused():
    part = scene(100.0, 100.0, [hole((50, 0), 10)], stress=1.0)
    with pytest.raises(ValueError, match="does not balance"):
        solve_body_fitted(part)


def test_principal_stress_of_pure_shear():
    assert principal_stress(np.array([0.0, 0.0, 3.0])) == pytest.approx(3.0)


@pytest.mark.parametrize("load", [{"displacement": 0.3}, {"strain": (0.0, 0.01, 0.0)}, {"stress": 29.6}])
def test_a_crack_through_the_whole_plate_releases_what_the_load_leaves(load):
    """Of a bar with displaced ends all its energy, of one with held sides less, under a stress no end of it."""
    W, H = 20.0, 30.0
    curves = full_fea_curves(
        scene(W, H, **load),
        start=(0, H / 2),
        direction=(1, 0),
        end=np.array([W, H / 2]),
        n_lengths=12,
        a_min=0.3,
    )
    assert curves.severs and curves.a[-1] == pytest.approx(W) and len(curves.a) == 2 * 12
    assert np.all(np.diff(curves.a) > 0) and np.all(np.diff(curves.a * curves.G_inc) > 0)
    whole = 29.6**2 * H / (2 * PMMA.E)
    if "displacement" in load:
        assert curves.G_inc[-1] == pytest.approx(whole, rel=1e-9)
        assert curves.sigma_I == pytest.approx(29.6, rel=1e-9)
    elif "strain" in load:
        # Saint-Venant: cut halves still hold their sides
        assert 0.5 * whole < curves.G_inc[-1] < whole / (1 - PMMA.nu**2)
    else:
        assert curves.G_inc[-1] > 1e3 * whole and curves.sigma_I == pytest.approx(29.6, rel=1e-9)


def test_a_severed_ligament_agrees_with_paths_that_end_just_before_the_far_surface():
    plate = scene(40.0, 40.0, [hole((20, 20), 5.0)], displacement=0.2)
    whole = full_fea_curves(
        plate, start=(25, 20), direction=(1, 0), end=np.array([40.0, 20.0]), n_lengths=14, a_min=0.2
    )
    short = full_fea_curves(plate, 0, 0.0, a_max=12.0, a_min=0.2, n_lengths=14)
    energy = np.interp(short.a, whole.a, whole.a * whole.G_inc)
    assert energy[-4:] == pytest.approx((short.a * short.G_inc)[-4:], rel=0.01)
    assert whole.a[-1] * whole.G_inc[-1] > energy[-1]
