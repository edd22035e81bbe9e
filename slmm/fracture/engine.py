"""What solves a part for the simulator: boundary integrals or finite elements, and what both have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.model import BoundaryModel
from slmm.criteria.griffith import energy_release_rate
from slmm.fracture.directions import Direction
from slmm.fracture.events import COMPETING, TIED, Event, growths
from slmm.mechanics.material import Material
from slmm.part.part import Part

Array = NDArray[np.float64]


class Rules(NamedTuple):
    """What decides on events.

    Attributes
    ----------
    direction : Direction
        Which way tips run on.
    initiation : callable
        The cracks that may start, given a model by boundary integrals and the load above which they are of no interest.
    """

    direction: Direction
    initiation: Callable[[BoundaryModel, float], list[Event]]


class State(Protocol):
    """A part with its cracks under the scene's own load."""

    @property
    def work(self) -> float:
        """Twice the stored energy, N mm for each mm of thickness."""
        ...

    @property
    def closed(self) -> float:
        """Length of cracks whose faces hold each other, mm."""
        ...

    def events(self, rules: Rules) -> list[Event]:
        """What may happen next, where it competes with the lowest load."""
        ...

    def finer(self, event: Event) -> tuple[float, float]:
        """Work and the load of an event by a finer model, for estimates of errors."""
        ...


class Engine(Protocol):
    """Solves one part after the other, each with other cracks than the one before.

    Attributes
    ----------
    keeps : bool
        Whether it keeps something from one solution for the next, which then depends on it in its last digits.
    """

    keeps: bool

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        ...

    def solve(self, part: Part) -> State:
        """The part with its cracks."""
        ...


def growth_load(K: Array, material: Material) -> float:
    """Load, over the scene's own, at which a tip with K_I and K_II (2,) grows by Griffith's criterion."""
    K_I, K_II = K.tolist()
    return float(np.sqrt(material.G_c / energy_release_rate(K_I, K_II, material)))


def competing_events(
    part: Part,
    K: Array,
    T: Array,
    closed: Array,
    first_cracks: Callable[[float], list[Event]],
    material: Material,
    direction: Direction,
) -> list[Event]:
    """Tips that grow and surfaces that crack, those of them that compete with the lowest load.

    Starts that are excluded are told where they would come before all that may happen.

    Parameters
    ----------
    part : Part
    K : ndarray, shape (k, 2)
        K_I and K_II of its tips, MPa sqrt(mm).
    T : ndarray, shape (k,)
        Stress along the crack at its tips, MPa; NaN where the direction does not ask for it.
    closed : ndarray, shape (k,)
        Stress intensities up to which there are none, for all that the model resolves.
    first_cracks : callable
        Cracks that may start, given the load above which they are of no interest.
    material : Material
    direction : Direction
        Which way tips run on.
    """
    # a closed tip has no mode I, and its faces slide
    moved = np.where(np.abs(K) > closed[:, None], K, 0.0)
    moved[:, 0] = np.maximum(moved[:, 0], 0.0)
    tips = growths(part.tips, moved, T, material, direction)
    lowest = min((event.load for event in tips), default=np.inf)
    found = tips + first_cracks(lowest * (1 + COMPETING))
    lowest = min((event.load for event in found if not event.excluded), default=np.inf)
    return [event for event in found if not event.excluded or event.load * (1 + TIED) < lowest]


def unloaded(part: Part, stress: float, share: float) -> Array:
    """K (k,) of tips that a share of a stress along surfaces, MPa, would cause: K that is none."""
    sizes = [np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in part.tips]
    return np.asarray(share * stress * np.sqrt(np.pi * np.array(sizes)))
