"""Hole patterns as a problem: how tough the plate is at least, from whichever side the crack comes (Paper D)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from slmm.fracture.history import Outcome
from slmm.fracture.simulation import simulate
from slmm.optimization.checks import check_whole
from slmm.optimization.hole_patterns.patterns import (
    DIRECTIONS,
    Design,
    expanded,
    fixed_cells,
    shape_of,
    symmetric,
)
from slmm.optimization.problem import Bound, Value
from slmm.part.level_set import IslandError, LevelSet
from slmm.scene.scene import Scene

#: the plate of Paper D, section 2.1: side, crack, frame without support points, mm; published
SIDE, CRACK, FRAME = 80.0, 10.0, 15.0
#: its material, PMMA of Sapora et al.; published
PMMA = {"E": 2960.0, "nu": 0.38, "sigma_c": 70.5, "K_Ic": 1.96, "state": "plane strain"}
#: increment, first length of a crack that starts, and largest displacement, mm; published
INCREMENT, FIRST_LENGTH, LARGEST = 2.0, 1.0, 2.0


@dataclass(frozen=True)
class HolePattern:
    """Support points on a grid in a square plate with a crack, each of them a hole or material.

    Its value is minus the least tensile toughness, mJ, of the directions from which the crack may come.

    Parameters
    ----------
    grid : int
        Support points along a side.
    pattern : {"full", "reflected", "rotated"}
        What designs vary: the whole grid, or the quarter that is mirrored or turned.
    increment, first_length : float
        Of cracks that grow and that start, mm.
    initiation : str
        As that of `slmm.fracture.simulate`.
    engine : str
        Likewise.

    Raises
    ------
    ValueError
        For a grid of less than one point or an unknown pattern.

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

    #: of what `evaluate` finds
    objective: ClassVar[Mapping[str, str]] = {"units": "mJ", "long_name": "minus the least tensile toughness"}

    def __post_init__(self) -> None:
        check_whole("grid", self.grid, 1)
        if self.pattern not in DIRECTIONS:
            raise ValueError(f"pattern = {self.pattern!r}: must be one of {', '.join(DIRECTIONS)}")
        # the repr tells a problem from others
        object.__setattr__(self, "grid", int(self.grid))

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
        return DIRECTIONS[self.pattern]

    def whole(self, design: ArrayLike) -> Design:
        """The whole grid of a design (rows, columns)."""
        design = np.asarray(design, dtype=bool)
        if design.shape != self.shape:
            raise ValueError(f"a design of {design.shape}: must have {self.shape[0]} x {self.shape[1]} cells")
        return expanded(design, self.pattern, self.grid)

    def valid(self, designs: np.ndarray) -> np.ndarray:
        """Which designs (n, rows, columns) have no island of material within a hole."""
        return np.array([self._has_no_island(self.whole(design)) for design in designs], dtype=bool)

    def _has_no_island(self, whole: Design) -> bool:
        try:
            self.level_set(whole).contours()
        except IslandError:
            return False
        return True

    def key(self, design: np.ndarray) -> bytes:
        """What a design has in common with those that turning and mirroring make of it."""
        return np.packbits(symmetric(self.whole(design))).tobytes()

    def level_set(self, whole: Design) -> LevelSet:
        """The function whose level is the outline of the holes of a whole grid."""
        spacing = (SIDE - 2 * FRAME) / self.grid
        return LevelSet(whole.astype(float), (SIDE / 2, SIDE / 2), spacing)

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
        return self._scene(np.rot90(self.whole(design), direction))

    def _scene(self, whole: Design) -> Scene:
        holes = [{"shape": "pattern", "values": whole.astype(float).tolist(), "frame": FRAME}]
        return Scene.from_dict(
            {
                "title": f"Hole pattern of {self.grid} x {self.grid} points",
                "plate": {"width": SIDE, "height": SIDE},
                "holes": holes if whole.any() else [],
                "cracks": [{"points": [[0.0, SIDE / 2], [CRACK, SIDE / 2]]}],
                "material": PMMA,
                "load": {"displacement": 1.0},
            }
        )

    def tensile_toughness(self, design: ArrayLike) -> np.ndarray:
        """U_T (directions,) of a design, mJ, the crack coming from one side after the other.

        Raises
        ------
        ValueError
            When a simulation failed, with its reason.
        """
        whole = self.whole(design)
        return np.array([self._toughness(np.rot90(whole, k), 0.0) for k in range(self.directions)])

    def _toughness(self, whole: Design, at_least: float) -> float:
        """U_T of one direction, mJ, or what is asked for if it is not reached."""
        result = simulate(
            self._scene(whole),
            self.increment,
            self.initiation,
            self.engine,
            first_length=self.first_length,
            largest_displacement=LARGEST,
            at_least=at_least,
            errors=False,
        )
        if result.attrs["outcome"] == Outcome.SHORT:
            return at_least
        if result.attrs["outcome"].startswith(Outcome.FAILED):
            raise ValueError(result.attrs["outcome"])
        return float(result.U_T)

    def evaluate(self, design: np.ndarray, below: float) -> Value | Bound:
        """Minus the least tensile toughness of a design, mJ; a bound where one direction is no tougher than asked for.

        What is simulated is the least of the designs that are equal by symmetry, so that all have one value. A
        simulation ends where it can no longer be tougher than asked for.
        """
        whole = symmetric(self.whole(design))
        least = np.inf
        for k in range(self.directions):
            least = min(least, self._toughness(np.rot90(whole, k), max(0.0, -below)))
            if -least >= below:
                return Bound(-least)
        return Value(-least)
