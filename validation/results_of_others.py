"""Failure indices from results of other programs, against full FEA of the same part.

Parts are meshed with so many elements for each quarter turn of their notches (body-fitted triangles, or thirds of them
as quadrilaterals, coarse away from notches), solved elsewhere, and read with nothing but the material. CalculiX
(``ccx``; Debian: calculix-ccx) solves six types of elements and writes .frd; FreeFEM (``FreeFem++``; Debian: freefem++
and libfreefem++) linear and quadratic triangles, whose corners it writes as VTU in single precision; scikit-fem linear
triangles and quadrilaterals, written as MED in the form of Code_Aster, which is not at hand here. A program that is not
installed is left out, and the script says so.

Required: the index where it is largest within 2 % from ten elements a quarter on, and within the estimate on all.
A refusal is told, and is no value. Writes validation/results/results_of_others.csv; ``--quick`` one part, coarse.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from checks import Check, run, save, show
from med_file import write_med
from solved_elsewhere import TYPES, by_calculix, by_freefem, by_scikit_fem, distorted, model

from slmm import Scene, failure_indices, gallery, read_scene
from slmm.initiation.solved_scene import solved_scene

PARTS = Path(__file__).parents[1] / "examples" / "parts"
#: elements a quarter, and from which on 2 % are required
MESHES, FINE, WITHIN = (3, 5, 10), 10, 0.02
#: inner nodes are moved by this share of the shortest edge beside them
DISTORTED = 0.25
#: types in all parts, and in those that all types are tried on
FEW = ("CPS3", "CPS4R")
PULLED = {"load": {"stress": 10.0}}


def parts() -> dict[str, tuple[Scene, tuple[float, float], tuple[str, ...]]]:
    """Scenes, where the index is largest, and which of CalculiX' elements."""
    hole = gallery.circular_hole(radius=10.0)
    return {
        "hole, moved": (hole.with_(load={"displacement": 0.5}), (60.0, 50.0), tuple(TYPES)),
        "ellipse, pulled": (gallery.elliptic_hole(**PULLED), (70.0, 50.0), tuple(TYPES)),
        "two holes, pulled": (gallery.two_holes(ligament=10.0, **PULLED), (55.0, 50.0), FEW),
        "lobed notch, strained": (gallery.lobed_notch(), (74.27, 48.34), FEW),
        "V-notch, pulled": (gallery.v_notch(), (10.0, 60.0), FEW),
        "square hole, pulled": (gallery.square_hole(**PULLED), (65.0, 65.0), FEW),
        "keyhole, pulled": (read_scene(PARTS / "keyhole.toml"), (23.0, 0.0), FEW),
    }


def files(scene: Scene, types: tuple[str, ...], count: int, folder: Path) -> Iterator[tuple[str, Path]]:
    """Which program and element, and its results."""
    if shutil.which("ccx"):
        for name in types:
            given = model(scene, TYPES[name], count)
            yield f"CalculiX, {name}", by_calculix(given, name, scene, folder, f"{name}_{count}")
            if name == "CPS4":
                crooked = distorted(given, DISTORTED)
                path = by_calculix(crooked, name, scene, folder, f"{name}_{count}_distorted")
                yield f"CalculiX, {name} distorted", path
    straight = not any(condition.span for condition in scene.loading)
    if shutil.which("FreeFem++") and straight:
        for element in ("P1", "P2"):
            yield f"FreeFEM, {element}, VTU", by_freefem(scene, count, element, folder, f"{element}_{count}")
    for kind in ("triangle", "quad"):
        given = model(scene, kind, count)
        path = folder / f"{kind}_{count}.med"
        write_med(path, given.points, kind, given.nodes, by_scikit_fem(given, scene))
        yield f"scikit-fem, {kind}, MED", path


def study(
    name: str, scene: Scene, at: tuple[float, float], types: tuple[str, ...], meshes: tuple[int, ...]
) -> list[Check]:
    """All programs and meshes of a part."""
    wanted = float(failure_indices(scene.with_(analysis={"points": [list(at)]}), "full-fea").failure_index[0])
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for count in meshes:
            for program, path in files(scene, types, count, Path(folder)):
                case = f"{name}; {program}, {count} a quarter"
                try:
                    solved = solved_scene(path, scene.material)
                    own = solved.with_(analysis={"points": [list(at)], "method": "boundary"})
                    result = failure_indices(own)
                except ValueError as error:
                    print(f"{case}: refused: {error}")
                    found.append(Check(case, "refused", np.nan, np.nan, rule="told"))
                    continue
                index, told = (float(result[key][0]) for key in ("failure_index", "failure_index_error"))
                found.append(
                    Check(case, "off, of the estimate", 1.0, abs(index - wanted) / told, rule="at most")
                )
                rule = "equal" if count >= FINE else "told"
                found.append(Check(case, "index", wanted, index, WITHIN, rule=rule, source="full FEA"))
    return found


def main(quick: bool = False) -> list[Check]:
    for program in ("ccx", "FreeFem++"):
        if shutil.which(program) is None:
            print(f"{program} is not installed: its results are left out.")
    checks = []
    for name, (scene, at, types) in parts().items():
        if quick and name != "ellipse, pulled":
            continue
        found = study(name, scene, at, types[:1] if quick else types, (5, 10) if quick else MESHES)
        show(name, found)
        checks += found
        if not quick:
            save("results_of_others", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
