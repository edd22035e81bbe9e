"""Tensile toughness of reference plates, and F(u) of handbooks: simulated, and the time that it takes.

The plate of Paper D (section 2.1), increments and first lengths of 2 mm, the largest tangential stress, against a
high-order prototype, whose values are good to 1e-5. Edge and centre cracks in long strips under uniform tension, whose
critical displacement and stiffness follow for every length from a handbook's stress intensity: the compliance is its
integral. Writes validation/results/fracture_references.csv, a minute; ``--quick`` leaves out the finer tolerance and
the shorter increment, and writes nothing.
"""

from __future__ import annotations

import time

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.scene.gallery import tensile_plate
from slmm.scene.scene import Scene

#: holes (x, y, radius) or (x, y, semi-axes, angle), mm and degrees, and U_T, mJ
PLATES: dict[str, tuple[list[tuple[float, ...]], float]] = {
    "full plate": ([], 106.9194),
    "circle of 8 mm in the middle": ([(40.0, 40.0, 8.0)], 274.276),
    "circle beside the middle": ([(38.0, 44.0, 7.0)], 268.585),
    "two circles": ([(46.0, 45.0, 12.0), (24.0, 36.0, 4.0)], 270.745),
    "two circles, an ellipse": (
        [(28.0, 44.0, 6.0), (46.0, 30.0, 5.0), (62.0, 45.0, 6.0, 4.0, 10.0)],
        238.791,
    ),
}
TOLERANCE = 1e-3


def references(tolerance: float) -> list[Check]:
    """U_T, its estimated error and the time, at a tolerance."""
    checks = []
    for name, (holes, U_T) in PLATES.items():
        scene = tensile_plate(holes)
        result = simulate(scene, 2.0, tolerance=tolerance)
        taken = []
        for _ in range(3):
            begin = time.process_time()
            simulate(scene, 2.0, tolerance=tolerance, errors=False)
            taken.append(time.process_time() - begin)
        case = f"{name}, tolerance {tolerance:g}"
        ours, error = float(result.U_T), float(result.U_T_error)
        source = "prototype of high order"
        checks += [
            Check(case, "U_T, mJ", U_T, ours, TOLERANCE, source=source),
            Check(
                case,
                "true error over U_T_error",
                1.0,
                abs(ours - U_T) / max(error, 1e-4 * U_T),
                rule="at most",
            ),
            Check(case, "CPU time, s", np.nan, min(taken), rule="told"),
        ]
    return checks


def increments() -> list[Check]:
    """Half the increment: where no event competes, U_T hardly changes."""
    checks = []
    for name, (holes, _) in PLATES.items():
        scene = tensile_plate(holes)
        long, short = (
            float(simulate(scene, step, first_length=2.0, errors=False).U_T) for step in (2.0, 1.0)
        )
        checks.append(Check(name, "U_T, increment of 2 against 1 mm", short, long, TOLERANCE))
    return checks


def edge_crack(share: np.ndarray) -> np.ndarray:
    """K_I/(sigma sqrt(pi a)) of a crack over the width, free to bend (Tada, 0.5 %)."""
    half = 0.5 * np.pi * share
    with np.errstate(invalid="ignore"):
        root = np.sqrt(np.where(share > 0, np.tan(half) / half, 1.0))
    return root * (0.752 + 2.02 * share + 0.37 * (1 - np.sin(half)) ** 3) / np.cos(half)


def centre_crack(share: np.ndarray) -> np.ndarray:
    """The same over half the width, of half a crack (Tada, 0.1 %)."""
    return (1 - 0.025 * share**2 + 0.06 * share**4) * np.sqrt(1 / np.cos(0.5 * np.pi * share))


#: width of a strip, or half of it, its height over that, and the material; stress intensity by the crack's share
WIDTH, SLENDER, E, K_IC = 20.0, 6.0, 1000.0, 1.0
STRIPS = {"edge crack": edge_crack, "centre crack": centre_crack}
#: shares of cracks from first to last, and of increments; accuracy of critical displacements and stiffnesses: K and its
#: square's integral have that of the formulas
FROM, TO, BY, HANDBOOK = 0.1, 0.6, 0.05, 0.01


def strip(name: str) -> Scene:
    """Half of a strip with a centre crack rolls on the middle line."""
    middle = {"on": "left", "displacement": [0.0, "free"]}
    pulled = [{"on": on, "traction": [0.0, stress]} for on, stress in (("top", 1.0), ("bottom", -1.0))]
    height = SLENDER * WIDTH
    return Scene.from_dict(
        {
            "plate": {"width": WIDTH, "height": height},
            "cracks": [{"points": [[0.0, height / 2], [FROM * WIDTH, height / 2]]}],
            "material": {"E": E, "nu": 0.3, "sigma_c": 1e4, "K_Ic": K_IC, "state": "plane stress"},
            "boundary": [*pulled, *([middle] if name == "centre crack" else [])],
        }
    )


def handbooks() -> list[Check]:
    """Critical displacements and stiffnesses while the crack grows, against those of its stress intensity."""
    checks = []
    for name, factor in STRIPS.items():
        result = simulate(strip(name), BY * WIDTH, errors=False)
        share = np.concatenate([[FROM], result.x.values[:-1] / WIDTH])
        counts = share < TO + 0.5 * BY
        share, S, u_c = share[counts], result.stiffness.values[counts], result.u_c.values[counts]
        fine = np.linspace(0.0, share.max(), 10_001)
        step = np.diff(fine, prepend=0.0) * fine * factor(fine) ** 2
        # of a strip as thick as 1 mm: u/F without a crack, and 2/E times the integral of (K/F)^2
        compliance = (SLENDER + 2 * np.pi * np.interp(share, fine, np.cumsum(step))) / E
        force = K_IC * np.sqrt(1000) * WIDTH / (factor(share) * np.sqrt(np.pi * share * WIDTH))
        case = f"{name}, a/W {share.min():g} to {share.max():.2g}, {counts.sum()} lengths"
        for what, ours, wanted in (
            ("stiffness", S, 1 / compliance),
            ("critical displacement", u_c, force * compliance),
        ):
            worst = np.abs(ours / wanted - 1).argmax()
            checks.append(
                Check(case, f"{what}, worst", wanted[worst], ours[worst], HANDBOOK, source="Tada, 0.5 %")
            )
    return checks


def main(quick: bool = False) -> list[Check]:
    checks = [*references(0.01), *handbooks()]
    if not quick:
        checks += [*references(1e-3), *increments()]
    show("Tensile toughness of reference plates", checks)
    if not quick:
        save("fracture_references", (check.row() for check in checks))
    return checks


if __name__ == "__main__":
    run(main, __doc__)
