"""Table 3 of Paper A: what each parameter of the method does to sigma_I and G_inc at position (1) of Fig. 15.

One parameter at a time goes from the published default v_1 to the published other value v_2; the effect is the largest
|1 - f(v_1)/f(v_2)| along the path (Eq. 31 prints it without the bars, but its 14.2 % needs them). The outline is ours,
``gallery.lobed_notch`` under e_xx, at the most critical of 50 positions, so the paper's numbers are told beside ours.

Twice each: with the cell that the rules of section 2.3.5 choose, which may itself change with the parameter, and with
the cell held as large as the default one. At the paper's position (1) the least height decides, phi_min = 10 voxels, so
the cell is held there; and phi_min then acts as the height: held, it compares cells of 10 and 20 voxels.

l_el,cm: tables are computed for the purpose, whose largest elements, and those at the tip of the longest crack, have
the published size; at shorter cracks ours are finer. l_el,full: elements of the plate, on the notch and on the path,
all of them by half, of the extrapolated full FEA.

Writes validation/results/table3_parameters.csv and .png; two minutes, ``--quick`` 15 s, without l_el,cm
and files.
"""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib
import numpy as np
import xarray as xr
from checks import RESULTS, Check, at_spread_positions, run, save, show

from precompute.spec import SweepSpec
from precompute.store import assemble, write
from precompute.sweep import run_sweep
from slmm import Scene, failure_indices
from slmm.initiation.full_fea import full_fea_curves
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import PUBLISHED, Settings
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

VOXELS = 1_000_000
POSITIONS = 50
SOURCE = "Paper A, Table 3"
#: c' around those of the position's two cells, 1/mm
CURVATURES = (-0.7, -0.5, -0.3, -0.1)
#: published: parameter, v_1, v_2, effects on sigma_I and G_inc
PUBLISHED_EFFECTS = {
    "n_fit,c": ("11", "21", 0.004, 0.007),
    "n_fit,u": ("28", "58", 0.004, 0.009),
    "n_cracks": ("10", "5", math.nan, 0.142),
    "D": ("D_imp", "D_all", 0.025, 0.012),
    "phi_min": ("10", "20", 0.054, 0.1721),
    "l_el,cm": ("0.01 mm", "0.02 mm", 0.0, 0.006),
    "n_el,lm": ("1e6", "5e5", 0.019, 0.039),
    "l_el,full": ("h", "h/2", 0.001, 0.001),
}
#: what a discretisation of ours may do at most; the other parameters belong to the method and to the outline
LIMITS = {"l_el,cm": 0.006, "l_el,full": 0.001}
SYMBOLS = {
    "n_fit,c": "$n_{fit,c}$",
    "n_fit,u": "$n_{fit,u}$",
    "n_cracks": "$n_{cracks}$",
    "D": "D",
    "phi_min": "$\\varphi_{min}$",
    "l_el,cm": "$l_{el,cm}$",
    "n_el,lm": "$n_{el,lm}$",
    "l_el,full": "$l_{el,full}$",
}


@dataclass(frozen=True)
class Effect:
    """Largest relative changes by one parameter.

    Attributes
    ----------
    parameter : str
    cell : {"chosen", "held", ""}
        By the rules, or as large as the default one; nothing for full FEA.
    sigma_I, G_inc : float
    """

    parameter: str
    cell: str
    sigma_I: float
    G_inc: float


def position_one() -> Scene:
    """The most critical position under e_xx."""
    scene = gallery.lobed_notch((0.1, 0.0, 0.0), analysis={"voxels": VOXELS})
    found = failure_indices(at_spread_positions(scene, POSITIONS), "dislocations")
    at = int(np.nanargmax(found.failure_index.values))
    return scene.with_(analysis={"points": [[float(found.x[at]), float(found.y[at])]]})


def curves(
    scene: Scene, settings: Settings, voxels: int = VOXELS, database: Path | None = None
) -> xr.Dataset:
    there = scene.with_(analysis={"voxels": voxels})
    found = failure_indices(there, "slmm+ac", curves=True, settings=settings, database=database)
    return found.isel(position=0)


def largest_change(one: xr.Dataset, other: xr.Dataset) -> tuple[float, float]:
    """Effects on sigma_I and G_inc over what both cells reach."""
    a = np.linspace(0.0, min(float(one.a[-1]), float(other.a[-1])), 401)[1:]
    ratio = [
        np.interp(a, one.a, one[name]) / np.interp(a, other.a, other[name]) for name in ("sigma_I", "G_inc")
    ]
    return float(np.abs(1 - ratio[0]).max()), float(np.abs(1 - ratio[1]).max())


def other_rules(**values: int) -> Settings:
    rule = PUBLISHED.fine._replace(**values)
    return replace(PUBLISHED, fine=rule, wide=rule)


#: settings with v_2, of the parameters that the published settings hold
SETTINGS: dict[str, Settings] = {
    "n_fit,c": other_rules(samples=21),
    "n_fit,u": other_rules(boundary_samples=58),
    "n_cracks": replace(PUBLISHED, linear_lengths=5),
    "D": replace(PUBLISHED, modes="published"),
    "phi_min": replace(PUBLISHED, cell_voxels=20),
    "n_el,lm": PUBLISHED,
}


