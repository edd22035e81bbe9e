"""Many scenes of one part: keys of the load and the material with the values that they take, and all combinations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from slmm.mechanics.material import MATERIALS
from slmm.scene.scene import Scene

#: combinations at most; chosen
MOST = 100_000
GRAMMAR = "give numbers with commas, or start:stop:count, or start:stop:count:log"

#: of the material; the unit in which each is read
MATERIAL = {"E": "MPa", "nu": "1", "sigma_c": "MPa", "K_Ic": "MPa sqrt(m)", "G_c": "N/mm"}
#: of [load] and of [[boundary]]: what is given, and what acts
GIVEN = {"strain": "1", "displacement": "mm", "rotation": "degrees"}
ACTING = {
    **{"stress": "MPa", "traction": "MPa", "pressure": "MPa"},
    **{"force": "N", "pin": "N", "moment": "N mm"},
}

Value = float | str
Values = str | float | Iterable[Value]


class Axis(NamedTuple):
    """A key and the values that it takes.

    Attributes
    ----------
    key : str
    values : tuple of float or of str
    units, long_name : str
    of : str
        The key without a component's number.
    component : int, optional
        Which number of a list; by default its size.
    """

    key: str
    values: tuple[Value, ...]
    units: str
    long_name: str
    of: str
    component: int | None = None


def parsed(text: str) -> tuple[str, tuple[Value, ...]]:
    """A key and its values from ``KEY=VALUES``.

    Raises
    ------
    ValueError
        When that is not its form.

    Examples
    --------
    >>> parsed("load.strain=0.001:0.003:3")
    ('load.strain', (0.001, 0.002, 0.003))
    >>> parsed("material.sigma_c=1:100:3:log,7")
    ('material.sigma_c', (1.0, 10.0, 100.0, 7.0))
    """
    key, equals, values = text.partition("=")
    if not equals or not key.strip():
        raise ValueError(
            f"{text!r}: give KEY=VALUES, as load.strain=0.001:0.01:10 or material.sigma_c=50,60,70"
        )
    return key.strip(), values_of(key.strip(), values)


def values_of(key: str, values: Values) -> tuple[Value, ...]:
    """The values of a key, each once.

    Raises
    ------
    ValueError
        When there is none, one is no number, or one comes twice.
    """
    if isinstance(values, str):
        found: list[Value] = [value for item in values.split(",") for value in _item(key, item.strip())]
    elif isinstance(values, int | float):
        found = [float(values)]
    else:
        found = [value if isinstance(value, str) else float(value) for value in values]
    if not found:
        raise ValueError(f"{key}: has no values; {GRAMMAR}")
    for value in found:
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError(f"{key} = {value}: must be a finite number")
        if isinstance(value, str) != (key == "material.name"):
            raise ValueError(f"{key} = {value!r}: {'must be a name' if key == 'material.name' else GRAMMAR}")
    twice = [value for k, value in enumerate(found) if value in found[:k]]
    if twice:
        raise ValueError(f"{key} = {twice[0]}: comes twice")
    return tuple(found)


def _item(key: str, item: str) -> list[Value]:
    """What stands between two commas: a number, a range, or the name of a material."""
    if key == "material.name":
        return [item]
    parts = [part.strip() for part in item.split(":")]
    try:
        numbers = [float(part) for part in parts[:2]]
        if len(parts) == 1:
            return [numbers[0]]
        count = int(parts[2])
        if len(parts) > 4 or (len(parts) == 4 and parts[3] != "log"):
            raise ValueError
    except (ValueError, IndexError):
        raise ValueError(f"{key} = {item!r}: is no value; {GRAMMAR}") from None
    start, stop = numbers
    if count < 1 or (count == 1) != (start == stop):
        raise ValueError(
            f"{key} = {item}: a range of {count} values; its count must be at least 2, and both ends differ"
        )
    if len(parts) == 4 and not (start > 0 and stop > 0):
        raise ValueError(f"{key} = {item}: a range by factors needs two ends above 0")
    if count > MOST:
        raise ValueError(f"{key} = {item}: has {count} values; at most {MOST} are computed at once")
    spread = np.geomspace if len(parts) == 4 else np.linspace
    return [float(f"{value:.15g}") for value in spread(start, stop, count).tolist()]


class Variants(NamedTuple):
    """All combinations of some axes.

    Attributes
    ----------
    axes : tuple of Axis
    loaded : list of Scene
        With each combination of the loads' values, the scene's own material.
    made_of : list of Scene
        With each combination of the materials' values, the scene's own load.
    load, material : ndarray (n,) of int
        Of each variant, the last axis fastest, its number in these.
    """

    axes: tuple[Axis, ...]
    loaded: list[Scene]
    made_of: list[Scene]
    load: np.ndarray
    material: np.ndarray

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values."""
        return tuple(len(axis.values) for axis in self.axes)


