"""What cracks and divided panels do to a factorised body and feel of it, kept while cracks grow.

With the base system's unknowns x and those of its border y, A x + B y = b and R x + D y = r, so that
(D - R A^-1 B) y = r - R A^-1 b. A panel of the body that was divided stays in A: forces in its equations, which are
unknowns of the border, hold its unknowns at nothing, and the panels in its place are part of the border. When cracks
grow most of the border stays, with its rows and columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from slmm.boundary.base_system import BaseSystem
from slmm.boundary.growing_factors import GrowingFactors
from slmm.boundary.rules import Array

#: room for so many rows at first; chosen
ROOM = 256


class Kind(StrEnum):
    """What a member of a border is."""

    DIVIDED = "divided"
    PANEL = "panel"
    CRACK = "crack"
    TIP = "tip"


class Member(NamedTuple):
    """A panel in the border.

    Attributes
    ----------
    kind : Kind
    key : tuple
        Which one; what it is besides does not change.
    width : int
        Its rows and columns.
    """

    kind: Kind
    key: tuple[complex, ...]
    width: int


class Border:
    """Rows and columns of members, the oldest first.

    Parameters
    ----------
    base : BaseSystem

    Attributes
    ----------
    members : list of Member
    factors : GrowingFactors
        Of D - R A^-1 B.
    """

    def __init__(self, base: BaseSystem) -> None:
        """Of a body that has neither cracks nor divided panels."""
        self.base = base
        self.members: list[Member] = []
        self.factors = GrowingFactors()
        self._size = 0
        self._columns = np.empty((ROOM, len(base.solution)))
        self._rows = np.empty_like(self._columns)
        self._right = np.empty(ROOM)
        self._matrix = np.empty((ROOM, ROOM))

    @property
    def columns(self) -> Array:
        """A^-1 B, transposed; (m, 2 n)."""
        return self._columns[: self._size]

    @property
    def rows(self) -> Array:
        """R (m, 2 n)."""
        return self._rows[: self._size]

    @property
    def right(self) -> Array:
        """r - R A^-1 b (m,)."""
        return self._right[: self._size]

    @property
    def matrix(self) -> Array:
        """D - R A^-1 B (m, m)."""
        return self._matrix[: self._size, : self._size]

    def keep(self, wanted: Sequence[Member]) -> list[Member]:
        """Forget what is not wanted; what is wanted and not there, tips last."""
        asked, known = set(wanted), set(self.members)
        stays = np.array([member in asked for member in self.members], dtype=bool)
        if not stays.all():
            first = int(stays.argmin())
            begin = sum(member.width for member in self.members[:first])
            rows = np.flatnonzero(np.repeat(stays, [member.width for member in self.members]))
            moved, size = rows[begin:], len(rows)
            self.factors.truncate(begin)
            for array in (self._columns, self._rows, self._right):
                array[begin:size] = array[moved]
            self._matrix[begin:size, :size] = self._matrix[np.ix_(moved, rows)]
            self._matrix[:begin, begin:size] = self._matrix[:begin, moved]
            self.members = [member for member in self.members if member in asked]
            self._size = size
        new = [member for member in wanted if member not in known]
        return sorted(new, key=lambda member: member.kind is Kind.TIP)

    def room(self, k: int) -> tuple[Array, Array, Array]:
        """Zeros to be filled before k rows are added: A^-1 B, transposed, and R (k, 2 n), and r - R A^-1 b (k,)."""
        m = self._size
        self._make_room(m + k)
        found = self._columns[m : m + k], self._rows[m : m + k], self._right[m : m + k]
        for array in found:
            array[:] = 0.0
        return found

    def extend(self, members: Sequence[Member], corner: Array, felt: Array) -> None:
        """More members, whose columns and rows are in the `room` for them.

        Parameters
        ----------
        members : sequence of Member
        corner : ndarray, shape (k, m + k)
            D of the new rows.
        felt : ndarray, shape (m, k)
            And of the new columns in the rows that are there.
        """
        m, k = self._size, len(corner)
        columns, rows = self._columns[m : m + k], self._rows[m : m + k]
        self._size = m + k
        self._matrix[m : m + k, : m + k] = corner - rows @ self.columns.T
        # the narrow factor first: the product takes less time
        self._matrix[:m, m : m + k] = felt - (columns @ self._rows[:m].T).T
        self.members = [*self.members, *members]

    def _make_room(self, size: int) -> None:
        if size <= len(self._right):
            return
        room = 2 * size
        m = self._size
        for name in ("_columns", "_rows", "_right"):
            old = getattr(self, name)
            array = np.empty((room, *old.shape[1:]))
            array[:m] = old[:m]
            setattr(self, name, array)
        matrix = np.empty((room, room))
        matrix[:m, :m] = self._matrix[:m, :m]
        self._matrix = matrix

    def solve(self) -> Array:
        """The unknowns of the border (m,)."""
        # tips are the first to go: they have a block of factors to themselves
        stays = self._size
        for member in reversed(self.members):
            if member.kind is not Kind.TIP:
                break
            stays -= member.width
        if self.factors.size < self._size:
            cut = [stays] if self.factors.size < stays < self._size else []
            self.factors.append(self.matrix, *cut)
        return self.factors.solve(self.right)
