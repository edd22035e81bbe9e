"""A plate with open cracks: free faces, known openings and energies, and what a trial path releases."""

import sys

import numpy as np
import pytest

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel, SlitModel
from slmm.fem.sparse_factor import factorised, last_block, nested_dissection
from slmm.scene import gallery
from slmm.scene.loading import Affine, Condition, Loading, plate_edges

pytest.importorskip("netgen")

SIGMA = 10.0


def meshed(scene, path=None, **options):
    return plate_mesh(scene.part, path, **options)


def solved(scene, refinements=0, path=None, **options):
    mesh = meshed(scene, path, **options)
    for _ in range(refinements):
        mesh = mesh.refined()
    return (PlateModel if path is None else SlitModel)(mesh, scene.material, scene.loading)


def work_of_load(model):
    """Half the work of the forces, N, the energy that a thickness of 1 mm holds."""
    return 0.5 * float(np.sum(model.load.force * model.u))


def face_nodes(model, x_max):
    """Pairs of nodes (n, 2) on the lower and the upper face of the gallery's edge crack, by their x."""
    x, y = model.points.T
    face = np.flatnonzero((np.abs(y - 60) < 1e-9) & (x < x_max - 1e-9))
    face = face[np.lexsort([model.u[face, 1], x[face].round(9)])]
    return face.reshape(-1, 2)


def graded(shortest, longest):
    """Depths of path nodes: equal steps to the shortest crack, then each a fifth longer."""
    n = round(np.log(longest / shortest) / np.log(1.2))
    return np.concatenate([np.linspace(0, shortest, 6)[:-1], np.geomspace(shortest, longest, n + 1)])


def extrapolated(values):
    """Freed of the tip's error, linear in its element, from a mesh and its refinement; nodes of the first."""
    coarse, fine = values
    return 2 * fine[::2] - coarse


@pytest.fixture(scope="module")
def tension():
    """An edge crack half through a plate, under tension: K = 2.8246 sigma sqrt(pi a)."""
    return solved(gallery.edge_crack(20.0), 1)


def test_faces_of_a_crack_in_tension_are_open_all_the_way_to_the_tip(tension):
    lower, upper = face_nodes(tension, 20.0).T
    assert np.array_equal(tension.points[lower], tension.points[upper])
    opening = tension.u[upper, 1] - tension.u[lower, 1]
    assert np.all(opening > 0)
    assert np.all(np.diff(opening) < 0)  # widest at the mouth
    assert np.abs(tension.u[upper, 0] - tension.u[lower, 0]).max() < 0.01 * opening.max()


def test_faces_of_a_crack_carry_no_stress(tension):
    face = face_nodes(tension, 19.0).ravel()
    assert np.abs(tension.nodal_stress[face][:, 1:]).max() < 0.03 * SIGMA
    # beyond the tip there is
    ahead = tension.stress(np.array([[22.0, 60.0]]))[0]
    assert ahead[1] > 2 * SIGMA


def test_energy_of_the_elements_is_the_work_of_the_load(tension):
    results = tension.results
    nodes, density = results.cells["CPE6"], results.energy["CPE6"]
    a, b, c = results.points[nodes[:, :3]].swapaxes(0, 1)
    double_area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert double_area.min() > 0
    assert results.elasticity[0].state == "plane stress"
    # straight sides everywhere: the mean of three points is exact
    assert density.mean(axis=1) @ double_area / 2 == pytest.approx(work_of_load(tension), rel=1e-9)


def test_mouth_of_an_edge_crack_opens_as_tada_says(tension):
    """delta = 4 sigma a/E V(a/W), good to 1 % (Tada, Paris and Irwin, The stress analysis of cracks handbook)."""
    lower, upper = face_nodes(tension, 20.0)[0]
    angle = np.pi / 2 * 20.0 / 40.0
    V = (1.46 + 3.42 * (1 - np.cos(angle))) / np.cos(angle) ** 2
    opening = tension.u[upper, 1] - tension.u[lower, 1]
    assert opening == pytest.approx(4 * SIGMA * 20.0 / tension.E * V, rel=0.01)


def test_opening_beside_the_tip_is_that_of_the_stress_intensity(tension):
    lower, upper = face_nodes(tension, 20.0).T
    r = 20.0 - tension.points[lower, 0]
    near = (r > 0.05) & (r < 0.2)
    assert near.sum() > 5
    K = 2.8246 * SIGMA * np.sqrt(np.pi * 20.0)
    opening = (tension.u[upper, 1] - tension.u[lower, 1])[near]
    assert opening == pytest.approx(8 * K / tension.E * np.sqrt(r[near] / (2 * np.pi)), rel=0.02)


