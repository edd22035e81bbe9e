"""Kernels on threads: what an import leaves alone, and what a forked child computes."""

import multiprocessing
import os
import subprocess
import sys

import numba
import numpy as np
import pytest

from slmm.running.threaded import threaded


@threaded()
def squares(x):
    result = np.empty_like(x)
    for i in numba.prange(len(x)):
        result[i] = x[i] ** 2
    return result


def test_an_import_changes_nothing():
    code = """if True:
        import os
        before = os.environ.get("OMP_WAIT_POLICY")
        import slmm.voxels.model, slmm.optimization.cantilever.exhaustive
        from numba.np.ufunc import parallel
        assert os.environ.get("OMP_WAIT_POLICY") == before
        assert not parallel._is_initialized
    """
    subprocess.run([sys.executable, "-c", code], check=True)


def _in_child(queue):
    queue.put(squares(np.arange(4.0)).tolist())


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_child_computes_what_its_parent_does():
    expected = squares(np.arange(4.0)).tolist()
    assert expected == [0.0, 1.0, 4.0, 9.0]
    context = multiprocessing.get_context("fork")
    queue = context.SimpleQueue()
    child = context.Process(target=_in_child, args=(queue,))
    child.start()
    child.join(120)
    assert child.exitcode == 0
    assert queue.get() == expected
