"""The faces of cracks: how far they open, where they would overlap, and what holds them closed there."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.crack_panels import CrackPanels, straight_rule, tip_rule
from slmm.boundary.rules import Array, Complex
from slmm.mechanics.faces_in_contact import ROUND_OFF, closing_pressures

Rows = NDArray[np.int64]

#: panels in which faces begin to touch are no longer than these shares of all that touches, or of all cracks: K at the
#: other end of a crack that bending closes is within 5e-4 then; chosen
OF_CLOSED, OF_CRACKS = 0.1, 0.005


def opening_of(jump: Complex, direction: Complex) -> Array:
    """Opening (m,) of jumps (m,) on lines along directions (m,), negative where faces overlap."""
    return (jump * direction.conj()).imag


def overlap(jump: Array, direction: Complex) -> bool:
    """Whether faces with jumps (2 m,), real and imaginary parts in turn, overlap anywhere."""
    opening = opening_of(jump[::2] + 1j * jump[1::2], direction)
    return bool(opening.min() < -ROUND_OFF * np.abs(jump).max(initial=1e-300))


def lengths_of(cracks: CrackPanels) -> Array:
    """Length (m,) of cracks that each of their points stands for, mm."""
    _, straight, _ = straight_rule(cracks.p)
    root, at_tip, _ = tip_rule(cracks.p)
    share = np.where(cracks.is_tip[:, None], root * at_tip / (root @ at_tip), 0.5 * straight)
    return np.asarray((np.abs(cracks.ends - cracks.starts)[:, None] * share).ravel())


def half_closed(cracks: CrackPanels, touching: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which panels (k,) have points (k p,) that touch beside others that do not, and are too long for that."""
    here = touching.reshape(-1, cracks.p)
    length = np.abs(cracks.ends - cracks.starts)
    allowed = max(OF_CLOSED * lengths_of(cracks)[touching].sum(), OF_CRACKS * length.sum())
    return np.asarray(here.any(axis=1) & ~here.all(axis=1) & (length > allowed))


def halved(cracks: CrackPanels, which: NDArray[np.bool_]) -> CrackPanels:
    """Panels of cracks, some of them in two halves."""
    middles = 0.5 * (cracks.starts + cracks.ends)
    first, second = 1 + which, np.cumsum(1 + which)[which] - 1
    starts, ends, tip = (np.repeat(values, first) for values in (cracks.starts, cracks.ends, cracks.tip))
    starts[second], ends[second - 1], tip[second - 1] = middles[which], middles[which], -1
    return CrackPanels.between(starts, ends, tip, cracks.p)


def held_closed(
    solve: Callable[[Array], Array], free: Array, cracks: Rows, direction: Complex
) -> tuple[Array, NDArray[np.bool_]]:
    """Unknowns (n,) of which jumps nowhere overlap, and where faces touch (m,), without friction.

    Parameters
    ----------
    solve : callable
        The unknowns (n, k) by right-hand sides (n, k), which are resultant forces along cracks in the rows of these,
        i times the tractions.
    free : ndarray, shape (n,)
        The unknowns where faces are free.
    cracks : ndarray of int, shape (2 m,)
        Which of them are jumps, real and imaginary parts in turn.
    direction : ndarray, shape (m,)
        Along the cracks.

    Raises
    ------
    ContactError
        When the search for the places that touch does not end.
    """
    moved = np.zeros((len(free), len(direction)))

    def opening(unknowns: Array) -> Array:
        jump = unknowns[cracks]
        return opening_of((jump[::2] + 1j * jump[1::2]).T, direction).T

    def by_pressure(places: Rows) -> Array:
        right, which = np.zeros((len(free), len(places))), np.arange(len(places))
        # forces along a crack are normal tractions
        right[cracks[2 * places], which] = -direction[places].real
        right[cracks[2 * places + 1], which] = -direction[places].imag
        moved[:, places] = solve(right)
        return opening(moved[:, places])

    moves = float(np.abs(free[cracks]).max(initial=1e-300))
    pressure, closed = closing_pressures(opening(free), by_pressure, moves)
    held = free + moved @ pressure
    # what touches moves along the crack alone, to the bit
    jump, along = held[cracks[::2]] + 1j * held[cracks[1::2]], direction
    jump = np.where(closed, along * (jump * along.conj()).real, jump)
    held[cracks[::2]], held[cracks[1::2]] = jump.real, jump.imag
    return held, closed
