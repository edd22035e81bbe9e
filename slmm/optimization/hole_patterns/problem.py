"""Hole patterns as a problem: how tough the plate is at least, from whichever side the crack comes (Paper D)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from slmm.fracture.first_cracks import INITIATIONS
from slmm.fracture.history import WHOLE, Outcome
from slmm.fracture.simulation import ENGINES, simulate
from slmm.optimization.checks import check_whole
from slmm.optimization.hole_patterns.margins import margins
from slmm.optimization.hole_patterns.objectives import FIGURES, LARGEST, OVER, Figure
from slmm.optimization.hole_patterns.patterns import (
    DIRECTIONS,
    SIDES,
    Design,
    expanded,
    fixed_cells,
    repaired,
    shape_of,
    symmetric,
    weakest_first,
)
from slmm.optimization.hole_patterns.plate import CrackedPlate
from slmm.optimization.problem import Bound, Value
from slmm.part.level_set import IslandError, LevelSet
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

#: increment, and first length of a crack that starts, mm; published
INCREMENT, FIRST_LENGTH = 2.0, 1.0
#: of a simulation, relative: what those of a search aim at, that of `slmm.fracture.simulate`
TOLERANCE = 0.01
PAPER = CrackedPlate()


@dataclass(frozen=True)
class HolePattern:
    """Support points on a grid in a square plate with a crack, each of them a hole or material.

    Its value is minus the least tensile toughness, mJ, of the directions from which the crack may come, or minus
    another figure of them.

    Parameters
    ----------
    grid : int
        Support points along a side.
    pattern : {"full", "reflected", "rotated"}
        What designs vary: the whole grid, or the quarter that is mirrored or turned.
    increment, first_length : float
        Of cracks that grow and that start, mm.
    initiation, engine : str
        As those of `slmm.fracture.simulate`.
    plate : CrackedPlate
        Its lengths, its material, and the function through the support points.
    sides : {"all", "left"}
        From which side the crack may come.
    figure : {"U_T", "peak force", "stiffness"}
        What is to be large.
    over : {"least", "mean"}
        Of the directions.
    heaviest : float
        What the plate may weigh, over a plate without holes.

    Raises
    ------
    ValueError
        For a grid of less than one point, a weight of nothing, or what is unknown.

    Examples
    --------
    >>> problem = HolePattern(3, "reflected")
    >>> problem.shape, problem.directions
    ((2, 2), 2)
    >>> problem.tensile_toughness(problem.start).round(0).tolist()
    [107.0, 107.0]
    """

    grid: int = 8
    pattern: str = "reflected"
    increment: float = INCREMENT
    first_length: float = FIRST_LENGTH
    initiation: str = "point"
    engine: str = "boundary"
    plate: CrackedPlate = PAPER
    sides: str = "all"
    figure: str = "U_T"
    over: str = "least"
    heaviest: float = 1.0

    def __post_init__(self) -> None:
        check_whole("grid", self.grid, 1)
        choices: dict[str, Collection[str]] = {
            "pattern": DIRECTIONS,
            "initiation": INITIATIONS,
            "engine": ENGINES,
            "sides": SIDES,
            "figure": FIGURES,
            "over": OVER,
        }
        for name, known in choices.items():
            if getattr(self, name) not in known:
                raise ValueError(f"{name} = {getattr(self, name)!r}: must be one of {', '.join(known)}")
        if not 0 < self.heaviest <= 1:
            raise ValueError(f"heaviest = {self.heaviest!r}: must lie above 0, and be 1 at most")
        # the repr tells a problem from others
        object.__setattr__(self, "grid", int(self.grid))

    @property
    def objective(self) -> Mapping[str, str]:
        """Units and long name of values."""
        figure = FIGURES[self.figure]
        return {"units": figure.units, "long_name": f"minus the {self.over} {figure.long_name}"}

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of a design: of the grid, or of its top right quarter."""
        return shape_of(self.pattern, self.grid)

    @property
    def fixed(self) -> np.ndarray:
        """Cells that are of no importance."""
        return fixed_cells(self.pattern, self.grid)

    @property
    def start(self) -> np.ndarray:
        """The solid plate."""
        return np.zeros(self.shape, dtype=bool)

    @property
    def directions(self) -> int:
        """How many directions symmetry leaves different."""
        return DIRECTIONS[self.pattern] if self.sides == "all" else 1

    def whole(self, design: ArrayLike) -> Design:
        """The whole grid of a design (rows, columns)."""
        design = np.asarray(design, dtype=bool)
        if design.shape != self.shape:
            raise ValueError(f"a design of {design.shape}: must have {self.shape[0]} x {self.shape[1]} cells")
        return expanded(design, self.pattern, self.grid)

    def valid(self, designs: np.ndarray) -> np.ndarray:
        """Which designs (n, rows, columns) have no island of material within a hole, and are light enough."""
        return np.array([self._is_allowed(self.whole(design)) for design in designs], dtype=bool)

    def _is_allowed(self, whole: Design) -> bool:
        try:
            return self.plate.weight(whole) <= self.heaviest
        except IslandError:
            return False

    def repaired(self, design: np.ndarray) -> np.ndarray:
        """A valid design with some more holes: where islands are, then from the middle until it is light enough.

        Raises
        ------
        ValueError
            When there is no such design.
        """
        return repaired(design, self.pattern, self.grid, self._lacks)

    def _lacks(self, whole: Design) -> tuple[float, float] | None:
        """Where a hole has to be for this to become a valid design, as shares of the grid; None of a valid one."""
        try:
            return None if self.plate.weight(whole) <= self.heaviest else (0.5, 0.5)
        except IslandError as error:
            x, y = ((at - self.plate.frame) / (self.plate.side - 2 * self.plate.frame) for at in error.at)
            return x, y

    def key(self, design: np.ndarray) -> bytes:
        """What a design has in common with those that turning and mirroring make of it."""
        return np.packbits(symmetric(self.whole(design), self.sides)).tobytes()

    def level_set(self, whole: Design) -> LevelSet:
        """The function whose level is the outline of the holes of a whole grid."""
        return self.plate.level_set(whole)

    def outlines(self, design: ArrayLike) -> list[np.ndarray]:
        """Points (n, 2) around each hole of a design, mm.

        Raises
        ------
        IslandError
            When there is material within a hole.
        """
        return [outline.polygon(400) for outline in self.level_set(self.whole(design)).outlines()]

    def scene(self, design: ArrayLike, direction: int = 0) -> Scene:
        """The plate with a design's holes, turned by so many quarters, and its crack from the left.

        Raises
        ------
        SceneError
            When there is material within a hole.
        """
        return self.plate.scene(np.rot90(self.whole(design), direction))

    def tensile_toughness(self, design: ArrayLike) -> np.ndarray:
        """U_T (directions,) of a design, mJ, the crack coming from one side after the other.

        Raises
        ------
        ValueError
            When a simulation ended early, with its reason.
        """
        return self._of_directions(FIGURES["U_T"], design)

    def by_direction(self, design: ArrayLike) -> np.ndarray:
        """What is to be large (directions,) of a design.

        Raises
        ------
        ValueError
            When a simulation ended early, with its reason.
        """
        return self._of_directions(FIGURES[self.figure], design)

    def fracture(
        self,
        scene: Scene,
        largest: float = LARGEST,
        at_least: float = 0.0,
        tolerance: float = TOLERANCE,
        errors: bool = False,
    ) -> xr.Dataset:
        """A plate's fracture as designs are simulated, see `slmm.fracture.simulate`.

        Parameters
        ----------
        scene : Scene
            As `scene` makes it.
        largest : float
            Displacement at which it ends, mm.
        at_least, tolerance, errors
            As those of `slmm.fracture.simulate`.

        Raises
        ------
        ValueError
            When it fails, with the reason.
        """
        result = simulate(
            scene,
            self.increment,
            self.initiation,
            self.engine,
            tolerance,
            first_length=self.first_length,
            largest_displacement=largest,
            at_least=at_least,
            errors=errors,
        )
        if result.attrs["outcome"] not in (*WHOLE, Outcome.SHORT):
            raise ValueError(result.attrs["outcome"])
        return result

    def margins(self, design: ArrayLike) -> xr.Dataset:
        """How far a design is from other events and other holes, see `slmm.optimization.hole_patterns.margins`.

        Raises
        ------
        ValueError
            When a simulation failed, with its reason.
        """
        return margins(self, self.whole(design))

    def _of_directions(self, figure: Figure, design: ArrayLike) -> np.ndarray:
        whole = self.whole(design)
        return np.array([self._simulated(figure, np.rot90(whole, k)) for k in range(self.directions)])

    def _simulated(self, figure: Figure, whole: Design, at_least: float = 0.0) -> float | None:
        """A figure of one direction; None where the tensile toughness that is asked for, mJ, is not reached."""
        result = self.fracture(self.plate.scene(whole), figure.largest, at_least)
        if result.attrs["outcome"] == Outcome.SHORT:
            return None
        return figure.of(result)

    def evaluate(self, design: np.ndarray, below: float) -> Value | Bound:
        """Minus the figure of a design; a bound where it is no better than asked for.

        What is simulated is the least of the designs that are equal by symmetry, so that all have one value, and the
        direction that is likely to be weak comes first. A simulation ends where it can no longer be tough enough.
        """
        whole = symmetric(self.whole(design), self.sides)
        found: list[float] = []
        for k in weakest_first(whole, self.directions):
            figure = self._simulated(FIGURES[self.figure], np.rot90(whole, k), self._needed(found, -below))
            if figure is None:
                return Bound(below)
            found.append(figure)
            if self.over == "least" and -min(found) >= below:
                return Bound(-min(found))
        return Value(-OVER[self.over](found))

    def _needed(self, found: list[float], wanted: float) -> float:
        """Tensile toughness, mJ, that the next direction must have for all of them to reach what is wanted."""
        if self.figure != "U_T" or not np.isfinite(wanted):
            return 0.0
        if self.over == "least":
            return max(0.0, wanted)
        last = len(found) == self.directions - 1
        return max(0.0, self.directions * wanted - sum(found)) if last else 0.0
