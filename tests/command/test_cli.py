"""The command line as a whole: its version, and that help comes at once."""

import subprocess
import sys

import pytest
from command_line import run

import slmm

SCENE = """
[plate]
width = 100.0
height = 100.0
[[holes]]
shape = "circle"
center = [50.0, 50.0]
radius = 20.0
[material]
name = "PMMA"
[load]
strain = [0.0, 0.02, 0.0]
[analysis]
method = "slmm+ac"
positions = 7
voxels = 40000
"""


def test_version():
    assert run("--version").stdout == f"slmm {slmm.__version__}\n"


@pytest.mark.parametrize("command", [[], ["initiation"], ["forces"], ["info"], ["optimize", "cantilever"]])
def test_help_loads_nothing_that_computes(command):
    program = f"""
import sys
from slmm.command.cli import app
app({[*command, "--help"]}, standalone_mode=False)
print(sorted({{"numpy", "numba", "xarray", "scipy", "matplotlib"}} & sys.modules.keys()))
"""
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert "Usage" in shown and shown.endswith("[]\n")


def test_a_result_that_is_only_printed_loads_nothing_that_labels_or_draws(tmp_path):
    """A query then takes half of the time: xarray brings pandas, and Dask where it is installed."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    program = f"""
import sys
from slmm.command.cli import app
app(["initiation", {str(scene)!r}], standalone_mode=False)
print(sorted({{"xarray", "pandas", "dask", "matplotlib", "skfem"}} & sys.modules.keys()))
"""
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert "Most critical" in shown and shown.endswith("[]\n")
