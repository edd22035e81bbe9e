"""The command line as a whole: its version, and that help comes at once."""

import subprocess
import sys

import pytest
from command_line import run

import slmm


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