def test_a_cut_along_which_nothing_acts_changes_nothing():
    along = np.array([[20.0, 120.0], [20.0, 90.0]])  # parallel to the tension
    model = solved(gallery.edge_crack(cracks=[{"points": along.tolist()}]))
    points = np.random.default_rng(0).uniform((0, 0), (40, 120), (100, 2))
    assert model.stress(points) == pytest.approx(np.tile([0.0, SIGMA, 0.0], (100, 1)), abs=1e-8)


def test_what_a_path_releases_is_the_work_that_a_crack_of_its_length_adds():
    """The closed path is held and let go; the crack is there from the start: two models, one energy."""
    depth = graded(0.5, 10.0)
    path = np.array([0.0, 60.0]) + depth[:, None] * [1, 0]
    plain = gallery.edge_crack(cracks=[])
    slits = [solved(plain, level, path, policy=SizePolicy(6.0)) for level in (0, 1)]
    released = extrapolated([slit.released_energy() for slit in slits])
    whole = work_of_load(solved(plain))
    for k in (8, len(depth) - 1):
        cracked = solved(gallery.edge_crack(float(depth[k])), 1)
        assert released[k] == pytest.approx(work_of_load(cracked) - whole, rel=3e-3)
    assert np.all(slits[1].tip_opening()[2:] > 0)


def test_a_path_on_from_a_tip_releases_the_difference():
    depth = graded(0.03, 2.0)
    path = np.array([5.0, 60.0]) + depth[:, None] * [1, 0]
    scene = gallery.edge_crack(5.0)
    slits = [solved(scene, level, path) for level in (0, 1)]
    released = extrapolated([slit.released_energy() for slit in slits])
    before, after = (work_of_load(solved(gallery.edge_crack(a), 1)) for a in (5.0, 7.0))
    assert released[-1] == pytest.approx(after - before, rel=3e-3)
    # with the path closed it is the plate with the shorter crack
    assert work_of_load(slits[1]) == pytest.approx(before, rel=1e-4)


def test_a_path_from_a_sharp_corner_releases_by_the_corners_power_law():
    """W goes with a^(2 lambda) where the stress goes with r^(lambda - 1); lambda = 0.5445 at a right angle."""
    scene = gallery.square_hole()
    depth = graded(0.02, 0.3)
    path = np.array([65.0, 65.0]) + depth[:, None] / np.sqrt(2)
    W = extrapolated([solved(scene, level, path).released_energy() for level in (0, 1)])
    slope = np.diff(np.log(W[5:])) / np.diff(np.log(depth[5:]))
    assert slope == pytest.approx(2 * 0.5445, abs=0.015)


def test_turned_loads_turn_the_stress():
    """A plate turned by a right angle, its strain too."""
    points = np.array([[20.0, 30.0], [36.0, 12.0]])
    upright = solved(gallery.elliptic_hole(load={"strain": [0.01, 0.1, 0.03]}))
    holes = [{"shape": "ellipse", "center": [50, 50], "semi_axes": [10, 20]}]
    turned = solved(gallery.elliptic_hole(holes=holes, load={"strain": [0.1, 0.01, -0.03]}))
    one, other = upright.stress(points), turned.stress(np.column_stack([100 - points[:, 1], points[:, 0]]))
    assert other[:, [1, 0, 2]] * [1, 1, -1] == pytest.approx(one, rel=5e-3, abs=1e-3 * np.abs(one).max())


def test_stress_and_displacement_are_found_anywhere():
    model = solved(gallery.circular_hole())
    u = model.displacement(np.array([[0.0, 0.0], [100.0, 100.0], [25.0, 100.0]]))
    assert u == pytest.approx(np.array([[0.0, 0.0], [0.0, 10.0], [0.0, 10.0]]), abs=1e-9)
    assert np.isnan(model.stress(np.array([[50.0, 50.0], [-1.0, 5.0]]))).all()
    size = model.element_size(np.array([[69.9, 50.0], [3.0, 3.0]]))
    assert 0.5 < size[0] < 3 < size[1] < 12


@pytest.mark.parametrize("load", [{"strain": [0.02, 0.1, 0.05]}, {"displacement": 1.0}, {"stress": 7.0}])
def test_reactions_balance_the_load(load):
    scene = gallery.elliptic_hole(load=load)
    mesh = meshed(scene)
    model = PlateModel(mesh, scene.material, scene.loading)
    residual = (model.K @ model.u.ravel()).reshape(-1, 2) - model.load.force
    scale = np.abs(residual).max() + np.abs(model.load.force).max()
    assert np.abs(residual[~model.load.prescribed]).max() < 1e-9 * scale
    # supports that only fix the rigid motion carry nothing
    assert np.abs(residual[model.load.supports]).max(initial=0.0) < 1e-8 * scale
    held = residual + model.load.force
    assert np.abs(held.sum(axis=0)).max() < 1e-8 * np.abs(held).sum()
    moment = model.points[:, 0] * held[:, 1] - model.points[:, 1] * held[:, 0]
    assert abs(moment.sum()) < 1e-8 * np.abs(moment).sum()


