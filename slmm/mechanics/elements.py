"""The usual finite elements, each described by its nodes, its shape functions' monomials and its integration rule.

Names, node order and order of the integration points are those of Abaqus (and CalculiX); those of QUAD9, HEX27
and WEDGE18, which Abaqus does not have or numbers otherwise, are VTK's. Bricks and quadrilaterals live on [-1, 1]^d,
tetrahedra and triangles on the unit simplex, wedges on the unit triangle times [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

#: det dX/dR over the largest side to the power of the dimension, below which an element is degenerate; chosen
DEGENERATE = 1e-10


@dataclass(frozen=True)
class Element:
    """An isoparametric element.

    Attributes
    ----------
    name : str
    corners : int
    nodes : ndarray (n, d)
        Reference coordinates.
    exponents : ndarray (n, d) of int
        Powers of the monomials that span the shape functions.
    points, weights : ndarray (ips, d), (ips,)
        Integration rule in reference coordinates.
    """

    name: str
    corners: int
    nodes: np.ndarray
    exponents: np.ndarray
    points: np.ndarray
    weights: np.ndarray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.nodes.shape[1]

    @cached_property
    def coefficients(self) -> np.ndarray:
        """Of the monomials (n,) in each shape function (n,)."""
        return np.linalg.inv(_monomials(self.nodes, self.exponents))

    def shape(self, at: np.ndarray) -> np.ndarray:
        """Shape functions (k, n) at reference coordinates (k, d)."""
        return _monomials(at, self.exponents) @ self.coefficients

    def gradient(self, at: np.ndarray) -> np.ndarray:
        """Their derivatives (k, n, d) by the reference coordinates."""
        result = []
        for i in range(self.dimension):
            lower = self.exponents.copy()
            lower[:, i] = np.maximum(lower[:, i] - 1, 0)
            result.append((_monomials(at, lower) * self.exponents[:, i]) @ self.coefficients)
        return np.stack(result, axis=-1)

    @cached_property
    def gradient_at_points(self) -> np.ndarray:
        """Derivatives (ips, n, d) at the integration points."""
        return np.ascontiguousarray(self.gradient(self.points))

    @cached_property
    def turned(self) -> tuple[np.ndarray, np.ndarray]:
        """Order of the nodes (n,) and of the points (ips,) of the element that runs the other way round."""
        # exchanging the first two coordinates maps each of the reference elements on itself
        exchanged = [1, 0, *range(2, self.dimension)]
        nodes, points = (
            np.linalg.norm(at[:, exchanged][:, None] - at, axis=2).argmin(axis=1)
            for at in (self.nodes, self.points)
        )
        return nodes, points

    @property
    def edges(self) -> np.ndarray:
        """Nodes (corners, 2 or 3) of a plane element's edges, anticlockwise: start, end and, if there is, middle."""
        if self.dimension != 2:
            raise ValueError(f"{self.name} is no plane element: it has faces, not edges")
        start = np.arange(self.corners)
        edges = [start, np.roll(start, -1)]
        if len(self.nodes) > self.corners:
            edges.append(start + self.corners)
        return np.stack(edges, axis=1)


def _monomials(at: np.ndarray, exponents: np.ndarray) -> np.ndarray:
    """Monomials (k, n) at points (k, d)."""
    return np.prod(np.asarray(at, dtype=float)[:, None] ** exponents, axis=-1)


