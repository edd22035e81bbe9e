"""Tips of a part's cracks in a body-fitted model, and K_I and K_II there, with what closed faces do to them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.fem.plate_model import PlateModel
from slmm.fracture.contour_integrals import stress_intensities
from slmm.fracture.face_traction import loaded_faces
from slmm.fracture.fem_mesh import clear_radii
from slmm.fracture.t_stress import t_stress
from slmm.fracture.tips import CrackTip
from slmm.part.crack import TIP
from slmm.part.part import Part

Array = NDArray[np.float64]

#: start, end and middle of edges outwards from a tip, by whether that is the crack's end; how edges are kept
OUTWARDS = ([0, 2, 1], [2, 0, 1])


def tips_in(model: PlateModel, part: Part) -> list[CrackTip]:
    """The tips of a part's cracks in a model of it, with their straight faces as far as all is clear."""
    found = []
    for crack, edges in zip(part.cracks, model.faces, strict=True):
        for at_end in [end for end, kind in ((False, crack.start), (True, crack.end)) if kind == TIP]:
            outwards = (edges[::-1] if at_end else edges)[:, OUTWARDS[at_end]]
            line = crack.points if at_end else crack.points[::-1]
            x, y = line[-1] - line[-2]
            # the left face is the upper one of the way to the crack's end, and the lower one of the way back
            upper, lower = outwards[..., int(at_end)], outwards[..., int(not at_end)]
            found.append(CrackTip(line[-1], float(np.arctan2(y, x)), upper[0, :1], upper, lower, 0.0))
    return [_clear(tip, radius, model.points) for tip, radius in zip(found, clear_radii(part), strict=True)]


def _clear(tip: CrackTip, radius: float, points: Array) -> CrackTip:
    """The tip with the edges that begin in what is clear."""
    near = np.linalg.norm(points[tip.upper[:, 0]] - tip.position, axis=1) < (1 - 1e-9) * radius
    return CrackTip(tip.position, tip.angle, tip.nodes, tip.upper[near], tip.lower[near], float(radius))


def tip_stress_intensities(model: PlateModel, part: Part) -> Array:
    """K_I and K_II (k, 2) of the tips of a part, MPa sqrt(mm), by the interaction integral over all that is clear.

    The pressure between closed faces counts in it. Where faces hold each other up to the tip, there is no K_I.

    Parameters
    ----------
    model : PlateModel
        Of the part.
    part : Part
    """
    (elasticity,) = model.results.elasticity
    held = model.pairs.nodes[model.touching]
    K = np.empty((len(part.tips), 2))
    for k, tip in enumerate(tips_in(model, part)):
        faces = None
        if np.isin(tip.upper, held).any():
            faces = loaded_faces(model.results, tip, model.thickness * model.internal_forces)
        K[k] = stress_intensities(model.results, tip, tip.clear, elasticity, faces)
        # beside a singularity nodes of closed faces may be apart by what elements do not resolve
        if np.isin(tip.upper[0], held).any():
            K[k, 0] = 0.0
    return K


def tip_t_stresses(model: PlateModel, part: Part) -> Array:
    """T (k,) of the tips of a part, MPa; parameters as of `tip_stress_intensities`.

    Raises
    ------
    ValueError
        When faces hold each other beside a tip: what their pressure adds to T is not known here.
    """
    (elasticity,) = model.results.elasticity
    held = model.pairs.nodes[model.touching]
    tips = tips_in(model, part)
    for tip in tips:
        if np.isin(tip.upper, held).any():
            x, y = tip.position
            raise ValueError(
                f"the crack's faces hold each other beside its tip at ({x:.6g}, {y:.6g}) mm: T is not known there by "
                'finite elements; engine "boundary" knows it'
            )
    return np.array([t_stress(model.results, tip, tip.clear, elasticity) for tip in tips])
