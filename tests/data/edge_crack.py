"""Writes a CalculiX model of this folder: a square plate 40 x 40 mm with an edge crack of 20 mm, CPE8 elements.

    python edge_crack.py && ccx edge_crack_2d

The crack is a true slit from (0, 20) to (20, 20): the nodes behind its tip are there twice. The lower and the upper
edge carry a tension of 100 MPa along y; what holds the plate on y = 20 carries nothing, so that the crack opens in
mode I alone. Another length and name: ``model(length)``.
"""

from pathlib import Path

import numpy as np

SIDE, CRACK, TENSION = 40.0, 20.0, 100.0
E, NU, THICKNESS = 210_000.0, 0.3, 1.0
ELEMENTS = 20  # along each side


def mesh(crack: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) and eight-node elements (m, 8), row by row from below."""
    size = SIDE / ELEMENTS
    number: dict[tuple[int, int, bool], int] = {}

    def node(i: int, j: int, upper: bool) -> int:
        """Of half elements along x and y; on the crack there is one below and one above."""
        on_crack = j == ELEMENTS and i * size / 2 < crack - 1e-9
        return number.setdefault((i, j, upper and on_crack), len(number))

    elements = [
        [
            node(i + di, j + dj, j >= ELEMENTS)
            for di, dj in ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        ]
        for j in range(0, 2 * ELEMENTS, 2)
        for i in range(0, 2 * ELEMENTS, 2)
    ]
    return np.array([(i, j) for i, j, _ in number]) * size / 2, np.array(elements)


def model(crack: float = CRACK) -> str:
    """The text of the input file."""
    points, elements = mesh(crack)
    right, middle = (1 + int(np.linalg.norm(points - at, axis=1).argmin()) for at in ((40, 20), (30, 20)))
    lines = ["*NODE, NSET=ALL", *(f"{k}, {x:g}, {y:g}, 0" for k, (x, y) in enumerate(points, 1))]
    lines += ["*ELEMENT, TYPE=CPE8, ELSET=PLATE"]
    lines += [f"{k}, " + ", ".join(str(n + 1) for n in element) for k, element in enumerate(elements, 1)]
    count = len(elements)
    lines += ["*ELSET, ELSET=LOWER, GENERATE", f"1, {ELEMENTS}, 1"]
    lines += ["*ELSET, ELSET=UPPER, GENERATE", f"{count - ELEMENTS + 1}, {count}, 1"]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{E:g}, {NU:g}"]
    lines += ["*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL", f"{THICKNESS:g}"]
    lines += ["*BOUNDARY", f"{right}, 1, 2", f"{middle}, 2, 2"]
    lines += ["*STEP", "*STATIC", "*DLOAD", f"LOWER, P1, {-TENSION:g}", f"UPPER, P3, {-TENSION:g}"]
    lines += ["*NODE FILE, OUTPUT=2D", "U", "*EL FILE, OUTPUT=2D", "S, ENER", "*END STEP"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    Path("edge_crack_2d.inp").write_text(model())
