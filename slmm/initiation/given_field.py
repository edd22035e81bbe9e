"""The user's own displacement field of the uncracked part, in place of a local model of ours."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from slmm.initiation.positions import Positions
from slmm.initiation.raster import rasterised
from slmm.initiation.uncracked import Raster, UncrackedField
from slmm.results.field import DisplacementField
from slmm.results.plane_elements import PLANE_ELEMENTS
from slmm.results.results import read_displacements
from slmm.scene.scene import Scene

#: voxels along the longest edge of an element that resolve displacements as well, by how many nodes an edge has. On
#: meshes solved with each type, as coarse as that lets them be, the critical failure index of a circular hole was low
#: by 2 %, with "triangle" by 3 %; measured
VOXELS_PER_EDGE = {2: 1, 3: 4}
#: by how much of the plate's longer side the model's box may miss the plate's; chosen
BOX = 1e-3
#: by how much the area may miss the plate's without its notches: a share of it, and of the notches' own, of which
#: chords of 0.4 radii leave 2.7 %; both chosen
AREA, NOTCH_AREA = 1e-3, 0.03
#: how far a notch of the model may lie from the scene's: in element edges, of which a chord of 0.4 radii is off by
#: 0.05, or in square roots of the notch's area, which is 0.9 % of a circle's radius; both chosen
OFF_IN_EDGES, OFF_IN_SIZES = 0.07, 0.005
#: units in mm that a model may be in by mistake
OTHER_UNITS = {"metres": 1e3, "centimetres": 10.0, "inches": 25.4, "micrometres": 1e-3}


@dataclass(frozen=True)
class GivenField:
    """Displacements of the uncracked part from any finite element model: an `uncracked.UncrackedField`.

    Attributes
    ----------
    field : DisplacementField
    raster : Raster
        Where the material is, from the scene.
    source : str
        Where the field comes from, for the result's provenance.
    """

    field: DisplacementField
    raster: Raster
    source: str
    coarser: None = None

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {"local_model": "given displacements", "displacements": self.source}

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm; beside the model those of its nearest element go on."""
        return self.field.displacement(points)

    def resolution(self, points: np.ndarray) -> np.ndarray:
        """Size (k,) of the voxels that would resolve the displacements at points (k, 2) as well, mm."""
        voxels = [
            np.full(len(nodes), VOXELS_PER_EDGE[PLANE_ELEMENTS[kind].edges.shape[1]])
            for kind, nodes in self.field.cells.items()
        ]
        return self._largest(points, self._longest_edge / np.concatenate(voxels))

    def edge_length(self, points: np.ndarray) -> np.ndarray:
        """Longest edge (k,) of the elements at points (k, 2), mm."""
        return self._largest(points, self._longest_edge)

    def _largest(self, points: np.ndarray, values: np.ndarray) -> np.ndarray:
        """The largest value (k,) of the elements that are next to points (k, 2), all alike near."""
        which, element = self._tree.query_nearest(shapely.points(points))
        largest = np.zeros(len(points))
        np.maximum.at(largest, which, values[element])
        return largest

    @cached_property
    def _corners(self) -> list[np.ndarray]:
        """Corners (m, k, 2) of the elements of each type."""
        cells = self.field.cells.items()
        return [self.field.points[nodes[:, : PLANE_ELEMENTS[kind].corners]] for kind, nodes in cells]

    @cached_property
    def _longest_edge(self) -> np.ndarray:
        edges = [corners - np.roll(corners, 1, axis=1) for corners in self._corners]
        return np.concatenate([np.linalg.norm(edge, axis=2).max(axis=1) for edge in edges])

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree(np.concatenate([shapely.polygons(corners) for corners in self._corners]))


def given_field(
    displacements: Any, scene: Scene, where: Positions, field: str | None = None
) -> UncrackedField:
    """The user's displacements as a field, once they have proved to be of the scene's plate.

    Parameters
    ----------
    displacements : path, DisplacementField, (points, cells, u) or UncrackedField
        A field that has been solved is taken as it is. Else a file as `slmm.results.results.read_displacements` takes
        it, of which the last step counts; a field; or the three arguments of `slmm.results.field.DisplacementField`.
    scene : Scene
        Plate and notches.
    where : Positions
        Where failure indices are wanted.
    field : str, optional
        Which nodal data of the file are the displacements, see `slmm.results.results.read_displacements`.

    Raises
    ------
    OSError
        When there is no such file.
    ValueError
        When the file or the arrays cannot be used, or the model is not one of the scene's plate: another box, another
        area, or a position that is not on a notch of the model.

    Notes
    -----
    A cell is at least ten voxels high. So at a round notch elements may be 0.15 radii long, quadratic ones 0.5 radii;
    with longer ones positions have no cell. They should grow slowly with the distance: where each is 2.5 times as
    large as the one before, bilinear ones cost 2.4 % (0.1 radii long at the hole), quadratic ones 0.6 % (0.2 radii).

    Examples
    --------
    >>> from slmm.initiation.positions import find_positions
    >>> scene = Scene.from_dict({
    ...     "plate": {"width": 20.0, "height": 20.0},
    ...     "holes": [{"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}],
    ...     "material": {"name": "PMMA"},
    ...     "load": {"strain": [0.0, 0.01, 0.0]},
    ... })
    >>> given = given_field("tests/data/plate_2d.frd", scene, find_positions(scene))
    >>> given.resolution(np.array([[12.0, 10.0]])).round(2)  # elements of eight nodes, up to 0.47 mm long
    array([0.12])
    """
    if isinstance(displacements, UncrackedField):
        if field is not None:
            raise ValueError(f"field = {field!r}: belongs to displacements from a file")
        return displacements
    model, source = displacement_field(displacements, field)
    given = GivenField(model, rasterised(scene), source)
    body = scene.part.body
    try:
        _check_box(model, body, scene)
        _check_area(model, body, scene)
        _check_positions(given, body, scene, where)
    except ValueError as error:
        raise ValueError(f"displacements of {source}: {error}") from None
    return given


