"""Simulated annealing (SA): Paper C, section 2.2.4 and A.4."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.ask import Ask, Asking
from slmm.optimization.checks import check_between, check_whole
from slmm.optimization.problem import Problem, start_design

#: share that rounding may change of a value (round-off, with room)
ROUND_OFF = 1e-9


def sa(
    problem: Problem,
    start: ArrayLike | None,
    rng: np.random.Generator,
    *,
    temperature: float = 0.1,
    cooling: float = 0.999,
    iterations: int = 50_000,
) -> Asking:
    """Flip one random cell after the other; what is worse is kept with the probability exp(-difference/temperature).

    Parameters
    ----------
    temperature : float
        At the beginning, in the units of the values.
    cooling : float
        Factor of the temperature from one iteration to the next.
    iterations : int
    """
    check_between("temperature", temperature, 0)
    check_between("cooling", cooling, 0, 1)
    check_whole("iterations", iterations, 1)
    design = start_design(problem, start, rng)
    (value,) = yield Ask(problem, design[None])
    # any value is better than none
    value = np.inf if np.isnan(value) else value
    free = np.argwhere(~problem.fixed)
    for _ in range(iterations):
        flipped = random_neighbour(problem, design, free, rng)
        if flipped is None:
            return "no valid neighbour"
        chance = rng.random()
        (other,) = yield Ask(problem, flipped[None], needed=above_kept(value, temperature, chance))
        if accepts(other - value, temperature, chance):
            design, value = flipped, other
        temperature *= cooling
    return "all iterations done"


def random_neighbour(
    problem: Problem, design: np.ndarray, free: np.ndarray, rng: np.random.Generator
) -> np.ndarray | None:
    """A valid design in which one random cell of the free ones (n, 2) is flipped; None if there is none."""
    left = free
    while len(left):
        k = rng.integers(len(left))
        flipped = design.copy()
        flipped[tuple(left[k])] ^= True
        if problem.valid(flipped[None])[0]:
            return flipped
        left = np.delete(left, k, axis=0)
    return None


def accepts(difference: float, temperature: float, chance: float) -> bool:
    """Whether a design that is worse by so much is kept, by a random number between 0 and 1; without a value, never."""
    if difference > 0:
        return temperature > 0 and chance <= np.exp(-difference / temperature)
    return bool(difference <= 0)


def above_kept(value: float, temperature: float, chance: float) -> float:
    """What all values that would be kept in place of this one are below, by a random number between 0 and 1.

    Examples
    --------
    >>> round(above_kept(2.0, 0.1, 0.5), 6), bool(accepts(0.0693, 0.1, 0.5)), bool(accepts(0.0694, 0.1, 0.5))
    (2.069315, True, False)
    """
    if temperature == 0:
        worse = 0.0
    elif chance == 0:
        return math.inf
    else:
        worse = -temperature * math.log(chance)
    # exponential and logarithm are not each other's inverse in the last digits
    return math.nextafter(value + worse + ROUND_OFF * (abs(value) + worse), math.inf)
