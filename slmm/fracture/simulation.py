"""The fracture process of a part: cracks start, grow, are arrested and start anew until it is severed (Paper D)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.fracture.events import Event, Kind, next_event
from slmm.fracture.fracture_result import fracture_result
from slmm.fracture.growth import LOOK_AHEAD, Increment, Surroundings
from slmm.fracture.history import History, Outcome, Step
from slmm.fracture.work_conjugate import work_conjugate
from slmm.part.crack import TIP, End
from slmm.part.part import Part
from slmm.running.blas import one_blas_thread
from slmm.running.progress import Progress, silent
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: increments of "auto" over the shorter side of the part: 2 mm of 80 mm; published (Paper D, section 3.1)
PER_SIDE = 0.025
#: cracks together are so many times as long as the part's shorter side, at most; chosen: with holes it is one or two
MOST_CROSSINGS = 10
#: places along a straight stretch that tell which pieces it holds or loads; chosen
MIDDLES = (np.arange(20) + 0.5) / 20
ENGINES, INITIATIONS = ("boundary",), ("point",)


@dataclass(frozen=True)
class Lengths:
    """Of increments, mm: while cracks grow, at their start, and how far ahead they look.

    Parameters
    ----------
    growth, first, ahead : float
    """

    growth: float
    first: float
    ahead: float


def simulate(
    scene: Scene,
    increment: float | str = "auto",
    initiation: str = "point",
    engine: str = "boundary",
    tolerance: float = 0.01,
    *,
    first_length: float | None = None,
    largest_displacement: float | None = None,
    errors: bool = True,
    progress: Progress = silent,
) -> xr.Dataset:
    """Fracture of a part under a load that grows until it breaks: cracks, the curve F(u), and the tensile toughness.

    One event after the other: the tip or the free surface with the lowest critical load. Tips grow where G reaches G_c,
    in the direction of the largest tangential stress; cracks start where the principal stress reaches the strength at
    the point method's distance below a surface. Cracks end on what they run into, and are arrested there. The force
    drops at constant displacement, and the displacement never falls (Paper D, section 2.2.3).

    Parameters
    ----------
    scene : Scene
        Its load counts as a unit.
    increment : float or "auto"
        Length of an increment, mm; "auto" is 1/40 of the part's shorter side.
    initiation : {"point"}
    engine : {"boundary"}
    tolerance : float
        Relative error of U_T that the engine's own model aims at.
    first_length : float, optional
        Of a crack that starts, mm; an increment if not given.
    largest_displacement : float, optional
        Where to stop, mm.
    errors : bool
        Whether U_T has an estimated error, for some of the time of the simulation.
    progress : callable

    Returns
    -------
    Dataset
        Over ``corner``: ``u`` (mm) and ``F`` (N), corner points of the curve; over ``step``: ``u_c``, ``u_load``,
        ``stiffness`` before the step, ``event``, ``tip`` (of which crack), ``x``, ``y`` where it stands after it,
        ``arrested_by``, ``K_I``, ``K_II``, ``released``, ``dissipated``, ``gap`` and more; ``U_T``, ``U_T_error`` in
        mJ; crack paths over ``crack`` and ``point``; ``outcome`` among the attributes.

    Raises
    ------
    ValueError
        When an argument or the load does not fit. What fails later ends the simulation with its reason and the steps
        so far.

    Examples
    --------
    >>> from slmm.scene.gallery import tensile_plate
    >>> result = simulate(tensile_plate(), increment=4.0)
    >>> round(float(result.U_T)), result.attrs["outcome"]
    (107, 'the part is severed')
    """
    if initiation not in INITIATIONS:
        raise ValueError(f"initiation = {initiation!r}: must be one of {', '.join(INITIATIONS)}")
    if engine not in ENGINES:
        raise ValueError(f"engine = {engine!r}: must be one of {', '.join(ENGINES)}")
    for name, value in (("tolerance", tolerance), ("largest_displacement", largest_displacement)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: must be a positive number")
    lengths = _lengths(scene.part, increment, first_length)
    simulation = Simulation(scene, lengths, tolerance, largest_displacement or math.inf, errors)
    with one_blas_thread():
        simulation.run(progress)
    settings = {
        "increment": lengths.growth,
        "first_length": lengths.first,
        "look_ahead": lengths.ahead,
        "initiation": initiation,
        "engine": engine,
        "tolerance": tolerance,
    }
    return fracture_result(scene, simulation.part, simulation.history, settings, simulation.reached)


def _lengths(part: Part, increment: float | str, first_length: float | None) -> Lengths:
    """Increments as they were asked for."""
    side = float(np.ptp(part.outer, axis=0).min())
    if isinstance(increment, str):
        if increment != "auto":
            raise ValueError(f"increment = {increment!r}: must be a length in mm or 'auto'")
        increment = PER_SIDE * side
    first = increment if first_length is None else first_length
    for name, length in (("increment", increment), ("first_length", first)):
        if not (math.isfinite(length) and 10 * part.tolerance < length < side):
            raise ValueError(
                f"{name} = {length!r}: must lie between {10 * part.tolerance:.3g} and {side:.6g} mm, the part's side"
            )
    return Lengths(increment, first, LOOK_AHEAD * increment)


class Simulation:
    """A part on its way to fracture.

    Attributes
    ----------
    part : Part
        With its cracks as they are now.
    history : History
    reached : list of list of int
        For each crack and each of its points the step that led there; -1 of what was there before.
    """

    def __init__(
        self, scene: Scene, lengths: Lengths, tolerance: float, largest: float, errors: bool
    ) -> None:
        """Nothing happens yet."""
        self.part, self.material, self.loading = scene.part, scene.material, scene.loading
        self.conjugate = work_conjugate(self.loading, self.part.thickness)
        self.engine = BoundaryEngine(self.material, self.loading, tolerance)
        self.lengths, self.largest, self.errors = lengths, largest, errors
        self.surroundings = Surroundings(self.part)
        self.history = History()
        self.reached = [[-1] * len(crack.points) for crack in self.part.cracks]

    def run(self, progress: Progress = silent) -> None:
        """Step by step to the end; what fails ends it."""
        if self.part.is_severed:
            self.history.outcome = Outcome.SEVERED
            return
        side = float(np.ptp(self.part.outer, axis=0).min())
        for k in range(int(MOST_CROSSINGS * side / self.lengths.growth)):
            progress(
                1 - 0.97**k, f"step {k + 1}, {len(self.part.cracks)} cracks, u = {self.history.u:.3g} mm"
            )
            try:
                outcome = self._step()
            except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
                if not self.history.steps:
                    raise
                outcome, self.history.reason = Outcome.FAILED, str(error)
            if outcome is not None:
                self.history.outcome = outcome
                return

    def _step(self) -> Outcome | None:
        """Solve, find the next event, and let it happen; how it ended, if it did."""
        history = self.history
        state = self.engine.solve(self.part)
        F, u = self.conjugate.force_and_displacement(state.work * self.part.thickness)
        history.last_stiffness = F / u
        events = state.events()
        if not events:
            history.slid += state.slides_before(self.largest / u)
            return Outcome.NO_EVENT
        event, gap = next_event(events)
        history.slid += state.slides_before(min(event.load, self.largest / u))
        if event.load * u > self.largest:
            history.last_u = self.largest
            return Outcome.LARGEST
        increment = self._increment(event)
        grown, crack = self._grown(event, increment)
        finer = (math.nan, math.nan)
        if self.errors and event.load * u > history.u:
            work, load = state.finer(event)
            F_finer, u_finer = self.conjugate.force_and_displacement(work * self.part.thickness)
            finer = F_finer / u_finer, load * u_finer
        at_start = self._is_at_start(event, crack)
        last = grown.cracks[crack].start if at_start else grown.cracks[crack].end
        end = grown.cracks[crack].points[0 if at_start else -1]
        self._note(crack, at_start)
        history.steps.append(
            Step(
                event.load * u,
                F / u,
                event.kind,
                crack,
                tuple(end.tolist()),
                _name(last, grown) if increment.arrested else "",
                float(np.linalg.norm(end - event.point)),
                (event.load * event.K[0], event.load * event.K[1]),
                gap,
                state.touches,
                finer,
            )
        )
        self.part = grown
        return self._ended() if increment.arrested else None

    def _increment(self, event: Event) -> Increment:
        """Where the event's increment ends."""
        own = self._crack_of(event.tip) if event.kind is Kind.GROWTH else -1
        length = self.lengths.growth if event.kind is Kind.GROWTH else self.lengths.first
        return self.surroundings.increment(
            self.part, event.point, event.direction, length, self.lengths.ahead, own
        )

    def _grown(self, event: Event, increment: Increment) -> tuple[Part, int]:
        """The part after an event, and which crack it was."""
        if event.kind is Kind.START:
            return self.part.with_crack([event.point, increment.end]), len(self.part.cracks)
        return self.part.grown(event.tip, increment.end), self._crack_of(event.tip)

    def _note(self, crack: int, at_start: bool) -> None:
        """Remember which step led to the new points of a crack."""
        k = len(self.history.steps)
        if crack == len(self.reached):
            self.reached.append([k, k])
        else:
            self.reached[crack].insert(0 if at_start else len(self.reached[crack]), k)

    def _crack_of(self, tip: int) -> int:
        """The crack that a tip belongs to."""
        of_tips = [k for k, crack in enumerate(self.part.cracks) for _ in crack.tips]
        return of_tips[tip]

    def _is_at_start(self, event: Event, crack: int) -> bool:
        """Whether an event moves the first point of its crack."""
        if event.kind is Kind.START:
            return False
        return bool((self.part.cracks[crack].points[0] == event.point).all())

    def _ended(self) -> Outcome | None:
        """What a part is whose crack has just run into something."""
        pieces = self.part.pieces
        if len(pieces) == 1:
            return None
        near = 2 * self.part.tolerance
        carried = set()
        for condition in self.loading:
            points, traction, _ = condition.rule
            if condition.span is None:
                points = np.array(condition.start) + MIDDLES[:, None] * np.subtract(
                    condition.end, condition.start
                )
            elif not any(condition.is_held):
                points = points[np.hypot(*traction.T) > 0]
            at = shapely.points(points)
            carried |= {k for k, piece in enumerate(pieces) if shapely.dwithin(piece, at, near).any()}
        if len(carried) < 2:
            return Outcome.LOOSE
        self.history.last_stiffness = 0.0
        return Outcome.SEVERED


def _name(end: End, part: Part) -> str:
    """What a crack ends at, in words."""
    if end == TIP:
        return ""
    if end.kind == "crack":
        return f"crack {end.number}"
    return f"hole {end.number}" if 0 <= end.number < len(part.holes) else "edge"
