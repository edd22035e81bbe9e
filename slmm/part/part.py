"""A part: its outer edge, the holes and notches in it, and its cracks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from slmm.part.chords import chords
from slmm.part.crack import TIP, Crack, End, joined, located, surface_at, touched
from slmm.part.outline import Outline

Array = NDArray[np.float64]

#: lengths below this share of the part's larger side count as zero; chosen
TOLERANCE = 1e-5


def are_apart(holes: Sequence[shapely.Polygon], whole: shapely.Polygon) -> bool:
    """Whether holes lie inside a whole, valid ones that touch neither its edge nor each other."""
    if not holes:
        return True
    shapely.prepare(whole)
    if not shapely.contains_properly(whole, holes).all() or not shapely.is_valid(holes).all():
        return False
    pairs = shapely.STRtree(holes).query(holes, predicate="intersects")
    return len(pairs.T) == len(holes)


@dataclass(frozen=True, eq=False)
class Part:
    """Geometry alone: where there is material, and which faces are free inside it.

    Parameters
    ----------
    outer : ndarray, shape (n, 2)
        Corners of the outer edge, counter-clockwise, mm; straight between them, or chords of the ``rim``.
    holes : tuple of Outline
        Holes, and notches that cut the outer edge.
    cracks : tuple of Crack
    thickness : float
        mm.
    rim : Outline, optional
        The outer edge as a curve, clockwise: with the material on its right, as that of a hole.

    Examples
    --------
    >>> part = Part.plate(40.0, 120.0, cracks=[[(0, 60), (20, 60)]])
    >>> part.cracks[0].start.kind, part.cracks[0].end.kind, part.is_severed
    ('surface', 'tip', False)
    >>> part.with_crack([(20, 60), (40, 60)]).is_severed
    True
    """

    outer: Array
    holes: tuple[Outline, ...] = ()
    cracks: tuple[Crack, ...] = ()
    thickness: float = 1.0
    rim: Outline | None = None

    @classmethod
    def within(
        cls,
        outline: Outline,
        holes: Sequence[Outline] = (),
        cracks: Sequence[ArrayLike] = (),
        thickness: float = 1.0,
    ) -> Part:
        """A part of any outer outline, which runs counter-clockwise around it.

        The other parameters and what is raised are those of `plate`.

        Examples
        --------
        >>> from slmm.part.shapes import circle
        >>> disk = Part.within(Outline.through(circle((0, 0), 40.0)), cracks=[[(-20, 0), (20, 0)]])
        >>> round(disk.body.area / (np.pi * 40**2), 5), len(disk.tips)
        (1.0, 2)
        """
        rim = outline.reversed()
        whole = cls(chords(rim)[::-1], tuple(holes), (), thickness, rim)
        return whole.with_cracks(cracks) if len(cracks) else whole

    @classmethod
    def plate(
        cls,
        width: float,
        height: float,
        holes: Sequence[Outline] = (),
        cracks: Sequence[ArrayLike] = (),
        thickness: float = 1.0,
    ) -> Part:
        """A rectangle with its lower left corner at (0, 0), mm.

        Parameters
        ----------
        width, height : float
        holes : sequence of Outline
        cracks : sequence of array_like, shape (n, 2)
            Points of each crack; an end that lies on a surface, or beyond one, is no tip.
        thickness : float

        Raises
        ------
        ValueError
            When the holes cut the plate in pieces or leave nothing of it, or a crack does not run through the material
            in one piece.
        """
        corners = np.array([(width, 0.0), (width, height), (0.0, height), (0.0, 0.0)])
        whole = cls(corners, tuple(holes), (), thickness)
        return whole.with_cracks(cracks) if len(cracks) else whole

    @cached_property
    def outlines(self) -> tuple[Outline, ...]:
        """All curved outlines, with the material on their right: the holes', and the rim's as the last one."""
        return self.holes if self.rim is None else (*self.holes, self.rim)

    @property
    def box(self) -> Array:
        """Lower left and upper right corner (2, 2) of the rectangle around it, mm."""
        return np.array([self.outer.min(axis=0), self.outer.max(axis=0)])

    @property
    def tolerance(self) -> float:
        """Lengths below this count as zero, mm."""
        return TOLERANCE * float(np.ptp(self.outer, axis=0).max())

    @cached_property
    def body(self) -> shapely.Polygon:
        """The part without its holes, as a polygon; each outline by its `slmm.part.chords.chords`.

        Raises
        ------
        ValueError
            When the holes cut it in pieces or leave nothing of it.
        """
        whole = shapely.Polygon(self.outer)
        notches = [shapely.Polygon(chords(hole)) for hole in self.holes]
        if are_apart(notches, whole):
            # from its lowest left corner, as an overlay has it: meshes depend on where rings begin
            first = np.lexsort((self.outer[:, 1], self.outer[:, 0]))[0]
            return shapely.Polygon(np.roll(self.outer, -first, axis=0), [n.exterior for n in notches])
        body = whole.difference(shapely.union_all(notches))
        if body.geom_type != "Polygon" or body.is_empty:
            (left, bottom), (right, top) = self.box
            raise ValueError(
                f"a part of {right - left:g} x {top - bottom:g} mm with {len(self.holes)} notches leaves "
                f"{len(getattr(body, 'geoms', []))} pieces: it must leave exactly one"
            )
        return body

    @cached_property
    def tips(self) -> list[Array]:
        """For each crack tip the line (n, 2) that leads there, mm, the tip last; in the order of the cracks."""
        return [line for crack in self.cracks for line in crack.tips]

    @cached_property
    def crack_lines(self) -> list[Array]:
        """Points (n, 2) of each crack, mm, those among them where it meets another one."""
        return joined(self.cracks, self.tolerance)

    @cached_property
    def pieces(self) -> list[shapely.Polygon]:
        """What the cracks leave of the body, each as a polygon; one if it hangs together."""
        if not self.cracks:
            return [self.body]
        beyond = 3 * self.tolerance
        lines = []
        for crack, line in zip(self.cracks, self.crack_lines, strict=True):
            ends = [line[0], line[-1]]
            for k, (end, inner) in enumerate(((crack.start, line[1]), (crack.end, line[-2]))):
                along = ends[k] - inner
                if end != TIP:  # round-off must not leave a bridge
                    ends[k] = ends[k] + beyond * along / np.linalg.norm(along)
            lines.append(shapely.LineString([ends[0], *line[1:-1], ends[1]]))
        net = shapely.union_all([self.body.boundary, *lines])
        faces = shapely.get_parts(shapely.polygonize([net]))
        inside = [face for face in faces if self.body.covers(face.representative_point())]
        return [face for face in inside if 2 * face.area / face.length > self.tolerance]

    @property
    def is_severed(self) -> bool:
        """Whether the cracks cut it in pieces."""
        return self._closes_loops and len(self.pieces) > 1

    @cached_property
    def _closes_loops(self) -> bool:
        """Whether cracks and the surfaces that they end on make a closed line, without which nothing is cut off."""
        places = Counter(point for line in self.crack_lines for point in map(tuple, line.tolist()))
        ends = [
            line[k]
            for crack, line in zip(self.cracks, self.crack_lines, strict=True)
            for k, end in ((0, crack.start), (-1, crack.end))
            if end.kind == "surface"
        ]
        surfaces = iter(self._surfaces.nearest(shapely.points(ends)).tolist() if ends else [])
        joined: dict[object, object] = {}

        def root(place: object) -> object:
            while place in joined:
                place = joined[place]
            return place

        for crack, line in zip(self.cracks, self.crack_lines, strict=True):
            if not shapely.LineString(line).is_simple:
                return True
            met: list[object] = [place for place in map(tuple, line.tolist()) if places[place] > 1]
            met = [next(surfaces), *met] if crack.start.kind == "surface" else met
            met = [*met, next(surfaces)] if crack.end.kind == "surface" else met
            for one, other in pairwise(met):
                if (here := root(one)) == (there := root(other)):
                    return True
                joined[here] = there
        return False

    @cached_property
    def _surfaces(self) -> shapely.STRtree:
        """The closed curves around the body."""
        return shapely.STRtree(shapely.get_rings(self.body))

    def end_at(self, point: Array) -> End:
        """What a crack would end at whose last point (2,) this is."""
        end, _ = surface_at(point, shapely.LinearRing(self.outer), self.outlines, self.tolerance)
        if end != TIP:
            return end
        tree = shapely.STRtree([crack.shape for crack in self.cracks])
        on = touched(point, tree, self.tolerance) if self.cracks else []
        return End("crack", on[0]) if on else TIP

    def with_crack(self, points: ArrayLike) -> Part:
        """The part with one more crack along points (n, 2), mm.

        One that begins at a tip goes on from there: it is no tip any more.
        """
        return self.with_cracks([points])

    def with_short_crack(self, mouth: Array, tip: Array) -> Part:
        """The part with a crack from a point (2,) of its surface to a tip (2,) inside, mm, however near to each other.

        Nothing is checked but that the mouth lies on a surface.
        """
        end = self.end_at(mouth)
        if end == TIP:
            raise ValueError(f"mouth = {np.asarray(mouth).tolist()}: must lie on a surface of the part")
        return self._with((*self.cracks, Crack(np.array([mouth, tip]), start=end)))

    def grown(self, tip: int, points: ArrayLike) -> Part:
        """The part with one of its cracks longer.

        Parameters
        ----------
        tip : int
            Which of `tips`.
        points : array_like, shape (2,) or (n, 2)
            Where the crack goes on to, mm; the last one is its new end, a tip unless it lies on something.

        Examples
        --------
        >>> part = Part.plate(40.0, 120.0, cracks=[[(0, 60), (20, 60)]])
        >>> part.grown(0, (25, 61)).tips[0].tolist()
        [[0.0, 60.0], [20.0, 60.0], [25.0, 61.0]]
        """
        return self._cracked(self._longer(tip, points))

    def grown_inside(self, tip: int, points: ArrayLike) -> Part:
        """The same where what is added is known to lie in the material, and to touch nothing there."""
        lines = zip(self.cracks, self._longer(tip, points), strict=True)
        return self._with(
            tuple(
                crack if line is crack.points else Crack(line, crack.start, crack.end)
                for crack, line in lines
            )
        )

    def _longer(self, tip: int, points: ArrayLike) -> list[Array]:
        """The lines (n, 2) of its cracks, one of which goes on from a tip."""
        more = np.atleast_2d(np.asarray(points, dtype=float))
        lines, number = [], -1
        for crack in self.cracks:
            line = crack.points
            for end, back in ((crack.start, True), (crack.end, False)):
                if end == TIP:
                    number += 1
                    if number == tip:
                        line = np.concatenate([more[::-1], line] if back else [line, more])
            lines.append(line)
        if not 0 <= tip <= number:
            raise ValueError(f"tip = {tip}: the part has {number + 1}")
        return lines

    def with_cracks(self, more: Sequence[ArrayLike]) -> Part:
        """The part with more cracks, see `with_crack`."""
        return self._cracked([crack.points for crack in self.cracks] + [np.asarray(line) for line in more])

    def _cracked(self, lines: Sequence[ArrayLike]) -> Part:
        """The part with these cracks alone."""
        points = [np.asarray(line, dtype=float) for line in lines]
        outer = shapely.LinearRing(self.outer)
        cracks = located(points, self.body, outer, self.outlines, self.tolerance, self.cracks)
        return self._with(cracks)

    def _with(self, cracks: tuple[Crack, ...]) -> Part:
        cracked = replace(self, cracks=cracks)
        cracked.__dict__["body"], cracked.__dict__["_surfaces"] = (
            self.body,
            self._surfaces,
        )  # cracks leave these
        return cracked
