"""J and K from results of CalculiX, a finite element program of others: Paper B's disk, written, solved, read back.

Needs ``ccx`` (Debian: calculix-ccx); without it the script says so and ends well. The disk has the displacements of
K_I = 20 and K_II = 10 MPa sqrt(m) at its rim; rings of quadrilaterals, triangles at the tip. Results are read from
CalculiX's .frd with the types and the material of the .inp beside it; once more from averaged nodal stresses and
energies alone, as of a material that is not known, and once with large displacements.

Required: J and K within 0.5 %. Writes validation/results/calculix.csv, 15 seconds; ``--quick`` one element type.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from checks import Check, run, save, show
from crack_tips import DISKS, ROOT_M, STEEL, disk

from slmm.fracture.loading import crack_tip_loading
from slmm.fracture.tip_field import tip_displacement
from slmm.results.read_results import read_element_results

K = 20.0, 10.0


def model(element_type: str, nlgeom: bool = False) -> str:
    """The disk as CalculiX's input."""
    points, cells, rim = disk(element_type, sectors=DISKS[element_type])
    nodes = cells[element_type]
    blocks = {element_type: nodes}
    if element_type not in ("CPE3", "CPE6"):  # triangles in place of the collapsed ones at the tip
        collapsed = nodes[:, 0] == nodes[:, 3]
        corner = [0, 1, 2] if nodes.shape[1] == 4 else [0, 1, 2, 4, 5, 6]
        blocks = {element_type: nodes[~collapsed], f"CPE{len(corner)}": nodes[collapsed][:, corner]}
    at = points[rim].copy()
    at[0, 1] = -0.0  # the lower face's end
    u = tip_displacement(at, ROOT_M * np.array(K), STEEL)
    used = np.unique(np.concatenate([block.ravel() for block in blocks.values()]))
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i + 1}, {points[i, 0]:.12g}, {points[i, 1]:.12g}, 0" for i in used]
    number = 0
    for name, block in blocks.items():
        lines.append(f"*ELEMENT, TYPE={name}, ELSET=DISK")
        lines += [f"{number + k + 1}, " + ", ".join(str(n + 1) for n in row) for k, row in enumerate(block)]
        number += len(block)
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{STEEL.E:g}, {STEEL.nu:g}"]
    lines += ["*SOLID SECTION, ELSET=DISK, MATERIAL=STEEL", "1.0"]
    lines += ["*STEP, NLGEOM" if nlgeom else "*STEP", "*STATIC", "*BOUNDARY"]
    lines += _prescribed(rim, u)
    lines += ["*NODE FILE", "U", "*EL FILE", "S, ENER", "*END STEP", ""]
    return "\n".join(lines)


def _prescribed(rim: np.ndarray, u: np.ndarray) -> list[str]:
    return [
        f"{node + 1}, {i + 1}, {i + 1}, {value:.12g}"
        for node, row in zip(rim, u, strict=True)
        for i, value in enumerate(row)
    ]


def solved_by_calculix(text: str, folder: Path, name: str) -> Path:
    """Run CalculiX; the path of its results."""
    (folder / f"{name}.inp").write_text(text)
    done = subprocess.run(
        ["ccx", name], cwd=folder, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "2"}
    )
    if done.returncode or not (folder / f"{name}.frd").exists():
        raise RuntimeError(f"ccx {name} failed: {done.stdout[-500:]}")
    return folder / f"{name}.frd"


def main(quick: bool = False) -> list[Check]:
    if shutil.which("ccx") is None:
        print("CalculiX (ccx) is not installed: nothing is checked. Debian has it as calculix-ccx.")
        return []
    exact = 1e6 * np.array([K[0] ** 2 + K[1] ** 2, -2 * K[0] * K[1]]) / STEEL.E_prime
    checks = []

    def compare(case: str, path: Path, **options: object) -> None:
        tip = crack_tip_loading(read_element_results(path, **options)).isel(tip=0)
        values = {"J_x, J/m2": 1e3 * tip.G, "J_y, J/m2": 1e3 * tip.J_across}
        values |= {"K_I, MPa sqrt(m)": tip.K_I / ROOT_M, "K_II, MPa sqrt(m)": tip.K_II / ROOT_M}
        for (quantity, ours), wanted in zip(values.items(), [*exact, *K], strict=True):
            if np.isfinite(ours):
                checks.append(Check(case, quantity, wanted, float(ours), 5e-3, source="exact"))

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for element_type in ["CPE8R"] if quick else DISKS:
            path = solved_by_calculix(model(element_type), folder, element_type)
            compare(f"CalculiX, {element_type}", path)
        if not quick:
            lonely = folder / "fields.frd"
            shutil.copy(folder / "CPE8.frd", lonely)
            compare("CalculiX, CPE8, nodal stresses and energies alone", lonely, method="linear")
            path = solved_by_calculix(model("CPE8", nlgeom=True), folder, "large")
            compare("CalculiX, CPE8, large displacements", path)
    show("J and K from CalculiX", checks)
    if not quick:
        save("calculix", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
