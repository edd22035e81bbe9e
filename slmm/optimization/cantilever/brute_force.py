"""What can be said of a cantilever when all its valid designs are known: the best ones, and anyone's exact rank."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from slmm import __version__
from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.exhaustive import Block, all_designs, check_grid, count_valid, design_of
from slmm.optimization.checks import check_whole
from slmm.running.array_file import read_arrays
from slmm.running.progress import Progress, silent
from slmm.running.whole_file import whole_file

#: values closer than this share of the larger one are those of the same design, computed in another way
SAME = 1e-8
#: values below this are zero as far as that goes, mm
SMALLEST = 1e-9
#: what is known is written so often, s
INTERVAL = 30.0
#: so many of the best designs are kept
BEST = 200_000


def brute_force(
    beam: Cantilever,
    best: int = BEST,
    progress: Progress = silent,
    journal: str | Path | None = None,
    resume: bool = False,
) -> xr.Dataset:
    """The best of all valid designs, in order.

    Parameters
    ----------
    beam : Cantilever
    best : int
        How many of them; all if there are less.
    progress : callable
        Is told the share that is done, and a word.
    journal : str or Path, optional
        An npz file for what is known, written again and again. For hours of work.
    resume : bool
        Go on where the journal ends, if there is one; the result is that of an undisturbed run.

    Returns
    -------
    xarray.Dataset
        ``n_valid``, ``best_design(row, column)``, ``endpoint_displacement(rank)`` in ascending order, mm, and
        ``code(rank)``, from which `slmm.optimization.cantilever.exhaustive.design_of` makes the designs.

    Raises
    ------
    ValueError
        See `slmm.optimization.cantilever.exhaustive.check_grid`; when best is less than 1; and for a journal that is of
        something else, or there already and not to be resumed.

    Examples
    --------
    >>> found = brute_force(Cantilever(4, 3))
    >>> int(found.n_valid), found.sizes["rank"], found.best_design.values.astype(int).tolist()
    (50, 50, [[1, 1, 1, 1], [1, 1, 1, 0], [1, 1, 0, 0]])
    """
    check_whole("best", best, 1)
    path = None if journal is None else Path(journal)
    if resume and path is None:
        raise ValueError("resume: needs a journal")
    check_grid(beam)
    total = count_valid(beam)
    state = _State(f"{beam!r}, best {best}, {__version__}")
    if path is not None and os.path.lexists(path):
        if not resume:
            raise ValueError(f"{path}: is there already; resume it, or remove it")
        state = _State.read(path, state.run)
    written = time.monotonic()
    for block in all_designs(beam, state.blocks):
        state.add(block, best)
        progress(state.designs / total, f"{state.designs:,} of {total:,} designs")
        if path is not None and time.monotonic() - written > INTERVAL:
            state.write(path)
            written = time.monotonic()
    if state.designs != total:
        raise ValueError(
            f"{path}: is damaged: with it there are {state.designs:,} valid designs, not {total:,}"
        )
    state.keep(best)
    (value,), (code,) = state.values, state.codes
    order = np.lexsort([code, value])
    value, code = value[order], code[order]
    return xr.Dataset(
        {
            "n_valid": ((), state.designs, {"units": "1", "long_name": "number of valid designs"}),
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

    Raises
    ------
    ValueError
        For a value that is not finite, and see `slmm.optimization.cantilever.exhaustive.check_grid`.

    Examples
    --------
    >>> beam = Cantilever(4, 3)
    >>> ranks(beam, beam.endpoint_displacement(np.ones((1, 3, 4), dtype=bool))).tolist()
    [14]
    """
    values = np.atleast_1d(np.asarray(values, dtype=float))
    if not np.isfinite(values).all():
        raise ValueError(f"values: {values[~np.isfinite(values)][0]} has no place")
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


class _State:
    """What is known after some blocks.

    Parameters
    ----------
    run : str
        What it is of.
    """

    def __init__(self, run: str) -> None:
        self.run = run
        self.blocks = self.designs = 0
        self.limit = np.inf
        self.values, self.codes = [np.empty(0)], [np.empty(0, dtype=np.int64)]

    def add(self, block: Block, best: int) -> None:
        """Take in a block."""
        row, column = np.nonzero(block.value <= self.limit)
        self.values.append(block.value[row, column])
        self.codes.append(block.left[row] | block.right[column])
        self.blocks, self.designs = self.blocks + 1, self.designs + block.value.size
        if sum(len(part) for part in self.values) > 5 * best:
            self.keep(best)
            self.limit = self.values[0].max()

    def keep(self, best: int) -> None:
        """The least values alone, in any order."""
        value, code = np.concatenate(self.values), np.concatenate(self.codes)
        if len(value) > best:
            least = np.argpartition(value, best - 1)[:best]
            value, code = value[least], code[least]
        self.values, self.codes = [value], [code]

    def write(self, path: Path) -> None:
        """Replace the journal by this, at once."""
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as unfinished, open(unfinished, "wb") as file:
            np.savez(
                file,
                run=self.run,
                blocks=self.blocks,
                designs=self.designs,
                limit=self.limit,
                values=np.concatenate(self.values),
                codes=np.concatenate(self.codes),
            )

    @classmethod
    def read(cls, path: Path, run: str) -> _State:
        """The journal of this run.

        Raises
        ------
        ValueError
            When it is of another one, or no journal.
        """
        known = read_arrays(
            path, ("run", "blocks", "designs", "limit", "values", "codes"), "journal of brute-force"
        )
        if known["run"].dtype.kind != "U" or known["run"].shape != () or known["run"].item() != run:
            raise ValueError(f"{path}: is the journal of another run; this is {run}")
        state = cls(run)
        wanted = {"blocks": (int, ()), "designs": (int, ()), "limit": (float, ())}
        n = known["values"].shape[:1]
        for name, (kind, shape) in (wanted | {"values": (float, n), "codes": (np.int64, n)}).items():
            if known[name].dtype != kind or known[name].shape != shape or np.isnan(known[name]).any():
                raise ValueError(f"{path}: is no journal of brute-force ({name}: not what it writes)")
        state.blocks, state.designs = int(known["blocks"]), int(known["designs"])
        state.limit = float(known["limit"])
        state.values, state.codes = [known["values"]], [known["codes"]]
        return state
