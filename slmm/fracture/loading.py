"""How the crack tips of a finite element model are loaded (J, K_I, K_II on several contours), and where they run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr

from slmm import __version__
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

#: the smallest domain around a tip: in edges of the elements there, and as a share of what is clear
FEWEST_EDGES, SMALLEST = 4, 0.1

#: of the direction in which a crack runs on: from the release rate at a short kink, from J as it is, from the largest
#: tangential stress, from the least density of strain energy
CRITERIA = ("MERR", "J", "MTS", "MSED")

#: contours that differ by more than this, or G that is further off K^2/E', are no answer: round-off and meshes of four
#: edges from tip to contour leave 3 % at most (chosen)
AGREE = 0.05
#: contours that differ by less than this share of the energy around the tip, over the radius, agree on nothing
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

#: (dimensions, units, long name) of the result
_VARIABLES = {
    "x": (("tip",), "mm", "place of the crack tip"),
    "y": (("tip",), "mm", "place of the crack tip"),
    "angle": (("tip",), "degree", "direction in which the crack points, from the x axis"),
    "radius": (("tip", "contour"), "mm", "radius of the domain of a contour"),
    "J_x": (("tip", "contour"), "N/mm", "J, component along x"),
    "J_y": (("tip", "contour"), "N/mm", "J, component along y"),
    "G": (("tip",), "N/mm", "energy release rate of growth straight on, median of the contours"),
    "spread": (("tip",), "1", "largest less least of that on the contours, over its median"),
    "J_across": (("tip",), "N/mm", "J left of the crack's direction, median of the contours"),
    "K_I": (("tip",), "MPa sqrt(mm)", "stress intensity of mode I, median of the contours"),
    "K_II": (("tip",), "MPa sqrt(mm)", "stress intensity of mode II, median of the contours"),
    "kink": (
        ("tip", "criterion"),
        "degree",
        "angle from the crack's direction to that in which it would run on",
    ),
}


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
    sizes = {"tip": len(own), "contour": contours, "criterion": len(CRITERIA)}
    values = {name: np.full([sizes[d] for d in dims], np.nan) for name, (dims, _, _) in _VARIABLES.items()}
    # J is of the strains of the model, K of small ones
    internal = (nodal_internal_forces(results), nodal_internal_forces(replace(results, method="linear")))
    status = [_fill(values, k, results, forces, internal, tip) for k, tip in enumerate(own)]
    data = {
        name: (dims, values[name], {"units": units, "long_name": text})
        for name, (dims, units, text) in _VARIABLES.items()
    }
    words = np.array(status, dtype=object)
    return xr.Dataset(
        {**data, "status": ("tip", words, {"units": "1", "long_name": "whether all is known, or why not"})},
        coords={"criterion": list(CRITERIA)},
        attrs={
            "version": __version__,
            "stresses": results.source,
            "method": results.method,
            "symmetry": ", ".join(symmetry),
            "remark": _remark(results, len(own)),
        },
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


def _fill(
    values: dict[str, np.ndarray],
    k: int,
    results: ElementResults,
    forces: np.ndarray,
    internal: tuple[np.ndarray, np.ndarray],
    tip: CrackTip,
) -> str:
    """Put what is known of one tip into its places; what is not known, and why."""
    values["x"][k], values["y"][k] = tip.position
    values["angle"][k] = np.degrees(tip.angle)
    edge = float(np.linalg.norm(results.points[tip.upper[0, 1]] - tip.position))
    if tip.clear < FEWEST_EDGES * edge * (1 - 1e-9):
        return TOO_COARSE.format(FEWEST_EDGES)
    smallest = max(SMALLEST * tip.clear, FEWEST_EDGES * edge)
    radii = np.geomspace(smallest, tip.clear, values["radius"].shape[1])
    elasticity = _elasticity_at(results, tip)
    faces = loaded_faces(results, tip, internal[0])
    J = np.array([j_vector(results, forces, tip, radius, elasticity, faces) for radius in radii])
    values["radius"][k] = radii
    values["J_x"][k], values["J_y"][k] = (J @ tip.axes).T
    G, J_across = np.median(J, axis=0)
    values["G"][k], values["J_across"][k] = G, J_across
    values["spread"][k] = np.ptp(J[:, 0]) / abs(G) if G else np.nan
    noise = RESOLVED * _energy_within(results, tip, radii[-1]) / radii[-1]
    if elasticity is None:
        return "; ".join([*_disagreement(J, None, np.nan, noise), NO_ELASTICITY])
    strained = faces if results.method == "linear" else loaded_faces(results, tip, internal[1])
    K = np.array([stress_intensities(results, tip, radius, elasticity, strained) for radius in radii])
    K_I, K_II = (float(x) for x in np.median(K, axis=0))
    values["K_I"][k], values["K_II"][k] = K_I, K_II
    says = _disagreement(J, K, elasticity.E_prime, noise)
    if K_I < 0:
        return "; ".join([*says, CLOSED])
    kinks = {
        "MERR": partial(maximum_energy_release_rate, K_I, K_II),
        "J": partial(energy_release_direction, np.array([G, J_across])),
        "MTS": partial(maximum_tangential_stress, K_I, K_II),
        "MSED": partial(minimum_strain_energy_density, K_I, K_II, elasticity),
    }
    for place, name in enumerate(CRITERIA):
        try:
            values["kink"][k, place] = np.degrees(kinks[name]())
        except ValueError as error:  # a criterion without an answer here, as MSED in mode I for nu <= 0
            says.append(f"no direction by {name}: {error}")
    return "; ".join(says) or OK


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
