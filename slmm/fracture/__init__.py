"""Crack tips: their loading, where they run, and when; the fracture of whole parts (Papers B and D)."""

from slmm.fracture.kink_correction import CorrectedKink, corrected_kink
from slmm.fracture.kinking import (
    energy_release_direction,
    kinked_stress_intensities,
    local_symmetry,
    maximum_energy_release_rate,
    maximum_tangential_stress,
    minimum_strain_energy_density,
)
from slmm.fracture.loading import crack_tip_loading
from slmm.fracture.simulation import simulate
from slmm.fracture.tips import CrackTip, find_crack_tips

__all__ = [
    "CorrectedKink",
    "CrackTip",
    "corrected_kink",
    "crack_tip_loading",
    "energy_release_direction",
    "find_crack_tips",
    "kinked_stress_intensities",
    "local_symmetry",
    "maximum_energy_release_rate",
    "maximum_tangential_stress",
    "minimum_strain_energy_density",
    "simulate",
]
