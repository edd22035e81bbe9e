"""Searches that use nothing of what they have seen: all designs (BF), and random ones (RS); Paper C, A.1 and A.2."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.ask import Ask, Asking
from slmm.optimization.checks import check_between
from slmm.optimization.problem import Problem, random_cells, start_design

#: free cells of which all designs are tried
MOST = 20
#: designs in one request (chosen)
BATCH = 1024


def bf(problem: Problem, start: ArrayLike | None, rng: np.random.Generator) -> Asking:
    """Brute force: every valid design; one to start from comes first, and the others need only be known to be better.

    A good start spares expensive problems work: most designs are given up early.
    """
    free = ~problem.fixed
    count = int(free.sum())
    if count > MOST:
        raise ValueError(
            f"{count} free cells: no more than {MOST} are tried; brute-force knows all designs of larger cantilevers"
        )
    best, first, batch = np.inf, 0, 1
    if start is not None:
        values = yield Ask(problem, start_design(problem, start, rng)[None])
        best = np.fmin.reduce(values, initial=best)
    while first < 1 << count:
        codes = np.arange(first, min(first + batch, 1 << count))
        designs = np.repeat(problem.start[None], len(codes), axis=0)
        designs[:, free] = codes[:, None] >> np.arange(count) & 1
        values = yield Ask(problem, designs, needed=best)
        best = np.fmin.reduce(values, initial=best)
        # small ones first: from then on only what is better need be known
        first, batch = first + batch, min(2 * batch, BATCH)
    return "all designs tried"


def rs(problem: Problem, start: ArrayLike | None, rng: np.random.Generator, *, limit: float) -> Asking:
    """Random sampling: valid designs, none of them twice, until one is not above a limit.

    Parameters
    ----------
    limit : float
        In the units of the values.
    """
    if start is not None:
        raise ValueError("start: designs are random, there is none to start from")
    number = 1 << int((~problem.fixed).sum())
    check_between("limit", limit, -np.inf)
    seen: set[bytes] = set()
    while len(seen) < number:
        designs = random_cells(problem, rng, BATCH)
        names = [bits.tobytes() for bits in np.packbits(designs.reshape(BATCH, -1), axis=1)]
        new = {name: k for k, name in enumerate(names) if name not in seen}
        seen.update(new)
        # not above the limit is below the next number
        values = yield Ask(problem, designs[list(new.values())], below=np.nextafter(limit, np.inf))
        if len(values) and values[-1] <= limit:
            return "limit reached"
    return "all designs tried"
