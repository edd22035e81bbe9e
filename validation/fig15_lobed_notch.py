"""Fig. 15 of Paper A: a notch with several lobes under e_xx, e_yy and g_xy of 0.1, PMMA, 50 positions.

The paper's outline is not published; ours is ``gallery.lobed_notch``. Failure indices along it by SLMM+AC with the
published and with the package's own settings, by dislocations, and by full FEA at every position; then the curves at
the most critical one. Critical positions are the maxima of the failure index above a fifth of the highest.

Required: FI within 3 % of full FEA at the most critical position (own settings, dislocations). The critical positions
and their order are full FEA's, with the published settings too, as the paper says of its notch. Told: the paper's FI
is up to 10.8 % too high at the most critical positions.

Writes validation/results/fig15_lobed_notch.csv (checks), _index.csv and .png; five to ten minutes, nearly all of them
for full FEA at 150 positions; ``--quick`` half a minute, full FEA at the most critical positions alone, and no files.
"""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from accuracy import reference, with_irwin_length
from checks import RESULTS, Check, at_spread_positions, run, save, show
from matplotlib.lines import Line2D
from scipy.interpolate import CubicSpline

from slmm import Scene, coupled_criterion, failure_indices
from slmm.initiation.local_model import solve_local_model
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

POSITIONS = 50
LOADS = {"e_xx": (0.1, 0.0, 0.0), "e_yy": (0.0, 0.1, 0.0), "g_xy": (0.0, 0.0, 0.1)}
TITLES = {"e_xx": "$\\epsilon_{xx}$ = 0.1", "e_yy": "$\\epsilon_{yy}$ = 0.1", "g_xy": "$\\gamma_{xy}$ = 0.1"}
PUBLISHED, DEFAULT, DISLOCATIONS, FULL = "SLMM+AC, published", "SLMM+AC, default", "dislocations", "full FEA"
#: method, settings, line
METHODS = {
    PUBLISHED: ("slmm+ac", "published", {"color": "C0", "ls": "--"}),
    DEFAULT: ("slmm+ac", "default", {"color": "C3", "ls": "-."}),
    DISLOCATIONS: ("dislocations", "default", {"color": "C2", "ls": ":"}),
}
REFERENCE = {"color": "0.75", "lw": 4}
LIMIT = 0.03
#: maxima below this share of the highest failure index are not critical
MINOR = 0.2

Index = dict[str, xr.Dataset]


def index_along(scene: Scene) -> Index:
    """Failure indices by every method but full FEA."""
    spread = at_spread_positions(scene, POSITIONS)
    return {
        label: failure_indices(spread, method, settings=settings)
        for label, (method, settings, _) in METHODS.items()
    }


def critical_positions(index: np.ndarray) -> list[int]:
    """Maxima of the failure index along the closed outline, the highest first."""
    index = np.nan_to_num(index)
    peaks = (index > np.roll(index, 1)) & (index >= np.roll(index, -1)) & (index > MINOR * np.nanmax(index))
    return sorted(np.flatnonzero(peaks).tolist(), key=lambda i: -index[i])


def at_most_critical(load: str, found: Index, truth: float, at: int) -> list[Check]:
    """Failure indices at the position that is most critical by full FEA."""
    checks = []
    for label in METHODS:
        over = float(found[label].failure_index[at]) / truth - 1
        case = f"{load}, {label}"
        if label == PUBLISHED:
            quantity = "FI over full FEA, most critical; paper: at most"
            checks.append(Check(case, quantity, 1.108, 1 + over, rule="told", source="Paper A, 3.1.2"))
        else:
            checks.append(Check(case, "error of FI, most critical", LIMIT, abs(over), rule="at most"))
    return checks


def ranking(load: str, found: Index, full: np.ndarray) -> list[Check]:
    """Which critical positions a method finds, and in which order."""
    true = critical_positions(full)
    checks = []
    for label in METHODS:
        FI = found[label].failure_index.values
        mine, case = critical_positions(FI), f"{load}, {label}"
        missed = sum(
            min((i - j) % POSITIONS, (j - i) % POSITIONS) > 1 for i, j in zip(true, mine, strict=False)
        )
        missed += abs(len(true) - len(mine))
        checks.append(
            Check(case, f"critical positions ({len(true)}) in another order", 0.0, missed, rule="at most")
        )
        errors = [abs(FI[i] / full[i] - 1) for i in true]
        checks.append(Check(case, "error of FI, largest of all critical", np.nan, max(errors), rule="told"))
    return checks


def by_full_fea(scene: Scene, rows: list[int]) -> np.ndarray:
    """Failure indices by full FEA at some of the positions, NaN elsewhere."""
    s = np.arange(POSITIONS) * scene.outlines[0].length / POSITIONS
    points = scene.outlines[0].points(s[rows]).tolist()
    FI = np.full(POSITIONS, np.nan)
    FI[rows] = failure_indices(scene.with_(analysis={"points": points}), "full-fea").failure_index.values
    return FI


