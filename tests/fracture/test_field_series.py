"""Files for ParaView: their times, and fields that are the engine's own."""

from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.critical_state import critical_state
from slmm.fracture.field_series import write_series
from slmm.running.whole_file import NotWrittenError
from slmm.scene.gallery import tensile_plate


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    result = simulate(scene, increment=8.0, errors=False)
    return scene, result, write_series(scene, result, tmp_path_factory.mktemp("run") / "series", size=5.0)


def test_time_is_the_displacement_and_no_two_files_have_the_same(written):
    _, result, path = written
    sets = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    times = [float(one.get("timestep")) for one in sets]
    assert times == pytest.approx(result.u_load.values, rel=1e-4)
    assert (np.diff(times) > 0).all()
    assert all((path.parent / one.get("file")).is_file() for one in sets)
    assert len(list(path.parent.iterdir())) == len(sets) + 1


def test_fields_are_those_of_the_model_at_the_points(written):
    scene, result, path = written
    mesh = meshio.read(path.parent / "step_002.vtu")
    state = critical_state(scene, result, 1)
    x_y, data = mesh.points[:, :2], mesh.point_data
    on_crack = np.abs(x_y[:, 1] - 40) < 1.0
    away = np.flatnonzero(~on_crack)[::7]
    assert data["displacement"][away, :2] == pytest.approx(state.displacement(x_y[away]))
    stress = np.column_stack([data[f"stress_{name}"][away] for name in ("xx", "yy", "xy")])
    assert stress == pytest.approx(state.stress(x_y[away]))
    top, bottom = (np.abs(x_y[:, 1] - y) < 1e-9 for y in (80.0, 0.0))
    assert data["displacement"][top, 1] == pytest.approx(float(result.u_c[1]), abs=1e-6)
    assert data["displacement"][bottom, 1] == pytest.approx(0.0, abs=1e-6)
    assert (data["principal_stress"] >= data["stress_yy"] - 1e-9).all()


def test_points_on_a_crack_are_apart_when_they_have_moved(written):
    scene, result, path = written
    mesh = meshio.read(path.parent / "step_001.vtu")
    here = (np.abs(mesh.points[:, 1] - 40) < 1e-9) & (mesh.points[:, 0] < 9.9)
    x, moved = mesh.points[here, 0], mesh.point_data["displacement"][here, 1]
    opening = [np.ptp(moved[x == at]) for at in np.unique(x)]
    assert all((x == at).sum() == 2 for at in np.unique(x))
    (faces,) = critical_state(scene, result, 0).faces
    exact = np.interp(np.unique(x), faces.points[:, 0], (faces.left - faces.right)[:, 1])
    assert opening == pytest.approx(exact, rel=0.01)


def test_a_place_that_cannot_be_written_is_told(written, tmp_path):
    scene, result, _ = written
    (tmp_path / "step_001.vtu").mkdir()
    with pytest.raises(NotWrittenError, match=r"step_001\.vtu: cannot be written"):
        write_series(scene, result, tmp_path, size=10.0)
    assert [path.name for path in tmp_path.iterdir()] == ["step_001.vtu"]
