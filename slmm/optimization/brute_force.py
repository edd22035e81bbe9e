"""What can be said of a cantilever when all its valid designs are known: the best ones, and anyone's exact rank."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from slmm import __version__
from slmm.optimization.cantilever import Cantilever
from slmm.optimization.exhaustive import Block, all_designs, count_valid, design_of

#: values closer than this share of the larger one are those of the same design, computed in another way
SAME = 1e-8
#: values below this are zero as far as that goes, mm
SMALLEST = 1e-9


def brute_force(
    beam: Cantilever, best: int = 200_000, progress: Callable[[float, str], None] | None = None
) -> xr.Dataset:
    """The best of all valid designs, in order.

    Parameters
    ----------
    beam : Cantilever
    best : int
        How many of them; all if there are less.
    progress : callable, optional
        Is told the share that is done, and a word.

    Returns
    -------
    xarray.Dataset
        ``n_valid``, ``best_design(row, column)``, ``endpoint_displacement(rank)`` in ascending order, mm, and
        ``code(rank)``, from which `slmm.optimization.exhaustive.design_of` makes the designs.

    Raises
    ------
    ValueError
        See `slmm.optimization.exhaustive.all_designs`; and when best is less than 1.

    Examples
    --------
    >>> found = brute_force(Cantilever(4, 3))
    >>> int(found.n_valid), found.sizes["rank"], found.best_design.values.astype(int).tolist()
    (50, 50, [[1, 1, 1, 1], [1, 1, 1, 0], [1, 1, 0, 0]])
    """
    if best < 1:
        raise ValueError(f"best = {best}: must be 1 at least")
    total = count_valid(beam)
    values, codes = [np.empty(0)], [np.empty(0, dtype=np.int64)]
    waiting, done, limit = 0, 0, np.inf
    for block in all_designs(beam):
        done += block.value.size
        row, column = np.nonzero(block.value <= limit)
        values.append(block.value[row, column])
        codes.append(block.left[row] | block.right[column])
        waiting += len(row)
        if waiting > 4 * best:
            values, codes = _least(values, codes, best)
            waiting, limit = 0, values[0].max()
        if progress is not None:
            progress(done / total, f"{done:,} of {total:,} designs")
    (value,), (code,) = _least(values, codes, best)
    order = np.lexsort([code, value])
    value, code = value[order], code[order]
    return xr.Dataset(
        {
            "n_valid": ((), done, {"units": "1", "long_name": "number of valid designs"}),
            "best_design": (
                ("row", "column"),
                design_of(beam, code[0]),
                {"units": "1", "long_name": "where the best design has material; row 0 is the top"},
            ),
            "endpoint_displacement": (
                "rank",
                value,
                {"units": "mm", "long_name": "sag of the upper right corner"},
            ),
            "code": (
                "rank",
                code,
                {"units": "1", "long_name": "bits of the free cells, column after column"},
            ),
        },
        coords={
            "rank": ("rank", np.arange(1, len(value) + 1), {"long_name": "place among all valid designs"})
        },
        attrs={
            "version": __version__,
            "columns": beam.columns,
            "rows": beam.rows,
            "algorithm": "brute-force",
        },
    )


def ranks(beam: Cantilever, values: ArrayLike) -> np.ndarray:
    """Places (n,) among all valid designs of designs with these endpoint displacements (n,), mm; the best has 1.

    Designs whose values differ by round-off alone share a place.

    Examples
    --------
    >>> beam = Cantilever(4, 3)
    >>> ranks(beam, beam.endpoint_displacement(np.ones((1, 3, 4), dtype=bool))).tolist()
    [14]
    """
    values = np.asarray(values, dtype=float)
    below = values - SAME * np.maximum(np.abs(values), SMALLEST)
    order = np.argsort(below)
    count = np.zeros(len(values) + 1, dtype=np.int64)
    for block in all_designs(beam):
        count += _places(below[order], block)
    result = np.empty(len(values), dtype=np.int64)
    result[order] = 1 + np.cumsum(count)[:-1]
    return result


def _places(limits: np.ndarray, block: Block) -> np.ndarray:
    """How many values of a block lie between sorted limits."""
    return np.bincount(np.searchsorted(limits, block.value.ravel(), side="right"), minlength=len(limits) + 1)


def _least(
    values: list[np.ndarray], codes: list[np.ndarray], best: int
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """The least values and their codes."""
    value, code = np.concatenate(values), np.concatenate(codes)
    if len(value) > best:
        least = np.argpartition(value, best - 1)[:best]
        value, code = value[least], code[least]
    return [value], [code]
