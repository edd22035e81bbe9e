"""The file format of scenes, ready-made ones, and what is wrong with one."""

from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene, read_scene

__all__ = ["Scene", "SceneError", "read_scene"]
