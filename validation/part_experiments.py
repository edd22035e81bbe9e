"""Tests on parts of other outlines: toughness from asymmetric half disks, first kinks of disks with a slot.

- Half disks of a brittle resin with a sharp crack, under loads that break it from pure mode I to pure mode II
  (Marghitas et al., Procedia Struct. Integr. 56 (2024) 26; asymmetric_scb_loads.csv of the experiments). K by boundary
  integrals from sizes and load of each specimen; the toughness that maximum tangential stress then takes from it.
- PMMA disks with a slot to the centre, pulled by two pins (Hao et al., Theor. Appl. Fract. Mech. 125 (2023) 103840).
  The crack starts where the round end of the slot is pulled most, and goes on by local symmetry; its first 3 mm are the
  kink.

Required: the mean toughness of all 16 half disks within the scatter of the tests in mode I (0.057 of 1.012), the first
kink of the disk with four tests within two degrees. The symmetric half disks alone are told: the K of their authors is
9 to 14 % above ours, which the handbook's fit agrees with to 2 %. So is where the kink is read: 52 degrees at the root,
57 over 10 mm; a slit in place of the slot gives 51. Half a minute; ``--quick`` does one disk. Writes
validation/results/part_experiments.csv.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
from checks import Check, run, save, show

from slmm.boundary.model import BoundaryModel
from slmm.fracture.kinking import local_symmetry, maximum_tangential_stress
from slmm.mechanics.stress import principal_stress
from slmm.scene.scene import Scene

EXPERIMENTS = Path(__file__).parents[2] / "shared" / "experiments"
#: of a half disk's supports and load, over its radius: K no longer changes (chosen)
CONTACT = 0.01
#: MPa sqrt(m) in MPa sqrt(mm)
ROOT_MM = math.sqrt(1000.0)
#: width of the disks' slot, mm
SLOT = 3.0
#: length of a path that tells its first direction, and of its increments, mm (chosen)
FIRST, STEP = 3.0, 0.5
#: first kink, degrees, of disks whose slot is 60 degrees off: the mean of four tests
FOUR_TESTS = 54.5


def half_disk(row: dict[str, str]) -> Scene:
    """A specimen under its largest load: both supports press, as the load's place asks of them."""
    R, t, a, left, right, P = (float(row[k]) for k in ("R_mm", "t_mm", "a_mm", "S1_mm", "S2_mm", "Pmax_N"))
    width, share = CONTACT * R, right / (left + right)
    return Scene.from_dict(
        {
            "part": {
                "outline": {
                    "shape": "polygon",
                    "points": [[-R, 0.0], [R, 0.0], [R, R], [-R, R]],
                    "corner_radii": [0.0, 0.0, R, R],
                },
                "thickness": t,
            },
            "cracks": [{"points": [[0.0, 0.0], [0.0, a]]}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"at": [-left, 0.0], "width": width, "force": [0.0, share * P]},
                {"at": [right, 0.0], "width": width, "force": [0.0, (1 - share) * P]},
                {"at": [0.0, R], "width": width, "force": [0.0, -P]},
            ],
        }
    )


def toughness(K_I: float, K_II: float) -> float:
    """K_Ic by maximum tangential stress from K at fracture."""
    angle = maximum_tangential_stress(K_I, K_II)
    return math.cos(angle / 2) * (K_I * math.cos(angle / 2) ** 2 - 1.5 * K_II * math.sin(angle))


def half_disks() -> list[Check]:
    with open(EXPERIMENTS / "asymmetric_scb_loads.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    checks, found, symmetric = [], [], []
    for row in rows:
        scene = half_disk(row)
        (K,) = BoundaryModel(scene.part, scene.material, scene.loading).stress_intensities() / ROOT_MM
        case = f"half disk {row['specimen']}"
        K_Ic = toughness(float(K[0]), float(K[1]))
        size = math.hypot(float(row["KI_MPa_sqrtm"]), float(row["KII_MPa_sqrtm"]))
        checks += [
            Check(
                case,
                "K_I, K_II in all, MPa sqrt(m)",
                size,
                float(np.hypot(*K)),
                rule="told",
                source="authors",
            ),
            Check(
                case,
                "K_Ic by maximum tangential stress",
                1.012,
                K_Ic,
                rule="told",
                source="tests, 1.012 +- 0.057",
            ),
        ]
        found.append(K_Ic)
        if row["S1_mm"] == row["S2_mm"]:
            symmetric.append(K_Ic)
    checks.append(
        Check(
            f"{len(found)} half disks",
            "mean K_Ic, MPa sqrt(m)",
            1.012,
            float(np.mean(found)),
            0.057 / 1.012,
            source="tests of the symmetric ones, 1.012 +- 0.057",
        )
    )
    told = Check(
        f"{len(symmetric)} symmetric half disks", "mean K_Ic", 1.012, float(np.mean(symmetric)), rule="told"
    )
    return [*checks, told]


def slotted_disk(degrees: float) -> Scene:
    """A disk pulled along y by two pins, with a round-ended slot to its centre, whose normal is so far from y."""
    pins, force = 39.0, 1000.0
    slot = {"shape": "v-notch", "tip": [0.0, 0.0], "direction": degrees, "opening": 0.0, "radius": SLOT / 2}
    return Scene.from_dict(
        {
            "part": {"outline": {"shape": "circle", "center": [0.0, 0.0], "radius": 60.0}, "thickness": 10.0},
            "holes": [{"shape": "circle", "center": [0.0, y], "radius": 6.4} for y in (pins, -pins)] + [slot],
            "material": {"name": "PMMA"},
            "boundary": [{"on": "hole 0", "pin": [0.0, force]}, {"on": "hole 1", "pin": [0.0, -force]}],
        }
    )


def first_path(scene: Scene) -> np.ndarray:
    """Points (n, 2), mm, of a crack that starts where the slot's stress is largest, by local symmetry."""
    slot = scene.outlines[2]
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    s = slot.project(np.zeros((1, 2)))[0] + SLOT * np.linspace(-0.7, 0.7, 400)
    start = s[principal_stress(model.stress(slot.points(s))).argmax()]
    along = slot.normals(start)
    part = scene.part.with_crack([slot.points(start), slot.points(start) + STEP * along])
    while np.linalg.norm(part.tips[0][-1] - part.tips[0][0]) < FIRST:
        model = BoundaryModel(part, scene.material, scene.loading)
        (K,) = model.stress_intensities()
        angle = local_symmetry(float(K[0]), float(K[1]))
        c, s = math.cos(angle), math.sin(angle)
        along = np.array([[c, -s], [s, c]]) @ along
        part = part.grown(0, part.tips[0][-1] + STEP * along)
    return part.tips[0]


def disks(quick: bool) -> list[Check]:
    checks = []
    for degrees in (60.0,) if quick else (0.0, 30.0, 60.0, 75.0):
        path = first_path(slotted_disk(degrees))
        x, y = path[-1] - path[0]
        kink = degrees - math.degrees(math.atan2(y, x))
        case = f"disk, {degrees:g} degrees"
        if degrees == 60.0:
            checks += [
                Check(
                    case, "first kink, degrees", FOUR_TESTS, kink, rule="told", source="mean of four tests"
                ),
                Check(case, "off the measured kink, degrees", 2.0, abs(kink - FOUR_TESTS), rule="at most"),
            ]
        else:
            checks.append(Check(case, "first kink, degrees", math.nan, kink, rule="told"))
    return checks


def main(quick: bool = False) -> list[Check]:
    checks = half_disks() + disks(quick)
    show("Tests on half disks and disks", checks)
    if not quick:
        save("part_experiments", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
