"""Crack initiation at arbitrary 2D notches: will a crack start, at which load, and where."""

__version__ = "0.1.0"

from slmm.initiation.criterion import CriticalLoad, coupled_criterion
from slmm.initiation.failure import failure_indices
from slmm.material import MATERIALS, Material
from slmm.scene import Scene, SceneError, read_scene

__all__ = [
    "MATERIALS",
    "CriticalLoad",
    "Material",
    "Scene",
    "SceneError",
    "coupled_criterion",
    "failure_indices",
    "read_scene",
]
