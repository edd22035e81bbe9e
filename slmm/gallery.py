"""Ready-made scenes by their public name; they stand in `slmm.scene.gallery`."""

from slmm.scene.gallery import (
    circular_hole,
    edge_crack,
    elliptic_hole,
    lobed_notch,
    lobes,
    rounded_square,
    sapora_plate,
    square_hole,
    tensile_plate,
    two_holes,
    v_notch,
)

__all__ = [
    "circular_hole",
    "edge_crack",
    "elliptic_hole",
    "lobed_notch",
    "lobes",
    "rounded_square",
    "sapora_plate",
    "square_hole",
    "tensile_plate",
    "two_holes",
    "v_notch",
]
