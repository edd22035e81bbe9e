"""Configurational forces by their public name; they stand in `slmm.fracture.configurational_forces`."""

from slmm.fracture.configurational_forces import (
    compute_CF,
    compute_CS,
    compute_F,
    compute_P,
    forces_in_rings,
    forces_within,
    nodal_configurational_forces,
)

__all__ = [
    "compute_CF",
    "compute_CS",
    "compute_F",
    "compute_P",
    "forces_in_rings",
    "forces_within",
    "nodal_configurational_forces",
]
