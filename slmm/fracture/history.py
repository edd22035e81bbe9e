"""What a simulation has come to: its steps, the curve F(u), the tensile toughness and the energies."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.events import Event, Kind

Array = NDArray[np.float64]

#: by which share a stiffness may be in error that bounds those after it; chosen, ten times the 1e-4 of the engines
STIFFNESS_COVERS = 1e-3


class Outcome(StrEnum):
    """How a simulation ended."""

    SEVERED = "the part is severed"
    LARGEST = "the largest displacement is reached"
    NO_EVENT = "no crack can grow or start"
    SHORT = "the tensile toughness asked for can no longer be reached"
    STEPS = "the largest number of steps is reached"
    FAILED = "failed"


#: of a simulation that has come as far as was asked: what it says of U_T is all of it
WHOLE = (Outcome.SEVERED, Outcome.LARGEST)


class Candidate(NamedTuple):
    """What could have happened in a step: a tip that grows, or a surface that cracks.

    Attributes
    ----------
    u_c : float
        Its critical displacement, mm.
    kind : Kind
    crack : int
        Whose tip it is, -1 of a surface.
    hole : int
        Whose surface it is, -1 of a straight outer edge, and of tips.
    x, y : float
        Where, mm.
    """

    u_c: float
    kind: Kind
    crack: int
    hole: int
    x: float
    y: float


class Excluded(NamedTuple):
    """A surface that would have cracked before the event of a step, and is not let.

    Attributes
    ----------
    u_c : float
        Its critical displacement, mm.
    x, y : float
        Where, mm.
    reason : str
        Why it does not crack.
    """

    u_c: float
    x: float
    y: float
    reason: str


@dataclass(frozen=True)
class Step:
    """One event.

    Attributes
    ----------
    u_c : float
        Displacement at which it happens, mm.
    stiffness : float
        Before it, N/mm.
    event : Event
    crack : int
        Which crack.
    end : (float, float)
        Where its tip stands after it, mm.
    arrested_by : str
        What it ran into; empty while it has a tip.
    length : float
        By which it became longer, mm.
    gap : float
        By which share the next event's load was higher; NaN where there was none.
    closed : float
        Length of cracks whose faces held each other, mm.
    candidates : tuple of Candidate
        All that was in question, the event among it.
    finer : (float, float)
        Stiffness, N/mm, and critical displacement, mm, of a finer model; NaN where it was not asked.
    excluded : tuple of Excluded
        What was critical before, and is not let happen.
    """

    u_c: float
    stiffness: float
    event: Event
    crack: int
    end: tuple[float, float]
    arrested_by: str
    length: float
    gap: float
    closed: float
    candidates: tuple[Candidate, ...]
    finer: tuple[float, float] = (math.nan, math.nan)
    excluded: tuple[Excluded, ...] = ()

    @property
    def kind(self) -> Kind:
        """What it is."""
        return self.event.kind

    @property
    def K(self) -> tuple[float, float]:
        """K_I and K_II at the critical load, MPa sqrt(mm); NaN of a start."""
        K_I, K_II = self.event.K
        return self.event.load * K_I, self.event.load * K_II

    @property
    def T(self) -> float:
        """Stress along the crack at the critical load, MPa; NaN of a start and where no criterion asks for it."""
        return self.event.load * self.event.T


@dataclass
class History:
    """Steps of a simulation, in their order.

    Parameters
    ----------
    steps : list of Step
    outcome : Outcome
    reason : str
        What failed, or is not let happen.
    last_stiffness : float
        After the last step, N/mm; 0 of a severed part.
    last_u : float
        Displacement to which the part was loaded after the last step, mm; 0 if not at all.
    next_u : float
        Critical displacement of the event that this came before, mm; NaN without one.
    """

    steps: list[Step] = field(default_factory=list)
    outcome: Outcome = Outcome.STEPS
    reason: str = ""
    last_stiffness: float = 0.0
    last_u: float = 0.0
    next_u: float = math.nan

    @property
    def u(self) -> float:
        """Displacement so far, mm: it never falls."""
        return max((step.u_c for step in self.steps), default=0.0)

    @property
    def loads(self) -> Array:
        """Displacement (n,) at which each step happens, mm: the largest critical one so far."""
        return np.maximum.accumulate([step.u_c for step in self.steps]) if self.steps else np.empty(0)

    @property
    def stiffnesses(self) -> Array:
        """Stiffness (n + 1,) before each step and after the last one, N/mm."""
        return np.array([*(step.stiffness for step in self.steps), self.last_stiffness])

    @property
    def corners(self) -> tuple[Array, Array]:
        """Displacements and forces at the corner points of F(u), mm and N: the force drops at constant displacement."""
        S, points = self.stiffnesses, [(0.0, 0.0)]
        for k, u in enumerate(self.loads.tolist()):
            if u > points[-1][0]:
                points.append((u, S[k] * u))
            points.append((u, S[k + 1] * u))
        if self.last_u > points[-1][0]:
            points.append((self.last_u, self.last_stiffness * self.last_u))
        # of drops at one displacement the first and the last point count
        kept = [
            point
            for k, point in enumerate(points)
            if k in (0, len(points) - 1) or not points[k - 1][0] == point[0] == points[k + 1][0]
        ]
        u, F = np.array(kept).T
        return u, F

    @property
    def toughness(self) -> float:
        """U_T, mJ: the sum of S (u_k^2 - u_(k-1)^2)/2, the area below F(u)."""
        return _toughness(self.stiffnesses, self.loads, self.last_u)

    def toughness_at_most(self, largest: float) -> float:
        """What U_T can still become until a displacement is reached, mJ, where the last stiffness is that of the part.

        Of all displacements that a part's supports allow, the true ones have the least energy, S u^2/2. A longer crack
        allows more of them, also where its faces hold each other: no crack makes the part stiffer, and the area below
        F(u) that is left is at most that of the line of the present stiffness.
        """
        left = 0.5 * self.last_stiffness * max(largest**2 - self.u**2, 0.0)
        return self.toughness + (1 + STIFFNESS_COVERS) * left

    @property
    def released(self) -> Array:
        """Stored energy (n,) that is set free by each step at constant displacement, mJ."""
        S = self.stiffnesses
        return np.asarray(0.5 * (S[:-1] - S[1:]) * self.loads**2)

    @property
    def stored(self) -> float:
        """Energy that is still stored at the end, mJ."""
        u = max(self.last_u, float(self.loads[-1]) if self.steps else 0.0)
        return 0.5 * self.last_stiffness * u**2

    @property
    def discretisation_error(self) -> float:
        """By how much U_T changes with what finer models gave, where they were asked, mJ."""
        steps = [step for step in self.steps if math.isfinite(step.finer[0])]
        if not steps:
            return math.nan if self.steps else 0.0
        S, u = self.stiffnesses, np.array([step.u_c for step in self.steps])
        for k, step in enumerate(self.steps):
            if math.isfinite(step.finer[0]):
                S[k], u[k] = step.finer
        return abs(_toughness(S, np.maximum.accumulate(u), self.last_u) - self.toughness)


def _toughness(S: Array, u: Array, last_u: float) -> float:
    before = np.concatenate([[0.0], u[:-1]])
    total = float(np.sum(S[:-1] * (u**2 - before**2)) / 2) if len(u) else 0.0
    highest = float(u[-1]) if len(u) else 0.0
    return total + (0.5 * float(S[-1]) * (last_u**2 - highest**2) if last_u > highest else 0.0)
