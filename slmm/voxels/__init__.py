"""The voxel model of a plate: stencils, kernels, multigrid."""
