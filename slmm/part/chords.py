"""Straight pieces that stand for an outline in the plane geometry: crossings, gaps, what lies inside."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from slmm.part.outline import Outline

Array = NDArray[np.float64]

#: of an outline, at least; chosen
CHORDS = 2000
#: they are this far off it at most, as a share of its length; of a circle it is a fifth of that; chosen
OFF = 1e-6


#: of outlines that were asked before: a part, its mesh and its surroundings all want them
_known: WeakKeyDictionary[Outline, Array] = WeakKeyDictionary()


def chords(outline: Outline) -> Array:
    """Points (n, 2) round an outline, its `Outline.polygon` and half way between where that would be too far off it.

    Examples
    --------
    A small bend of a long outline has as many as it needs.

    >>> from slmm.part.shapes import circle
    >>> len(chords(Outline.through(circle((0, 0), 8.0))))
    2000
    >>> wave = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    >>> points = (40 + 0.2 * np.cos(200 * wave))[:, None] * np.column_stack([np.cos(wave), np.sin(wave)])
    >>> len(chords(Outline.through(points))) > 4000
    True
    """
    if outline not in _known:
        _known[outline] = _found(outline)
    return _known[outline]


def _found(outline: Outline) -> Array:
    """The points, which nobody changes."""
    most = OFF * outline.length
    s = outline.arc_lengths(CHORDS)
    step = np.diff(s, append=s[0] + outline.length)
    # second derivatives are linear between breaks: the largest bounds them all
    bends = 2.0 * np.hypot(*outline.coefficients[1].T)
    first = outline.coefficients[0], np.diff(outline.breaks)[:, None]
    ends = np.hypot(*(6.0 * first[0] * first[1] + 2.0 * outline.coefficients[1]).T)
    if step.max() ** 2 / 8 * max(bends.max(), ends.max()) > most:
        while (far := step**2 / 8 * _bend(outline, s, step) > most).any():
            s = np.sort(np.concatenate([s, (s + 0.5 * step)[far]]))
            step = np.diff(s, append=s[0] + outline.length)
    points = outline.points(s)
    points.setflags(write=False)
    return points


def _bend(outline: Outline, s: Array, step: Array) -> Array:
    """The largest curvature (n,) at three places of each step, 1/mm."""
    return np.abs([outline.curvatures(s + share * step) for share in (0.01, 0.5, 0.99)]).max(axis=0)
