"""One thread of linear algebra: on small matrices more of them cost up to thirty times the time, on busy machines."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import lru_cache

import threadpoolctl


def one_blas_thread() -> AbstractContextManager[object]:
    """As long as this holds, BLAS works on one thread.

    Examples
    --------
    >>> with one_blas_thread():
    ...     threads = {pool["num_threads"] for pool in _libraries().info()}
    >>> threads
    {1}
    """
    limit: AbstractContextManager[object] = _libraries().limit(limits=1)
    return limit


@lru_cache(maxsize=1)
def _libraries() -> threadpoolctl.ThreadpoolController:
    return threadpoolctl.ThreadpoolController().select(user_api="blas")