@pytest.mark.parametrize(
    ("load", "prescribed", "supports"),
    [({"strain": [0.0, 0.1, 0.0]}, None, 0), ({"displacement": 1.0}, None, 1), ({"stress": 7.0}, 3, 3)],
)
def test_supports_of_the_kinds_of_load(load, prescribed, supports):
    scene = gallery.circular_hole(load=load)
    model = solved(scene)
    x, y = model.points.T
    top, bottom = y == 100, y == 0
    found = model.load
    assert found.supports.sum() == supports
    if prescribed is not None:
        assert found.prescribed.sum() == prescribed
        assert found.force[top].sum(axis=0) == pytest.approx([0.0, 700.0])
        assert found.force[bottom].sum(axis=0) == pytest.approx([0.0, -700.0])
        assert not found.force[~top & ~bottom].any()
    elif "strain" in load:
        assert np.array_equal(found.prescribed.all(axis=1), top | bottom | (x == 0) | (x == 100))
        assert found.value[top, 1] == pytest.approx(10.0)
    else:
        assert np.array_equal(found.prescribed[:, 1], top | bottom)
        assert np.all(found.value[top, 1] == 1.0) and np.all(found.value[bottom] == 0.0)


def test_other_supports_may_be_given():
    """Half a plate with its plane of symmetry at x = 0 is the whole plate."""
    whole = gallery.circular_hole(10.0, 60.0, load={"stress": 5.0})
    half = whole.with_(
        plate={"width": 30.0, "height": 60.0},
        holes=[{"shape": "circle", "center": [0.0, 30.0], "radius": 10.0}],
    )
    bottom, _, top, left = plate_edges(30.0, 60.0)
    pulled = (
        Condition(*left, (Affine(), None)),
        Condition(*bottom, traction=(0.0, -5.0)),
        Condition(*top, traction=(0.0, 5.0)),
    )
    model = PlateModel(meshed(half).refined(), half.material, Loading(pulled))
    points = np.array([[10.0, 30.0], [15.0, 33.0], [3.0, 45.0]])
    reference = PlateModel(meshed(whole).refined(), whole.material, whole.loading).stress(
        points + np.array([30.0, 0.0])
    )
    assert model.stress(points) == pytest.approx(reference, abs=0.05)


def test_last_block_of_a_factor_is_the_schur_complement():
    model = solved(gallery.circular_hole())
    free = np.flatnonzero(~model.load.prescribed.ravel())
    first, last = free[:-12], free[-12:]
    order = np.concatenate([first[nested_dissection(model.K, first)], last])
    S = last_block(factorised(model.K, order), 12)
    K = model.K.toarray()
    schur = K[np.ix_(last, last)] - K[np.ix_(last, first)] @ np.linalg.solve(
        K[np.ix_(first, first)], K[np.ix_(first, last)]
    )
    assert pytest.approx(schur, rel=1e-9, abs=1e-9 * np.abs(schur).max()) == S
    assert np.array_equal(S, S.T)


def test_without_metis_the_same_displacements_come_by_the_solver_s_own_ordering(monkeypatch):
    scene = gallery.circular_hole()
    with_metis = solved(scene)
    monkeypatch.setitem(sys.modules, "pymetis", None)
    without = solved(scene)
    assert np.allclose(without.u, with_metis.u, rtol=0, atol=1e-11 * np.abs(with_metis.u).max())


@pytest.mark.parametrize("points", [[(0, 60), (10, 60)], [(10, 60), (0, 60)]], ids=["inwards", "outwards"])
def test_cracks_open_by_the_distance_of_their_faces(points):
    scene = gallery.edge_crack(cracks=[{"points": points}])
    model = solved(scene)
    [faces] = model.faces
    assert model.points[faces[..., 0]] == pytest.approx(model.points[faces[..., 1]], abs=1e-12)
    # the upper face is on the left of a crack that runs to the right
    jump = model.u[faces[:, 1, 1], 1] - model.u[faces[:, 1, 0], 1]
    assert model.opening == pytest.approx(jump if points[0][0] == 0 else -jump, rel=1e-9)
    assert model.opening.min() > 0
    pressed = solved(scene.with_(load={"stress": -10.0}))
    assert pressed.opening == pytest.approx(-model.opening, rel=1e-6)


def test_cracks_that_meet_open_each_by_itself():
    model = solved(
        gallery.edge_crack(cracks=[{"points": [(0, 60), (20, 60)]}, {"points": [(12, 60), (12, 75)]}])
    )
    assert len(model.opening) == sum(len(faces) for faces in model.faces)
    edges = len(model.faces[0])
    assert model.opening[:edges].min() > 0
