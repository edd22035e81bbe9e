"""Crack initiation at arbitrary 2D notches: will a crack start, at which load, and where.

What is named here is loaded when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from slmm.criteria.coupled import CriticalLoad, coupled_criterion
    from slmm.initiation.failure import failure_indices
    from slmm.mechanics.material import MATERIALS, Material
    from slmm.scene.errors import SceneError
    from slmm.scene.scene import Scene, read_scene

_HOME = {
    "CriticalLoad": "slmm.criteria.coupled",
    "coupled_criterion": "slmm.criteria.coupled",
    "failure_indices": "slmm.initiation.failure",
    "MATERIALS": "slmm.mechanics.material",
    "Material": "slmm.mechanics.material",
    "SceneError": "slmm.scene.errors",
    "Scene": "slmm.scene.scene",
    "read_scene": "slmm.scene.scene",
}

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


def __getattr__(name: str) -> Any:
    """Load what is asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'slmm' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """What there is, loaded or not."""
    return sorted({*globals(), *_HOME})
