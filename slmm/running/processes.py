"""Processes that end with the one that started them, however that one ends."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection


@contextmanager
def processes(number: int) -> Iterator[ProcessPoolExecutor]:
    """Processes of one thread each. They end at once when this one is killed or leaves with an exception.

    An interrupt from the keyboard, which reaches them too, is left to this process.

    Parameters
    ----------
    number : int

    Examples
    --------
    >>> with processes(1) as pool:
    ...     pool.submit(sum, [1, 2]).result()
    3
    """
    # forked processes would share locks of threads that they do not have
    spawning = multiprocessing.get_context("spawn")
    theirs, ours = spawning.Pipe(duplex=False)
    pool = ProcessPoolExecutor(number, spawning, initializer=_settle, initargs=(theirs,))
    try:
        yield pool
    except BaseException:
        ours.close()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        ours.close()


def _settle(parent: Connection) -> None:
    """Make a process one of many: one thread, an end when its parent's end of a pipe is closed, and none before."""
    # not every module that is loaded here waits for them
    import numba
    import threadpoolctl

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    numba.set_num_threads(1)
    threadpoolctl.threadpool_limits(1)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: Connection) -> None:
    # nothing is ever sent: it is closed, or its process is gone
    parent.poll(None)
    os._exit(1)
