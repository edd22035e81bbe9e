"""How the crack tips of a finite element model are loaded (J, K_I, K_II on several contours), and where they run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np
import xarray as xr

from slmm.fracture.configurational_forces import nodal_configurational_forces
from slmm.fracture.contour_integrals import j_vector, stress_intensities
from slmm.fracture.face_traction import loaded_faces
from slmm.fracture.kinking import (
    energy_release_direction,
    maximum_energy_release_rate,
    maximum_tangential_stress,
    minimum_strain_energy_density,
)
from slmm.fracture.symmetry import half_model_side, whole_part
from slmm.fracture.tips import CrackTip, find_crack_tips
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named
from slmm.results.internal_forces import nodal_internal_forces
from slmm.running.labelled import labelled

#: the smallest domain around a tip: in edges of the elements there, and as a share of what is clear; both chosen
FEWEST_EDGES, SMALLEST = 4, 0.1

#: of the direction in which a crack runs on: from the release rate at a short kink, from J as it is, from the largest
#: tangential stress, from the least density of strain energy
CRITERIA = ("MERR", "J", "MTS", "MSED")

#: contours that differ by more than this, or G that is further off K^2/E', are no answer: round-off and meshes of four
#: edges from tip to contour leave 3 % at most (chosen)
AGREE = 0.05
#: contours that differ by less than this share of the energy around the tip, over the radius, agree on nothing; chosen
RESOLVED = 1e-3

OK = "ok"
NO_TIP = (
    "No crack tip: nowhere inside the material do two faces of the boundary end that are straight and no farther apart "
    "than 1 % of their length. Of a half or quarter model, --symmetry x or y finds the tip on its line of symmetry; "
    "--tip X,Y names one, as of a narrow notch."
)
DIFFER = (
    "contours differ by {:.2g} %: body forces, thermal strains, a tip too near an edge or a mesh too coarse?"
)
UNLOADED = "hardly loaded: G is below what the contours resolve"
OFF_IRWIN = (
    "G is {:.2g} % off K^2/E': not linear elastic, another elasticity than is given, or a mesh too coarse?"
)
NO_ELASTICITY = "no linear elasticity is known here: K_I, K_II, kinks and J across the crack need it"
TOO_COARSE = "fewer than {} edges of elements between the tip and what lies next to it: mesh too coarse"
CLOSED = "K_I is negative: the faces would overlap"


class Known(NamedTuple):
    """How a value of a tip stands in the result: dimensions besides the tip, units and name."""

    dims: tuple[str, ...]
    units: str
    long_name: str


@dataclass
class TipLoading:
    """What is known of one crack tip; NaN where it is not, and ``status`` says why."""

    x: Annotated[float, Known((), "mm", "place of the crack tip")]
    y: Annotated[float, Known((), "mm", "place of the crack tip")]
    angle: Annotated[float, Known((), "degree", "direction in which the crack points, from the x axis")]
    radius: Annotated[np.ndarray, Known(("contour",), "mm", "radius of the domain of a contour")]
    J_x: Annotated[np.ndarray, Known(("contour",), "N/mm", "J, component along x")]
    J_y: Annotated[np.ndarray, Known(("contour",), "N/mm", "J, component along y")]
    G: Annotated[
        float, Known((), "N/mm", "energy release rate of growth straight on, median of the contours")
    ]
    spread: Annotated[float, Known((), "1", "largest less least of that on the contours, over its median")]
    J_across: Annotated[float, Known((), "N/mm", "J left of the crack's direction, median of the contours")]
    K_I: Annotated[float, Known((), "MPa sqrt(mm)", "stress intensity of mode I, median of the contours")]
    K_II: Annotated[float, Known((), "MPa sqrt(mm)", "stress intensity of mode II, median of the contours")]
    kink: Annotated[
        np.ndarray,
        Known(("criterion",), "degree", "angle from the crack's direction to that in which it would run on"),
    ]
    status: Annotated[str, Known((), "1", "whether all is known, or why not")]

    @classmethod
    def at(cls, tip: CrackTip, contours: int) -> TipLoading:
        """A tip of which nothing is known but its place."""
        size = {"contour": contours, "criterion": len(CRITERIA)}
        values: dict[str, Any] = {
            name: np.full([size[d] for d in known.dims], np.nan) for name, known in described().items()
        }
        x, y = (float(place) for place in tip.position)
        return cls(**values | {"x": x, "y": y, "angle": float(np.degrees(tip.angle)), "status": OK})


def described() -> dict[str, Known]:
    """How each value of a tip stands in the result."""
    hints = get_type_hints(TipLoading, include_extras=True)
    return {name: hint.__metadata__[0] for name, hint in hints.items()}


def as_dataset(tips: Sequence[TipLoading], contours: int) -> xr.Dataset:
    """The loading of some tips, with dimensions tip, contour and criterion."""
    size = {"contour": contours, "criterion": len(CRITERIA)}
    data = {}
    for name, known in described().items():
        shape = (len(tips), *(size[d] for d in known.dims))
        values = np.empty(shape, dtype=object if name == "status" else float)
        for k, tip in enumerate(tips):
            values[k] = getattr(tip, name)
        data[name] = (("tip", *known.dims), values, known.units, known.long_name)
    return labelled(data).assign_coords(criterion=list(CRITERIA))


def crack_tip_loading(
    results: ElementResults,
    contours: int = 5,
    forces: np.ndarray | None = None,
    symmetry: Sequence[str] = (),
    tips: Sequence[Sequence[float]] = (),
) -> xr.Dataset:
    """What drives each crack tip of a plane model, and where it would run.

    Tips are found in the mesh: where the boundary turns back and its two faces run on side by side, no farther apart
    than 1 % of their length (`slmm.fracture.tips`). The contours' radii grow to what is clear around the tip; that they
    agree is the check of path independence.

    Parameters
    ----------
    results : ElementResults
        Of a plane model. What acts on the faces of its cracks is taken from the internal forces of their nodes.
    contours : int
        Number of domains around each tip.
    forces : ndarray (n, 2), optional
        Nodal configurational forces, N, where they are known already; with symmetry those of the whole part.
    symmetry : sequence of str
        Lines of symmetry of a half or quarter model, as in `slmm.fracture.symmetry.whole_part`: "y" where u_y = 0.
        G, J, K and the contours are then those of the whole part, at the tips that the model has itself.
    tips : sequence of (x, y) or (x, y, angle)
        Places of tips that are not found by themselves, as in `slmm.fracture.tips.find_crack_tips`.

    Returns
    -------
    xarray.Dataset
        Dimensions tip, contour, criterion: x, y, angle, radius, J_x, J_y, G, spread, J_across, K_I, K_II, kink,
        status. Missing values are NaN, and status says why. The criteria: MERR, the release rate at the tip of a
        short kink (Amestoy and Leblond); J, the direction of J (thesis 3.2.4.2), good for K_II below a tenth of K_I;
        MTS, the largest tangential stress (Eq. 3.7); MSED, the least density of strain energy. The attribute
        ``remark`` says what would find more tips.

    Raises
    ------
    ValueError
        For a model in space, less than one contour, a line that is none of symmetry, a place that is no tip.

    Examples
    --------
    >>> from slmm.results.read_results import read_element_results
    >>> loading = crack_tip_loading(read_element_results("tests/data/edge_crack_2d.frd"))
    >>> loading.sizes["tip"], loading.x.values.tolist(), bool(loading.spread.max() < 0.01)
    (1, [20.0], True)
    """
    if results.dimension != 2:
        raise ValueError(
            "crack tips are looked for in plane models: of a model in space, sum the nodal forces"
        )
    if contours < 1:
        raise ValueError(f"contours = {contours}: must be 1 at least")
    given = len(results.points)
    results = whole_part(results, symmetry)
    if forces is None:
        forces = nodal_configurational_forces(
            results.points, results.cells, results.u, results.stress, results.energy, results.method,
            results.thickness,
        )  # fmt: skip
    found = find_crack_tips(results.points, results.cells, results.region, tips)
    # those of an image say the same again
    own = [tip for tip in found if tip.nodes.min() < given]
    # J is of the strains of the model, K of small ones
    internal = (nodal_internal_forces(results), nodal_internal_forces(replace(results, method="linear")))
    known = [tip_loading(results, forces, internal, tip, contours) for tip in own]
    return as_dataset(known, contours).assign_attrs(
        stresses=results.source,
        method=results.method,
        symmetry=", ".join(symmetry),
        remark=_remark(results, len(own)),
    )


def _remark(results: ElementResults, tips: int) -> str:
    """What would find more crack tips than there are, in words; empty when there is nothing to say."""
    line = half_model_side(results)
    half = (
        f"It looks like a half model: --symmetry {line} gives the tip on its line of symmetry."
        if line
        else ""
    )
    return half if tips else f"{NO_TIP} {half}".strip()


def tip_loading(
    results: ElementResults,
    forces: np.ndarray,
    internal: tuple[np.ndarray, np.ndarray],
    tip: CrackTip,
    contours: int,
) -> TipLoading:
    """What is known of one tip; what is not known, and why.

    Parameters
    ----------
    results : ElementResults
    forces : ndarray (n, 2)
        Nodal configurational forces, N.
    internal : (ndarray (n, 2), ndarray (n, 2))
        Nodal internal forces, N, with the model's strains and with small ones.
    tip : CrackTip
    contours : int
        Number of domains around it.
    """
    known = TipLoading.at(tip, contours)
    edge = float(np.linalg.norm(results.points[tip.upper[0, 1]] - tip.position))
    if tip.clear < FEWEST_EDGES * edge * (1 - 1e-9):
        known.status = TOO_COARSE.format(FEWEST_EDGES)
        return known
    smallest = max(SMALLEST * tip.clear, FEWEST_EDGES * edge)
    known.radius = radii = np.geomspace(smallest, tip.clear, contours)
    elasticity = _elasticity_at(results, tip)
    faces = loaded_faces(results, tip, internal[0])
    J = np.array([j_vector(results, forces, tip, radius, elasticity, faces) for radius in radii])
    known.J_x, known.J_y = (J @ tip.axes).T
    known.G, known.J_across = (float(j) for j in np.median(J, axis=0))
    known.spread = float(np.ptp(J[:, 0]) / abs(known.G)) if known.G else np.nan
    noise = RESOLVED * _energy_within(results, tip, radii[-1]) / radii[-1]
    if elasticity is None:
        known.status = "; ".join([*_disagreement(J, None, np.nan, noise), NO_ELASTICITY])
        return known
    strained = faces if results.method == "linear" else loaded_faces(results, tip, internal[1])
    K = np.array([stress_intensities(results, tip, radius, elasticity, strained) for radius in radii])
    K_I, K_II = (float(x) for x in np.median(K, axis=0))
    known.K_I, known.K_II = K_I, K_II
    says = _disagreement(J, K, elasticity.E_prime, noise)
    if K_I < 0:
        known.status = "; ".join([*says, CLOSED])
        return known
    kinks = {
        "MERR": partial(maximum_energy_release_rate, K_I, K_II),
        "J": partial(energy_release_direction, np.array([known.G, known.J_across])),
        "MTS": partial(maximum_tangential_stress, K_I, K_II),
        "MSED": partial(minimum_strain_energy_density, K_I, K_II, elasticity),
    }
    for place, name in enumerate(CRITERIA):
        try:
            known.kink[place] = np.degrees(kinks[name]())
        except ValueError as error:  # a criterion without an answer here, as MSED in mode I for nu <= 0
            says.append(f"no direction by {name}: {error}")
    known.status = "; ".join(says) or OK
    return known


def _disagreement(J: np.ndarray, K: np.ndarray | None, E_prime: float, noise: float) -> list[str]:
    """What J (c, 2) and K (c, 2) on the contours say against each other, in words."""
    size = abs(np.median(J[:, 0]))
    apart = np.ptp(J[:, 0])
    if K is not None:
        # of the release rate that K stands for
        irwin = np.median(K, axis=0) @ np.median(K, axis=0) / E_prime
        apart = max(apart, 2 * np.ptp(K, axis=0).max() * np.sqrt(irwin / E_prime))
        size = max(size, irwin)
    if apart > AGREE * size:
        return [UNLOADED if apart <= noise else DIFFER.format(100 * apart / size)]
    if K is not None and abs(np.median(J[:, 0]) - irwin) > AGREE * size:
        return [UNLOADED if size <= noise else OFF_IRWIN.format(100 * abs(np.median(J[:, 0]) / irwin - 1))]
    return []


def _energy_within(results: ElementResults, tip: CrackTip, radius: float) -> float:
    """Energy of the elements within a radius of a tip, per thickness, N."""
    total = 0.0
    for name, nodes in results.cells.items():
        X = results.points[nodes]
        here = np.linalg.norm(X - tip.position, axis=-1).min(axis=1) < radius
        element = element_named(name)
        volume = np.linalg.det(np.einsum("eni,pnj->epij", X[here], element.gradient_at_points))
        total += float(np.sum(results.energy[name][here] * volume * element.weights))
    return total


def _elasticity_at(results: ElementResults, tip: CrackTip) -> Elasticity | None:
    """Of the material that the tip lies in, if it is known."""
    if not results.elasticity:
        return None
    for name, nodes in results.cells.items():
        touching = np.isin(nodes, tip.nodes).any(axis=1)
        if touching.any():
            return results.elasticity[int(results.region[name][touching][0])]
    return None
