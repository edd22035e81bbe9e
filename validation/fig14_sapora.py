"""Fig. 14 of Paper A: critical stress of PMMA plates with small holes (Sapora et al.), plane strain, nu = 0.38.

Holes of 0.25, 0.5, 1 and 2 mm; the analytic coupled criterion with two symmetric cracks (Kirsch's stress, Tada's K),
as Sapora et al. have it, and with one crack, as SLMM+AC has it. Ours: SLMM+AC with the published settings and cell
(h = 1.95 r, section 3.3) and with the package's, dislocations, full FEA; point and averaged form of the stress
criterion. The specimens' width and height are not published, so a square plate of 40 radii stands for them: its stress
is 0.6 % above that of an unbounded plate, and the methods that see its edges are as much below the analytic load.
The measured stresses are not at hand.

Required: within 3 % of the analytic solution for one crack, at 0.25 mm too, by a method that applies; SLMM+AC does not
there (its crack is longer than the cell) and must say so.

Writes validation/results/fig14_sapora.csv and .png; a minute, ``--quick`` 15 s and no files.
"""

from __future__ import annotations

from dataclasses import replace

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show
from circular_hole import critical_stress, one_crack, two_cracks, unbounded_plate

from slmm import Scene, failure_indices
from slmm.initiation.settings import DEFAULT, PUBLISHED, Settings
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

RADII = (0.25, 0.5, 1.0, 2.0)
TOLERANCE = 0.03
#: the published cell's height in radii
CELL = 1.95
SMALLEST = min(RADII)
PUBLISHED_LABEL, DEFAULT_LABEL = "SLMM+AC, published", "SLMM+AC, default"
MARKERS = {PUBLISHED_LABEL: "x", DEFAULT_LABEL: "o", "dislocations": "s", "full FEA": "d"}


def plate(radius: float) -> Scene:
    return unbounded_plate(radius, gallery.sapora_plate(radius))


def methods(radius: float) -> dict[str, tuple[str, Settings]]:
    return {
        PUBLISHED_LABEL: ("slmm+ac", replace(PUBLISHED, height=CELL * radius)),
        DEFAULT_LABEL: ("slmm+ac", DEFAULT),
        "dislocations": ("dislocations", DEFAULT),
        "full FEA": ("full-fea", DEFAULT),
    }


def analytic(radius: float, shape, average: bool) -> float:
    """Critical stress in the unbounded plate, MPa."""
    material = plate(radius).material
    return material.sigma_c * critical_stress(radius / material.irwin_length, shape, average)


def compare(radius: float, average: bool, labels: tuple[str, ...]) -> list[Check]:
    """All methods at one hole against one crack; without a verdict for the paper's way and where there is no value."""
    scene, closed = plate(radius), analytic(radius, one_crack, average)
    case = f"R = {radius:g} mm, {'average' if average else 'point'}"
    checks = []
    for label in labels:
        method, settings = methods(radius)[label]
        result = failure_indices(scene, method, settings=settings, average=average)
        status, load = str(result.status.values[0]), scene.load.stress * float(result.load_factor[0])
        quantity = f"{label}, sigma_f, MPa" if status == "ok" else f"{label}: {status}"
        rule = "equal" if status == "ok" and label != PUBLISHED_LABEL else "told"
        checks.append(Check(case, quantity, closed, load, TOLERANCE, rule, "one crack: Kirsch, p-version"))
        if radius == SMALLEST and not average and label in (PUBLISHED_LABEL, DEFAULT_LABEL):
            said = float(status == "crack longer than the cell")
            checks.append(
                Check(case, f"{label}: says that its crack is too long", 1.0, said, 1e-9, source="Fig. 14")
            )
    both = analytic(radius, two_cracks, average)
    checks.append(Check(case, "two cracks instead of one, MPa", closed, both, rule="told"))
    return checks


def published_deviation(checks: list[Check]) -> list[Check]:
    """The paper's largest deviation from the analytic solution, 4.5 % at 0.5 mm; its sign is not said."""
    result = []
    for form in ("point", "average"):
        mine = [c for c in checks if c.case == f"R = 0.5 mm, {form}"]
        ours = next((c.ours for c in mine if c.quantity.startswith(PUBLISHED_LABEL)), np.nan)
        both = next((c.ours for c in mine if c.quantity.startswith("two cracks")), np.nan)
        quantity = f"{PUBLISHED_LABEL}: deviation from two cracks"
        result.append(Check(f"R = 0.5 mm, {form}", quantity, 0.045, abs(ours / both - 1), rule="told"))
    return result


def draw(checks: list[Check]) -> None:
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", sharey=True)
    fine = np.geomspace(0.2, 2.5, 40)
    for axis, form in zip(axes, ("point", "average"), strict=True):
        average = form == "average"
        axis.plot(fine, [analytic(r, two_cracks, average) for r in fine], "k-", label="analytic, two cracks")
        axis.plot(fine, [analytic(r, one_crack, average) for r in fine], "k--", label="analytic, one crack")
        for k, (label, marker) in enumerate(MARKERS.items()):
            found = [
                c for c in checks if c.case.endswith(form) and c.quantity.startswith(f"{label}, sigma_f")
            ]
            at = [float(c.case.split()[2]) for c in found]
            axis.plot(at, [c.ours for c in found], marker, color=f"C{k}", mfc="none", label=label)
        axis.axvline(SMALLEST, color="0.7", lw=0.8, ls=":")
        axis.annotate(
            "SLMM+AC not\napplicable",
            (SMALLEST, 0.03),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=8,
        )
        axis.set(xscale="log", xlabel="radius r in mm", title=f"{form} stress criterion", xlim=(0.18, 2.6))
        axis.set_xticks(RADII, [f"{r:g}" for r in RADII])
        axis.minorticks_off()
    axes[0].set_ylabel("critical stress $\\sigma_f$ in MPa")
    axes[1].legend(frameon=False)
    figure.savefig(RESULTS / "fig14_sapora.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    if quick:
        checks = compare(0.25, False, tuple(MARKERS)) + compare(0.5, False, tuple(MARKERS)[:3])
    else:
        checks = [c for r in RADII for average in (False, True) for c in compare(r, average, tuple(MARKERS))]
        checks += published_deviation(checks)
    show("Holes of Sapora et al. in PMMA, Fig. 14; wanted: one crack, analytic", checks)
    if not quick:
        save("fig14_sapora", [check.row() for check in checks])
        draw(checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