def variants_of(scene: Scene, vary: Mapping[str, Values]) -> Variants:
    """The combinations of what keys of a scene take.

    Parameters
    ----------
    scene : Scene
    vary : mapping of str to values
        Keys are ``material.`` and one of name, E, nu, sigma_c, K_Ic, G_c; ``load.`` and its kind; ``boundary.``, the
        number of the condition, and what it gives. Of a list of numbers, as a strain or a force, the component of
        largest amount takes the value, and the others follow in proportion; one of them alone is ``load.strain.1``.

    Raises
    ------
    ValueError
        When a key is none of the scene's, keys contradict each other, or values are none that the scene may have.

    Examples
    --------
    >>> from slmm.scene.gallery import circular_hole
    >>> found = variants_of(circular_hole(), {"load.strain": [0.01, 0.02], "material.sigma_c": "60:80:3"})
    >>> found.shape, found.loaded[1].load.strain, found.made_of[2].material.sigma_c
    ((2, 3), (0.0, 0.02, 0.0), 80.0)
    """
    if not vary:
        raise ValueError("vary: names no key; give one, as load.strain or material.sigma_c")
    axes = tuple(_axis(scene, key, values_of(key, values)) for key, values in vary.items())
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST:
        raise ValueError(f"vary: has {count} combinations; at most {MOST} are computed at once")
    _contradictions([axis.key for axis in axes])
    of_material = [axis.key.startswith("material.") for axis in axes]
    grid = np.indices([len(axis.values) for axis in axes]).reshape(len(axes), -1)

    def numbers(wanted: bool) -> np.ndarray:
        chosen = [k for k, it_is in enumerate(of_material) if it_is == wanted]
        shape = tuple(len(axes[k].values) for k in chosen)
        return np.ravel_multi_index(tuple(grid[chosen]), shape) if chosen else np.zeros(count, dtype=int)

    loads = [axis for axis in axes if not axis.key.startswith("material.")]
    materials = [axis for axis in axes if axis.key.startswith("material.")]
    return Variants(
        axes,
        [_loaded(scene, loads, values) for values in product(*(axis.values for axis in loads))],
        [_made_of(scene, materials, values) for values in product(*(axis.values for axis in materials))],
        numbers(False),
        numbers(True),
    )


