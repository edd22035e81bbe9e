"""Table of rounded V-notches for matched asymptotics (thesis section 3.3.4.3), by finite elements.

Near a rounded V-notch that is small in its part, the part is an unbounded body loaded by the first symmetric term of
Williams' series of the sharp notch. What then depends on the opening angle and the distance over the root's size only
is solved once here: the stress on the bisector and the energy that a crack on it releases. Lengths are measured in
half widths of the root, radius cos(opening/2), the distance of the tangent points from the bisector: in this unit
everything is smooth up to the straight edge, where the arc shrinks to a point.

Sharp notches are solved on meshes of the same kind. Their release coefficient is known exactly
(`slmm.mechanics.williams.release_coefficient`); stored in the table, theirs shows how good the meshes are.

Element sizes grow in proportion to the distance from the notch, so that every element end on the bisector is the tip
of a crack in a mesh that is fine for its length. The energy at a tip is then wrong by a fixed share of an element and
is extrapolated from two meshes.
"""

from __future__ import annotations

import json
import math
import platform
import shlex
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import scipy
import skfem
import typer
import xarray as xr
from numpy.polynomial.chebyshev import chebfit, chebval

from precompute.half_body import HalfBody
from precompute.store import rounded
from slmm import __version__
from slmm.command.terminal import Application, check_target, console, progress_bar, refusals
from slmm.initiation.v_notch_table import LAYOUT, SCHEMA
from slmm.mechanics.crack_line import crack_factor
from slmm.mechanics.williams import half_angle, release_coefficient, singular_exponent, williams_fields
from slmm.running.model_file import checksum
from slmm.running.whole_file import whole_file

#: Poisson's ratio of the models; no result depends on it
NU = 0.3

#: the path stress is fitted by a polynomial of this degree in ln(1 + eta/BEND)
PATH_DEGREE, BEND = 24, 0.3

#: the first crack tip lies at this fraction of the shortest length that is kept
FIRST_TIP = 0.03

DEFAULT_OUTPUT = Path("models/v_notches.nc")


@dataclass(frozen=True)
class NotchSpec:
    """Settings of the table. The unit of length is the root's half width, at a sharp notch the crack length.

    Attributes
    ----------
    openings : tuple of float
        Opening angles below 180 degrees, ascending.
    shortest, longest : float
        Crack lengths that are kept.
    step : float
        Size of an element over its distance from the notch; the second mesh has half of it.
    coarse : float
        Factor on ``step`` away from the bisector and from the crack lengths that are kept.
    near, far : float
        Radius of the hole that stands for a sharp tip, and of the outer boundary.
    """

    openings: tuple[float, ...] = tuple(float(angle) for angle in range(0, 180, 10))
    shortest: float = 0.01
    longest: float = 100.0
    step: float = 0.075
    coarse: float = 3.0
    near: float = 1e-5
    far: float = 1e6


def divide(end: float, size: Callable[[float], float]) -> np.ndarray:
    """Ends of elements on [0, end] whose size depends on where they start.

    Examples
    --------
    >>> divide(7.0, lambda x: 1.0 + x)
    array([0., 1., 3., 7.])
    """
    ends = [0.0]
    while ends[-1] < end * (1 - 1e-9):
        ends.append(ends[-1] + size(ends[-1]))
    return np.array(ends) * (end / ends[-1])


def halved(ends: np.ndarray) -> np.ndarray:
    """Ends when every element is divided in the middle.

    Examples
    --------
    >>> halved(np.array([0.0, 1.0, 3.0]))
    array([0. , 0.5, 1. , 2. , 3. ])
    """
    return np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))


