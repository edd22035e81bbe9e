"""Settings of the meta-model method: those of the package and those of the paper."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from slmm.initiation.placement import Constraints

#: D_imp, published (Paper A, section 2.2.3): direction (0: xi, 1: eta), powers p, q
IMPORTANT_MODES = ((0, 1, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0))


@dataclass(frozen=True)
class Settings:
    """How cells are chosen, fitted and relaxed.

    Parameters
    ----------
    name : str
        For the result's provenance.
    modes : {"important", "published", "all"}
        D_imp (5), D_all (16) or all that the database holds and that differ on the cell's boundary.
    fine, wide : Constraints
        Rules for the cell that is tried first, and for the larger one that serves where the crack would be longer
        than the first or where the first does not exist.
    cell_voxels : int
        Least height of a cell in voxels, phi_min.
    relaxed : {"unbounded", "force"}
        The upper bound that auto control mixes in.
    linear_lengths : int
        0 interpolates G_inc/a smoothly; n interpolates G_inc linearly between n equidistant lengths.
    height : float
        Fixes the cell's height, mm; 0 lets it grow.
    void_stiffness : float
        Stiffness of a hole's voxels as a share of the material's; 0 takes the scene's.
    contact : bool
        Crack faces that meet stay closed; the paper lets them penetrate one another.
    """

    name: str
    modes: str
    fine: Constraints
    wide: Constraints
    cell_voxels: int
    relaxed: str
    linear_lengths: int = 0
    height: float = 0.0
    void_stiffness: float = 0.0
    contact: bool = True

    def describe(self) -> dict:
        """Plain values for provenance."""
        values = asdict(self)
        for rule in ("fine", "wide"):
            # JSON knows no infinity: None is no limit
            limits = getattr(self, rule)._asdict()
            values[rule] = {name: None if np.isinf(limit) else limit for name, limit in limits.items()}
        return values


def _smooth(deviation: float) -> Constraints:
    # An infinite absolute tolerance leaves the paper's variance aside: the largest deviation decides instead.
    return Constraints(
        samples=21,
        quartic=True,
        absolute=np.inf,
        relative=0.0,
        deviation=deviation,
        boundary_samples=84,
        inside=2,
    )


_PAPER = Constraints(
    samples=11,
    quartic=False,
    absolute=0.01,
    relative=0.1,
    deviation=np.inf,
    boundary_samples=28,
    inside=2,
)

#: The package's own, chosen (validation/chart.py): cells so small that a parabola with the curvature at the mouth
#: follows the outline.
DEFAULT = Settings("default", "all", _smooth(0.005), _smooth(0.03), cell_voxels=10, relaxed="unbounded")

#: Paper A's, published: the largest valid cell, five modes, force control as the upper bound, ten lengths, voids of
#: 1 %.
PUBLISHED = Settings(
    "published",
    "important",
    _PAPER,
    _PAPER,
    cell_voxels=10,
    relaxed="force",
    linear_lengths=10,
    void_stiffness=0.01,
    contact=False,
)
