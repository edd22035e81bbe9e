"""The table of rounded V-notches under opening load: its file, and its interpolation over angle and length.

`precompute.v_notch` makes it, for a Young's modulus and a generalised stress intensity of 1; `asymptotics` scales it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from slmm.mechanics.williams import release_coefficient, singular_exponent, williams_fields
from slmm.running.model_file import read_verified, shipped

#: version of the layout below; a table of another one is refused
SCHEMA = 1

#: variables of the table of rounded notches and their dimensions
LAYOUT: dict[str, tuple[str, ...]] = {
    "release": ("opening", "length"),
    "stress": ("opening", "component", "length"),
    "sharp_release": ("opening", "mode"),
}

#: lengths are interpolated over ln(1 + length/LENGTH_BEND); chosen
LENGTH_BEND = 0.1


@dataclass(frozen=True)
class VNotchTable:
    """Rounded V-notches under k_1, computed by `precompute.v_notch`.

    The unit of length is the half width of the root, l = radius cos(opening/2).

    Attributes
    ----------
    opening : ndarray (n_o,)
        Stored opening angles, from 0 to pi, radians.
    length : ndarray (n_l,)
        Crack lengths and distances from the root over l, from 0.
    log_release : ndarray (n_o, n_l)
        Logarithm of E' G_inc/(k_1^2 l^(2 lambda - 1)) over the length.
    stress : ndarray (n_o, 2, n_l)
        Stress across the bisector and along it over k_1 l^(lambda - 1).
    checksum : str
        Of the file, for provenance.
    """

    opening: np.ndarray
    length: np.ndarray
    log_release: np.ndarray
    stress: np.ndarray
    checksum: str = ""

    @cached_property
    def _release_spline(self) -> CubicSpline:
        return CubicSpline(self.opening, self.log_release)

    @cached_property
    def _stress_spline(self) -> CubicSpline:
        decrease = [self._decrease(self.length, singular_exponent(opening)) for opening in self.opening]
        return CubicSpline(self.opening, self.stress / np.array(decrease)[:, None])

    @staticmethod
    def _decrease(length: np.ndarray, exponent: float) -> np.ndarray:
        """How the stress falls far away, finite at the root; what is left interpolates well."""
        return (1 + length) ** (exponent - 1)

    def release(self, opening: float, length: np.ndarray) -> np.ndarray:
        """E' G_inc/(k_1^2 l^(2 lambda - 1)) for crack lengths over l, shape of ``length``.

        Beyond the longest stored length it approaches the sharp notch in proportion to 1/length.
        """
        sharp = release_coefficient(opening)
        exponent = 2 * singular_exponent(opening) - 1
        last = self.length[-1]
        curve = CubicSpline(np.log1p(self.length / LENGTH_BEND), self._release_spline(opening))
        inside = np.minimum(length, last)
        excess = np.exp(curve(math.log1p(last / LENGTH_BEND))) * last / (sharp * last**exponent) - 1
        beyond = np.maximum(length, last)
        return np.where(
            length > last,
            sharp * beyond**exponent * (1 + excess * last / beyond),
            np.exp(curve(np.log1p(inside / LENGTH_BEND))) * inside,
        )

    def bisector_stress(self, opening: float, length: np.ndarray) -> np.ndarray:
        """Stress across the bisector and along it over k_1 l^(lambda - 1), shape (2, ...).

        Beyond the largest stored distance it approaches the sharp notch in proportion to 1/length.
        """
        exponent = singular_exponent(opening)
        field = williams_fields(opening, True, 1)[0]
        sharp = field.stress(np.array(1.0), np.array(0.0))[[1, 0]]
        last = self.length[-1]
        curve = CubicSpline(np.log1p(self.length / LENGTH_BEND), self._stress_spline(opening), axis=-1)
        inside = np.minimum(length, last)
        excess = (
            curve(math.log1p(last / LENGTH_BEND)) * self._decrease(last, exponent) / last ** (exponent - 1)
            - sharp
        )
        beyond = np.maximum(length, last)
        return np.where(
            length > last,
            beyond ** (exponent - 1) * (sharp[:, None] + excess[:, None] * last / beyond),
            curve(np.log1p(inside / LENGTH_BEND)) * self._decrease(inside, exponent),
        )


def read_v_notches(path: Path | str) -> VNotchTable:
    """Read a table of rounded notches and verify it.

    Raises
    ------
    DatabaseError
        When the file is missing, truncated, altered, or of another schema.
    """
    table = read_verified(path, SCHEMA, LAYOUT, "python -m precompute.v_notch")
    return VNotchTable(
        table["opening"].values,
        table["length"].values,
        np.log(table["release"].values),
        table["stress"].values,
        str(table.attrs["checksum"]),
    )


@lru_cache(maxsize=4)
def _v_notches(path: Path, _modified: float) -> VNotchTable:
    return read_v_notches(path)


def load_v_notches(path: Path | str | None = None) -> VNotchTable:
    """The shipped table of rounded notches or another one, read once.

    Raises
    ------
    DatabaseError
        When the file cannot be used.
    """
    path = Path(path) if path is not None else shipped("v_notches.nc")
    if not path.is_file():
        return read_v_notches(path)  # says what is wrong
    return _v_notches(path.resolve(), path.stat().st_mtime)