def sharp_body(opening: float, spec: NotchSpec, fine: bool) -> tuple[HalfBody, int]:
    """Half of a sharp notch and the index of the element end at r = 1 on its bisector.

    The square's coordinates are the angle from the bisector and ln(r/near).
    """
    wide = spec.coarse * spec.step
    inner, outer = (divide(math.log(r), lambda _: wide) for r in (1 / spec.near, spec.far))
    middle = np.arange(-20, 21) * spec.step  # fine elements for the crack tip at r = 1
    along = np.concatenate([-inner[inner > 20 * spec.step][::-1], middle, outer[outer > 20 * spec.step]])
    across = divide(half_angle(opening), lambda theta: min(spec.step * (1 + theta), wide))
    if fine:
        along, across = halved(along), halved(across)
    tip = int(np.argmin(np.abs(along)))
    depth = along - along[0]

    def place(theta, x):
        r = spec.near * np.exp(x)
        return r * np.sin(theta), r * np.cos(theta)

    return HalfBody(across, depth, place, lambda _, x, __: x > depth[-1] - 1e-9), tip


def rounded_body(opening: float, spec: NotchSpec, fine: bool) -> tuple[HalfBody, np.ndarray]:
    """Half of a notch with a root of half width 1, and the crack tips on its bisector.

    The square's coordinates are the share q of the arc from the bisector to the tangent point and
    x = ln(1 + eta/eta_0). Lines of constant x are circles about the root's centre, r = radius + eta; on them q runs
    from the bisector to the straight flank, which ends at the angle arc + arccos(radius/r).

    Returns
    -------
    HalfBody
    ndarray
        Distances eta of the element ends from the root, up to the longest length kept.
    """
    radius, arc = 1 / math.cos(0.5 * opening), 0.5 * (math.pi - opening)
    eta_0 = FIRST_TIP * spec.shortest / spec.step
    longest, end = (math.log1p(eta / eta_0) for eta in (spec.longest, spec.far))
    wide = spec.coarse * spec.step
    kept = divide(longest, lambda _: spec.step)
    along = np.concatenate([kept[:-1], longest + divide(end - longest, lambda _: wide)])
    # across the bisector sizes grow likewise, until the angle that they span far away is the limit
    width = radius * arc
    across = divide(
        1.0,
        lambda q: min(spec.step * (q + eta_0 / width), wide / (arc + math.pi * q)),
    )
    if fine:
        kept, along, across = halved(kept), halved(along), halved(across)

    def place(q, x):
        r = radius + eta_0 * np.expm1(x)
        angle = arc * q + np.arccos(radius / r) * q**2
        return r * np.sin(angle), r * np.cos(angle) - radius

    body = HalfBody(across, along, place, lambda _, x, __: x > along[-1] - 1e-9)
    return body, eta_0 * np.expm1(kept)


