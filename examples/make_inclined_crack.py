"""Writes inclined_crack.inp, a plate with an inclined crack, and has CalculiX (ccx) solve it; needs the extra `fea`."""

import subprocess
from pathlib import Path

import numpy as np

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.slit import open_slits
from slmm.part.part import Part

SIDE, HALF, ANGLE = 60.0, 10.0, np.radians(35.0)
PULL = 0.03  # mm, at the top and at the bottom


def main() -> None:
    """Write both files next to this script."""
    half = HALF * np.array([np.cos(ANGLE), np.sin(ANGLE)])
    crack = np.array([SIDE / 2 - half, SIDE / 2 + half])
    mesh = open_slits(plate_mesh(Part.plate(SIDE, SIDE, cracks=[crack]), policy=SizePolicy(largest=8.0))).mesh
    points = mesh.doflocs.T
    triangles = np.concatenate([mesh.t, mesh.nvertices + mesh.t2f]).T
    a, b, c = points[triangles[:, :3]].swapaxes(0, 1)
    clockwise = np.cross(np.pad(b - a, ((0, 0), (0, 1))), np.pad(c - a, ((0, 0), (0, 1))))[:, 2] < 0
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1, 5, 4, 3]]
    y = points[:, 1]
    bottom, top = np.flatnonzero(y < 1e-9), np.flatnonzero(y > SIDE - 1e-9)
    held = bottom[np.argmin(points[bottom, 0])]
    lines = [
        "** A plate of steel, 60 x 60 mm, pulled; a crack of 20 mm at 35 degrees. N, mm, MPa",
        "*NODE, NSET=ALL",
        *(f"{i + 1}, {x:.9g}, {y:.9g}, 0" for i, (x, y) in enumerate(points)),
        "*ELEMENT, TYPE=CPE6, ELSET=PLATE",
        *(f"{i + 1}, " + ", ".join(str(n + 1) for n in nodes) for i, nodes in enumerate(triangles)),
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        "210000, 0.3",
        "*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL",
        "1.",
        "*STEP",
        "*STATIC",
        "*BOUNDARY",
        f"{held + 1}, 1, 1, 0.",
        *(f"{i + 1}, 2, 2, {-PULL}" for i in bottom),
        *(f"{i + 1}, 2, 2, {PULL}" for i in top),
        "*NODE FILE",
        "U",
        "*END STEP",
        "",
    ]
    model = Path(__file__).with_name("inclined_crack.inp")
    model.write_text("\n".join(lines))
    subprocess.run(["ccx", model.stem], cwd=model.parent, check=True)
    for left in (
        *(model.with_suffix(s) for s in (".12d", ".cvg", ".dat", ".sta")),
        model.with_name("spooles.out"),
    ):
        left.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
