"""Half bodies of sharp and rounded V-notches whose elements grow with the distance from the notch."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from precompute.half_body import HalfBody
from precompute.v_notch_spec import NotchSpec
from slmm.mechanics.williams import half_angle

#: the first crack tip lies at this fraction of the shortest length that is kept
FIRST_TIP = 0.03


def divide(end: float, size: Callable[[float], float]) -> np.ndarray:
    """Ends of elements on [0, end] whose size depends on where they start.

    Examples
    --------
    >>> divide(7.0, lambda x: 1.0 + x)
    array([0., 1., 3., 7.])
    """
    ends = [0.0]
    while ends[-1] < end * (1 - 1e-9):
        ends.append(ends[-1] + size(ends[-1]))
    return np.array(ends) * (end / ends[-1])


def halved(ends: np.ndarray) -> np.ndarray:
    """Ends when every element is divided in the middle.

    Examples
    --------
    >>> halved(np.array([0.0, 1.0, 3.0]))
    array([0. , 0.5, 1. , 2. , 3. ])
    """
    return np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))


def sharp_body(opening: float, spec: NotchSpec, fine: bool) -> tuple[HalfBody, int]:
    """Half of a sharp notch and the index of the element end at r = 1 on its bisector.

    The square's coordinates are the angle from the bisector and ln(r/near).
    """
    wide = spec.coarse * spec.step
    inner, outer = (divide(math.log(r), lambda _: wide) for r in (1 / spec.near, spec.far))
    middle = np.arange(-20, 21) * spec.step  # fine elements for the crack tip at r = 1
    along = np.concatenate([-inner[inner > 20 * spec.step][::-1], middle, outer[outer > 20 * spec.step]])
    across = divide(half_angle(opening), lambda theta: min(spec.step * (1 + theta), wide))
    if fine:
        along, across = halved(along), halved(across)
    tip = int(np.argmin(np.abs(along)))
    depth = along - along[0]

    def place(theta, x):
        r = spec.near * np.exp(x)
        return r * np.sin(theta), r * np.cos(theta)

    return HalfBody(across, depth, place, lambda _, x, __: x > depth[-1] - 1e-9), tip


def rounded_body(opening: float, spec: NotchSpec, fine: bool) -> tuple[HalfBody, np.ndarray]:
    """Half of a notch with a root of half width 1, and the crack tips on its bisector.

    The square's coordinates are the share q of the arc from the bisector to the tangent point and
    x = ln(1 + eta/eta_0). Lines of constant x are circles about the root's centre, r = radius + eta; on them q runs
    from the bisector to the straight flank, which ends at the angle arc + arccos(radius/r).

    Returns
    -------
    HalfBody
    ndarray
        Distances eta of the element ends from the root, up to the longest length kept.
    """
    radius, arc = 1 / math.cos(0.5 * opening), 0.5 * (math.pi - opening)
    eta_0 = FIRST_TIP * spec.shortest / spec.step
    longest, end = (math.log1p(eta / eta_0) for eta in (spec.longest, spec.far))
    wide = spec.coarse * spec.step
    kept = divide(longest, lambda _: spec.step)
    along = np.concatenate([kept[:-1], longest + divide(end - longest, lambda _: wide)])
    # across the bisector sizes grow likewise, until the angle that they span far away is the limit
    width = radius * arc
    across = divide(
        1.0,
        lambda q: min(spec.step * (q + eta_0 / width), wide / (arc + math.pi * q)),
    )
    if fine:
        kept, along, across = halved(kept), halved(along), halved(across)

    def place(q, x):
        r = radius + eta_0 * np.expm1(x)
        angle = arc * q + np.arccos(radius / r) * q**2
        return r * np.sin(angle), r * np.cos(angle) - radius

    body = HalfBody(across, along, place, lambda _, x, __: x > along[-1] - 1e-9)
    return body, eta_0 * np.expm1(kept)