def _gauss(n: int, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss rule of n points a direction, the first coordinate fastest."""
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.array([p[::-1] for p in product(x, repeat=dimension)])
    weights = np.array([np.prod(p) for p in product(w, repeat=dimension)])
    return points, weights


def _wedge_rule(triangle: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """A rule of equal weights on the triangle, times Gauss points along the wedge."""
    x, w = np.polynomial.legendre.leggauss(n)
    points = [[*p, (1 + z) / 2] for z in x for p in triangle]
    return np.array(points), np.repeat(w / 4, len(triangle)) / len(triangle)


CENTRE = np.array([[1 / 3, 1 / 3]])
THREE = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
_a, _b = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
FOUR = np.array([[_a, _a, _a], [_b, _a, _a], [_a, _b, _a], [_a, _a, _b]])

_CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
_MIDDLES = [[0, -1], [1, 0], [0, 1], [-1, 0]]
_BRICK = np.array(
    [
        *([*p, z] for z in (-1, 1) for p in _CORNERS),
        *([*p, z] for z in (-1, 1) for p in _MIDDLES),
        *([*p, 0] for p in _CORNERS),
    ],
    dtype=float,
)
#: all that are at most linear in each coordinate, or quadratic in one of them
_SERENDIPITY_3 = np.array([p for p in product(range(3), repeat=3) if sum(q == 2 for q in p) <= 1])
_SERENDIPITY_2 = np.array([p for p in product(range(3), repeat=2) if sum(q == 2 for q in p) <= 1])
_QUADRILATERAL = np.array([*_CORNERS, *_MIDDLES], dtype=float)
_QUADRILATERAL_9 = np.array([*_CORNERS, *_MIDDLES, [0, 0]], dtype=float)
_BRICK_27 = np.array(
    [*_BRICK, *([0.0] * i + [side] + [0.0] * (2 - i) for i in range(3) for side in (-1.0, 1.0)), [0.0] * 3]
)
#: all that are at most quadratic in each coordinate
_QUADRATIC_2 = np.array(list(product(range(3), repeat=2)))
_QUADRATIC_3 = np.array(list(product(range(3), repeat=3)))
_TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
_TETRAHEDRON = np.array([*([*p, 0] for p in _TRIANGLE), *([*p / 2, 0.5] for p in _TRIANGLE[:3]), [0, 0, 1]])
_TETRAHEDRON = _TETRAHEDRON[[0, 1, 2, 9, 3, 4, 5, 6, 7, 8]]
_WEDGE = np.array(
    [
        *([*p, z] for z in (0, 1) for p in _TRIANGLE[:3]),
        *([*p, z] for z in (0, 1) for p in _TRIANGLE[3:]),
        *([*p, 0.5] for p in _TRIANGLE[:3]),
    ]
)


def _up_to(degree: int, dimension: int) -> np.ndarray:
    return np.array([p for p in product(range(degree + 1), repeat=dimension) if sum(p) <= degree])


def _linear(dimension: int) -> np.ndarray:
    return np.array(list(product(range(2), repeat=dimension)))


#: quadratic in the triangle with at most linear along the wedge, and quadratic along it with linear in the triangle
_WEDGE_15 = np.array([*([*p, z] for z in (0, 1) for p in _up_to(2, 2)), *([*p, 2] for p in _up_to(1, 2))])
#: quadratic in the triangle and along the wedge; its last nodes are the middles of its three rectangles
_WEDGE_18 = np.array([[*p, z] for z in range(3) for p in _up_to(2, 2)])
_WEDGE_18_NODES = np.array([*_WEDGE, *([*p, 0.5] for p in _TRIANGLE[3:])])
_WEDGE_6 = np.array([[*p, z] for z in (0, 1) for p in _up_to(1, 2)])

ELEMENTS = {
    element.name: element
    for element in (
        Element("CPE3", 3, _TRIANGLE[:3], _up_to(1, 2), CENTRE, np.array([0.5])),
        Element("CPE4", 4, _QUADRILATERAL[:4], _linear(2), *_gauss(2, 2)),
        Element("CPE4R", 4, _QUADRILATERAL[:4], _linear(2), *_gauss(1, 2)),
        Element("CPE6", 3, _TRIANGLE, _up_to(2, 2), THREE, np.full(3, 1 / 6)),
        Element("CPE8", 4, _QUADRILATERAL, _SERENDIPITY_2, *_gauss(3, 2)),
        Element("CPE8R", 4, _QUADRILATERAL, _SERENDIPITY_2, *_gauss(2, 2)),
        Element("QUAD9", 4, _QUADRILATERAL_9, _QUADRATIC_2, *_gauss(3, 2)),
        Element("C3D4", 4, _TETRAHEDRON[:4], _up_to(1, 3), np.full((1, 3), 0.25), np.array([1 / 6])),
        Element("C3D6", 6, _WEDGE[:6], _WEDGE_6, *_wedge_rule(CENTRE, 2)),
        Element("C3D8", 8, _BRICK[:8], _linear(3), *_gauss(2, 3)),
        Element("C3D8R", 8, _BRICK[:8], _linear(3), *_gauss(1, 3)),
        Element("C3D10", 4, _TETRAHEDRON, _up_to(2, 3), FOUR, np.full(4, 1 / 24)),
        Element("C3D15", 6, _WEDGE, _WEDGE_15, *_wedge_rule(THREE, 3)),
        Element("C3D20", 8, _BRICK, _SERENDIPITY_3, *_gauss(3, 3)),
        Element("C3D20R", 8, _BRICK, _SERENDIPITY_3, *_gauss(2, 3)),
        Element("WEDGE18", 6, _WEDGE_18_NODES, _WEDGE_18, *_wedge_rule(THREE, 3)),
        Element("HEX27", 8, _BRICK_27, _QUADRATIC_3, *_gauss(3, 3)),
    )
}

#: names of Abaqus and CalculiX whose nodes and points are those of another element; for those of plane stress the
#: stretch out of the plane is taken as 1, which errs by as much as the strain
ALIASES = {
    alias: name
    for name, aliases in {
        "CPE3": ("CPE3H", "CPS3"),
        "CPE4": ("CPE4H", "CPE4I", "CPE4IH", "CPS4", "CPS4I"),
        "CPE4R": ("CPE4RH", "CPS4R"),
        "CPE6": ("CPE6H", "CPS6"),
        "CPE8": ("CPE8H", "CPS8"),
        "CPE8R": ("CPE8RH", "CPS8R"),
        "C3D4": ("C3D4H",),
        "C3D6": ("C3D6H",),
        "C3D8": ("C3D8H", "C3D8I", "C3D8IH"),
        "C3D8R": ("C3D8RH",),
        "C3D10": ("C3D10H", "C3D10T"),
        "C3D15": ("C3D15H",),
        "C3D20": ("C3D20H",),
        "C3D20R": ("C3D20RH",),
    }.items()
    for alias in aliases
}


def element_named(name: str) -> Element:
    """The element of a name or an alias.

    Raises
    ------
    ValueError
        For an unknown one; the message lists what is known.

    Examples
    --------
    >>> element_named("C3D10H").name
    'C3D10'
    """
    key = str(name).upper()
    if (element := ELEMENTS.get(ALIASES.get(key, key))) is None:
        raise ValueError(f"element_type = {name!r}: unknown; known are {', '.join([*ELEMENTS, *ALIASES])}")
    return element
