"""Writes the CalculiX models of this folder: a plate 20 x 20 mm with a circular hole, r = 2 mm, CPS8 elements.

    python plate_with_hole.py && ccx plate_2d && ccx plate_expanded

Step 1 prescribes Kirsch's displacements (unbounded plate, 1 MPa remote tension along y) on the outer edges, so
that his solution holds in the whole plate. Step 2 prescribes u_y = 0.01 y there, as the load
``strain = [0.0, 0.01, 0.0]`` of a scene does; it alone is in the expanded model.
"""

from pathlib import Path

import numpy as np

SIDE, RADIUS, TENSION, STRAIN = 20.0, 2.0, 1.0, 0.01
E, NU, THICKNESS = 2960.0, 0.35, 1.0
AROUND, ACROSS, GROWTH = 32, 7, 1.45  # elements around the hole and from it to the edge


def kirsch(points: np.ndarray) -> np.ndarray:
    """Displacements (n, 2), mm, of an unbounded plate with a hole at the origin, plane stress, tension along y."""
    # the classical solution is for tension along its first axis: here y
    x, y = points[:, 1], -points[:, 0]
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    kappa = (3 - NU) / (1 + NU)
    scale = TENSION * RADIUS / (8 * E / (2 * (1 + NU)))
    q = RADIUS / r
    along = scale * (
        (kappa + 1) / q * np.cos(theta)
        + 2 * q * ((1 + kappa) * np.cos(theta) + np.cos(3 * theta))
        - 2 * q**3 * np.cos(3 * theta)
    )
    across = scale * (
        (kappa - 3) / q * np.sin(theta)
        + 2 * q * ((1 - kappa) * np.sin(theta) + np.sin(3 * theta))
        - 2 * q**3 * np.sin(3 * theta)
    )
    return np.column_stack([-across, along])


def mesh() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (n, 2), eight-node elements (m, 8) and the nodes on the outer edges; the lower left corner is (0, 0)."""
    number: dict[tuple[int, int], int] = {}
    points = []
    depth = np.concatenate([[0.0], np.cumsum(GROWTH ** np.arange(ACROSS))])
    depth = np.interp(np.arange(2 * ACROSS + 1) / 2, np.arange(ACROSS + 1), depth / depth[-1])
    for j in range(2 * ACROSS + 1):
        for i in range(2 * AROUND):
            if i % 2 and j % 2:
                continue  # no node in the middle of an element
            side, t = divmod((i + AROUND / 4) % (2 * AROUND), AROUND / 2)
            t = 2 * t / (AROUND / 2) - 1
            c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][int(side)]
            turn = np.array([[c, s], [-s, c]])
            on_edge = SIDE / 2 * np.array([1.0, t]) @ turn
            on_hole = RADIUS * np.array([np.cos(np.pi / 4 * t), np.sin(np.pi / 4 * t)]) @ turn
            number[i, j] = len(points)
            points.append(SIDE / 2 + (1 - depth[j]) * on_hole + depth[j] * on_edge)
    elements = [
        [
            number[(i + di) % (2 * AROUND), j + dj]
            for dj, di in ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        ]
        for j in range(0, 2 * ACROSS, 2)
        for i in range(0, 2 * AROUND, 2)
    ]
    outer = [k for (_, j), k in number.items() if j == 2 * ACROSS]
    return np.array(points), np.array(elements), np.array(outer)


def boundary(nodes: np.ndarray, u: np.ndarray) -> list[str]:
    """Prescribed displacements of both directions."""
    return [f"{k + 1}, {d + 1}, {d + 1}, {u[i, d]:.12g}" for i, k in enumerate(nodes) for d in (0, 1)]


def model(output: str, loads: list[np.ndarray], element_output: str = "") -> str:
    """The text of the input file: a step for each set of displacements of the outer nodes."""
    points, elements, outer = mesh()
    lines = ["*NODE, NSET=ALL", *(f"{k + 1}, {x:.12g}, {y:.12g}, 0" for k, (x, y) in enumerate(points))]
    lines += ["*ELEMENT, TYPE=CPS8, ELSET=PLATE"]
    lines += [f"{k + 1}, " + ", ".join(str(n + 1) for n in element) for k, element in enumerate(elements)]
    lines += ["*MATERIAL, NAME=PMMA", "*ELASTIC", f"{E:g}, {NU:g}"]
    lines += ["*SOLID SECTION, ELSET=PLATE, MATERIAL=PMMA", f"{THICKNESS:g}"]
    for number, u in enumerate(loads, 1):
        lines += ["*STEP", "*STATIC", "*BOUNDARY, OP=NEW", *boundary(outer, u)]
        lines += [f"*NODE FILE, OUTPUT={output}", "U"]
        if element_output and number == len(loads):
            lines += [f"*EL FILE, OUTPUT={output}", element_output]
        lines += ["*END STEP"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    points, _, outer = mesh()
    strained = np.column_stack([np.zeros(len(outer)), STRAIN * points[outer, 1]])
    Path("plate_2d.inp").write_text(model("2D", [kirsch(points[outer] - SIDE / 2), strained], "S, ENER"))
    Path("plate_expanded.inp").write_text(model("3D", [strained]))
