"""Finite elements as the engine of the simulator: K against known ones, U_T and paths against boundary integrals."""

import sys

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.fem.triangulation import MesherError
from slmm.fracture import fem_engine, simulate
from slmm.fracture.configurational_forces import forces_within, nodal_configurational_forces
from slmm.fracture.directions import Direction
from slmm.fracture.engine import Rules
from slmm.fracture.events import Kind
from slmm.fracture.fem_engine import FemEngine
from slmm.fracture.fem_mesh import clear_radii
from slmm.fracture.first_cracks import point_method
from slmm.fracture.history import Outcome
from slmm.scene.gallery import edge_crack, tensile_plate
from slmm.scene.scene import Scene

pytest.importorskip("netgen")

BENT = tensile_plate([(40.0, 42.0, 8.0)], cracks=[{"points": [[0, 40], [20, 41], [23, 42.5], [25, 44.5]]}])


def solved(scene, tolerance=0.01):
    return FemEngine(scene.material, scene.loading, tolerance).solve(scene.part)


def test_K_of_an_edge_crack():
    """sigma sqrt(pi a) F(a/W), F(1/4) = 1.5012 with an error of half a percent at most (Tada)."""
    [(mode_I, mode_II)] = solved(edge_crack()).K
    assert mode_I == pytest.approx(10 * np.sqrt(np.pi * 10) * 1.5012, rel=6e-3)
    assert abs(mode_II) < 1e-3 * mode_I


def test_K_of_a_bent_crack_is_that_of_boundary_integrals():
    [expected] = BoundaryModel(BENT.part, BENT.material, BENT.loading, 10, 10).stress_intensities()
    [ours] = solved(BENT).K
    assert ours == pytest.approx(expected, abs=5e-4 * np.linalg.norm(expected))


def test_the_configurational_force_at_the_tip_is_what_K_stands_for():
    """Minus the force, along the crack, is G (thesis Eq. 3.15), but for what elements at the tip do not resolve."""
    state = solved(BENT)
    results = state.model.results
    forces = nodal_configurational_forces(
        results.points, results.cells, results.u, results.stress, results.energy, results.method, results.thickness
    )  # fmt: skip
    [line], [clear] = BENT.part.tips, clear_radii(BENT.part)
    along = (line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2])
    G = -forces_within(results.points, forces, line[-1], [0.5 * clear, 0.9 * clear]) @ along
    (elasticity,) = results.elasticity
    assert G.tolist() == pytest.approx([state.K[0] @ state.K[0] / elasticity.E_prime] * 2, rel=0.01)


def test_a_bar_on_narrow_supports_yields_as_by_boundary_integrals():
    """Stresses are singular where supports end; elements there are a twelfth of them, and err by less than 1e-3."""
    at = {"width": 0.5}
    bar = Scene.from_dict(
        {
            "plate": {"width": 100.0, "height": 20.0},
            "cracks": [{"points": [[40.0, 0.0], [40.0, 6.0]]}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"at": [10.0, 0.0], "displacement": ["free", 0.0], **at},
                {"at": [90.0, 0.0], "displacement": ["free", 0.0], **at},
                {"at": [50.0, 20.0], "force": [0.0, -100.0], **at},
            ],
        }
    )
    model = BoundaryModel(bar.part, bar.material, bar.loading, 10, 10)
    state = solved(bar)
    assert state.work == pytest.approx(model.work, rel=1e-3)
    [ours], [expected] = state.K, model.stress_intensities()
    assert ours == pytest.approx(expected, abs=1e-3 * np.linalg.norm(expected))


def test_an_internal_crack_has_the_same_K_at_both_tips():
    scene = tensile_plate(cracks=[{"points": [[30.0, 35.0], [50.0, 45.0]]}])
    one, other = solved(scene).K
    assert other == pytest.approx(one, rel=2e-3)
    assert one[0] > abs(one[1]) > 0.1 * one[0]


