"""Reference scenes that the README, the tests and the validation share.

Every function takes changes as `Scene.with_` does, e.g. ``circular_hole(material={"name": "PS"},
analysis={"method": "full-fea"})``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slmm.scene.scene import Scene


def circular_hole(radius: float = 20.0, size: float = 100.0, e_yy: float = 0.1, **changes: Any) -> Scene:
    """Square PMMA plate with a circular hole in its centre, stretched in y (Paper A, Fig. 13).

    Parameters
    ----------
    radius : float
        Radius of the hole, mm.
    size : float
        Side of the plate, mm.
    e_yy : float
        Strain in y; the displacement of all four edges is prescribed.
    **changes
        Changes to the scene, see `Scene.with_`.

    Examples
    --------
    >>> circular_hole(radius=5.0, analysis={"positions": 8}).analysis.positions
    8
    """
    hole = {"shape": "circle", "center": [size / 2, size / 2], "radius": radius}
    return _scene("Circular hole", size, [hole], (0.0, e_yy, 0.0), changes)


def elliptic_hole(e_yy: float = 0.1, **changes: Any) -> Scene:
    """PMMA plate, 100 mm x 100 mm, with an elliptic hole, 20 mm x 10 mm semi-axes, long across the load."""
    hole = {"shape": "ellipse", "center": [50.0, 50.0], "semi_axes": [20.0, 10.0]}
    return _scene("Elliptic hole", 100.0, [hole], (0.0, e_yy, 0.0), changes)


def rounded_square(e_yy: float = 0.1, **changes: Any) -> Scene:
    """PMMA plate, 100 mm x 100 mm, with a 30 mm x 30 mm hole whose corners have a radius of 6 mm."""
    hole = {"shape": "rectangle", "center": [50.0, 50.0], "size": [30.0, 30.0], "corner_radius": 6.0}
    return _scene("Rounded square", 100.0, [hole], (0.0, e_yy, 0.0), changes)


def square_hole(e_yy: float = 0.1, **changes: Any) -> Scene:
    """PMMA plate, 100 mm x 100 mm, with a 30 mm x 30 mm hole whose corners are sharp, its sides along the edges.

    Examples
    --------
    >>> square_hole().outlines[0].corners.round(6).tolist()
    [0.0, 30.0, 60.0, 90.0]
    """
    hole = {"shape": "rectangle", "center": [50.0, 50.0], "size": [30.0, 30.0], "corner_radius": 0.0}
    return _scene("Square hole", 100.0, [hole], (0.0, e_yy, 0.0), changes)


def two_holes(ligament: float = 2.0, e_yy: float = 0.1, **changes: Any) -> Scene:
    """PMMA plate, 100 mm x 100 mm, with two circular holes, 10 mm in radius, side by side across the load.

    Parameters
    ----------
    ligament : float
        Material between the holes at its thinnest, in the middle of the plate, mm.
    e_yy : float
        Strain in y; the displacement of all four edges is prescribed.
    **changes
        Changes to the scene, see `Scene.with_`.
    """
    radius = 10.0
    holes = [
        {"shape": "circle", "center": [50.0 + side * (radius + ligament / 2), 50.0], "radius": radius}
        for side in (-1, 1)
    ]
    title = f"Two holes, ligament of {ligament:g} mm"
    return _scene(title, 100.0, holes, (0.0, e_yy, 0.0), changes)


def lobed_notch(strain: Sequence[float] = (0.0, 0.1, 0.0), **changes: Any) -> Scene:
    """PMMA plate, 100 mm x 100 mm, with a smooth hole of several lobes and no symmetry.

    Its mean radius is 20 mm. The lobes have radii of curvature down to 5.8 mm; between them the outline bends
    into the hole with radii down to 4 mm.

    Parameters
    ----------
    strain : (3,) sequence of float
        e_xx, e_yy, gamma_xy.
    **changes
        Changes to the scene, see `Scene.with_`.
    """
    hole = {"shape": "points", "points": lobes(center=(50.0, 50.0), radius=20.0)}
    return _scene("Lobed notch", 100.0, [hole], tuple(strain), changes)


def sapora_plate(radius: float, **changes: Any) -> Scene:
    """PMMA plate with a small circular hole under uniform tension, after Sapora et al. (Paper A, Fig. 14).

    Published are the thickness of 10 mm, the radii from 0.25 mm to 2 mm and the material (plane strain,
    nu = 0.38). Width and height of the real specimens are not published in the thesis; 20 mm x 40 mm is
    our choice, wide enough for a hole of 2 mm. The load is a unit to scale from, 10 MPa.

    Parameters
    ----------
    radius : float
        Radius of the hole, mm.
    **changes
        Changes to the scene, see `Scene.with_`.
    """
    return Scene.from_dict(
        {
            "title": f"Sapora plate, r = {radius:g} mm",
            "plate": {"width": 20.0, "height": 40.0, "thickness": 10.0},
            "holes": [{"shape": "circle", "center": [10.0, 20.0], "radius": radius}],
            "material": {"E": 2960.0, "nu": 0.38, "sigma_c": 70.5, "K_Ic": 1.96, "state": "plane strain"},
            "load": {"stress": 10.0},
        }
    ).with_(**changes)


def v_notch(opening: float = 60.0, radius: float = 0.0, **changes: Any) -> Scene:
    """PMMA plate, 40 mm x 120 mm x 5 mm, with one V-notch in its left edge, under tension along the plate.

    The notch is 10 mm deep, at half height, and points across the load. The load is a unit to scale from, 10 MPa.

    Parameters
    ----------
    opening : float
        Angle between the flanks, degrees.
    radius : float
        Radius of the root, mm; 0 is a sharp tip. The depth is that of the surface at the root.
    **changes
        Changes to the scene, see `Scene.with_`.

    Examples
    --------
    >>> (outline,) = v_notch(opening=90.0).outlines
    >>> sharp = int(outline.corner_at(outline.project([[10.0, 60.0]]))[0])
    >>> round(float(np.degrees(outline.corner_angles[sharp])), 6)
    90.0
    """
    notch = {
        "shape": "v-notch",
        "tip": [10.0, 60.0],
        "direction": 0.0,
        "opening": opening,
        "radius": radius,
    }
    root = f"root radius {radius:g} mm" if radius else "sharp"
    return _tension(f"V-notch of {opening:g} degrees, {root}", {"holes": [notch]}, changes)


def edge_crack(length: float = 10.0, **changes: Any) -> Scene:
    """PMMA plate, 40 mm x 120 mm x 5 mm, with a straight crack from its left edge, under tension along the plate.

    It runs across the load at half height. The load is a unit to scale from, 10 MPa; pass
    ``load={"displacement": 0.1}`` to move the top edge instead.

    Parameters
    ----------
    length : float
        Length of the crack, mm.
    **changes
        Changes to the scene, see `Scene.with_`.

    Examples
    --------
    >>> edge_crack(5.0).cracks[0].points
    ((0.0, 60.0), (5.0, 60.0))
    """
    crack = {"points": [[0.0, 60.0], [length, 60.0]]}
    return _tension(f"Edge crack of {length:g} mm", {"cracks": [crack]}, changes)


def tensile_plate(
    holes: Sequence[tuple[float, ...]] = (), displacement: float = 1.0, **changes: Any
) -> Scene:
    """PMMA plate, 80 mm x 80 mm, with a crack of 10 mm from the middle of its left edge (Paper D, section 2.1).

    Its bottom edge is held in y, its top edge moves up as one.

    Parameters
    ----------
    holes : sequence of (x, y, radius) or (x, y, semi_axis, semi_axis, angle)
        Circles and ellipses, mm and degrees.
    displacement : float
        Of the top edge, mm; a unit to scale from.
    **changes
        Changes to the scene, see `Scene.with_`.

    Examples
    --------
    >>> [hole.shape for hole in tensile_plate([(40.0, 40.0, 8.0), (62.0, 45.0, 6.0, 4.0, 10.0)]).holes]
    ['circle', 'ellipse']
    """

    def table(x: float, y: float, *size: float) -> dict[str, Any]:
        if len(size) == 1:
            return {"shape": "circle", "center": [x, y], "radius": size[0]}
        a, b, angle = size
        return {"shape": "ellipse", "center": [x, y], "semi_axes": [a, b], "angle": angle}

    return Scene.from_dict(
        {
            "title": f"Tensile plate, {len(holes)} hole{'s' * (len(holes) != 1)}",
            "plate": {"width": 80.0, "height": 80.0, "thickness": 1.0},
            "holes": [table(*hole) for hole in holes],
            "cracks": [{"points": [[0.0, 40.0], [10.0, 40.0]]}],
            "material": {"E": 2960.0, "nu": 0.38, "sigma_c": 70.5, "K_Ic": 1.96, "state": "plane strain"},
            "load": {"displacement": displacement},
        }
    ).with_(**changes)


def lobes(center: tuple[float, float], radius: float, n: int = 360) -> list[list[float]]:
    """Points (n, 2), mm, on r(theta) = radius (1 + 0.1 cos 3 theta + 0.12 cos(5 theta + 0.5))."""
    theta = np.linspace(0.0, 2 * np.pi, n, endpoint=False)
    r = radius * (1 + 0.1 * np.cos(3 * theta) + 0.12 * np.cos(5 * theta + 0.5))
    points = np.column_stack([center[0] + r * np.cos(theta), center[1] + r * np.sin(theta)])
    return points.tolist()


def _scene(
    title: str,
    size: float,
    holes: list[dict[str, Any]],
    strain: tuple[float, ...],
    changes: dict[str, Any],
) -> Scene:
    return Scene.from_dict(
        {
            "title": title,
            "plate": {"width": size, "height": size, "thickness": 1.0},
            "holes": holes,
            "material": {"name": "PMMA"},
            "load": {"strain": list(strain)},
        }
    ).with_(**changes)


def _tension(title: str, defects: dict[str, list[dict[str, Any]]], changes: dict[str, Any]) -> Scene:
    return Scene.from_dict(
        {
            "title": title,
            "plate": {"width": 40.0, "height": 120.0, "thickness": 5.0},
            **defects,
            "material": {"name": "PMMA"},
            "load": {"stress": 10.0},
        }
    ).with_(**changes)
