"""What has been solved under some loads, for others on the same part of the same elasticity.

By boundary integrals the factorised part stays. Voxel models are sums of those of other loads, where these span the
load.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from slmm.initiation.local_model import LocalModel
from slmm.scene.scene import Scene
from slmm.scene.variants import load_numbers

if TYPE_CHECKING:
    from slmm.initiation.boundary_field import BoundaryField  # imports the kernels

#: what of a load others may leave, as a share of it; round-off
SPANNED = 1e-12
#: loads that are summed may be so many times as large as the sum, and the solver's errors with them; chosen
LARGER = 10.0


class LoadCases:
    """Models of one part and elasticity, by their loads."""

    def __init__(self) -> None:
        """None yet."""
        self._boundary: BoundaryField | None = None
        self._loads: list[np.ndarray] = []
        self._voxels: list[tuple[int, LocalModel]] = []

    def under(self, scene: Scene) -> dict[str, Any]:
        """What they say of the part under a scene's load, as `slmm.initiation.task.Task.solved`."""
        solved: dict[str, Any] = {}
        if self._boundary is not None:
            with suppress(ValueError):  # which the method itself will say
                solved["boundary"] = self._boundary.under(scene.loading)
        shares = self._shares(scene)
        if shares is not None:
            solved["voxels"] = self._voxels[0][0], summed([local for _, local in self._voxels], shares)
        return solved

    def keep(self, scene: Scene, solved: dict[str, Any]) -> None:
        """Keep what has been solved under a scene's load."""
        self._boundary = self._boundary or solved.get("boundary")
        if "voxels" in solved and scene.load is not None and self._shares(scene) is None:
            if self._voxels and _grids(solved["voxels"][1]) != _grids(self._voxels[0][1]):
                # positions that were added asked for other voxels
                self._loads, self._voxels = [], []
            self._loads.append(_vector(scene))
            self._voxels.append(solved["voxels"])

    def _shares(self, scene: Scene) -> np.ndarray | None:
        """How much of each load (k,) the scene's is; None where they do not span it."""
        if not self._loads:
            return None
        load, cases = _vector(scene), np.array(self._loads).T
        shares = np.linalg.lstsq(cases, load, rcond=None)[0]
        size = np.linalg.norm(load)
        left = np.linalg.norm(cases @ shares - load)
        summands = np.abs(shares) @ np.linalg.norm(cases, axis=0)
        return shares if left <= SPANNED * size and summands <= LARGER * size else None


def summed(models: list[LocalModel], shares: np.ndarray) -> LocalModel:
    """The model under the sum of shares (k,) of the loads of some models on the same voxels."""
    first = models[0]
    coarser = [model.coarser for model in models if model.coarser is not None]
    return replace(
        first,
        u=np.tensordot(shares, np.array([model.u for model in models]), 1),
        iterations=max(model.iterations for model in models),
        residual=max(model.residual for model in models),
        coarser=summed(coarser, shares) if coarser else None,
    )


def _grids(model: LocalModel | None) -> list[tuple[int, ...]]:
    """Shapes of a model's displacements and those of its coarser ones."""
    return [] if model is None else [model.u.shape, *_grids(model.coarser)]


def _vector(scene: Scene) -> np.ndarray:
    """All numbers of a load."""
    return np.concatenate(load_numbers(scene))
