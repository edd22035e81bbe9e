"""What a sweep covers: axes of the database, modes, fineness of the meshes."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from precompute.grading import Fineness
from precompute.modes import Mode, complete_modes, published_modes
from slmm.running.input_file import shown
from slmm.scene.errors import problems_of
from slmm.scene.toml_file import read_toml

#: Effective Poisson's ratios that the default database spans: plane stress from -0.9, plane strain to 0.4949.
POISSON_RANGE = (-0.9, 0.98)


#: c' of Paper A, 1/mm
PUBLISHED_CURVATURES = tuple(round(-1 + 0.1 * i, 10) for i in range(16))


def poisson_nodes(n: int, low: float = POISSON_RANGE[0], high: float = POISSON_RANGE[1]) -> list[float]:
    """Chebyshev points in atanh(nu), half the logarithm of the ratio of bulk to shear stiffness.

    A compliance is analytic in that ratio except where it is negative, so these points converge
    geometrically up to both ends, which points in nu itself do not.

    Examples
    --------
    >>> [round(nu, 2) for nu in poisson_nodes(3, -0.5, 0.5)]
    [-0.5, 0.0, 0.5]
    """
    x = np.sin(np.pi / 2 * np.linspace(-1, 1, n))
    a, b = np.arctanh(low), np.arctanh(high)
    nodes = np.tanh(a + (b - a) * (x + 1) / 2)
    nodes[[0, -1]] = low, high
    return [round(float(nu), 12) + 0.0 for nu in nodes]


class SweepSpec(BaseModel):
    """The sweep, as a TOML file may give it; every key has the default database's value."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str = "Crack cells for all Poisson's ratios"
    #: c', 1/mm, ascending: the 16 of Paper A, section 2.3.4, and four more that tame the spline at its ends
    curvature: tuple[float, ...] = tuple(sorted([-0.975, -0.94, 0.44, 0.475, *PUBLISHED_CURVATURES]))
    #: effective Poisson's ratio: nu in plane stress, nu/(1 - nu) in plane strain
    poisson: tuple[float, ...] = tuple(poisson_nodes(13))
    #: a', mm, ascending, at most 1 mm; dense towards the surface
    crack_length: tuple[float, ...] = tuple(np.geomspace(0.02, 1.0, 12).round(6).tolist())
    #: "published": the 16 of Paper A, Eq. 5; a number: all polynomials up to that degree
    modes: int | str = 4
    #: Legendre polynomials of the crack-face tractions
    orders: int = Field(default=8, ge=2, le=16)
    #: points of the path stress, Chebyshev-spaced over 0 <= eta' <= 1
    path_points: int = Field(default=17, ge=8, le=65)
    tip: float = Field(default=0.002, gt=0, le=0.1)
    growth: float = Field(default=1.3, gt=1, le=4)
    coarsest: float = Field(default=0.08, gt=0, le=0.5)

    @field_validator("curvature", "poisson", "crack_length")
    @classmethod
    def _ascending(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if len(values) == 0 or not np.all(np.isfinite(values)) or np.any(np.diff(values) <= 0):
            raise ValueError("must be finite numbers in ascending order")
        return values

    @field_validator("curvature")
    @classmethod
    def _curvature(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] < -1 or values[-1] > 0.5:
            raise ValueError("curvatures must lie between -1 and 0.5 per mm (Paper A, Table 1)")
        return values

    @field_validator("poisson")
    @classmethod
    def _poisson(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] <= -1 or values[-1] >= 1:
            raise ValueError("effective Poisson's ratios must lie between -1 and 1")
        return values

    @field_validator("crack_length")
    @classmethod
    def _crack_length(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if len(values) < 4 or values[0] <= 0 or values[-1] > 1:
            raise ValueError("give at least 4 crack lengths above 0 and up to 1 mm")
        return values

    @field_validator("modes")
    @classmethod
    def _modes(cls, value: int | str) -> int | str:
        if value != "published" and value not in range(2, 9):
            raise ValueError("must be 'published' or a degree from 2 to 8")
        return value

    @property
    def mode_list(self) -> list[Mode]:
        """The deformation modes."""
        return published_modes() if self.modes == "published" else complete_modes(int(self.modes))

    @property
    def fineness(self) -> Fineness:
        """Of the meshes."""
        return Fineness(self.tip, self.growth, self.coarsest)

    @property
    def eta(self) -> np.ndarray:
        """Points of the path stress, mm."""
        return 0.5 - 0.5 * np.cos(np.pi * np.arange(self.path_points) / (self.path_points - 1))

    @property
    def fingerprint(self) -> str:
        """Changes with every setting that changes a result."""
        from slmm import __version__

        settings = self.model_dump(exclude={"title"}) | {"version": __version__}
        return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:16]


def read_spec(path: Path) -> SweepSpec:
    """Read a sweep from a TOML file; raises ValueError that names what is wrong."""
    try:
        return SweepSpec.model_validate(read_toml(path))
    except ValidationError as error:
        raise ValueError(
            f"{shown(path)}: {'; '.join(problems_of(error, {(): [*SweepSpec.model_fields]}))}"
        ) from error
    except ValueError as error:
        raise ValueError(f"{shown(path)}: {error}") from error
