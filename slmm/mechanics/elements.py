"""Elements and their types by the names that Abaqus and CalculiX give them, from `slmm.mechanics.element_types`."""

from __future__ import annotations

from slmm.mechanics.element import Element
from slmm.mechanics.element_types import ELEMENT_TYPES, ElementType

_TYPES = {name: known for known in ELEMENT_TYPES.values() for name in known.elements}

#: elements by their own names
ELEMENTS = {element.name: element for known in ELEMENT_TYPES.values() for element in known.elements.values()}

#: further names, and the name of the element that is meant
ALIASES = {
    name: element.name
    for known in ELEMENT_TYPES.values()
    for name, element in known.elements.items()
    if name != element.name
}


def type_named(name: str) -> ElementType:
    """The type of the element of a name or an alias.

    Raises
    ------
    ValueError
        For an unknown one; the message lists what is known.

    Examples
    --------
    >>> type_named("C3D20RH").kind
    'hexahedron20'
    """
    if (known := _TYPES.get(str(name).upper())) is None:
        raise ValueError(f"element_type = {name!r}: unknown; known are {', '.join([*ELEMENTS, *ALIASES])}")
    return known


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
    return type_named(name).elements[str(name).upper()]
