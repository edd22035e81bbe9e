"""The voxel model by its former name, which scripts outside the package hold on to."""

from slmm.voxels.model import solve_voxels

__all__ = ["solve_voxels"]
