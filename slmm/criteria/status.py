"""Whether a position has a value, and else why not: all words for it in one place."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """What a result says of a position.

    Examples
    --------
    >>> Status.NO_MESH.of("the mesher failed")
    'no mesh: the mesher failed'
    """

    OK = "ok"
    SEVERED = "the cracks sever the part"

    # curves that end before the criterion is met
    BEYOND_CELL = "crack longer than the cell"
    BEYOND_DISLOCATIONS = "crack longer than the dislocations reach"
    BEYOND_PATH = "crack longer than the path"
    SEVERS = "hardly a crack shorter than the ligament starts, and one through it would sever the part"
    CELL_ENDS = "the cell ends before the critical distance"

    # criteria that do not apply
    SINGULAR = "the stress at a corner or crack tip is infinite: no strength criterion applies"
    TOO_DEEP = "the stress sinks to zero within the critical distance, or the path ends: no critical distance applies"
    NO_CRACK = "no crack: Griffith's criterion needs a crack tip"
    CLOSES = "the crack closes: its faces would touch, which the model does not see"
    COMPRESSED = "compressed across the bisector, where no crack opens"

    # sources that have nothing to say
    NO_MESH = "no mesh: {}"
    NO_CELL = "no cell: {}"
    CORNER = "no cell: sharp corner"
    CRACK_TIP = "no cell: crack tip"
    CRACKED = "no cell: the scene has cracks, which cells and voxels do not see"
    UNKNOWN_SUPPORT = "no cell: what the edges lend to cells is known for [load] alone, not for [[boundary]]"
    NO_DISLOCATIONS = "a corner or crack tip, where dislocations do not start"
    NO_TRIAL = "no trial cracks: {}"
    STIFF = "no dislocations: they do not know how a stiff stretch answers"
    NEAR_SINGULAR = "a corner or crack tip is so near that the stress depends on the mesh"
    TOUCHED = "no notch of its own: something else touches its tip"
    MIXED = "mixed mode: the stress beside the root exceeds the root's by {:.2g} of it"
    NOT_ASYMPTOTIC = "crack of {} mm longer than {} of the clear distance around the notch, {} mm"

    def of(self, *what: object) -> str:
        """The words with what they are about."""
        return self.value.format(*what)