def displacement_field(
    displacements: Any, field: str | None = None, step: int = -1
) -> tuple[DisplacementField, str]:
    """The field that a user gives in one of the forms of `given_field`, and where it comes from."""
    if isinstance(displacements, str | os.PathLike):
        path = os.fspath(displacements)
        return read_displacements(path, step, field), os.path.basename(path)
    if field is not None:
        raise ValueError(f"field = {field!r}: belongs to displacements from a file")
    if isinstance(displacements, tuple | list) and len(displacements) == 3:
        points, cells, u = displacements
        if not isinstance(cells, Mapping):
            raise ValueError(
                f"displacements: cells are a {type(cells).__name__}: must map types to node numbers"
            )
        displacements = DisplacementField(points, cells, u)
    if not isinstance(displacements, DisplacementField):
        raise ValueError(
            f"displacements are a {type(displacements).__name__}: must be a path, a DisplacementField or "
            "(points, cells, u)"
        )
    return displacements, f"a field of {len(displacements.points)} nodes"


def _check_box(field: DisplacementField, body: shapely.Polygon, scene: Scene) -> None:
    nodes = np.unique(np.concatenate([nodes.ravel() for nodes in field.cells.values()]))
    box = np.concatenate([field.points[nodes].min(axis=0), field.points[nodes].max(axis=0)])
    wanted = np.array(body.bounds)
    allowed = BOX * scene.size
    if np.abs(box - wanted).max() <= allowed:
        return
    says = (
        f"the model reaches from ({box[0]:g}, {box[1]:g}) to ({box[2]:g}, {box[3]:g}), the plate of the scene from "
        f"({wanted[0]:g}, {wanted[1]:g}) to ({wanted[2]:g}, {wanted[3]:g}) mm"
    )
    for unit, factor in OTHER_UNITS.items():
        if np.abs(box * factor - wanted).max() <= allowed:
            raise ValueError(
                f"{says}: the model seems to be in {unit}; lengths and displacements must be in mm"
            )
    if np.abs((box[2:] - box[:2]) - (wanted[2:] - wanted[:2])).max() <= allowed:
        dx, dy = wanted[:2] - box[:2]
        raise ValueError(f"{says}: move the model by ({dx:g}, {dy:g}) mm, to the coordinates of the scene")
    raise ValueError(
        f"{says}: the model must be one of the whole plate, in the coordinates of the scene and in mm"
    )


def _check_area(field: DisplacementField, body: shapely.Polygon, scene: Scene) -> None:
    notches = scene.outer.area - body.area
    area = field.area()
    if abs(area - body.area) > AREA * body.area + NOTCH_AREA * notches:
        raise ValueError(
            f"the model's area is {area:.6g} mm2, that of the plate without its notches {body.area:.6g} mm2: they "
            "must be of the same shape"
        )


def _check_positions(given: GivenField, body: shapely.Polygon, scene: Scene, where: Positions) -> None:
    """Beside every position, the model must end where the scene's notch begins."""
    around = shapely.box(*scene.outer.bounds) if scene.plate is None else scene.outer
    notches = around.difference(body)
    normals, size = np.zeros((len(where.s), 2)), np.zeros(len(where.s))
    for k, outline in enumerate(scene.outlines):
        on_k = where.hole == k
        normals[on_k] = outline.normals(where.s[on_k])
        size[on_k] = np.sqrt(shapely.Polygon(outline.polygon(500)).intersection(around).area)
    allowed = np.maximum(OFF_IN_EDGES * given.edge_length(where.points), OFF_IN_SIZES * size)
    deeper = where.points + allowed[:, None] * normals
    outside = where.points - allowed[:, None] * normals
    # at a mouth, in a narrow notch or beside a thin ligament the step may lead elsewhere
    missing = shapely.contains_xy(body, deeper) & ~given.field.covers(deeper, 0.0)
    filled = shapely.contains_xy(notches, outside) & given.field.covers(outside, 0.0)
    for wrong, says in ((missing, "no element is there"), (filled, "the model goes on into the notch")):
        if wrong.any():
            first = int(np.argmax(wrong))
            x, y = where.points[first]
            raise ValueError(
                f"{np.count_nonzero(wrong)} of {len(wrong)} positions are not on the model's surface, the first one "
                f"at ({x:.6g}, {y:.6g}) mm: {says}, farther than {allowed[first]:.2g} mm"
            )
