"""Predictions under `[[boundary]]`: bending, pressure, and the short forms written out."""

import numpy as np
import pytest

from slmm import Scene, failure_indices
from slmm.scene import gallery

pytest.importorskip("netgen")

BEAM = {"width": 44.0, "height": 10.0, "thickness": 5.0}
NOTCH = {"shape": "v-notch", "tip": [22, 3], "direction": 90, "opening": 0, "radius": 0.5}
#: as tractions, which let the beam turn
SUPPORTS = [{"at": [x, 0], "width": 0.05, "force": [0.0, 150.0]} for x in (2, 42)]
PUSH = {"at": [22, 10], "width": 0.05, "force": [0.0, -300.0]}


def beam(**tables):
    return Scene.from_dict(
        {"plate": BEAM, "material": {"name": "PMMA"}, "boundary": [*SUPPORTS, PUSH], **tables}
    )


def test_three_point_bending_has_its_stress_intensity():
    scene = beam(cracks=[{"points": [[22, 0], [22, 5]]}])
    result = failure_indices(scene, "griffith")
    unit = 60.0 * 40.0 / 10.0**1.5  # P S/(B W^1.5)
    assert float(result.stress_intensity_I[0]) / unit == pytest.approx(2.64367, rel=2e-3)


def test_a_notched_beam_fails_where_all_methods_say():
    scene = beam(holes=[NOTCH], analysis={"points": [[22, 3]]})
    full = failure_indices(scene, "full-fea")
    for method in ("dislocations", "auto"):
        other = failure_indices(scene, method)
        gap = abs(float(other.failure_index[0] - full.failure_index[0]))
        assert gap <= float(other.failure_index_error[0] + full.failure_index_error[0]), method
    cells = failure_indices(scene, "slmm+ac")
    assert "known for [load] alone" in str(cells.status.values[0])


def test_strength_and_critical_distances_come_by_boundary_integrals_under_conditions():
    scene = beam(holes=[NOTCH], analysis={"points": [[22, 3]]})
    for criterion in ("rankine", "point"):
        lines = failure_indices(scene, criterion)
        mesh = failure_indices(scene.with_(analysis={"local_model": "body-fitted"}), criterion)
        assert lines.attrs["local_model"] == "boundary"
        gap = abs(float(lines.failure_index[0] - mesh.failure_index[0]))
        assert gap <= float(lines.failure_index_error[0] + mesh.failure_index_error[0])


def test_the_short_form_written_out_gives_the_same():
    short = gallery.circular_hole(load={"displacement": 0.1}, analysis={"points": [[70, 50]]})
    out = short.with_(
        boundary=[
            {"on": "bottom", "displacement": ["free", 0.0]},
            {"on": "top", "displacement": ["free", 0.1]},
        ]
    )
    for method in ("full-fea", "dislocations"):
        one, other = (failure_indices(scene, method).failure_index.values for scene in (short, out))
        np.testing.assert_array_equal(one, other)


def test_pressure_around_a_plate_is_uniform_compression():
    held = gallery.circular_hole(1.0, 100.0)
    scene = held.with_(boundary=[{"on": "outer", "pressure": -10.0}], analysis={"points": [[51, 50]]})
    result = failure_indices(scene, "rankine")
    # a hole in equibiaxial tension doubles the stress
    assert float(result.failure_index[0]) * scene.material.sigma_c == pytest.approx(20.0, rel=2e-3)


def test_a_mesh_without_nodes_where_conditions_end_is_refused():
    from slmm.fem.element_size import SizePolicy
    from slmm.fem.mesh import plate_mesh
    from slmm.fem.plate_model import PlateModel

    scene = beam()
    with pytest.raises(ValueError, match=r"the mesh has no node at \(.*\), where a condition ends"):
        PlateModel(plate_mesh(scene.part, policy=SizePolicy(3.0)), scene.material, scene.loading)
