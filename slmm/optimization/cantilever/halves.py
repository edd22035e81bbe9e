"""Halves of the cantilever, condensed to the line of nodes where they meet.

A half grows column by column from its end towards the middle: the held edge of the left half, the free end of the right
one. What stays of it is the stiffness and the weight on the line, how the corner's sag depends on the line, and a
*profile* of its last column: which cells are there and what they hang on. A part that touches the line may yet be held
by the other half; one that does not is lost, and with it the design. So no elimination meets a part that could move
freely.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numba import njit, prange

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.column_kernels import add_column, column_places, eliminate
from slmm.running.threaded import threaded

#: of a column's cells from the top: no cell, a cell that is held, and from 2 on the number of a part that is not
EMPTY, HELD = 0, 1
Profile = tuple[int, ...]


@dataclass(frozen=True)
class Halves:
    """All left or all right halves that valid designs have.

    Parameters
    ----------
    code : ndarray (n,) of int64
        Which of the cells that may be left out are there: bits, column after column from the second one, in each from
        the second row downwards.
    pattern : ndarray (n,)
        The bits of the column next to the line.
    profile : ndarray (n,)
        Places in ``profiles``.
    profiles : list of Profile
    K : ndarray (n, m, m)
        Stiffness of the line's m unknowns, N/mm.
    V : ndarray (n, m, 2)
        Weight, N, and derivative of the corner's sag.
    value : ndarray (n,)
        The corner's sag with the line held, mm.
    """

    code: np.ndarray
    pattern: np.ndarray
    profile: np.ndarray
    profiles: list[Profile]
    K: np.ndarray
    V: np.ndarray
    value: np.ndarray


def counted(first: Profile, columns: int) -> dict[Profile, int]:
    """How many ways there are from a profile to each of those that come after so many more columns.

    Examples
    --------
    The second cell of the next column may be there or not:

    >>> counted((HELD, HELD), 1)
    {(1, 0): 1, (1, 1): 1}
    """
    numbers = {first: 1}
    for _ in range(columns):
        grown: dict[Profile, int] = {}
        for profile, number in numbers.items():
            for after in _followers(profile):
                grown[after] = grown.get(after, 0) + number
        numbers = grown
    return numbers


def left_halves(beam: Cantilever, columns: int) -> Halves:
    """The held edge and some columns, the first of which has all its cells."""
    K, V = _columns(beam, towards_right=True)
    m, full = K.shape[1] // 2, len(K) - 1
    profiles = [(HELD,) * beam.rows]
    zero = np.zeros(1, dtype=np.int64)
    halves = Halves(zero, zero + full, zero, profiles, K[full, m:, m:][None], V[full, m:][None], np.zeros(1))
    for column in range(1, columns):
        halves = _grown(halves, K, V, (column - 1) * (beam.rows - 1))
    return halves


def right_halves(beam: Cantilever, columns: int) -> Halves:
    """The free end and some columns."""
    K, V = _columns(beam, towards_right=False)
    m = K.shape[1] // 2
    end = np.zeros((1, m, 2))
    end[0, 1, 1] = 1.0  # the corner's vertical displacement
    zero = np.zeros(1, dtype=np.int64)
    halves = Halves(zero, zero, zero, [(EMPTY,) * beam.rows], np.zeros((1, m, m)), end, np.zeros(1))
    for k in range(columns):
        halves = _grown(halves, K, V, (beam.columns - 2 - k) * (beam.rows - 1))
    return halves


def fits(left: list[Profile], right: list[Profile]) -> np.ndarray:
    """Whether every part of two halves is held once they meet (left, right).

    Examples
    --------
    A lower cell of the right half that nothing holds hangs on a held one of the left half, or on nothing:

    >>> fits([(HELD, HELD), (HELD, EMPTY)], [(HELD, 2)]).tolist()
    [[True], [False]]
    """
    return _all_fit(np.array(left), np.array(right))


@threaded(cache=True)
def _all_fit(left, right):
    result = np.empty((len(left), len(right)), dtype=np.bool_)
    for i in prange(len(left)):
        for j in range(len(right)):
            result[i, j] = _fit(left[i], right[j])
    return result


@njit(cache=True)
def _fit(left, right):
    # parts of the right half are counted behind those of the left one; what is held is the same
    rows = len(left)
    parent = np.arange(2 * rows + 2)
    shift = rows
    for row in range(rows):
        if left[row] != EMPTY and right[row] != EMPTY:
            a, b = left[row], HELD if right[row] == HELD else right[row] + shift
            while parent[a] != a:
                a = parent[a]
            while parent[b] != b:
                b = parent[b]
            # what is held has the least number
            parent[max(a, b)] = min(a, b)
    for row in range(rows):
        for part in (left[row], right[row] + shift if right[row] > HELD else right[row]):
            while parent[part] != part:
                part = parent[part]
            if part > HELD:
                return False
    return True


class _Parts:
    """What hangs together: sets of anything, joined in pairs."""

    def __init__(self) -> None:
        self.parent: dict = {HELD: HELD}

    def find(self, x):
        self.parent.setdefault(x, x)
        while self.parent[x] != x:
            x = self.parent[x]
        return x

    def join(self, x, y) -> None:
        self.parent[self.find(x)] = self.find(y)


@lru_cache(maxsize=1 << 16)
def _followers(profile: Profile) -> list[Profile]:
    """Profiles of all next columns in which no part is lost."""
    each = (_continued(profile, pattern) for pattern in range(2 ** (len(profile) - 1)))
    return [after for after in each if after is not None]


def _continued(profile: Profile, pattern: int) -> Profile | None:
    """The profile of the next column; None when a part is lost."""
    cells = [True, *(bool(pattern >> k & 1) for k in range(len(profile) - 1))]
    parts = _Parts()
    parts.join(("cell", 0), HELD)
    for row, (cell, before) in enumerate(zip(cells, profile, strict=True)):
        if cell and before != EMPTY:
            parts.join(("cell", row), HELD if before == HELD else ("part", before))
    for upper, lower in pairwise(range(len(cells))):
        if cells[upper] and cells[lower]:
            parts.join(("cell", upper), ("cell", lower))
    of_cells = {parts.find(("cell", row)) for row, cell in enumerate(cells) if cell}
    if any(parts.find(("part", part)) not in of_cells for part in profile if part > HELD):
        return None
    names = {parts.find(HELD): HELD}
    result = []
    for row, cell in enumerate(cells):
        result.append(names.setdefault(parts.find(("cell", row)), len(names) + 1) if cell else EMPTY)
    return tuple(result)


def _grown(halves: Halves, K: np.ndarray, V: np.ndarray, shift: int) -> Halves:
    """Halves with one more column, of each pattern that loses no part; its bits stand at ``shift``."""
    patterns = len(K)
    profiles: dict[Profile, int] = {}
    follows = np.full((len(halves.profiles), patterns), -1)
    for i, profile in enumerate(halves.profiles):
        for j in range(patterns):
            if (after := _continued(profile, j)) is not None:
                follows[i, j] = profiles.setdefault(after, len(profiles))
    parent, pattern = np.nonzero(follows[halves.profile] >= 0)
    K_new, V_new, value = _condensed(halves.K, halves.V, halves.value, K, V, parent, pattern)
    return Halves(
        halves.code[parent] | pattern << shift,
        pattern,
        follows[halves.profile[parent], pattern],
        list(profiles),
        K_new,
        V_new,
        value,
    )


def _columns(beam: Cantilever, towards_right: bool) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness (patterns, 2 m, 2 m) and loads (patterns, 2 m, 2) of columns: the line behind, then the line ahead."""
    line, middles = 2 * (2 * beam.rows + 1), 2 * (beam.rows + 1)
    between, right, left = np.split(np.arange(2 * line + middles), [middles, middles + line])
    # what is in the middle comes first and is eliminated
    order = np.concatenate([between, *((left, right) if towards_right else (right, left))])
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    places = place[column_places(beam.rows)]
    K, V = [], []
    for pattern in range(2 ** (beam.rows - 1)):
        cells = np.array([True, *(pattern >> k & 1 for k in range(beam.rows - 1))], dtype=bool)
        A, loads = np.zeros((len(order),) * 2), np.zeros((len(order), 2))
        add_column(A, loads, cells, places, *beam.cell)
        eliminate(A, loads, middles)
        upper = np.triu(A[middles:, middles:])
        K.append(upper + np.triu(upper, 1).T)
        V.append(loads[middles:])
    return np.array(K), np.array(V)


@threaded(cache=True, error_model="numpy")
def _condensed(K, V, value, K_column, V_column, parent, pattern):
    """Halves with one more column each, their former lines eliminated."""
    m = K.shape[1]
    K_new, V_new = np.empty((len(parent), m, m)), np.empty((len(parent), m, 2))
    value_new = np.empty(len(parent))
    for k in prange(len(parent)):
        A, loads = K_column[pattern[k]].copy(), V_column[pattern[k]].copy()
        A[:m, :m] += K[parent[k]]
        loads[:m] += V[parent[k]]
        value_new[k] = value[parent[k]] + eliminate(A, loads, m)
        for i in range(m):
            V_new[k, i] = loads[m + i]
            for j in range(i, m):
                K_new[k, i, j] = K_new[k, j, i] = A[m + i, m + j]
    return K_new, V_new, value_new
