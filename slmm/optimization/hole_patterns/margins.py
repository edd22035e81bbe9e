"""How far a design is from another fate: its saddles, its forks and ties, its tail, and what its U_T is good to.

A fork is where a small change lets other events happen. The holes are shifted by a fiftieth of a millimetre, up and
down, across the way of the crack: where U_T changes by more than the numerical error with that, it is no property of
the design. The plate upside down breaks as it does upright; what differs there is numerical error, or again a fork.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.events import COMPETING
from slmm.optimization.hole_patterns.objectives import OVER
from slmm.optimization.hole_patterns.plate import CrackedPlate, Values
from slmm.running.labelled import labelled

if TYPE_CHECKING:
    import xarray as xr

    from slmm.optimization.hole_patterns.problem import HolePattern

#: shifts of the holes across the way of the crack, mm; chosen, far below what anybody drills to
SHIFTS = (-0.02, 0.02)
#: by how much U_T may change with them, relative, of a design that does not fork; chosen
STEADY = 0.005
#: relative error of simulations that tell what those of a search are good to; chosen, a tenth of theirs
FINER = 1e-3
#: share of the largest force below which a plate but hinges; chosen
HINGES = 0.1


def margins(problem: HolePattern, whole: Values, plate: CrackedPlate | None = None) -> xr.Dataset:
    """Margins of a whole grid of support values, five simulations for each direction.

    Parameters
    ----------
    problem : HolePattern
        Its settings; the values may be any numbers.
    whole : ndarray (grid, grid)
    plate : CrackedPlate, optional
        Another one than the problem's.

    Returns
    -------
    Dataset
        Over ``direction``: ``U_T`` and ``U_T_finer`` (mJ), the latter with a tenth of the error; ``U_T_upside_down``;
        ``parted`` and over ``shift_y`` ``parted_shifted``, the first step that is another than upright and unshifted,
        -1 where all are alike; ``gap``, the nearest tie of two events, and ``competing``, how many steps have one
        within 0.5 %; ``hinging``, see `hinging_share`. ``U_T_shifted`` over both. Over ``saddle``: ``x``, ``y`` and
        ``value`` of the function through the support points. Attributes: ``margin`` of the nearest saddle,
        ``numerical_error`` (relative, the largest that upside down and finer show), ``spread`` (see `spread_of`), and
        whether it ``forks``: whether that is above 0.5 %.

    Raises
    ------
    ValueError
        When a simulation failed, with its reason.
    """
    plate = plate or problem.plate
    upright, finer, upside_down, displaced = [], [], [], []
    for k in range(problem.directions):
        turned = np.rot90(whole, k)
        upright.append(problem.fracture(plate.scene(turned)))
        finer.append(float(problem.fracture(plate.scene(turned), tolerance=FINER).U_T))
        upside_down.append(problem.fracture(plate.scene(turned[::-1])))
        displaced.append(shifted(problem, turned, plate))
    U_T = np.array([float(result.U_T) for result in upright])
    over = np.array([float(result.U_T) for result in upside_down])
    moved = np.array([[float(result.U_T) for result in row] for row in displaced])
    level_set = plate.level_set(whole)
    places, values = level_set.saddles()
    spread = spread_of(U_T, moved, problem.over)
    across = "direction", "shift_y"
    return labelled(
        {
            "U_T": ("direction", U_T, "mJ", "tensile toughness"),
            "U_T_finer": ("direction", finer, "mJ", f"tensile toughness, tolerance {FINER:g}"),
            "U_T_upside_down": ("direction", over, "mJ", "tensile toughness of the plate upside down"),
            "U_T_shifted": (across, moved, "mJ", "tensile toughness with shifted holes"),
            "parted": (
                "direction",
                [parted_upside_down(a, b, plate.side) for a, b in zip(upright, upside_down, strict=True)],
                "1",
                "first step that is another upside down, -1 without one",
            ),
            "parted_shifted": (
                across,
                [[parted_at(a, b) for b in row] for a, row in zip(upright, displaced, strict=True)],
                "1",
                "first step that is another with shifted holes, -1 without one",
            ),
            "gap": (
                "direction",
                [float(np.nanmin([*result.gap, np.inf])) for result in upright],
                "1",
                "least gap of an event's load to the next one's, relative",
            ),
            "competing": (
                "direction",
                [int((result.gap < COMPETING).sum()) for result in upright],
                "1",
                f"steps whose next event's load is within {COMPETING:g}",
            ),
            "hinging": (
                "direction",
                [hinging_share(result.u.values, result.F.values) for result in upright],
                "1",
                f"share of U_T behind the last force of {HINGES:g} of the largest",
            ),
            "x": ("saddle", places[:, 0], "mm", "x of the saddle"),
            "y": ("saddle", places[:, 1], "mm", "y of the saddle"),
            "value": ("saddle", values, "1", f"value there, a hole above {level_set.threshold:g}"),
        },
        {"shift_y": (np.array(SHIFTS), "mm", "of the holes, upwards")},
        margin=float(np.abs(values - level_set.threshold).min(initial=math.inf)),
        numerical_error=float(max(np.abs(over / U_T - 1).max(), np.abs(finer / U_T - 1).max())),
        spread=spread,
        forks=int(spread > STEADY),
    )


def hinging_share(u: NDArray[np.float64], F: NDArray[np.float64]) -> float:
    """Share of the area below F(u) that comes when the force has fallen below a tenth of its peak for good.

    Parameters
    ----------
    u, F : ndarray (n,)
        Corners of the curve.

    Examples
    --------
    >>> hinging_share(np.array([0.0, 1.0, 1.0, 2.0, 2.0]), np.array([0.0, 10.0, 0.4, 0.8, 0.0]))
    0.107...
    """
    last = int(np.flatnonzero(F / F.max() >= HINGES)[-1])
    return float(np.trapezoid(F[last + 1 :], u[last + 1 :]) / np.trapezoid(F, u))


def parted_at(one: xr.Dataset, other: xr.Dataset, upside_down: float | None = None) -> int:
    """The first step in which two simulations of one plate let happen different things, -1 if they never do.

    Parameters
    ----------
    upside_down : float, optional
        The plate's height, mm, where the other one is upside down.

    Notes
    -----
    The same event leads its tip to a place within half an increment.
    """
    near = 0.5 * float(one.attrs["increment"])
    shorter = min(one.sizes["step"], other.sizes["step"])
    y = other.y.values if upside_down is None else upside_down - other.y.values
    for k in range(shorter):
        away = math.hypot(one.x.values[k] - other.x.values[k], one.y.values[k] - y[k])
        if one.event.values[k] != other.event.values[k] or away > near:
            return k
    return -1 if one.sizes["step"] == other.sizes["step"] else shorter


def parted_upside_down(one: xr.Dataset, other: xr.Dataset, height: float) -> int:
    """The first step that is another upside down, as `parted_at`.

    In a plate that is its own mirror image two sides tie, and the rule takes the lower one both times.
    """
    steps = parted_at(one, other, height), parted_at(one, other)
    return -1 if -1 in steps else max(steps)


def shifted(problem: HolePattern, whole: Values, plate: CrackedPlate | None = None) -> list[xr.Dataset]:
    """Fractures of a plate with its holes shifted.

    Raises
    ------
    ValueError
        When a simulation failed, with its reason.
    """
    plate = plate or problem.plate
    return [problem.fracture(plate.scene(whole, (0.0, shift))) for shift in SHIFTS]


def spread_of(U_T: NDArray[np.float64], moved: NDArray[np.float64], over: str = "least") -> float:
    """By how much what counts of all directions changes with shifts, relative.

    Parameters
    ----------
    U_T : ndarray (directions,)
    moved : ndarray (directions, shifts)
        With shifted holes.
    over : {"least", "mean"}

    Examples
    --------
    >>> round(spread_of(np.array([400.0, 500.0]), np.array([[402.0, 400.0], [390.0, 500.0]])), 6)
    0.025
    """
    count = OVER[over]
    value = count(U_T.tolist())
    return max(abs(count(column) / value - 1) for column in moved.T.tolist())
