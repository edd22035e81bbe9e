"""The cantilever of Paper C, all its designs, and all neighbours of one."""

from slmm.optimization.cantilever.beam import Cantilever

__all__ = ["Cantilever"]
