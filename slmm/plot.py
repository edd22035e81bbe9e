"""The picture of a result by its public name; it is drawn in `slmm.pictures.initiation`."""

from slmm.pictures.initiation import (
    plot_initiation,
)

__all__ = [
    "plot_initiation",
]
