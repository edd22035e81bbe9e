"""What a terminal is told beside results."""

import numba

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
