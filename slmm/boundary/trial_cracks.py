"""Trial cracks from a surface: the energy that they set free, from their own unknowns on one factorised body."""

from __future__ import annotations

import numpy as np

from slmm.boundary.model import BoundaryModel
from slmm.boundary.rules import Array, rule

#: lengths that are solved between two breaks, and where these lie over the longest crack: what a crack feels of a notch
#: varies over the notch's own radius, which may be short; chosen on tests/boundary/test_trial_cracks.py
SOLVED, BREAKS = 6, (0.0, 0.12, 1.0)


class TrialCracks:
    """Straight cracks of all lengths from one place of a surface, each alone in the part.

    G_inc(a) is the mean of G over the crack. G is solved at Gauss points of its length, where s^-p G(s) is a polynomial
    between two breaks; a crack at a surface has p = 1, at a corner the stress's own exponent decides.

    Parameters
    ----------
    model : BoundaryModel
        The part without them.
    point, direction : ndarray, shape (2,)
        mm, and a unit vector into the material.
    longest : float
        mm; all cracks up to that length lie inside the part and meet no other one.
    exponent : float
        p above; 0 where a crack goes on.
    tip : int, optional
        Which crack tip of the part goes on, from its place; by default the place is one of a surface.
    solved : int
        Lengths between two breaks; one fewer tells the error.

    Attributes
    ----------
    lengths : ndarray, shape (n,)
        That are solved, mm.
    K : ndarray, shape (n, 2)
        K_I and K_II at their tips, MPa sqrt(mm); where K_I is negative the faces would overlap.
    G : ndarray, shape (n,)
        Energy release rate at their tips, N/mm.

    Raises
    ------
    ValueError
        When the point is on no surface.

    Examples
    --------
    An edge crack in a wide plate under 10 MPa, 1.1215^2 pi sigma^2 a/E at its tip, has set free half of that for each
    mm.

    >>> from slmm.mechanics.material import Material
    >>> from slmm.part.part import Part
    >>> from slmm.scene.loading import plate_loading
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1, state="plane stress")
    >>> plate = BoundaryModel(Part.plate(400.0, 800.0), material, plate_loading(400.0, 800.0, stress=10.0))
    >>> trial = TrialCracks(plate, np.array([0.0, 400.0]), np.array([1.0, 0.0]), 1.0)
    >>> float((trial.incremental(np.array([0.5, 1.0])) / np.array([0.5, 1.0])).round(3)[1])
    0.198
    """

    def __init__(
        self,
        model: BoundaryModel,
        point: Array,
        direction: Array,
        longest: float,
        exponent: float = 1.0,
        tip: int | None = None,
        solved: int = SOLVED,
    ) -> None:
        """Solve."""
        self.longest, self.exponent, self._solved = longest, exponent, solved
        x, _ = rule(solved)
        low, high = (longest * np.array(part)[:, None] for part in (BREAKS[:-1], BREAKS[1:]))
        self.lengths = (0.5 * (low + high) + 0.5 * (high - low) * x).ravel()
        ends = [point + a * direction for a in self.lengths]
        part, old = model.part, model.body
        if tip is None:
            parts = [part.with_short_crack(point, end) for end in ends]
            body = old.divided(parts[-1], [complex(*end) for end in ends])
        else:
            parts = [part.grown(tip, end) for end in ends]
            body = old if old.serves(parts[-1]) else old.divided(parts[-1])
        cracked = [
            BoundaryModel(
                each, old.material, old.loading, old.p, model.crack_p, body, model.contact, old.grading
            )
            for each in parts
        ]
        # tips come in the order of the cracks, the new one's last
        number = -1 if tip is None else tip
        self.K = np.array([each.stress_intensities()[number] for each in cracked])
        self.G = (self.K**2).sum(axis=1) / old.E

    def incremental(self, a: Array) -> Array:
        """G_inc (k,), N/mm, of cracks of lengths a (k,), mm, up to the longest one."""
        t, total = a / self.longest, np.zeros(len(a))
        power = np.arange(self._solved)
        order = power + self.exponent + 1
        solved = zip(
            *(v.reshape(-1, self._solved) for v in (self.lengths / self.longest, self.G)), strict=True
        )
        for (s, G), low, high in zip(solved, BREAKS[:-1], BREAKS[1:], strict=True):
            coefficients = np.linalg.solve(s[:, None] ** power, G / s**self.exponent) / order
            total += (np.clip(t, low, high)[:, None] ** order - low**order) @ coefficients
        return np.asarray(total / t)
