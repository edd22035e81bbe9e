"""The fracture process of a part: cracks start, grow, are arrested and start anew until it is severed (Paper D)."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.fracture.directions import DIRECTIONS
from slmm.fracture.engine import Engine, Rules
from slmm.fracture.events import Event, Kind, next_event
from slmm.fracture.fem_engine import FemEngine
from slmm.fracture.first_cracks import INITIATIONS, point_method
from slmm.fracture.fracture_result import fracture_result
from slmm.fracture.grown_part import GrownPart, crack_of, grown_part, is_carried
from slmm.fracture.growth import LOOK_AHEAD, Surroundings
from slmm.fracture.history import Candidate, History, Outcome, Step
from slmm.fracture.journal import end_of, history_of, record_of, run_of, step_of
from slmm.fracture.lengths import Lengths, lengths_of
from slmm.fracture.work_conjugate import work_conjugate
from slmm.mechanics.material import Material
from slmm.running.blas import one_blas_thread
from slmm.running.line_journal import LineJournal, open_lines
from slmm.running.progress import Progress, silent
from slmm.scene.loading import Loading
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: cracks together are so many times as long as the part's shorter side, at most; chosen: with holes it is one or two
MOST_CROSSINGS = 10
ENGINES: dict[str, Callable[[Material, Loading, float], Engine]] = {
    "boundary": BoundaryEngine,
    "fem": FemEngine,
}


def simulate(
    scene: Scene,
    increment: float | str = "auto",
    initiation: str = "point",
    engine: str = "boundary",
    tolerance: float = 0.01,
    *,
    direction: str = "MTS",
    first_length: float | None = None,
    largest_displacement: float | None = None,
    errors: bool = True,
    journal: str | Path | None = None,
    resume: bool = False,
    from_step: int | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Fracture of a part under a load that grows until it breaks: cracks, the curve F(u), and the tensile toughness.

    One event after the other: the tip or the free surface with the lowest critical load. Tips grow where G reaches G_c,
    in the direction that a criterion finds; cracks start where a criterion of initiation is met first: by the point
    method where the principal stress at a distance below a surface reaches the strength. Cracks end on what they run
    into, and are arrested there. The force drops at constant displacement, and the displacement never falls (Paper D,
    section 2.2.3).

    Parameters
    ----------
    scene : Scene
        Its load counts as a unit.
    increment : float or "auto"
        Length of an increment, mm; "auto" begins with 1/40 of the part's shorter side, becomes shorter where the path
        bends, and longer where it is straight, far from surfaces, and the curve falls.
    initiation : {"point", "coupled", "slmm+ac"}
        What starts cracks at surfaces: the point method, the coupled criterion by trial cracks, or the same by crack
        cells of the database where one fits, in plates under [load]. The last two know how long the crack is then.
    engine : {"boundary", "fem"}
        What solves the part: boundary integrals, or finite elements on a mesh of their own for every increment, which
        take some ten times as long and do not hold faces of cracks apart.
    tolerance : float
        Relative error of U_T that the engine's own model aims at.
    direction : {"MTS", "MERR", "local symmetry", "J"}
        Which way cracks grow: largest tangential stress, largest energy release rate, no mode II, or along the vector
        J.
    first_length : float, optional
        Of a crack that starts, mm, where its criterion does not say it; an increment if not given.
    largest_displacement : float, optional
        Where to stop, mm.
    errors : bool
        Whether U_T has an estimated error, for some of the time of the simulation.
    journal : str or Path, optional
        A file to which each step is written as soon as it is done, see `slmm.fracture.journal`.
    resume : bool
        Go on behind the last step of the journal, if it is there; the result is that of a simulation that was never
        stopped, to the bit.
    from_step : int, optional
        Resume behind so many steps of the journal, 0 to all of them, and drop those that follow: behind another than
        the last one, or where a simulation has ended.
    progress : callable

    Returns
    -------
    Dataset
        Over ``corner``: ``u`` (mm) and ``F`` (N), corner points of the curve; over ``step``: ``u_c``, ``u_load``,
        ``stiffness`` before the step, ``event``, ``tip`` (of which crack), ``x``, ``y`` where it stands after it,
        ``arrested_by``, ``K_I``, ``K_II``, ``released``, ``dissipated``, ``gap`` and more; over ``candidate`` what was
        in question in each step; over ``state`` the equilibrium path; ``U_T``, ``U_T_error`` in mJ, and
        ``U_T_integrated``, in which the force falls steadily where cracks grow so; crack paths over ``crack`` and
        ``point``; ``outcome`` among the attributes.

    Raises
    ------
    ValueError
        When an argument or the load does not fit, or the journal is that of another simulation, damaged, or of one that
        has not ended and is not resumed. What fails later ends the simulation with its reason and the steps so far.
    NotWrittenError
        When the journal cannot be written; it is resumed with the steps that it holds.
    ImportError
        When the engine needs an extra that is not installed.

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
    if engine == "fem" and initiation != "point":
        raise ValueError(
            f"initiation = {initiation!r}: engine fem knows 'point' alone; take the engine 'boundary' for it"
        )
    if direction not in DIRECTIONS:
        raise ValueError(f"direction = {direction!r}: must be one of {', '.join(DIRECTIONS)}")
    for name, value in (("tolerance", tolerance), ("largest_displacement", largest_displacement)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: must be a positive number")
    if resume and journal is None:
        raise ValueError("resume = True: needs the journal of what shall be resumed")
    if from_step is not None and not resume:
        raise ValueError(f"from_step = {from_step!r}: needs resume = True, which it is for")
    if from_step is not None and (not isinstance(from_step, Integral) or from_step < 0):
        raise ValueError(f"from_step = {from_step!r}: must be a number of steps, 0 or more")
    lengths = lengths_of(scene.part, increment, first_length, LOOK_AHEAD)
    solver = ENGINES[engine](scene.material, scene.loading, tolerance)
    settings = {
        "increment": "auto" if lengths.by_path else lengths.growth,
        "first_length": lengths.first,
        "look_ahead": lengths.ahead,
        "initiation": initiation,
        "direction": direction,
        "engine": engine,
        "tolerance": tolerance,
    }
    largest = largest_displacement or math.inf
    rules = Rules(DIRECTIONS[direction], INITIATIONS[initiation](scene))
    simulation = Simulation(scene, solver, rules, lengths, largest, errors)
    run = run_of(scene, {**settings, "largest_displacement": largest_displacement, "errors": errors})
    with (
        nullcontext() if journal is None else open_lines(journal, run, resume, from_step) as opened,
        one_blas_thread(),
    ):
        simulation.run(progress, opened)
    made_with = {**settings, **solver.described}
    return fracture_result(scene, simulation.part, simulation.history, made_with, simulation.reached)


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
        self,
        scene: Scene,
        engine: Engine,
        rules: Rules,
        lengths: Lengths,
        largest: float,
        errors: bool,
    ) -> None:
        """Nothing happens yet."""
        self.part, self.loading, self.engine = scene.part, scene.loading, engine
        self.conjugate = work_conjugate(self.loading, self.part.thickness)
        self.rules, self.lengths, self.largest, self.errors = rules, lengths, largest, errors
        self.surroundings = Surroundings(self.part)
        self.history = History()
        self.reached = [[-1] * len(crack.points) for crack in self.part.cracks]

    def run(self, progress: Progress = silent, journal: LineJournal | None = None) -> None:
        """Step by step to the end, behind those of a journal; what fails ends it."""
        if journal is not None:
            self._take_up([step_of(record) for record in journal.records], solves=journal.end is None)
            if journal.end is not None:
                self.history = history_of(self.history.steps, journal.end)
                return
        self._go_on(progress, journal)
        if journal is not None:
            journal.add_end(end_of(self.history))

    def _go_on(self, progress: Progress, journal: LineJournal | None) -> None:
        """Solve and let happen what comes next, again and again."""
        steps = self.history.steps
        if self.part.is_severed:
            # steps of a journal may end where a crack has just run into something
            self.history.outcome = (self._ended() if steps else None) or Outcome.SEVERED
            return
        side = float(np.ptp(self.part.outer, axis=0).min())
        for k in range(len(steps), int(MOST_CROSSINGS * side / self.lengths.growth)):
            progress(
                1 - 0.97**k, f"step {k + 1}, {len(self.part.cracks)} cracks, u = {self.history.u:.3g} mm"
            )
            try:
                outcome = self._step()
            except (ValueError, ArithmeticError, RuntimeError, np.linalg.LinAlgError) as error:
                if not steps:
                    raise
                outcome, self.history.reason = Outcome.FAILED, str(error)
            if journal is not None and len(steps) > k:
                journal.add(record_of(steps[k]))
            if outcome is not None:
                self.history.outcome = outcome
                return

    def _take_up(self, steps: list[Step], solves: bool) -> None:
        """Let happen again what happened, solved again where the engine keeps something of it for what follows."""
        for k, step in enumerate(steps):
            if solves and self.engine.keeps:
                state = self.engine.solve(self.part)
                if self.rules.initiation is not point_method:  # trial cracks leave their panels behind
                    state.events(self.rules)
                if math.isfinite(step.finer[0]):
                    state.finer(step.event)
            grown = self._grown(step.event, step.u_c)
            if (grown.crack, tuple(grown.end.tolist())) != (step.crack, step.end):
                raise ValueError(
                    f"step {k + 1} of the journal leads crack {step.crack} to {step.end}, and here crack {grown.crack} "
                    f"to {tuple(grown.end.tolist())}: it was written on another machine; begin anew"
                )
            self.history.last_stiffness = step.stiffness
            self._happens(step, grown)

    def _step(self) -> Outcome | None:
        """Solve, find the next event, and let it happen; how it ended, if it did."""
        history = self.history
        state = self.engine.solve(self.part)
        F, u = self.conjugate.force_and_displacement(state.work * self.part.thickness)
        history.last_stiffness = F / u
        events = state.events(self.rules)
        if not events:
            return Outcome.NO_EVENT
        event, gap = next_event(events)
        if event.load * u > self.largest:
            history.last_u, history.next_u = self.largest, event.load * u
            return Outcome.LARGEST
        grown = self._grown(event, event.load * u)
        finer = (math.nan, math.nan)
        if self.errors and event.load * u > history.u:
            work, load = state.finer(event)
            F_finer, u_finer = self.conjugate.force_and_displacement(work * self.part.thickness)
            finer = F_finer / u_finer, load * u_finer
        step = Step(
            event.load * u,
            F / u,
            event,
            grown.crack,
            tuple(grown.end.tolist()),
            grown.arrested_by,
            float(np.linalg.norm(grown.end - event.point)),
            gap,
            state.touches,
            tuple(self._candidate(event, u) for event in events),
            finer,
        )
        self._happens(step, grown)
        return self._ended() if step.arrested_by else None

    def _happens(self, step: Step, grown: GrownPart) -> None:
        """Take over what a step has made of the part."""
        k = len(self.history.steps)
        if grown.crack == len(self.reached):
            self.reached.append([k, k])
        else:
            self.reached[grown.crack].insert(0 if grown.at_start else len(self.reached[grown.crack]), k)
        self.history.steps.append(step)
        self.part = grown.part

    def _candidate(self, event: Event, u: float) -> Candidate:
        """What is in question, where u is the displacement under the scene's own load, mm."""
        crack = crack_of(self.part, event.tip) if event.kind is Kind.GROWTH else -1
        x, y = event.point.tolist()
        return Candidate(event.load * u, event.kind, crack, event.hole, x, y)

    def _grown(self, event: Event, u_c: float) -> GrownPart:
        length = self._length(event, u_c) if event.kind is Kind.GROWTH else event.length or self.lengths.first
        return grown_part(self.part, event, self.surroundings, length, self.lengths.ahead)

    def _length(self, event: Event, u_c: float) -> float:
        """Length of a tip's increment, mm."""
        crack = crack_of(self.part, event.tip)
        at_start = bool((self.part.cracks[crack].points[0] == event.point).all())
        has_grown = self.reached[crack][0 if at_start else -1] >= 0
        room = self.surroundings.room(self.part, event.point, crack) if self.lengths.by_path else math.inf
        line, rising = self.part.tips[event.tip], u_c >= self.history.u
        return self.lengths.along(line, has_grown, event.direction, room, rising)

    def _ended(self) -> Outcome | None:
        """What a part is whose crack has just run into something."""
        if len(self.part.pieces) == 1:
            return None
        near = 2 * self.part.tolerance
        if sum(is_carried(piece, self.loading, near) for piece in self.part.pieces) < 2:
            return Outcome.LOOSE
        self.history.last_stiffness = 0.0
        return Outcome.SEVERED
