"""Trial cracks turned away from the normal, into the direction that needs the least load."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slmm.criteria.status import Status
from slmm.initiation.paths import IN_IRWIN_LENGTHS, IN_LIGAMENT, Paths, ligaments
from slmm.initiation.task import Answer, Task

#: directions that are tried, rad from the usual one, to both sides (chosen)
MOST, STEP = np.radians(60.0), np.radians(15.0)


def turned(task: Task, angle: np.ndarray) -> Task:
    """The same with paths turned counter-clockwise by angles (n,), rad.

    Parameters
    ----------
    task : Task
    angle : ndarray, shape (n,)
    """
    paths = task.paths
    c, s = np.cos(angle), np.sin(angle)
    x, y = paths.direction.T
    direction = np.column_stack([c * x - s * y, s * x + c * y])
    ligament = ligaments(task.scene, paths.start, direction)
    longest = np.minimum(IN_IRWIN_LENGTHS * task.scene.material.irwin_length, IN_LIGAMENT * ligament)
    return task.with_paths(Paths(paths.start, direction, ligament, longest))


def in_best_direction(method: Callable[[Task], Answer]) -> Callable[[Task], Answer]:
    """A method that answers for the direction with the largest failure index; the column ``turned`` has it, degrees.

    Some directions are tried; a parabola through the best one and its neighbours says where to look once more, and a
    quarter of what that brings is added to the error: the parabola is good to the second order.
    """

    def answer(task: Task) -> Answer:
        angles = np.arange(-MOST, MOST + 0.5 * STEP, STEP)
        tried = [method(turned(task, np.full(task.n, angle))) for angle in angles]
        index = np.array([_index(found) for found in tried])
        best = index.argmax(axis=0)
        result = tried[len(angles) // 2]
        for k, found in enumerate(tried):
            rows = np.flatnonzero(best == k)
            result.take(rows, found.rows(rows))
        top = angles[best]
        result.column("turned")[:] = np.degrees(top)
        inner = np.clip(best, 1, len(angles) - 2)
        low, middle, high = (index[inner + side, np.arange(task.n)] for side in (-1, 0, 1))
        bend = low - 2 * middle + high
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.where(bend < 0, 0.5 * (low - high) / bend, np.nan)
        rows = np.flatnonzero(np.isfinite(off) & (index.max(axis=0) > 0))
        if not len(rows):
            return result
        angle = np.clip(angles[inner[rows]] + STEP * off[rows], -MOST, MOST)
        among = task.among(rows)
        found = method(turned(among, angle))
        found.column("turned")[:] = np.degrees(angle)
        gain = _index(found) - index.max(axis=0)[rows]
        better = np.flatnonzero(gain > 0)
        found.error[better] += 0.25 * gain[better] / _index(found)[better]
        result.take(rows[better], found.rows(better))
        return result

    return answer


def _index(answer: Answer) -> np.ndarray:
    """Failure indices (n,); below all where there is none."""
    with np.errstate(divide="ignore"):
        return np.where(answer.status == Status.OK, 1 / answer.load_factor, -1.0)
