"""Kernels on several threads: how they are compiled, how threads wait, and what a forked child does.

Nothing is set when a module is imported. When the first kernel is used, or threads are counted,

- LLVM is told to check more arrays for overlap than it would by default (8). Loops of the voxel kernels read more, and
  it would give up vectorising them, which costs a factor of four. The option stays for all that this process compiles
  later; it changes no results.
- numba starts its threads, those of OpenMP with the policy to sleep while they wait, unless ``OMP_WAIT_POLICY`` says
  otherwise: where others use the cores too, spinning made solves fifteen times slower. The environment is as before
  afterwards.

GNU's OpenMP cannot go on in a child of fork whose parent has used it: numba ends the child, and the parent waits. A
child therefore computes on one thread, with kernels that are compiled for that; results are the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cached_property, update_wrapper
from types import FunctionType
from typing import Any

import llvmlite.binding
import numba

#: the process whose threads have been started; a child of fork has its parent's number here
_started_in: int | None = None


def number_of_threads() -> int:
    """Threads of this process, which are started if they are not running yet."""
    global _started_in
    if _started_in is None:
        llvmlite.binding.set_option("slmm", "--runtime-memory-check-threshold=128")
        policy = os.environ.get("OMP_WAIT_POLICY")
        os.environ.setdefault("OMP_WAIT_POLICY", "passive")
        try:
            numba.get_num_threads()  # loads OpenMP, which reads the policy then
        finally:
            if policy is None:
                del os.environ["OMP_WAIT_POLICY"]
        _started_in = os.getpid()
    return int(numba.get_num_threads())


class Threaded:
    """A kernel on several threads, and the same one on a single thread for forked children."""

    __wrapped__: Callable[..., Any]

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        """Compile nothing yet, and prepare nothing: most runs use few of the kernels that they import."""
        update_wrapper(self, function)
        self._options = options

    @cached_property
    def on_threads(self) -> Callable[..., Any]:
        """The kernel of the parent."""
        kernel: Callable[..., Any] = numba.njit(parallel=True, **self._options)(self.__wrapped__)
        return kernel

    @cached_property
    def alone(self) -> Callable[..., Any]:
        """The kernel of a forked child."""
        function = self.__wrapped__
        assert isinstance(function, FunctionType)
        # numba keeps compiled kernels by the name, and would take one for the other
        named = FunctionType(function.__code__, function.__globals__, f"{function.__name__}_alone")
        named.__qualname__ = f"{function.__qualname__}_alone"
        named.__module__ = function.__module__
        kernel: Callable[..., Any] = numba.njit(**self._options)(named)
        return kernel

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel."""
        if _started_in is None:
            number_of_threads()
        kernel = self.on_threads if _started_in == os.getpid() else self.alone
        return kernel(*arguments)


def threaded(**options: Any) -> Callable[[Callable[..., Any]], Threaded]:
    """Decorator of kernels with a loop over `numba.prange`; options of `numba.njit`.

    Examples
    --------
    >>> import numpy as np
    >>> @threaded()
    ... def doubled(x):
    ...     for i in numba.prange(len(x)):
    ...         x[i] *= 2
    >>> x = np.ones(3)
    >>> doubled(x)
    >>> x.tolist()
    [2.0, 2.0, 2.0]
    """
    return lambda function: Threaded(function, options)
