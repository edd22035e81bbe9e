"""Boundary integrals as the engine of a simulation: as many points as the tolerance of U_T asks for."""

import pytest

from slmm.fracture import simulate
from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.scene.gallery import tensile_plate


@pytest.mark.parametrize("holes", [[], [(40.0, 40.0, 8.0)], [(28.0, 44.0, 6.0), (46.0, 30.0, 5.0)]])
def test_the_default_tolerance_gives_U_T_of_a_finer_one_to_a_thousandth(holes):
    scene = tensile_plate(holes)
    ours, finer = (float(simulate(scene, 4.0, tolerance=of, errors=False).U_T) for of in (0.01, 1e-3))
    assert ours == pytest.approx(finer, rel=1e-3)


def test_a_coarser_tolerance_takes_fewer_unknowns():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    models = [
        BoundaryEngine(scene.material, scene.loading, of).solve(scene.part).model for of in (0.01, 1e-3, 1e-5)
    ]
    points = [model.panels.n for model in models]
    assert points == sorted(points) and len(set(points)) == 3
