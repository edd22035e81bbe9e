"""A part on its way to fracture: step by step, each the event with the lowest load (Paper D, section 2.2.3)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.bends import ahead, bend_at
from slmm.fracture.engine import Engine, Rules
from slmm.fracture.events import Event, Kind, next_event
from slmm.fracture.first_cracks import point_method
from slmm.fracture.grown_part import GrownPart, crack_of, grown_part
from slmm.fracture.growth import Surroundings
from slmm.fracture.history import Candidate, Excluded, History, Outcome, Step
from slmm.fracture.journal import end_of, history_of, record_of, step_of
from slmm.fracture.lengths import Lengths
from slmm.fracture.loose_pieces import Loose, carrying_piece
from slmm.fracture.work_conjugate import work_conjugate
from slmm.part.crack import TIP, End
from slmm.part.remains import remains
from slmm.running.line_journal import LineJournal
from slmm.running.progress import Progress, silent
from slmm.scene.scene import Scene

Array = NDArray[np.float64]

#: cracks together are so many times as long as the part's shorter side, at most; chosen: with holes it is one or two
MOST_CROSSINGS = 10


class Process:
    """A part on its way to fracture.

    Attributes
    ----------
    part : Part
        With its cracks as they are now, without pieces that came loose.
    history : History
    lines : list of ndarray, shape (n, 2)
        All cracks there have been, mm, also where they went with a piece that came loose.
    reached : list of list of int
        For each of these and each of its points the step that led there; -1 of what was there before.
    loose : list of Loose
        Pieces that came loose.
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
        self.lines = [crack.points for crack in self.part.cracks]
        self.reached = [[-1] * len(line) for line in self.lines]
        self.loose: list[Loose] = []
        # the part's cracks among the lines, and its outlines among the scene's, of which a rim is the last
        self._lines_of = tuple(range(len(self.lines)))
        self._rim = len(self.part.holes)
        self._holes_of = tuple(range(self._rim + 1))

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
            self._let_go()
            if solves and self.engine.keeps:
                state = self.engine.solve(self.part)
                if self.rules.initiation is not point_method:  # trial cracks leave their panels behind
                    state.events(self.rules)
                if math.isfinite(step.finer[0]):
                    state.finer(step.event)
            grown = self._grown(step.event, step.u_c)
            line = self._line_of(grown)
            if (line, tuple(grown.end.tolist())) != (step.crack, step.end):
                raise ValueError(
                    f"step {k + 1} of the journal leads crack {step.crack} to {step.end}, and here crack {line} "
                    f"to {tuple(grown.end.tolist())}: it was written on another machine; begin anew"
                )
            self.history.last_stiffness = step.stiffness
            self._happens(step, grown)

    def _step(self) -> Outcome | None:
        """Solve, find the next event, and let it happen; how it ended, if it did."""
        history = self.history
        if not self._let_go():
            history.last_stiffness = 0.0
            return Outcome.SEVERED
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
        event, gap = next_event(events, self._last_place())
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
            self._line_of(grown),
            tuple(grown.end.tolist()),
            self._name(grown.arrested_by),
            float(np.linalg.norm(grown.end - event.point)),
            gap,
            state.closed,
            tuple(self._candidate(event, u) for event in events),
            finer,
            excluded,
        )
        self._happens(step, grown)
        return None

    def _happens(self, step: Step, grown: GrownPart) -> None:
        """Take over what a step has made of the part."""
        k, line = len(self.history.steps), step.crack
        if line == len(self.lines):
            self._lines_of = (*self._lines_of, line)
            self.lines.append(grown.part.cracks[grown.crack].points)
            self.reached.append([k, k])
        else:
            at = 0 if self._is_first(line, step.event.point) else len(self.lines[line])
            self.lines[line] = np.insert(self.lines[line], at, grown.end, axis=0)
            self.reached[line].insert(at, k)
        self.history.steps.append(step)
        self.part = grown.part

    def _let_go(self) -> bool:
        """Whether the part still carries its load; what the last step cut loose is no part of it any more."""
        steps, part = self.history.steps, self.part
        if (steps and not steps[-1].arrested_by) or not part.is_severed:
            return True
        kept = carrying_piece(part, self.loading)
        if kept is None:
            return False
        left = remains(part, kept)
        for piece in part.pieces:
            if piece is not kept:
                x, y = piece.centroid.coords[0]
                self.loose.append(Loose(len(steps) - 1, x, y, piece.area))
        self.part, self.surroundings = left.part, Surroundings(left.part)
        self._lines_of = tuple(self._lines_of[k] for k in left.cracks)
        self._holes_of = (*(self._hole(k) for k in left.holes), self._rim)
        return True

    def _line_of(self, grown: GrownPart) -> int:
        """Which of the lines is longer or new."""
        return (*self._lines_of, len(self.lines))[grown.crack]

    def _is_first(self, line: int, point: Array) -> bool:
        return bool((self.lines[line][0] == point).all())

    def _hole(self, number: int) -> int:
        """Which outline of the scene one of the part is, -1 of a straight edge and a new notch."""
        return self._holes_of[number] if number >= 0 else -1

    def _name(self, end: End) -> str:
        """What a crack ends at, in words; nothing of a tip."""
        if end == TIP:
            return ""
        if end.kind == "crack":
            return f"crack {self._lines_of[end.number]}"
        hole = self._hole(end.number)
        return f"hole {hole}" if 0 <= hole < self._rim else "edge"

    def _last_place(self) -> Array:
        """Where the last thing happened: the end of the last step, the first tip, or the middle of the part."""
        if self.history.steps:
            return np.array(self.history.steps[-1].end)
        return self.part.tips[0][-1] if self.part.tips else self.part.box.mean(axis=0)

    def _candidate(self, event: Event, u: float) -> Candidate:
        """What is in question, where u is the displacement under the scene's own load, mm."""
        line = self._lines_of[crack_of(self.part, event.tip)] if event.kind is Kind.GROWTH else -1
        x, y = event.point.tolist()
        return Candidate(event.load * u, event.kind, line, self._hole(event.hole), x, y)

    def _grown(self, event: Event, u_c: float) -> GrownPart:
        if event.kind is Kind.START:
            length = event.length or self.lengths.first
        elif not self.lengths.by_path:
            length = self.lengths.growth
        else:
            bend = bend_at(self.history.steps, event)
            length = self._length(event, bend.turned, u_c)
            event = replace(event, direction=ahead(event.direction, bend, length))
        return grown_part(self.part, event, self.surroundings, length, self.lengths.ahead)

    def _length(self, event: Event, turned: float, u_c: float) -> float:
        """Length of a tip's increment as its path asks, mm."""
        crack = crack_of(self.part, event.tip)
        its = self._lines_of[crack]
        has_grown = self.reached[its][0 if self._is_first(its, event.point) else -1] >= 0
        room = self.surroundings.room(self.part, event.point, crack)
        line, rising = self.part.tips[event.tip], u_c >= self.history.u
        return self.lengths.along(line, has_grown, event.direction, turned, room, rising)
