"""Several runs of one search, with seeds that follow one another, as one dataset."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from slmm.optimization.problem import Problem
from slmm.optimization.search import SearchResult, search

#: is told the number of the run, of its simulations, and the best value of all runs so far
Progress = Callable[[int, int, float], None]


def search_runs(
    problem: Problem,
    algorithm: str = "tbfsl",
    *,
    runs: int = 1,
    seed: int = 0,
    journals: str | Path | None = None,
    resume: bool = False,
    progress: Progress | None = None,
    **options: Any,
) -> xr.Dataset:
    """Search again and again, the k-th time with seed + k.

    Parameters
    ----------
    runs : int
    journals : str or Path, optional
        A folder for the journal of each run, see `slmm.optimization.journal`; made where it is missing.
    resume : bool
        Go on with the journals that are there.
    progress : callable, optional
        Is told the number of the run, the number of its simulations, and the best value of all runs.
    problem, algorithm, seed, options
        As in `slmm.optimization.search`.

    Returns
    -------
    xarray.Dataset
        The variables of `SearchResult.to_dataset` over ``run``; histories are filled up with NaN.

    Raises
    ------
    ValueError
        When runs is less than 1, and as in `search`.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> found = search_runs(Cantilever(4, 3), "tbfsl", runs=3)
    >>> found.value.dims, found.value.round(5).values.tolist()
    (('run',), [0.00717, 0.00717, 0.00717])
    """
    if runs < 1:
        raise ValueError(f"runs = {runs}: must be 1 at least")
    if journals is not None:
        Path(journals).mkdir(parents=True, exist_ok=True)
    results: list[SearchResult] = []
    for k in range(runs):
        best = min((result.value for result in results), default=np.inf)

        def tell(simulations: int, value: float, k: int = k, best: float = best) -> None:
            if progress is not None:
                progress(k, simulations, min(value, best))

        journal = None if journals is None else Path(journals) / f"run-{seed + k}.sqlite"
        results.append(
            search(
                problem, algorithm, seed=seed + k, journal=journal, resume=resume, progress=tell, **options
            )
        )
    each = [result.to_dataset() for result in results]
    each = [one.assign_coords(improvement=np.arange(one.sizes["improvement"])) for one in each]
    joined = xr.concat(each, dim="run", join="outer", combine_attrs="drop_conflicts")
    joined.attrs.pop("stopped", None)
    joined["stopped"] = (
        "run",
        np.array([r.stopped for r in results], dtype=object),
        {"units": "1", "long_name": "why"},
    )
    joined["seed"] = ("run", [r.seed for r in results], {"units": "1", "long_name": "of the random numbers"})
    return joined