def draw_deformed(axis: plt.Axes, scene: Scene, critical: list[int], load: str) -> None:
    local = solve_local_model(scene, 250_000)
    outline = scene.outlines[0]
    at = outline.polygon(600)
    at = np.vstack([at, at[:1]])
    edge = np.array([[0, 0], [100, 0], [100, 100], [0, 100], [0, 0]], dtype=float)
    axis.fill(*(edge + local.displacement(edge)).T, fc="0.9", ec="0.3")
    axis.fill(*(at + local.displacement(at)).T, fc="w", ec="0.3")
    axis.plot(*at.T, color="0.6", lw=0.8, ls="--")
    s = np.array(critical) * outline.length / POSITIONS
    points, normals = outline.points(s), outline.normals(s)
    moved = points + local.displacement(points)
    axis.plot(*moved.T, "o", color="C3", ms=4)
    for k, (x, y) in enumerate(moved + 6 * normals):
        axis.annotate(f"({k + 1})", (x, y), ha="center", va="center", fontsize=9)
    axis.set(aspect="equal", xlabel="x in mm", ylabel="y in mm", title=TITLES[load])


def draw_criterion(axis: plt.Axes, scene: Scene, at: int) -> None:
    """Stress over strength and energy over toughness at the critical load of full FEA."""
    outline = scene.outlines[0]
    point = outline.points(np.array([at * outline.length / POSITIONS]))[0].tolist()
    there = scene.with_(analysis={"points": [point]})
    cells = {
        label: failure_indices(there, method, curves=True, settings=settings)
        for label, (method, settings, _) in METHODS.items()
        if method == "slmm+ac"
    }
    longest = float(cells[PUBLISHED].a[0, -1])
    # dislocations go as far as a tougher material's crack would
    longer = with_irwin_length(there, 2 * longest)
    curves = cells | {DISLOCATIONS: failure_indices(longer, "dislocations", curves=True)}
    full = reference(scene, point, longest)
    m = scene.material
    critical = coupled_criterion(full.a, full.G_inc, full.sigma_I[1:], m)
    lf = critical.load_factor
    a = np.linspace(full.a[0], full.a[-1], 300)
    axis.plot(full.eta, lf * full.sigma_I / m.sigma_c, **REFERENCE)
    axis.plot(a, lf**2 * CubicSpline(full.a, full.G_inc / full.a)(a) * a / m.G_c, **REFERENCE)
    for label, (_, _, line) in METHODS.items():
        c = curves[label].isel(position=0)
        axis.plot(c.a, lf * c.sigma_I / m.sigma_c, **line)
        axis.plot(c.a, lf**2 * c.G_inc / m.G_c, **line)
    axis.axhline(1, color="k", lw=0.6)
    axis.plot(critical.crack_length, 1, "ko", ms=4)
    axis.annotate("$a_c$", (critical.crack_length, 1), (4, 5), textcoords="offset points")
    axis.set(xlim=(0, longest), ylim=(0, None), xlabel="crack length a, depth $\\eta$ in mm")
    axis.set(title="position (1)", ylabel="$\\sigma_I/\\sigma_c$ (falling), $G_{inc}/G_c$ (rising)")


def draw(found: dict[str, Index], full: dict[str, np.ndarray]) -> None:
    figure, axes = plt.subplots(3, 3, figsize=(12, 11), layout="constrained")
    for (load, strain), row in zip(LOADS.items(), axes, strict=True):
        scene = gallery.lobed_notch(strain)
        critical = critical_positions(full[load])
        draw_deformed(row[0], scene, critical, load)
        s = np.arange(POSITIONS) * scene.outlines[0].length / POSITIONS
        row[1].plot(s, full[load], **REFERENCE)
        for label, (_, _, line) in METHODS.items():
            row[1].plot(s, found[load][label].failure_index, **line)
        for k, i in enumerate(critical):
            row[1].annotate(
                f"({k + 1})", (s[i], full[load][i]), (0, 9), textcoords="offset points", ha="center"
            )
        row[1].set(
            xlabel="position s in mm", ylabel="failure index FI", ylim=(0, 1.15 * np.nanmax(full[load]))
        )
        draw_criterion(row[2], scene, critical[0])
    lines = [Line2D([], [], **REFERENCE, label=FULL)]
    lines += [Line2D([], [], **line, label=label) for label, (_, _, line) in METHODS.items()]
    figure.legend(handles=lines, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(RESULTS / "fig15_lobed_notch.png", dpi=130)
    plt.close(figure)


def index_rows(found: dict[str, Index], full: dict[str, np.ndarray]) -> list[dict[str, object]]:
    return [
        {
            "load": load,
            "position": i,
            "x": float(methods[DEFAULT].x[i]),
            "y": float(methods[DEFAULT].y[i]),
            "s": float(methods[DEFAULT].arc_length[i]),
            FULL: float(full[load][i]),
            **{label: float(result.failure_index[i]) for label, result in methods.items()},
        }
        for load, methods in found.items()
        for i in range(POSITIONS)
    ]


def main(quick: bool = False) -> list[Check]:
    scenes = {load: gallery.lobed_notch(strain) for load, strain in LOADS.items()}
    found = {load: index_along(scene) for load, scene in scenes.items()}
    checks, full = [], {}
    for load, scene in scenes.items():
        # dislocations find the most critical position; with all of them full FEA does
        some = critical_positions(found[load][DISLOCATIONS].failure_index.values)[:1]
        full[load] = by_full_fea(scene, some if quick else list(range(POSITIONS)))
        at = int(np.nanargmax(full[load]))
        checks += at_most_critical(load, found[load], full[load][at], at)
        # in place of full FEA, dislocations in the quick form: they are within 0.2 % of it
        order = found[load][DISLOCATIONS].failure_index.values if quick else full[load]
        checks += ranking(load, found[load], order)
    show("Lobed notch, Fig. 15", checks)
    if not quick:
        save("fig15_lobed_notch", [check.row() for check in checks])
        save("fig15_lobed_notch_index", index_rows(found, full))
        draw(found, full)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
