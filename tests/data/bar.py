"""Writes a CalculiX model of this folder: a bar 40 x 10 x 10 mm of two materials, solid elements.

    python bar.py && ccx bar_3d

The left half is of steel, two C3D20R elements; the right one of a material a third as stiff, two cubes of two C3D15
elements each. nu/E is the same on both sides, so that the bar, held in its planes of symmetry and drawn out along x
until it carries 100 MPa, is in uniaxial stress throughout.
"""

from pathlib import Path

import numpy as np

SIZE, TENSION = 10.0, 100.0
MATERIALS = {"STEEL": (210_000.0, 0.3), "SOFT": (70_000.0, 0.1)}

CORNERS = np.array([(x, y, z) for z in (0, 2) for x, y in ((0, 0), (2, 0), (2, 2), (0, 2))])
BRICK_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
#: of a cube's corners: the first has a side on the left, the second on the right
WEDGES = [(0, 1, 3, 4, 5, 7), (1, 2, 3, 5, 6, 7)]


def model() -> str:
    """The text of the input file."""
    number: dict[tuple[int, ...], int] = {}

    def element(corners: np.ndarray, edges: list[tuple[int, int]]) -> list[int]:
        """Nodes at the corners and in the middle of the edges, in half cubes; new ones get the next number."""
        at = np.concatenate([corners, corners[edges].sum(axis=1) // 2])
        return [number.setdefault(tuple(map(int, p)), len(number) + 1) for p in at]

    cubes = [CORNERS + np.array([2 * k, 0, 0]) for k in range(4)]
    bricks = [element(cube, BRICK_EDGES) for cube in cubes[:2]]
    wedges = [element(cube[list(corners)], WEDGE_EDGES) for cube in cubes[2:] for corners in WEDGES]
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, " + ", ".join(f"{SIZE / 2 * x:g}" for x in at) for at, k in number.items()]
    first = 1
    for name, kind, elements in (("LEFT", "C3D20R", bricks), ("RIGHT", "C3D15", wedges)):
        lines += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
        for k, nodes in enumerate(elements, first):
            lines += [f"{k}, " + ", ".join(map(str, nodes[:10])) + ",", ", ".join(map(str, nodes[10:]))]
        first += len(elements)
    for section, (name, (E, nu)) in zip(("LEFT", "RIGHT"), MATERIALS.items(), strict=True):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{E:g}, {nu:g}"]
        lines += [f"*SOLID SECTION, ELSET={section}, MATERIAL={name}"]
    lines += ["*BOUNDARY"]
    lines += [f"{k}, {i + 1}" for at, k in number.items() for i in range(3) if at[i] == 0]
    end = max(x for x, _, _ in number)
    extension = sum(SIZE * end / 4 * TENSION / E for E, _ in MATERIALS.values())
    lines += ["*STEP", "*STATIC", "*BOUNDARY"]
    lines += [f"{k}, 1, 1, {extension:.12g}" for (x, _, _), k in number.items() if x == end]
    lines += ["*NODE FILE", "U", "*EL FILE", "S, ENER", "*END STEP"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    Path("bar_3d.inp").write_text(model())