def load_numbers(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """All numbers of a scene's load: what is given (displacements, strains, rotations), and what acts."""
    tables = [scene.load] if scene.load is not None else list(scene.boundary)
    given, acting = (
        [
            0.0 if value == "free" else float(value)
            for table in tables
            for name in names
            for value in np.ravel(np.array(getattr(table, name, None) or 0.0, dtype=object)).tolist()
        ]
        for names in (GIVEN, ACTING)
    )
    return np.array(given), np.array(acting)


def _axis(scene: Scene, key: str, values: tuple[Value, ...]) -> Axis:
    """A key of the scene with its unit and meaning."""
    table, *rest = key.split(".")
    if table == "material" and len(rest) == 1 and rest[0] in ("name", *MATERIAL):
        return Axis(key, values, MATERIAL.get(rest[0], "1"), f"{rest[0]} of the material", key)
    of_load = _load_keys(scene)
    component = (
        rest[-1] if rest and rest[-1].isdigit() and len(rest) > (2 if table == "boundary" else 1) else ""
    )
    base = key.removesuffix(f".{component}") if component else key
    if base not in of_load:
        known = [*(f"material.{name}" for name in ("name", *MATERIAL)), *of_load]
        raise ValueError(f"{key}: is no key of this scene that can be varied; it has {', '.join(known)}")
    value = of_load[base]
    name = base.rsplit(".", 1)[1]
    units = (GIVEN | ACTING)[name]
    if not isinstance(value, tuple):
        if component:
            raise ValueError(f"{key}: {base} is one number; leave .{component} away")
        return Axis(key, values, units, base, base)
    if component:
        if int(component) >= len(value):
            raise ValueError(f"{key}: {base} has {len(value)} components, from 0 to {len(value) - 1}")
        if value[int(component)] == "free":
            raise ValueError(f'{key}: {base} is "free" that way, and no displacement is given')
        return Axis(key, values, units, f"component {component} of {base}", base, int(component))
    if not any(number not in (0.0, "free") for number in value):
        raise ValueError(f"{key}: is zero, without a direction; name a component, as {base}.0")
    return Axis(key, values, units, f"component of largest amount of {base}, the others in proportion", base)


def _load_keys(scene: Scene) -> dict[str, Any]:
    """The keys of the load that the scene has, and what stands there."""
    tables: list[tuple[str, Any]] = [(f"boundary.{i}", table) for i, table in enumerate(scene.boundary)]
    if scene.load is not None:
        tables.append(("load", scene.load))
    return {
        f"{at}.{name}": getattr(table, name)
        for at, table in tables
        for name in (*GIVEN, *ACTING)
        if getattr(table, name, None) is not None
    }


def _contradictions(keys: Sequence[str]) -> None:
    """Refuse keys that say the same, or the contrary."""
    for key in keys:
        for other in keys:
            if other.startswith(f"{key}."):
                raise ValueError(f"{other}: contradicts {key}, which is all of it; vary one of them")
    if {"material.K_Ic", "material.G_c"} <= set(keys):
        raise ValueError("material.G_c: contradicts material.K_Ic; vary one of them")
    constants = [key for key in keys if key.startswith("material.") and key != "material.name"]
    if "material.name" in keys and constants:
        raise ValueError(f"{constants[0]}: contradicts material.name, which has its own; vary one of them")


def _made_of(scene: Scene, axes: Sequence[Axis], values: Sequence[Value]) -> Scene:
    """The scene of another material: constants that are not named stay, of a named one, too."""
    changes: dict[str, Value] = {
        axis.key.split(".")[1]: value for axis, value in zip(axes, values, strict=True)
    }
    if not changes:
        return scene
    if "name" in changes:
        if changes["name"] not in MATERIALS:
            raise ValueError(f"material.name = {changes['name']!r}: known are {', '.join(MATERIALS)}")
        return scene.with_(material=changes)
    table, material = scene.material_table, scene.material
    constants: dict[str, Value] = {"E": material.E, "nu": material.nu, "sigma_c": material.sigma_c}
    if table.G_c is not None:
        constants["G_c"] = table.G_c
    else:
        constants["K_Ic"] = table.K_Ic if table.K_Ic is not None else material.K_Ic / math.sqrt(1000.0)
    if {"K_Ic", "G_c"} & set(changes):
        constants = {name: constants[name] for name in ("E", "nu", "sigma_c")}
    return scene.with_(material=constants | changes)


def _loaded(scene: Scene, axes: Sequence[Axis], values: Sequence[Value]) -> Scene:
    """The scene under another load."""
    if not axes:
        return scene
    load: dict[str, Any] = {}
    boundary = [table.model_dump(by_alias=True, exclude_unset=True) for table in scene.boundary]
    for axis, value in zip(axes, values, strict=True):
        *at, name = axis.of.split(".")
        target, source = (
            (load, scene.load) if at == ["load"] else (boundary[int(at[1])], scene.boundary[int(at[1])])
        )
        target[name] = _changed(target.get(name, getattr(source, name)), axis.component, float(value))
    return scene.with_(load=load) if load else scene.with_(boundary=boundary)


def _changed(old: Any, component: int | None, value: float) -> Any:
    """A number, or a list of numbers with another component or size."""
    if not isinstance(old, list | tuple):
        return value
    if component is not None:
        return [value if k == component else number for k, number in enumerate(old)]
    size = max((number for number in old if number != "free"), key=abs)
    return [number if number == "free" else value * (number / size) for number in old]
