"""Results of other programs give the index of full FEA; programs that are not there are left out."""

import numpy as np
import pytest
from scripts import of, script

from slmm import Material
from slmm.results.results import read_displacements
from tests.solved_plates import ring, stretched


@pytest.mark.slow
def test_indices_are_within_the_estimates_and_two_percent(monkeypatch, capsys):
    study = script("results_of_others")
    checks = study.main(quick=True)
    assert all(check.holds for check in checks), [check for check in checks if not check.holds]
    for check in of(checks, "MED", "index"):
        assert abs(check.difference) < 0.02, check
    monkeypatch.setattr(study.shutil, "which", lambda name: None)
    assert study.main(quick=True)
    assert "ccx is not installed" in capsys.readouterr().out


def test_med_files_in_the_form_of_code_aster_are_read(tmp_path):
    points, quads = ring(16, 3)
    field = stretched(points, {"quad": quads}, Material.from_name("PMMA"))
    script("med_file").write_med(tmp_path / "plate.med", points, "quad", quads, field.u)
    found = read_displacements(tmp_path / "plate.med")
    at = np.array([[3.0, 4.0], [15.0, 12.0]])
    assert found.displacement(at) == pytest.approx(field.displacement(at), abs=1e-15)