def released_energy(
    body: HalfBody, opening: float, origin: float, symmetric: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Energy released by a crack on the bisector under the first Williams term, E = 1 MPa, thickness 1 mm.

    Parameters
    ----------
    body : HalfBody
        Half of the notch.
    opening : float
        Opening angle, radians.
    origin : float
        eta of the tip that the prescribed displacements belong to, mm.
    symmetric : bool
        Which of the two fields; its amplitude is 1.

    Returns
    -------
    energy : ndarray
        Both halves, N mm; entry j with the tip at the j-th element end.
    u : ndarray
        Displacements without a crack, mm.
    """
    direction = 0 if symmetric else 1
    field = williams_fields(opening, symmetric, 1)[0]
    dofs = np.flatnonzero(body.held)
    xi, eta = body.where[0, dofs], body.where[1, dofs] - origin
    along, across = field.displacement(np.hypot(xi, eta), np.arctan2(xi, eta), 1.0, NU)
    K = body.stiffness(NU)
    u = np.zeros(len(body.free))
    u[dofs] = np.where(body.direction[dofs] == 0, across, along)

    open_body = body.factorise(K)
    u_free = -open_body.solve((K @ u)[body.free][:, None])
    line = body.line[direction]
    S = open_body.line_stiffness(direction)
    closing = np.zeros_like(u_free)
    closing[line] = -S @ u_free[line]
    y = crack_factor(S, closing[line])[:, 0]
    u[body.free] = (u_free + open_body.solve(closing))[:, 0]
    energy = np.concatenate([[0.0], np.cumsum(y**2)])  # 1/2 y^2 in each half
    return energy[::2], u  # the tip at an element end: nodes before it, those in the middle of elements too


def extrapolated(coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Value for vanishing element size, from two sizes of ratio 2 and an error linear in the size."""
    return 2 * fine - coarse


def sharp_release(opening: float, symmetric: bool, spec: NotchSpec) -> float:
    """Release coefficient E' B of a sharp notch by finite elements."""
    energy = []
    for fine in (False, True):
        body, tip = sharp_body(opening, spec, fine)
        energy.append(released_energy(body, opening, 0.0, symmetric)[0][tip])
    return float(extrapolated(*energy))


def rounded_notch(opening: float, spec: NotchSpec) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stress and energy at one opening angle, for k_1 = 1, E = 1 MPa and a root of half width 1.

    Returns
    -------
    length : ndarray (n,)
        0 and the crack lengths from shortest to longest, mm.
    release : ndarray (n,)
        G_inc over the length, N/mm2; at 0 its limit, that of a straight edge under the stress of the root.
    stress : ndarray (2, n)
        Stress across the bisector and along it at these distances, MPa.
    """
    # far away the root is a point: the sharp tip where flanks meet, Creager's origin where they are parallel
    radius = 1 / math.cos(0.5 * opening)
    origin = radius / math.sin(0.5 * opening) - radius if opening > 0 else -0.5 * radius
    energies = []
    for fine in (False, True):
        body, tips = rounded_body(opening, spec, fine)
        energy, u = released_energy(body, opening, origin, True)
        energies.append(energy[: len(tips)])
    length = tips[::2]
    keep = length > spec.shortest * (1 - 1e-9)
    a = length[keep]
    release = extrapolated(energies[0], energies[1][::2])[keep] / a**2
    distance = np.concatenate([[0.0], a])
    stress = bisector_stress(body, u, singular_exponent(opening), distance)
    root = release_coefficient(math.pi) * stress[0, 0] ** 2
    return distance, np.concatenate([[root], release]), stress


def bisector_stress(body: HalfBody, u: np.ndarray, exponent: float, distance: np.ndarray) -> np.ndarray:
    """Stress across and along the bisector, shape (2, len(distance)), MPa.

    Least-squares polynomial in ln(1 + eta/BEND) through the stress of the elements beside the bisector, freed of its
    decrease far away.
    """
    # the 2 x 2 integration points, where 8-node elements give their best stresses
    inner = 0.5 - math.sqrt(1 / 12)
    points = np.array([[inner, inner, 1 - inner, 1 - inner], [inner, 1 - inner, inner, 1 - inner]])
    strip = skfem.Basis(
        body.basis.mesh, body.basis.elem, elements=body.strip, quadrature=(points, np.full(4, 0.25))
    )
    gradient = strip.interpolate(u).grad
    strain = np.array([gradient[0, 0], gradient[1, 1]])
    stress = (strain + NU * strain[::-1]) / (1 - NU**2)
    eta = strip.global_coordinates()[1]
    near = eta < 2 * distance[-1]
    end = math.log1p(2 * distance[-1] / BEND)

    def on_unit_interval(eta):
        return 2 * np.log1p(eta / BEND) / end - 1

    growth = (1 + eta[near]) ** (1 - exponent)
    fit = chebfit(on_unit_interval(eta[near]), (growth * stress[:, near]).T, PATH_DEGREE)
    return chebval(on_unit_interval(distance), fit) / (1 + distance) ** (1 - exponent)


@dataclass(frozen=True)
class NotchResult:
    """What the table keeps of one opening angle, lengths over the root's half width.

    Attributes
    ----------
    length : ndarray (n,)
        0 and the crack lengths.
    release : ndarray (n,)
        E' G_inc/(k_1^2 l^(2 lambda_1 - 1)) over the length at the rounded notch.
    stress : ndarray (2, n)
        Stress across and along the bisector of the rounded notch over k_1 l^(lambda_1 - 1).
    sharp_release : tuple of float
        E' B of the sharp notch for either mode, NaN where its field is not singular.
    """

    length: np.ndarray
    release: np.ndarray
    stress: np.ndarray
    sharp_release: tuple[float, float]


def solve_notch(opening: float, spec: NotchSpec) -> NotchResult:
    """Rounded and sharp notch of one opening angle (radians)."""
    symmetric, antisymmetric = (
        sharp_release(opening, parity, spec) if singular_exponent(opening, parity) < 1 else math.nan
        for parity in (True, False)
    )
    return NotchResult(*rounded_notch(opening, spec), (symmetric, antisymmetric))


def straight_edge(length: np.ndarray) -> NotchResult:
    """The limit of an opening of 180 degrees in tension, in closed form."""
    edge = release_coefficient(math.pi)
    uniform = np.stack([np.ones_like(length), np.zeros_like(length)])
    return NotchResult(length, np.full_like(length, edge), uniform, (edge, math.nan))


def assemble(spec: NotchSpec, results: list[NotchResult]) -> xr.Dataset:
    """The table from the results of all opening angles, closed by the straight edge."""
    length = results[0].length
    results = [*results, straight_edge(length)]
    values = {
        "release": (
            [result.release for result in results],
            "1",
            "E' G_inc/(k_1^2 l^(2 lambda_1 - 1)) over a/l at a rounded notch",
        ),
        "stress": (
            [result.stress for result in results],
            "1",
            "stress on the bisector over k_1 l^(lambda_1 - 1) at a rounded notch",
        ),
        "sharp_release": (
            [result.sharp_release for result in results],
            "1",
            "E' B of a sharp notch on a mesh of the same kind, singular fields only",
        ),
    }
    coordinates = {
        "opening": (np.radians([*spec.openings, 180.0]), "rad", "opening angle"),
        "length": (length, "1", "crack length or distance from the root over l = radius cos(opening/2)"),
        "component": (["across", "along"], "1", "direction of the normal stress to the bisector"),
        "mode": (["symmetric", "antisymmetric"], "1", "mode of the far field"),
    }
    dataset = xr.Dataset(
        {
            # results are good to 1e-4; what lies beyond 24 bits is round-off
            name: (LAYOUT[name], rounded(np.array(array), 24), {"units": units, "long_name": long_name})
            for name, (array, units, long_name) in values.items()
        },
        coords={
            name: ((name,), array, {"units": units, "long_name": long_name})
            for name, (array, units, long_name) in coordinates.items()
        },
    )
    dataset.attrs = {
        "title": "Rounded V-notches under the first symmetric term of Williams' series",
        "schema": SCHEMA,
        "Conventions": "CF-1.8",
        "source": "precompute.v_notch: matched asymptotics, thesis section 3.3.4.3",
        "version": __version__,
        "command": shlex.join(["python", "-m", "precompute.v_notch", *sys.argv[1:]]),
        "settings": json.dumps(asdict(spec)),
        "mesh": f"structured 8-node quadrilaterals, 2 x 2 points; sizes {spec.step} and {spec.step / 2} of the "
        "distance, energies extrapolated",
        "solver": f"SuperLU of scipy {scipy.__version__}, assembled by scikit-fem {skfem.__version__}",
        "platform": f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}",
    }
    dataset.attrs["checksum"] = checksum(dataset)
    return dataset


def write(dataset: xr.Dataset, path: Path) -> None:
    """Write the file whole or not at all."""
    with whole_file(path) as unfinished:
        dataset.to_netcdf(
            unfinished, engine="netcdf4", encoding={name: {"zlib": True, "shuffle": True} for name in LAYOUT}
        )


app = Application(add_completion=False)


@app.command()
def v_notches(
    output: Annotated[Path, typer.Option("-o", "--output", help="The table to write.")] = DEFAULT_OUTPUT,
) -> None:
    """Solve rounded V-notches of all opening angles once and write them as a netCDF table."""
    with refusals():
        check_target(output, (".nc",), "-o")
        spec = NotchSpec()
        notches = []
        with progress_bar() as progress:
            for k, opening in enumerate(np.radians(spec.openings)):
                progress(k / len(spec.openings), f"V-notch {k + 1} of {len(spec.openings)}")
                notches.append(solve_notch(opening, spec))
        write(assemble(spec, notches), output)
        console().print(f"{output}: {output.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    app()