def of_settings(scene: Scene) -> list[Effect]:
    """The parameters of the settings and of the local model."""
    default = curves(scene, PUBLISHED)
    height = float(default.cell_height)
    held = curves(scene, replace(PUBLISHED, height=height))
    voxel = math.sqrt(scene.plate.width * scene.plate.height / VOXELS)
    effects = []
    for parameter, settings in SETTINGS.items():
        voxels = VOXELS // 2 if parameter == "n_el,lm" else VOXELS
        changed = curves(scene, settings, voxels)
        effects.append(Effect(parameter, "chosen", *largest_change(default, changed)))
        before, after = held, height
        if parameter == "phi_min":
            before = curves(scene, replace(PUBLISHED, height=PUBLISHED.cell_voxels * voxel))
            after = settings.cell_voxels * voxel
        changed = curves(scene, replace(settings, height=after), voxels)
        effects.append(Effect(parameter, "held", *largest_change(before, changed)))
    return effects


def of_cell_mesh(scene: Scene) -> Effect:
    """The element size of the crack cell: two tables, for the default cell."""
    settings = replace(PUBLISHED, height=float(curves(scene, PUBLISHED).cell_height))
    found = []
    for size in (0.01, 0.02):
        spec = SweepSpec(
            curvature=CURVATURES,
            poisson=(scene.material.plane_stress_equivalent[1],),
            crack_length=tuple(np.linspace(0.1, 1.0, PUBLISHED.linear_lengths).round(10).tolist()),
            modes="published",
            tip=size,
            coarsest=size,
        )
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            run_sweep(spec, folder, workers=2)
            write(assemble(spec, folder), folder / "cells.nc", folder)
            found.append(curves(scene, settings, database=folder / "cells.nc"))
    return Effect("l_el,cm", "held", *largest_change(*found))


def of_full_fea(scene: Scene) -> Effect:
    """The element size of full FEA: on the path, on the notch and in the plate."""
    where = find_positions(scene)
    side = min(scene.plate.width, scene.plate.height)
    longest = float(curves(scene, PUBLISHED).a[-1])
    eta = np.linspace(0.0, longest, 40)
    coarse, fine = (
        full_fea_curves(
            scene,
            int(where.hole[0]),
            float(where.s[0]),
            longest,
            n_lengths=n,
            eta=eta,
            size_max=side / 8 * size,
            angle_max=0.25 * size,
        )
        for n, size in ((24, 1.0), (47, 0.5))
    )
    sigma_I = np.abs(1 - coarse.sigma_I / fine.sigma_I).max()
    # every second one of the lengths is the coarser model's
    return Effect("l_el,full", "", float(sigma_I), float(np.abs(1 - coarse.G_inc / fine.G_inc[::2]).max()))


def beside_the_paper(effects: list[Effect]) -> list[Check]:
    checks = []
    for effect in effects:
        one, two, *published = PUBLISHED_EFFECTS[effect.parameter]
        case = f"{effect.parameter}: {one} to {two}" + (f", cell {effect.cell}" if effect.cell else "")
        for name, wanted in zip(("sigma_I", "G_inc"), published, strict=True):
            limit = LIMITS.get(effect.parameter)
            rule, wanted = ("told", wanted) if limit is None else ("at most", limit)
            checks.append(
                Check(case, f"effect on {name}", wanted, getattr(effect, name), rule=rule, source=SOURCE)
            )
    return checks


def draw(effects: list[Effect]) -> None:
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.6), layout="constrained", sharey=True)
    names = list(PUBLISHED_EFFECTS)
    y = np.arange(len(names))
    for axis, quantity, column in zip(axes, ("sigma_I", "G_inc"), (2, 3), strict=True):
        symbol = {"sigma_I": "$\\sigma_I$", "G_inc": "$G_{inc}$"}[quantity]
        ours = {(e.parameter, e.cell): 100 * getattr(e, quantity) for e in effects}
        series = {
            "Paper A": [100 * PUBLISHED_EFFECTS[name][column] for name in names],
            "ours, cell held (or full FEA)": [
                ours.get((n, "held"), ours.get((n, ""), math.nan)) for n in names
            ],
            "ours, cell chosen by the rules": [ours.get((n, "chosen"), math.nan) for n in names],
        }
        for k, (label, values) in enumerate(series.items()):
            bars = axis.barh(y + 0.27 * (k - 1), values, 0.25, color=("0.6", "C0", "C1")[k], label=label)
            axis.bar_label(bars, [f"{v:.2g}" if v == v else "" for v in values], padding=2, fontsize=7)
        axis.set(xlabel=f"effect on {symbol} in %")
        axis.margins(x=0.12)
    labels = [f"{SYMBOLS[n]}: {PUBLISHED_EFFECTS[n][0]} to {PUBLISHED_EFFECTS[n][1]}" for n in names]
    axes[0].set_yticks(y, [label.replace("_imp", "$_{imp}$").replace("_all", "$_{all}$") for label in labels])
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    figure.savefig(RESULTS / "table3_parameters.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    scene = position_one()
    effects = of_settings(scene)
    if not quick:
        effects.append(of_cell_mesh(scene))
    effects.append(of_full_fea(scene))
    checks = beside_the_paper(effects)
    show("Parameters of Table 3; wanted: the paper's effect on its outline, or the limit of ours", checks)
    if not quick:
        save("table3_parameters", [check.row() for check in checks])
        draw(effects)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