def test_the_finer_mesh_tells_the_error():
    state = solved(BENT)
    event = state.events(Rules(Direction("MTS"), point_method))[0]
    assert event.kind is Kind.GROWTH
    model = BoundaryModel(BENT.part, BENT.material, BENT.loading, 10, 10)
    work, load = state.finer(event)
    assert (
        0 < work - model.work < 0.7 * (state.work - model.work)
    )  # it is too stiff, and in the first order of the size
    true = np.sqrt(BENT.material.G_c / model.energy_release_rates()[0])
    assert abs(load / true - 1) < 5e-4


def test_the_work_of_a_stretch_that_moves_as_one_body_is_that_by_boundary_integrals():
    boundary = [
        {"from": [0.0, 0.0], "to": [40.0, 0.0], "displacement": [0.0, 0.0]},
        {"from": [40.0, 70.0], "to": [0.0, 70.0], "stiff": True, "force": [0.0, 2400.0]},
    ]
    plate = {"plate": {"width": 40.0, "height": 70.0}, "material": {"name": "PMMA"}, "boundary": boundary}
    gripped = Scene.from_dict({**plate, "cracks": [{"points": [[0.0, 35.0], [8.0, 35.0]]}]})
    model = BoundaryModel(gripped.part, gripped.material, gripped.loading, 10, 10)
    assert solved(gripped).work == pytest.approx(model.work, rel=1e-3)


@pytest.mark.parametrize(("holes", "U_T"), [([], 106.919), ([(40.0, 40.0, 8.0)], 274.276)])
def test_tensile_toughness_and_paths_of_reference_plates(holes, U_T):
    """Cracks run straight and unstably here, and increments of 2 mm give the same to five digits."""
    one, other = (
        simulate(tensile_plate(holes), 8.0, engine=engine, first_length=1.0, errors=engine == "fem")
        for engine in ("boundary", "fem")
    )
    assert float(other.U_T) == pytest.approx(U_T, rel=5e-3)
    assert abs(float(other.U_T) - U_T) < float(other.U_T_error)
    assert other.attrs["outcome"] == Outcome.SEVERED and other.attrs["engine"] == "fem"
    assert other.event.values.tolist() == one.event.values.tolist()
    assert other.arrested_by.values.tolist() == one.arrested_by.values.tolist()
    assert other.crack_x.values == pytest.approx(one.crack_x.values, abs=0.12, nan_ok=True)
    assert other.crack_y.values == pytest.approx(one.crack_y.values, abs=0.12, nan_ok=True)


def test_a_plate_upside_down_cracks_upside_down():
    up, down = (
        simulate(tensile_plate([(38.0, y, 7.0)]), 12.0, engine="fem", errors=False) for y in (44.0, 36.0)
    )
    assert float(down.U_T) == pytest.approx(float(up.U_T), rel=2e-3)
    # where the second crack starts is known to 0.1 mm, see tests/fracture/test_engine.py
    assert down.crack_x.values == pytest.approx(up.crack_x.values, abs=0.2, nan_ok=True)
    assert 80.0 - down.crack_y.values == pytest.approx(up.crack_y.values, abs=0.2, nan_ok=True)


def test_without_netgen_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "netgen.geom2d", None)
    with pytest.raises(ImportError, match=r"netgen: pip install slmm\[fea\]"):
        simulate(tensile_plate(), engine="fem")


def test_where_the_mesher_fails_later_the_steps_so_far_are_kept(monkeypatch):
    made, crack_mesh = [], fem_engine.crack_mesh

    def fails(*arguments):
        made.append(arguments)
        if len(made) == 3:
            raise MesherError("the mesher failed: no reason")
        return crack_mesh(*arguments)

    monkeypatch.setattr(fem_engine, "crack_mesh", fails)
    result = simulate(tensile_plate(), 8.0, engine="fem", errors=False)
    assert result.attrs["outcome"] == "failed: the mesher failed: no reason"
    assert result.sizes["step"] == 2
