"""Which nodal data of a file are the displacements: by the names that programs give them, or by the user's word.

Programs write them as vectors, or as a scalar for each direction. Where several data fit that are not the same, nobody
is guessed to be the right one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

#: what programs call displacements, in lower case, with a space for each run of spaces, lines and points
NAMES = (
    "displacement",
    "displacements",
    "disp",
    "u",
    "displ",
    "uh",
    "u h",
    "deformation",
    "displacement vector",
    "displacement vectors",
    "displacement field",
    "nodal displacement",
    "nodal displacements",
    "spatial displacement",
    "displacement 1",  # Elmer, of the first of several solvers
    "depl",
    "deplacement",
)

#: Code_Aster: the result's name, filled up with lines to eight letters, and what it is; ParaView adds a word
_ASTER = re.compile(r".*depl( vector)?")

#: what tells a direction, at the end of a name or before it
_DIRECTION = re.compile(
    r"(?P<stem>.*?)[ ,]*(?P<end>[xyz]|[0-3])([ -]component)?|(?P<start>[xyz])[ -](component of )?(?P<rest>.*)"
)

#: directions in three ways of counting; what begins with 0 has a 1 and a 2 as well
_AXES = ("xyz", "012", "123")

#: two data are the same when they differ by less than this share of their largest value: single precision; round-off
SAME = 1e-6

#: how meshio names the steps of a MED file: "name[0] - time"
_STEP_NAME = re.compile(r"(?P<name>.*?)(\[(?P<number>\d+)\] - .*)?", re.DOTALL)


class Displacements(NamedTuple):
    """Data that are displacements: what they are called, and values (n, 2 or 3) by the number of the step."""

    name: str
    steps: Mapping[int, np.ndarray]


def name_and_step(key: str) -> tuple[str, int]:
    """The name of data without its step, and the number of the step, -1 if it has none."""
    match = _STEP_NAME.fullmatch(key)
    assert match is not None  # the pattern takes any text
    return match["name"].strip(), int(match["number"] or -1)


def find_displacements(
    data: Mapping[str, np.ndarray],
    components: Mapping[str, Sequence[str]] | None = None,
    field: str | None = None,
) -> Displacements:
    """The displacements among nodal data.

    Parameters
    ----------
    data : mapping of str to ndarray (n,) or (n, c)
        By name; with the step in the name as meshio has it.
    components : mapping of str to sequence of str, optional
        What the file calls the components, where it does.
    field : str, optional
        Which data they are: the name of a vector, or what the names of scalars for each direction have in common.

    Raises
    ------
    ValueError
        When no data fit, several do that are not the same, or they have another number of components.

    Examples
    --------
    >>> data = {"T": np.ones(2), "disp_x": np.array([0.0, 1.0]), "disp_y": np.array([0.0, 2.0])}
    >>> found = find_displacements(data)
    >>> found.name, found.steps[-1].tolist()
    ('disp_x, disp_y', [[0.0, 0.0], [1.0, 2.0]])
    """
    by_name: dict[str, dict[int, str]] = {}
    for key in data:
        name, step = name_and_step(key)
        by_name.setdefault(name, {})[step] = key
    candidates = _vectors(data, by_name, components or {}) | _scalars(data, by_name)
    if field is None:
        fitting = {name: own for name, own in candidates.items() if _is_displacement(own.stem)}
    else:
        fitting = {name: own for name, own in candidates.items() if name == field}
        fitting = fitting or {name: own for name, own in candidates.items() if own.stem == _plain(field)}
    if not fitting:
        if field is None:
            wanted = f"nodal data must have one of the names {', '.join(NAMES[:4])} and the like, or be named (--field)"
        else:
            wanted = f"field = {field[:60]!r}: must be one of the nodal data"
        raise ValueError(f"holds no displacements: {wanted}; there are {_listed(by_name)}")
    right = {name: own for name, own in fitting.items() if own.components in (2, 3)}
    if not right:
        name, own = next(iter(fitting.items()))
        raise ValueError(
            f"the displacements {name!r} have {own.components} components: 2 or 3 components are needed"
        )
    first = next(iter(right))
    if differing := [name for name in [*right][1:] if not _same(right[first].steps, right[name].steps)]:
        raise ValueError(
            f"several nodal data may be the displacements: {_listed([first, *differing])}; name the right one (--field)"
        )
    return Displacements(first, right[first].steps)


class _Candidate(NamedTuple):
    stem: str
    components: int
    steps: dict[int, np.ndarray]


def _vectors(
    data: Mapping[str, np.ndarray],
    by_name: Mapping[str, Mapping[int, str]],
    components: Mapping[str, Sequence[str]],
) -> dict[str, _Candidate]:
    """All data as they are; of displacements with rotations the displacements."""
    found = {}
    for name, keys in by_name.items():
        called = [_plain(word) for word in components.get(name, ())]
        axes = [axis for axis in ("dx", "dy", "dz") if axis in called]
        steps = {}
        for step, key in keys.items():
            values = data[key]
            if values.ndim == 2 and values.shape[1] == len(called) > 3 and axes[:2] == ["dx", "dy"]:
                values = values[:, [called.index(axis) for axis in axes]]
            steps[step] = values
        shapes = {values.shape[1:] for values in steps.values()}
        (shape, *others) = shapes
        width = shape[0] if len(shape) == 1 and not others else 1 if not shape else 0
        found[name] = _Candidate(_plain(name), width, steps)
    return found


def _scalars(
    data: Mapping[str, np.ndarray], by_name: Mapping[str, Mapping[int, str]]
) -> dict[str, _Candidate]:
    """Vectors of scalars whose names differ by the direction."""
    groups: dict[str, dict[str, str]] = {}
    for name, keys in by_name.items():
        match = _DIRECTION.fullmatch(_plain(name))
        if match and all(data[key].size == len(data[key]) for key in keys.values()):
            stem = match["stem"] if match["end"] else match["rest"]
            groups.setdefault(stem, {})[match["end"] or match["start"]] = name
    found = {}
    for stem, names in groups.items():
        axes = next((axes for axes in _AXES if axes[0] in names and axes[1] in names), None)
        if axis_names := [names[axis] for axis in axes or "" if axis in names]:
            of_axes = [by_name[name] for name in axis_names]
            steps = {
                step: np.column_stack([data[own[step]].reshape(-1) for own in of_axes])
                for step in of_axes[0]
                if all(step in own for own in of_axes)
            }
            if steps:
                found[", ".join(axis_names)] = _Candidate(stem, len(axis_names), steps)
    return found


def _plain(name: str) -> str:
    """A name in lower case, with a space for each run of spaces, lines and points."""
    return re.sub(r"[\s_.:]+", " ", name.lower()).strip()


def _is_displacement(stem: str) -> bool:
    return stem in NAMES or _ASTER.fullmatch(stem) is not None


def _same(one: Mapping[int, np.ndarray], other: Mapping[int, np.ndarray]) -> bool:
    """Whether two data are the same displacements; of three components and two, the two."""
    if one.keys() != other.keys():
        return False
    for step, values in one.items():
        d = min(values.shape[1], other[step].shape[1])
        a, b = values[:, :d], other[step][:, :d]
        known = np.isfinite(a) & np.isfinite(b)
        if (np.isfinite(a) != np.isfinite(b)).any():
            return False
        if np.abs(a - b)[known].max(initial=0.0) > SAME * np.abs(a)[known].max(initial=0.0):
            return False
    return True


def _listed(names: Iterable[str]) -> str:
    """At most twenty of the names."""
    names = [name[:60] for name in names]
    more = f" and {len(names) - 20} more" if len(names) > 20 else ""
    return (", ".join(names[:20]) or "none") + more
