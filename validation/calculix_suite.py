"""Every result of CalculiX' own test suite is read, or refused for a reason that is true.

The suite is the folder ``test`` of https://github.com/Dhondtguido/CalculiX (commit 3593817, August 2026; GPL, nothing
of it is kept here). Given that folder, or any other with .frd and .inp files::

    python validation/calculix_suite.py FOLDER --run     # ccx (Debian: calculix-ccx) solves a copy of each .inp first
    python validation/calculix_suite.py FOLDER           # the .frd files as they are

Most inputs of the suite write no displacements: to the copies, *NODE FILE with U, RF and *EL FILE with S, ENER is added
in each step. Each result goes to ``slmm forces`` and to what ``--displacements`` reads. Where stresses follow from the
displacements, the nodal forces that balance them are compared with those of the file (RF), which contain what contact,
ties and inertia add: types, order of nodes, integration and materials are then read right.

Required: no crash, no exit code but 0 and 2, no reason but those listed here; nodal forces within 1 % in the median
file. Writes validation/results/calculix_suite.csv; 10 minutes with ``--run``, 3 without.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import re
import shutil
import subprocess
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from checks import Check, save, show
from rich import box
from rich.console import Console
from rich.table import Table
from typer.testing import CliRunner

from slmm.command.cli import app
from slmm.mechanics.element_results import ElementResults
from slmm.mechanics.elements import element_named
from slmm.results.frd import read_frd
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

#: what is added to each step
OUTPUT = "*NODE FILE\nU, RF\n*EL FILE\nS, ENER\n"

#: why a result may be refused, in the words of the messages
TRUE_REASONS = {
    "no displacements are asked for": r"holds no (displacements|nodes)|no finite displacement of node",
    "the run broke off": r"9999, is missing|the block is cut off|no CalculiX result file",
    "flows: CalculiX announces displacements and writes none": r"nodes announced, 0 found",
    "meshes in binary": r"form '[23]': only ASCII",
    "modes of vibration or buckling": r"is a mode of vibration or buckling",
    "shells, beams, membranes, trusses, axisymmetric and users' elements": r"has elements of type "
    r"((S|B|M3D|T\dD|CAX|U)\w+(, )?)+: only|there are no plane or solid elements|axisymmetric elements",
    "other elements than those of the input file": r"REFINE MESH|MODEL CHANGE|COMPOSITE|has no element|names node \d+",
    "several thicknesses": r"NODAL THICKNESS|several thicknesses",
    "parts and instances": r"\*PART: parts and instances",
    "stresses follow from more than displacements, and are not in the file": r"(stress|energy) not known at this step",
}
NOT_PLANE = r"a plane model( in the x-y plane)? (of .* )?is needed|there is no element"


class Verdict(NamedTuple):
    """What became of a result file: "read", "refused" or "failed", why, and whether that is among what is true."""

    name: str
    forces: str
    reason: str
    plane: str
    plane_reason: str
    difference: float

    @property
    def right(self) -> bool:
        """Read, or refused for a reason that is true."""
        return all(
            verdict == "read" or (verdict == "refused" and bool(true_reason(reason)))
            for verdict, reason in ((self.forces, self.reason), (self.plane, self.plane_reason))
        )


def true_reason(reason: str) -> str:
    """Which of the reasons a message gives; none, if it is empty."""
    if re.search(NOT_PLANE, reason):
        return "not a plane model"
    return next((called for called, words in TRUE_REASONS.items() if re.search(words, reason)), "")


def solve(folder: Path, copy: Path, seconds: float) -> None:
    """Let CalculiX solve every input of a folder, in a copy of it."""
    shutil.copytree(folder, copy, dirs_exist_ok=True)
    inputs = sorted(copy.glob("*.inp"), key=lambda path: path.stat().st_size)
    for path in inputs:
        text = path.read_text(encoding="latin-1")
        path.write_text(re.sub(r"(?im)^\s*\*\s*end\s*step", rf"{OUTPUT}\g<0>", text), encoding="latin-1")
    for number, path in enumerate(inputs, 1):
        print(f"\r{number} of {len(inputs)}: {path.stem:40s}", end="", flush=True)
        with contextlib.suppress(subprocess.TimeoutExpired):  # what it has written is read like the rest
            subprocess.run(
                ["ccx", path.stem],
                cwd=copy,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=seconds,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )
    print()


def verdicts(folder: Path) -> Iterator[Verdict]:
    """Of every result in a folder."""
    for path in sorted(folder.glob("*.frd")):
        ran = CliRunner().invoke(app, ["forces", str(path)])
        unexpected = ran.exception is not None and not isinstance(ran.exception, SystemExit)
        forces = "failed" if unexpected else {0: "read", 2: "refused"}.get(ran.exit_code, "failed")
        reason = str(ran.exception) if unexpected else " ".join(ran.stderr.split())
        plane, plane_reason = "read", ""
        try:
            read_displacements(path)
        except ValueError as error:
            plane, plane_reason = "refused", str(error)
        except Exception as error:  # whatever else it is, it is what this looks for
            plane, plane_reason = "failed", f"{type(error).__name__}: {error}"
        difference = force_difference(path) if forces == "read" else math.nan
        here = [
            text.replace(f"{folder}{os.sep}", "")
            for text in (reason if forces != "read" else "", plane_reason)
        ]
        yield Verdict(path.name, forces, here[0], plane, here[1], difference)


def nodal_forces(results: ElementResults) -> np.ndarray:
    """Forces (n, d) that balance the stresses, N."""
    forces = np.zeros_like(results.points)
    for name, nodes in results.cells.items():
        element = element_named(name)
        jacobian = np.einsum("eni,qnj->eqij", results.points[nodes], element.gradient_at_points)
        gradient = np.einsum("qnj,eqji->eqni", element.gradient_at_points, np.linalg.inv(jacobian))
        volume = np.linalg.det(jacobian) * element.weights
        np.add.at(forces, nodes, np.einsum("eqij,eqnj,eq->eni", results.stress[name], gradient, volume))
    return forces * results.thickness


def force_difference(path: Path) -> float:
    """Largest difference from the nodal forces of the file, over the largest of these; NaN where they are unknown."""
    results, frd = read_element_results(path), read_frd(path)
    displacement = frd.fields["DISP"][-1]
    found = [
        f for f in frd.fields.get("FORC", []) if (f.step, f.value) == (displacement.step, displacement.value)
    ]
    if not results.source.startswith("displacements") or not found:
        return math.nan
    solid = [nodes.ravel() for kind, nodes in frd.cells.items() if not kind.startswith("line")]
    used = np.unique(np.concatenate(solid))
    if len(used) != len(results.points):  # solids in place of plane elements
        return math.nan
    theirs = np.nan_to_num(found[0].values[used, : results.dimension])
    largest = np.abs(theirs).max()
    # below the digits of stresses that are none, as of a body that flies
    if (
        largest
        < 1e-9 * results.elasticity[0].E * np.abs(results.u).max() * np.ptp(results.points, axis=0).max()
    ):
        return math.nan
    return float(np.abs(nodal_forces(results) - theirs).max() / largest)


def study(folder: Path) -> tuple[list[Check], list[Verdict]]:
    """Table of what became of the results, and the checks."""
    found = list(verdicts(folder))
    title = f"{len(found)} results"
    table = Table("slmm forces", "why", "files", title=title, box=box.SIMPLE_HEAD, title_justify="left")
    counted = Counter((v.forces, true_reason(v.reason) if v.forces != "read" else "") for v in found)
    for (verdict, why), count in sorted(counted.items(), key=lambda item: -item[1]):
        table.add_row(verdict, why, str(count))
    Console(width=140).print(table)
    for verdict in found:
        if not verdict.right:
            print("TO BE LOOKED AT", *verdict)
    wrong = sum(not v.right for v in found)
    checks = [
        Check("all results", "neither read nor refused for a true reason", 0, wrong, rule="at most"),
        Check(
            "all results",
            "read by slmm forces",
            math.nan,
            sum(v.forces == "read" for v in found),
            rule="told",
        ),
        Check(
            "all results",
            "read by --displacements",
            math.nan,
            sum(v.plane == "read" for v in found),
            rule="told",
        ),
    ]
    if known := [v.difference for v in found if math.isfinite(v.difference)]:
        case, near = f"{len(known)} with RF", sum(difference < 0.01 for difference in known)
        checks += [
            Check(case, "difference of nodal forces, median", 0.01, float(np.median(known)), rule="at most"),
            Check(case, "share of files within 1 %", math.nan, near / len(known), rule="told"),
        ]
    show("Results of CalculiX", checks)
    return checks, found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="with .frd and .inp files")
    parser.add_argument("--run", action="store_true", help="solve copies of the .inp files first")
    parser.add_argument("--seconds", type=float, default=20.0, help="for each of them (default: 20)")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = asked.folder
        if asked.run:
            folder = Path(name) / "suite"
            solve(asked.folder, folder, asked.seconds)
        checks, found = study(folder)
    save("calculix_suite", [verdict._asdict() for verdict in found])
    raise SystemExit(0 if all(check.holds for check in checks) else 1)


if __name__ == "__main__":
    main()
