"""Genetic algorithm (GA) on cells that are on or off: Paper C, section 2.2.3 and A.3."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.ask import Ask, Asking
from slmm.optimization.checks import check_between, check_whole
from slmm.optimization.problem import Problem, Repairing, check_has, random_design, start_designs


def ga(
    problem: Repairing,
    start: ArrayLike | None,
    rng: np.random.Generator,
    *,
    population: int = 93,
    recombinations: int = 34,
    mutation: float = 5.5e-4,
    patience: int = 5,
    scale: float | None = None,
) -> Asking:
    """Selection, recombination, mutation and repair, generation after generation; no design is simulated twice.

    Parameters
    ----------
    population : int
        Number of designs. Random ones are added to those it starts from.
    recombinations : int
        Pairs that exchange a block of cells, in each generation.
    mutation : float
        Probability that a cell flips, in each generation.
    patience : int
        It goes on for so many generations without a better design, and stops after one more.
    scale : float, optional
        A value that is worse by this is selected 1/e times as often, in the units of the values. By default it is the
        distance of the median from the best of each generation, which serves any problem. Eq. 4 says 1 mm, but what
        Table 2 has found is found with 0.01 mm.
    """
    check_has(problem, "repaired")
    _check(population, recombinations, mutation, patience, scale)
    designs = first_generation(problem, start, rng, population)
    known: dict[bytes, float] = {}
    best, waited = np.inf, 0
    while True:
        new = {name: design for design in designs if (name := design.tobytes()) not in known}
        if new:
            found = yield Ask(problem, np.array(list(new.values())))
            known.update(zip(new, found.tolist(), strict=True))
        values = np.array([known[design.tobytes()] for design in designs])
        if np.isnan(values).all():
            return "no design of a generation has a value"
        if np.nanmin(values) < best:
            best, waited = np.nanmin(values), 0
        elif waited < patience:
            waited += 1
        else:
            return f"no better design in {patience + 1} generations"
        weights = fitness(values, scale)
        designs = designs[rng.choice(len(designs), len(designs), p=weights / weights.sum())]
        designs = recombined(problem, designs, recombinations, rng)
        designs = designs ^ (~problem.fixed & (rng.random(designs.shape) < mutation))
        designs = np.array([problem.repaired(design) for design in designs])


def _check(population: int, recombinations: int, mutation: float, patience: int, scale: float | None) -> None:
    check_whole("population", population, 2)
    check_whole("recombinations", recombinations, 0)
    if 2 * recombinations > population:
        raise ValueError(
            f"recombinations = {recombinations}: {population} designs make {population // 2} pairs"
        )
    check_between("mutation", mutation, 0, 1)
    check_whole("patience", patience, 0)
    if scale is not None:
        check_between("scale", scale, 0)
        if scale == 0:
            raise ValueError("scale = 0: must be positive")


def first_generation(
    problem: Problem, start: ArrayLike | None, rng: np.random.Generator, population: int
) -> np.ndarray:
    """Given designs (rows, columns) or (n, rows, columns), and random ones for the rest (population, rows, columns).

    Raises
    ------
    ValueError
        When more are given than there are, or one is not a valid design.
    """
    given = np.empty((0, *problem.shape), dtype=bool)
    if start is not None:
        array = np.asarray(start)
        given = start_designs(problem, array[None] if array.ndim == 2 else array)
    if len(given) > population:
        raise ValueError(f"start: has {len(given)} designs, more than the population of {population}")
    others = [random_design(problem, rng) for _ in range(population - len(given))]
    return np.concatenate([given, others]) if others else given


def fitness(values: np.ndarray, scale: float | None) -> np.ndarray:
    """How often designs (n,) are selected, in proportion: exp(-value/scale) over that of the best; 0 without a value.

    Examples
    --------
    >>> fitness(np.array([1.0, 2.0, 3.0, np.nan]), scale=None).round(3).tolist()
    [1.0, 0.368, 0.135, 0.0]
    """
    above = values - np.nanmin(values)
    if scale is None:
        scale = float(np.nanmedian(above))
    # once most designs are the best one, nothing but the best one is selected
    relative = above / scale if scale > 0 else np.where(above > 0, np.inf, above)
    return np.nan_to_num(np.exp(-relative), nan=0.0)


def recombined(problem: Problem, designs: np.ndarray, pairs: int, rng: np.random.Generator) -> np.ndarray:
    """Designs (n, rows, columns) of which so many pairs have exchanged a random rectangle of cells."""
    result = designs.copy()
    free = np.argwhere(~problem.fixed)
    if not len(free):
        return result
    low, high = free.min(axis=0), free.max(axis=0) + 1
    for one, other in rng.permutation(len(designs))[: 2 * pairs].reshape(-1, 2):
        (top, left), (bottom, right) = np.sort(rng.integers(low, high, (2, 2)), axis=0)
        block = slice(top, bottom + 1), slice(left, right + 1)
        result[one][block], result[other][block] = designs[other][block], designs[one][block]
    return result
