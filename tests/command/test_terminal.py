"""What a terminal is told beside results."""

import os
import subprocess
import sys

import numba
import pytest

from slmm.command.terminal import word_on_compilation


def test_compilation_is_announced_once(capsys):
    @numba.njit
    def twice(x):
        return 2 * x

    with word_on_compilation():
        assert twice(1) == 2
        assert twice(1.0) == 2.0
    assert capsys.readouterr().err.count("compiling kernels") == 1
    with word_on_compilation():
        assert twice(1) == 2
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("wanted", "threads"), [(None, "1"), ("2", "2")])
def test_linear_algebra_gets_one_thread_unless_more_are_asked_for(wanted, threads):
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    if wanted is not None:
        environment["OPENBLAS_NUM_THREADS"] = wanted
    program = """
import os
from slmm.command.cli import app
app(["--version"], standalone_mode=False)
print(os.environ["OPENBLAS_NUM_THREADS"])
"""
    command = [sys.executable, "-c", program]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
    assert shown.split()[-1] == threads
