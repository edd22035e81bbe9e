"""A part on its way to fracture: step by step, each the event with the lowest load (Paper D, section 2.2.3)."""

from __future__ import annotations

import math

import numpy as np

from slmm.fracture.engine import Engine, Rules
from slmm.fracture.events import Event, Kind, next_event
from slmm.fracture.first_cracks import point_method
from slmm.fracture.grown_part import GrownPart, crack_of, grown_part, is_carried
from slmm.fracture.growth import Surroundings
from slmm.fracture.history import Candidate, Excluded, History, Outcome, Step
from slmm.fracture.journal import end_of, history_of, record_of, step_of
from slmm.fracture.lengths import Lengths
from slmm.fracture.work_conjugate import work_conjugate
from slmm.running.line_journal import LineJournal
from slmm.running.progress import Progress, silent
from slmm.scene.scene import Scene

#: cracks together are so many times as long as the part's shorter side, at most; chosen: with holes it is one or two
MOST_CROSSINGS = 10


class Process:
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
        at_least: float,
    ) -> None:
        """Nothing happens yet."""
        self.part, self.loading, self.engine = scene.part, scene.loading, engine
        self.conjugate = work_conjugate(self.loading, self.part.thickness)
        self.rules, self.lengths, self.largest, self.errors = rules, lengths, largest, errors
        self.at_least = at_least
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
        if self.at_least and history.toughness_at_most(self.largest) < self.at_least:
            return Outcome.SHORT
        found = state.events(self.rules)
        events = [event for event in found if not event.excluded]
        excluded = tuple(
            Excluded(event.load * u, float(event.point[0]), float(event.point[1]), event.excluded)
            for event in found
            if event.excluded
        )
        if not events:
            if excluded:
                history.reason = (
                    f"what would crack first, at u = {min(excluded).u_c:.4g} mm, is {min(excluded).reason}"
                )
            elif math.isfinite(self.largest):
                history.last_u = self.largest
                return Outcome.LARGEST
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
            state.closed,
            tuple(self._candidate(event, u) for event in events),
            finer,
            excluded,
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
