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
from numpy.typing import NDArray

from slmm.boundary.base_system import BaseSystem
from slmm.boundary.growing_factors import GrowingFactors
from slmm.boundary.rules import Array

#: room for so many rows at first; chosen
ROOM = 1024


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
    size : int
        Of its rows.
    factors : GrowingFactors
        Of D - R A^-1 B.
    """

    def __init__(self, base: BaseSystem) -> None:
        """Of a body that has neither cracks nor divided panels."""
        self.base = base
        self.size = 0
        self.factors = GrowingFactors()
        self._begins: dict[Member, int] = {}
        self._columns = np.empty((ROOM, len(base.solution)))
        self._rows = np.empty_like(self._columns)
        self._right = np.empty(ROOM)
        self._matrix = np.empty((ROOM, ROOM))

    @property
    def columns(self) -> Array:
        """A^-1 B, transposed; (m, 2 n)."""
        return self._columns[: self.size]

    @property
    def matrix(self) -> Array:
        """D - R A^-1 B (m, m)."""
        return self._matrix[: self.size, : self.size]

    def keep(self, wanted: Sequence[Member]) -> list[Member]:
        """Forget what is not wanted; what is wanted and not there, tips last."""
        asked = set(wanted)
        stays = np.array([member in asked for member in self._begins], dtype=bool)
        new = [member for member in wanted if member not in self._begins]
        if not stays.all():
            members = list(self._begins)
            begin = self._begins[members[int(stays.argmin())]]
            rows = np.flatnonzero(np.repeat(stays, [member.width for member in members]))
            moved, size = rows[np.searchsorted(rows, begin) :], len(rows)
            self.factors.truncate(begin)
            for array in (self._columns, self._rows, self._right):
                array[begin:size] = array[moved]
            self._matrix[begin:size, :size] = self._matrix[np.ix_(moved, rows)]
            self._matrix[:begin, begin:size] = self._matrix[:begin, moved]
            self._begins, self.size = {}, 0
            for member in members:
                if member in asked:
                    self._append(member)
        return sorted(new, key=lambda member: member.kind is Kind.TIP)

    def _append(self, member: Member) -> None:
        self._begins[member] = self.size
        self.size += member.width

    def places(self, members: Sequence[Member]) -> NDArray[np.int64]:
        """The rows of members, in their order."""
        return np.array(
            [self._begins[member] + k for member in members for k in range(member.width)], dtype=int
        )

    def extend(self, members: Sequence[Member]) -> tuple[Array, Array, Array]:
        """Make room for k rows of more members: B (2 n, k), R (k, 2 n) and r (k,), all to be filled in place."""
        first = self.size
        for member in members:
            self._append(member)
        self._make_room(first)
        new = slice(first, self.size)
        return self._columns[new].T, self._rows[new], self._right[new]

    def eliminate(self, first: int) -> None:
        """Solve for what members from a row on do to the base system, and what is felt of that; D is to be added."""
        new, size = slice(first, self.size), self.size
        columns, rows = self._columns[new], self._rows[new]
        columns[:] = self.base.solve(columns.T).T
        self._right[new] -= rows @ self.base.solution
        np.matmul(rows, self.columns.T, out=self._matrix[new, :size])
        np.negative(self._matrix[new, :size], out=self._matrix[new, :size])
        # the narrow factor first: the product takes less time
        self._matrix[:first, new] = -(columns @ self._rows[:first].T).T

    def drop(self, first: int) -> None:
        """Forget the members from a row on."""
        self._begins = {member: at for member, at in self._begins.items() if at < first}
        self.size = first

    def _make_room(self, filled: int) -> None:
        """For all rows, of which some are filled."""
        if self.size <= len(self._right):
            return
        room = 2 * self.size
        for name in ("_columns", "_rows", "_right"):
            old = getattr(self, name)
            array = np.empty((room, *old.shape[1:]))
            array[:filled] = old[:filled]
            setattr(self, name, array)
        matrix = np.empty((room, room))
        matrix[:filled, :filled] = self._matrix[:filled, :filled]
        self._matrix = matrix

    def solve(self) -> Array:
        """The unknowns of the border (m,)."""
        # tips are the first to go: they have a block of factors to themselves
        stays = self.size
        for member in reversed(self._begins):
            if member.kind is not Kind.TIP:
                break
            stays -= member.width
        if self.factors.size < self.size:
            cut = [stays] if self.factors.size < stays < self.size else []
            self.factors.append(self.matrix, *cut)
        return self.factors.solve(self._right[: self.size])
