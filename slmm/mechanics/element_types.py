"""The table of element types: all that is known of each, in one place.

Whoever reads or writes files, finds faces or adds up forces takes it from here; a new type is a new entry in
`ELEMENT_TYPES` and nothing else. Its shape functions must be spanned by monomials, so that pyramids are none. Plane
elements with more than one node between the ends of an edge have forces, but where the boundary is followed (crack
tips) or displacements are interpolated, they are refused.

Names, node order and order of the integration points are those of Abaqus (and CalculiX); those of QUAD9, HEX27
and WEDGE18, which Abaqus does not have or numbers otherwise, are VTK's. Where another program has the nodes in another
order, the entry says where in its files our first node stands, our second, and so on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from slmm.mechanics.element import Element
from slmm.mechanics.quadrature import CENTRE, FOUR, THREE, gauss_rule, wedge_rule


class Numbered(NamedTuple):
    """A type that files know by a number.

    Attributes
    ----------
    number : int
    order : tuple of int, optional
        Where in the file our nodes stand; without it, in our order.
    former : tuple of int, optional
        The same for files that are older: of VTK, before version 2.1 of XML and 5.1 of legacy files.
    """

    number: int
    order: tuple[int, ...] | None = None
    former: tuple[int, ...] | None = None


class Named(NamedTuple):
    """A type that files know by what its name begins with, and the number of its nodes.

    Attributes
    ----------
    beginnings : tuple of str
    order : tuple of int, optional
        Where in the file our nodes stand; without it, in our order.
    """

    beginnings: tuple[str, ...]
    order: tuple[int, ...] | None = None


@dataclass(frozen=True)
class ElementType:
    """What an element is, and what other programs call it.

    Attributes
    ----------
    kind : str
        Its name in meshio, which says nothing of integration.
    element : Element
        With full integration, by its name here: that of Abaqus if there is one.
    vtk : tuple of Numbered
        In VTK's files, which may have it under several numbers; the first one is written.
    aliases : tuple of str
        Names of Abaqus and CalculiX of elements with the same nodes and points: those of plane stress, whose stretch
        out of the plane is taken as 1 in configurational forces, which errs by as much as the strain; hybrid ones; ...
    reduced : Element, optional
        With fewer integration points.
    reduced_aliases : tuple of str
        Names of elements with the nodes and points of that one.
    plane_stress, incompatible : tuple of str
        Which of all these names are of elements in plane stress, and of elements with incompatible modes.
    frd : Numbered, optional
        In CalculiX's results.
    exodus : Named, optional
        In Exodus files.
    side : str
        Of solids, the kind of plane element that two opposite faces are, when a layer may stand for a plane model.

    Examples
    --------
    >>> known = ELEMENT_TYPES["quad8"]
    >>> known.count, known.element.name, len(known.element.points), known.reduced.name, len(known.reduced.points)
    (8, 'CPE8', 9, 'CPE8R', 4)
    >>> known.frd.number, [cell.number for cell in known.vtk], known.exodus.beginnings
    (10, [23, 70], ('QUAD', 'SHELL'))
    """

    kind: str
    element: Element
    vtk: tuple[Numbered, ...]
    aliases: tuple[str, ...] = ()
    reduced: Element | None = None
    reduced_aliases: tuple[str, ...] = ()
    plane_stress: tuple[str, ...] = ()
    incompatible: tuple[str, ...] = ()
    frd: Numbered | None = None
    exodus: Named | None = None
    side: str = ""

    @property
    def count(self) -> int:
        """Of its nodes."""
        return len(self.element.nodes)

    @cached_property
    def elements(self) -> dict[str, Element]:
        """The elements by all their names, aliases last."""
        found = {self.element.name: self.element}
        if self.reduced is None:
            return found | dict.fromkeys(self.aliases, self.element)
        found |= {self.reduced.name: self.reduced} | dict.fromkeys(self.aliases, self.element)
        return found | dict.fromkeys(self.reduced_aliases, self.reduced)


# reference nodes, corners first

_CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
_MIDDLES = [[0, -1], [1, 0], [0, 1], [-1, 0]]
_QUADRILATERAL = np.array([*_CORNERS, *_MIDDLES, [0, 0]], dtype=float)
_BRICK = np.array(
    [
        *([*p, z] for z in (-1, 1) for p in _CORNERS),
        *([*p, z] for z in (-1, 1) for p in _MIDDLES),
        *([*p, 0] for p in _CORNERS),
        *([0.0] * i + [side] + [0.0] * (2 - i) for i in range(3) for side in (-1.0, 1.0)),
        [0.0] * 3,
    ],
    dtype=float,
)
_TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
_TETRAHEDRON = np.array([*([*p, 0] for p in _TRIANGLE), *([*p / 2, 0.5] for p in _TRIANGLE[:3]), [0, 0, 1]])
_TETRAHEDRON = _TETRAHEDRON[[0, 1, 2, 9, 3, 4, 5, 6, 7, 8]]
#: the last three are the middles of its rectangles
_WEDGE = np.array(
    [
        *([*p, z] for z in (0, 1) for p in _TRIANGLE[:3]),
        *([*p, z] for z in (0, 1) for p in _TRIANGLE[3:]),
        *([*p, 0.5] for p in _TRIANGLE),
    ]
)

# powers of the monomials that span the shape functions


def _up_to(degree: int, dimension: int) -> np.ndarray:
    """All of at most this degree in total."""
    return np.array([p for p in product(range(degree + 1), repeat=dimension) if sum(p) <= degree])


def _in_each(degree: int, dimension: int) -> np.ndarray:
    """All of at most this degree in each coordinate."""
    return np.array(list(product(range(degree + 1), repeat=dimension)))


def _serendipity(dimension: int) -> np.ndarray:
    """All that are at most linear in each coordinate, or quadratic in one of them."""
    return np.array([p for p in product(range(3), repeat=dimension) if sum(q == 2 for q in p) <= 1])


_WEDGE_6 = np.array([[*p, z] for z in (0, 1) for p in _up_to(1, 2)])
#: quadratic in the triangle with at most linear along the wedge, and quadratic along it with linear in the triangle
_WEDGE_15 = np.array([*([*p, z] for z in (0, 1) for p in _up_to(2, 2)), *([*p, 2] for p in _up_to(1, 2))])
_WEDGE_18 = np.array([[*p, z] for z in range(3) for p in _up_to(2, 2)])

#: CalculiX and Exodus have the middles of the edges between bottom and top before those of the top
_BRICK_20_ORDER = (*range(12), *range(16, 20), *range(12, 16))
_WEDGE_15_ORDER = (*range(9), *range(12, 15), *range(9, 12))

#: element types by kind. Numbers and orders of CalculiX are those of the manual of CalculiX GraphiX, "Element Types";
#: of VTK, those of vtkCellType.h and of the cells' own documentation: of Lagrange cells (69 to 73), 8 nodes of a
#: quadrilateral and 20 of a brick are serendipity elements, as dolfinx writes them; of Exodus, those of SAND92-2137
ELEMENT_TYPES = {
    known.kind: known
    for known in (
        ElementType(
            "triangle",
            Element("CPE3", 3, _TRIANGLE[:3], _up_to(1, 2), CENTRE, np.array([0.5])),
            aliases=("CPE3H", "CPS3"),
            plane_stress=("CPS3",),
            frd=Numbered(7),
            vtk=(Numbered(5), Numbered(7), Numbered(69)),
            exodus=Named(("TRI",)),
        ),
        ElementType(
            "quad",
            Element("CPE4", 4, _QUADRILATERAL[:4], _in_each(1, 2), *gauss_rule(2, 2)),
            aliases=("CPE4H", "CPE4I", "CPE4IH", "CPS4", "CPS4I"),
            reduced=Element("CPE4R", 4, _QUADRILATERAL[:4], _in_each(1, 2), *gauss_rule(1, 2)),
            reduced_aliases=("CPE4RH", "CPS4R"),
            plane_stress=("CPS4", "CPS4I", "CPS4R"),
            incompatible=("CPE4I", "CPE4IH", "CPS4I"),
            frd=Numbered(9),
            # the sides of a pixel (8) run the same way, those of others around
            vtk=(Numbered(9), Numbered(7), Numbered(8, order=(0, 1, 3, 2)), Numbered(70)),
            exodus=Named(("QUAD", "SHELL")),
        ),
        ElementType(
            "triangle6",
            Element("CPE6", 3, _TRIANGLE, _up_to(2, 2), THREE, np.full(3, 1 / 6)),
            aliases=("CPE6H", "CPS6"),
            plane_stress=("CPS6",),
            frd=Numbered(8),
            vtk=(Numbered(22), Numbered(69)),
            exodus=Named(("TRI",)),
        ),
        ElementType(
            "quad8",
            Element("CPE8", 4, _QUADRILATERAL[:8], _serendipity(2), *gauss_rule(3, 2)),
            aliases=("CPE8H", "CPS8"),
            reduced=Element("CPE8R", 4, _QUADRILATERAL[:8], _serendipity(2), *gauss_rule(2, 2)),
            reduced_aliases=("CPE8RH", "CPS8R"),
            plane_stress=("CPS8", "CPS8R"),
            frd=Numbered(10),
            vtk=(Numbered(23), Numbered(70)),
            exodus=Named(("QUAD", "SHELL")),
        ),
        ElementType(
            "quad9",
            Element("QUAD9", 4, _QUADRILATERAL, _in_each(2, 2), *gauss_rule(3, 2)),
            vtk=(Numbered(28), Numbered(70)),
            exodus=Named(("QUAD", "SHELL")),
        ),
        ElementType(
            "tetra",
            Element("C3D4", 4, _TETRAHEDRON[:4], _up_to(1, 3), np.full((1, 3), 0.25), np.array([1 / 6])),
            aliases=("C3D4H",),
            frd=Numbered(3),
            vtk=(Numbered(10), Numbered(71)),
            exodus=Named(("TET",)),
        ),
        ElementType(
            "wedge",
            Element("C3D6", 6, _WEDGE[:6], _WEDGE_6, *wedge_rule(CENTRE, 2)),
            aliases=("C3D6H",),
            frd=Numbered(2),
            # the triangles of VTK's linear wedges (13) run the other way round, those of its quadratic ones do not
            vtk=(Numbered(13, order=(0, 2, 1, 3, 5, 4)), Numbered(73)),
            exodus=Named(("WED",)),
            side="triangle",
        ),
        ElementType(
            "hexahedron",
            Element("C3D8", 8, _BRICK[:8], _in_each(1, 3), *gauss_rule(2, 3)),
            aliases=("C3D8H", "C3D8I", "C3D8IH"),
            reduced=Element("C3D8R", 8, _BRICK[:8], _in_each(1, 3), *gauss_rule(1, 3)),
            reduced_aliases=("C3D8RH",),
            incompatible=("C3D8I", "C3D8IH"),
            frd=Numbered(1),
            # the sides of a voxel (11) run the same way, those of others around
            vtk=(Numbered(12), Numbered(11, order=(0, 1, 3, 2, 4, 5, 7, 6)), Numbered(72)),
            exodus=Named(("HEX",)),
            side="quad",
        ),
        ElementType(
            "tetra10",
            Element("C3D10", 4, _TETRAHEDRON, _up_to(2, 3), FOUR, np.full(4, 1 / 24)),
            aliases=("C3D10H", "C3D10T"),
            frd=Numbered(6),
            vtk=(Numbered(24), Numbered(71)),
            exodus=Named(("TET",)),
        ),
        ElementType(
            "wedge15",
            Element("C3D15", 6, _WEDGE[:15], _WEDGE_15, *wedge_rule(THREE, 3)),
            aliases=("C3D15H",),
            frd=Numbered(5, order=_WEDGE_15_ORDER),
            vtk=(Numbered(26), Numbered(73)),
            exodus=Named(("WED",), order=_WEDGE_15_ORDER),
            side="triangle6",
        ),
        ElementType(
            "hexahedron20",
            Element("C3D20", 8, _BRICK[:20], _serendipity(3), *gauss_rule(3, 3)),
            aliases=("C3D20H",),
            reduced=Element("C3D20R", 8, _BRICK[:20], _serendipity(3), *gauss_rule(2, 3)),
            reduced_aliases=("C3D20RH",),
            frd=Numbered(4, order=_BRICK_20_ORDER),
            vtk=(Numbered(25), Numbered(72)),
            exodus=Named(("HEX",), order=_BRICK_20_ORDER),
            side="quad8",
        ),
        ElementType(
            "wedge18",
            Element("WEDGE18", 6, _WEDGE, _WEDGE_18, *wedge_rule(THREE, 3)),
            vtk=(Numbered(32), Numbered(73)),
            side="triangle6",
        ),
        ElementType(
            "hexahedron27",
            Element("HEX27", 8, _BRICK, _in_each(2, 3), *gauss_rule(3, 3)),
            # Lagrange bricks (72) had two of the edges between bottom and top the other way round
            vtk=(Numbered(29), Numbered(72, former=(*range(18), 19, 18, *range(20, 27)))),
            # Exodus has the middle of the brick before those of its faces
            exodus=Named(("HEX",), order=(*_BRICK_20_ORDER, 23, 24, 25, 26, 21, 22, 20)),
            side="quad9",
        ),
    )
}
