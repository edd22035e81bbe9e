"""Every valid design of the cantilever: halves, condensed once, and combined in pairs.

Where two halves meet, only the nodes with material on both sides tie them together; which these are, the two columns
beside the line say. For each pair of such columns all left halves are reduced to these nodes, and all right ones; then
a pair costs one elimination of a dozen unknowns, done for several right halves at once. Profiles that do not fit are
never paired.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numba import njit, prange

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.column_kernels import eliminate
from slmm.optimization.cantilever.halves import EMPTY, HELD, Halves, counted, fits, left_halves, right_halves
from slmm.running.threaded import threaded

#: right halves that are worked on side by side
LANES = 128
#: bytes that the stiffness of all left halves, or all right ones, may take
MOST = 8e9
#: rows of grids whose designs are counted
TALLEST = 10


@dataclass(frozen=True)
class Block:
    """Some designs and how far their ends sag.

    Parameters
    ----------
    left, right : ndarray of int64 (n,), (m,)
        Codes of the halves; a design's code is that of both together.
    value : ndarray (n, m)
        mm.
    """

    left: np.ndarray
    right: np.ndarray
    value: np.ndarray

    @property
    def code(self) -> np.ndarray:
        """Codes (n, m) of the designs."""
        return self.left[:, None] | self.right


def all_designs(beam: Cantilever, first: int = 0) -> Iterator[Block]:
    """The endpoint displacement of every valid design, block by block.

    Parameters
    ----------
    beam : Cantilever
    first : int
        So many blocks are left out, which costs next to nothing.

    Raises
    ------
    ValueError
        See `check_grid`.

    Examples
    --------
    >>> sum(block.value.size for block in all_designs(Cantilever(4, 3)))
    50
    """
    left, right, fit = _halves(beam)
    done = 0
    for pattern, of_left in _by_pattern(left).items():
        for other, of_right in _by_pattern(right).items():
            pairs = [
                (these, those)
                for i, these in _runs(left.profile[of_left])
                for j, those in _runs(right.profile[of_right])
                if fit[i, j]
            ]
            if wanted := pairs[max(first - done, 0) :]:
                yield from _blocks(beam.rows, (left, pattern, of_left), (right, other, of_right), wanted)
            done += len(pairs)


def count_valid(beam: Cantilever) -> int:
    """Number of valid designs.

    Raises
    ------
    ValueError
        For more than ten rows, which have too many profiles.

    Examples
    --------
    >>> count_valid(Cantilever(8, 5))  # Paper C
    59554032
    """
    if beam.rows > TALLEST:
        raise ValueError(
            f"grid {beam.columns} x {beam.rows}: designs of more than {TALLEST} rows are not counted"
        )
    ends = counted((HELD,) * beam.rows, beam.columns - 1)
    return sum(number for profile, number in ends.items() if max(profile) == HELD)


def check_grid(beam: Cantilever) -> None:
    """Refuse a grid of which not all designs can be known.

    Raises
    ------
    ValueError
        For grids of one column, or whose designs have more than 62 bits, or whose halves take too much memory.
    """
    bits = (beam.columns - 1) * (beam.rows - 1)
    if beam.columns < 2 or bits > 62:
        raise ValueError(
            f"grid {beam.columns} x {beam.rows}: needs two columns at least and 62 free cells at most"
        )
    check_memory(beam, 4 * 2 ** (beam.rows - 1))  # single columns
    columns = (beam.columns + 1) // 2
    for first, more in ((HELD, columns - 1), (EMPTY, beam.columns - columns)):
        check_memory(beam, sum(counted((first,) * beam.rows, more).values()))


def _halves(beam: Cantilever) -> tuple[Halves, Halves, np.ndarray]:
    """Both halves, and which of their profiles fit."""
    check_grid(beam)
    columns = (beam.columns + 1) // 2
    left, right = left_halves(beam, columns), right_halves(beam, beam.columns - columns)
    return left, right, fits(left.profiles, right.profiles)


def check_memory(beam: Cantilever, number: int) -> None:
    """Refuse so many halves if they take too much memory."""
    if (size := number * 8 * (4 * beam.rows + 2) ** 2) > MOST:
        raise ValueError(
            f"grid {beam.columns} x {beam.rows}: its halves take {size / 1e9:.0f} GB, more than {MOST / 1e9:g}"
        )


def design_of(beam: Cantilever, code: np.ndarray) -> np.ndarray:
    """Designs (..., rows, columns) by their codes (...).

    Examples
    --------
    >>> design_of(Cantilever(3, 2), np.array(0b01)).astype(int).tolist()
    [[1, 1, 1], [1, 1, 0]]
    """
    code = np.asarray(code, dtype=np.int64)
    result = np.ones((*code.shape, beam.rows, beam.columns), dtype=bool)
    bit = np.arange((beam.columns - 1) * (beam.rows - 1))
    there = (code[..., None] >> bit & 1).astype(bool)
    result[..., 1:, 1:] = there.reshape(*code.shape, beam.columns - 1, beam.rows - 1).swapaxes(-1, -2)
    return result


def _by_pattern(halves: Halves) -> dict[int, np.ndarray]:
    """Places of the halves with each pattern, those of one profile together."""
    order = np.lexsort([halves.profile, halves.pattern])
    patterns, start = np.unique(halves.pattern[order], return_index=True)
    return dict(zip(patterns.tolist(), np.split(order, start[1:]), strict=True))


def _blocks(rows: int, left_group, right_group, pairs: list[tuple[slice, slice]]) -> Iterator[Block]:
    """Halves of two patterns, those of one profile with those of one."""
    (left, first, of_left), (right, second, of_right) = left_group, right_group
    touched_left, touched_right = _touched(rows, first), _touched(rows, second)
    both = touched_left & touched_right
    A, loads, _ = _reduced(
        left.K, left.V, left.value, of_left, np.flatnonzero(touched_left & ~both), np.flatnonzero(both)
    )
    B, others, value = _reduced(
        right.K, right.V, right.value, of_right, np.flatnonzero(touched_right & ~both), np.flatnonzero(both)
    )
    B, others = np.ascontiguousarray(B.T), np.ascontiguousarray(others.transpose(2, 1, 0))
    for these, those in pairs:
        found = _paired(
            A[these], loads[these, :, 0], B[:, those], others[0][:, those], others[1][:, those], value[those]
        )
        yield Block(left.code[of_left[these]], right.code[of_right[those]], found)


def _touched(rows: int, pattern: int) -> np.ndarray:
    """Which unknowns of a line (m,) a column with this pattern has material at."""
    cells = np.array([True, *(pattern >> k & 1 for k in range(rows - 1))], dtype=bool)
    nodes = np.zeros(2 * rows + 1, dtype=bool)
    for shift in range(3):
        nodes[shift : shift + 2 * rows : 2] |= cells
    return np.repeat(nodes, 2)


def _runs(sorted_values: np.ndarray) -> Iterator[tuple[int, slice]]:
    """Each value and where it stands."""
    values, start = np.unique(sorted_values, return_index=True)
    for value, low, high in zip(values, start, [*start[1:], len(sorted_values)], strict=True):
        yield int(value), slice(low, high)


@threaded(cache=True, error_model="numpy")
def _reduced(K, V, value, which, gone, kept):
    """Halves with some unknowns eliminated: upper triangles by rows (n, k (k + 1)/2), loads (n, k, 2), value (n,)."""
    n, k = len(gone) + len(kept), len(kept)
    triangles = np.empty((len(which), k * (k + 1) // 2))
    loads, values = np.empty((len(which), k, 2)), np.empty(len(which))
    order = np.concatenate((gone, kept))
    for h in prange(len(which)):
        A, b = np.empty((n, n)), np.empty((n, 2))
        for i in range(n):
            b[i] = V[which[h], order[i]]
            for j in range(n):
                A[i, j] = K[which[h], order[i], order[j]]
        values[h] = value[which[h]] + eliminate(A, b, len(gone))
        place = 0
        for i in range(k):
            loads[h, i] = b[len(gone) + i]
            for j in range(i, k):
                triangles[h, place] = A[len(gone) + i, len(gone) + j]
                place += 1
    return triangles, loads, values


# inner loops over the right halves side by side, whose length LLVM must not know: it would unroll, not vectorise them
lanes = njit(cache=True, error_model="numpy", fastmath={"contract"}, boundscheck=False)


@lanes
def _add(target, number, source, width):
    for l in range(width):
        target[l] = number + source[l]


@lanes
def _subtract(target, factor, source, width):
    for l in range(width):
        target[l] -= factor[l] * source[l]


@lanes
def _divide(target, pivot, width):
    for l in range(width):
        target[l] /= pivot[l]


@lanes
def _add_quotients(target, a, b, pivot, width):
    for l in range(width):
        target[l] += a[l] * b[l] / pivot[l]


@threaded(cache=True, error_model="numpy")
def _paired(A_left, f_left, A_right, f_right, t_right, value):
    """Sag of the corner (left, right) of all pairs; of the right halves unknowns come first, halves last."""
    lefts, rights = len(A_left), len(value)
    n, entries = f_left.shape[1], A_left.shape[1]
    result = np.empty((lefts, rights))
    for h in prange(lefts):
        A, f, t = np.empty((entries, LANES)), np.empty((n, LANES)), np.empty((n, LANES))
        factor = np.empty(LANES)
        for start in range(0, rights, LANES):
            width = min(LANES, rights - start)
            for e in range(entries):
                _add(A[e], A_left[h, e], A_right[e, start:], width)
            for i in range(n):
                _add(f[i], f_left[h, i], f_right[i, start:], width)
                _add(t[i], 0.0, t_right[i, start:], width)
            sag = result[h, start : start + width]
            _add(sag, 0.0, value[start:], width)
            pivot = 0
            for k in range(n):
                _add_quotients(sag, f[k], t[k], A[pivot], width)
                row = pivot + n - k
                for i in range(k + 1, n):
                    factor[:width] = A[pivot + i - k, :width]
                    _divide(factor, A[pivot], width)
                    _subtract(f[i], factor, f[k], width)
                    _subtract(t[i], factor, t[k], width)
                    for j in range(i, n):
                        _subtract(A[row + j - i], factor, A[pivot + j - k], width)
                    row += n - i
                pivot += n - k
    return result
