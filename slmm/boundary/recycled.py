"""An iterative solver for many right-hand sides of one system: what earlier ones have searched serves the next.

Generalised conjugate residuals (Eisenstat, Elman and Schultz, SIAM J. Numer. Anal. 20 (1983) 345-357): directions are
kept with their images, which are orthonormal, and each right-hand side is first projected on all of them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg as la

from slmm.boundary.rules import Array

#: residual over the right-hand side at which it stops; directions that are kept, and searched for one right-hand side,
#: at most (all chosen)
RESIDUAL, MOST_KEPT, MOST_SEARCHED = 1e-9, 600, 200
#: an image that those before leave less of than this share has lost its digits (chosen)
LOST = 1e-6


class NotSolvedError(ValueError):
    """The iterative solver has not converged."""


class Recycled:
    """A system that is known by what it does to vectors.

    Parameters
    ----------
    image : callable
        The matrix times a vector (n,).
    preconditioned : callable
        An approximate inverse times a vector (n,).

    Attributes
    ----------
    searched : int
        Directions that are kept.

    Examples
    --------
    >>> A = np.diag([1.0, 2.0, 3.0]) + 0.1
    >>> system = Recycled(lambda x: A @ x, lambda r: r / np.diag(A))
    >>> bool(np.allclose(A @ system.solve(np.eye(3)), np.eye(3)))
    True
    """

    def __init__(self, image: Callable[[Array], Array], preconditioned: Callable[[Array], Array]) -> None:
        """Nothing is searched yet."""
        self._image, self._preconditioned = image, preconditioned
        self._kept = np.empty((2, 0, 0))
        self.searched = 0

    def solve(self, right: Array) -> Array:
        """Solutions (n,) or (n, k) for right-hand sides of that shape, of which the largest tells what is small.

        Several are solved in the order of their singular values: most of them are nearly the same.

        Raises
        ------
        NotSolvedError
            When the residual does not fall.
        """
        if not self.searched:
            self._kept = np.empty((2, 0, len(right)))
        if right.ndim == 1:
            return self._solved(right, RESIDUAL * float(np.linalg.norm(right)))
        U, size, V = la.svd(right, full_matrices=False, overwrite_a=False)
        allowed = RESIDUAL * float(size[0])
        return np.column_stack([self._solved(column, allowed) for column in (U * size).T]) @ V

    def _solved(self, right: Array, allowed: float) -> Array:
        x, rest = np.zeros(len(right)), right.copy()
        directions, images = self._kept[:, : self.searched]
        for _ in range(2 if self.searched else 0):  # once more, for what round-off leaves
            share = images @ rest
            rest -= share @ images
            x += share @ directions
        for _ in range(MOST_SEARCHED):
            if np.linalg.norm(rest) <= allowed:
                return x
            direction, image = self._next(rest)
            along = float(image @ rest)
            rest -= along * image
            x += along * direction
        raise NotSolvedError(
            f"boundary integrals: the residual is {np.linalg.norm(rest) / allowed:.1e} times too large after "
            f"{MOST_SEARCHED} iterations"
        )

    def _next(self, rest: Array) -> tuple[Array, Array]:
        """Search what is left of a right-hand side: a direction and its image, which are kept."""
        direction = self._preconditioned(rest).copy()
        image = self._image(direction)
        if self.searched >= MOST_KEPT:
            self.searched = 0
        size, before = float(np.linalg.norm(image)), (direction.copy(), image.copy())
        directions, images = self._kept[:, : self.searched]
        for _ in range(2 if self.searched else 0):
            share = images @ image
            image -= share @ images
            direction -= share @ directions
        if np.linalg.norm(image) < LOST * size:
            # nothing but round-off is left beside what was searched: begin anew
            direction, image = before
            self.searched = 0
        size = float(np.linalg.norm(image))
        if self.searched == self._kept.shape[1]:
            more = np.empty((2, min(MOST_KEPT, 2 * self.searched + 16), len(rest)))
            more[:, : self.searched] = self._kept[:, : self.searched]
            self._kept = more
        self._kept[0, self.searched], self._kept[1, self.searched] = direction / size, image / size
        self.searched += 1
        return direction / size, image / size
