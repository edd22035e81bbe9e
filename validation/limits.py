"""Where methods fail: what happens there, what the status says, and what `auto` does instead.

Point and line method on bending beams; the stress at a crack; crack cells that intrude, overhang or are undercut;
notches too small for their crack; thin ligaments; Poisson's ratios near their ends; compression and biaxial tension;
soft and stiff void; coarse voxels; outlines from noisy pictures; cracks beside holes; minute notches.

Each case asks several methods at one position. The truth is full FEA, for pictures that of the outline drawn.
Required: `auto` within 2 % of it everywhere and nowhere farther off than it says (and a quarter of a per cent, full
FEA's share); each other method of ours that gives a value likewise no farther off than it says in 95 % of the cases;
and a status with the words expected where a method does not apply.

Writes validation/results/limits.csv and limits.png; about five minutes, ``--quick`` a few cheap cases.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show
from PIL import Image

from slmm import Material, Scene, coupled_criterion, failure_indices
from slmm.initiation.by_stress import line_method, point_method
from slmm.scene import gallery

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STRESS = ("rankine", "point", "line")
CELLS = ("slmm", "slmm+ac")
OURS = ("slmm+ac", "asymptotics", "dislocations")
ALL = STRESS + CELLS + ("asymptotics", "dislocations")
#: what full FEA and the truth's own extrapolation leave open
TRUTH_ERROR = 0.0025

Row = dict[str, object]


@dataclass(frozen=True)
class Case:
    """One scene with one position, the methods asked, and what their status must say."""

    limit: str
    name: str
    scene: Scene
    methods: tuple[str, ...]
    says: Mapping[str, str] = field(default_factory=dict)
    #: the scene whose truth counts, where it is another one
    true: Scene | None = None
    #: whether `auto` has to come within 2 % of it
    strict: bool = True


def at(scene: Scene, x: float, y: float) -> Scene:
    """The scene with one position."""
    return scene.with_(analysis={"points": [[x, y]]})


def hole(x: float, y: float, radius: float) -> dict[str, object]:
    return {"shape": "circle", "center": [x, y], "radius": radius}


def slot(x: float, y: float, width: float, height: float, radius: float) -> dict[str, object]:
    return {"shape": "rectangle", "center": [x, y], "size": [width, height], "corner_radius": radius}


def cracks_and_corners() -> Iterator[Case]:
    limit = "stress at a crack or corner"
    singular = dict.fromkeys(STRESS, "corner or crack tip") | dict.fromkeys(CELLS, "no cell")
    yield Case(limit, "edge crack", gallery.edge_crack(), ALL, singular)
    yield Case(limit, "square hole, corner", at(gallery.square_hole(), 65, 65), ALL, singular)
    beside = at(gallery.square_hole(), 65, 64.9)
    yield Case(
        limit,
        "square hole, 0.1 mm beside the corner",
        beside,
        ALL,
        {"slmm+ac": "undercut", "dislocations": "longer than"},
    )
    on_mesh = beside.with_(analysis={"local_model": "body-fitted"})
    yield Case(
        limit,
        "the same, stress on a mesh",
        at(on_mesh, 65, 64.99),
        STRESS,
        dict.fromkeys(STRESS, "depends on the mesh"),
    )


def cells_that_do_not_fit() -> Iterator[Case]:
    limit = "cell leaves the plate, intrudes or is undercut"
    for gap, says in ((1.0, "leaves the plate"), (4.0, "")):
        scene = gallery.circular_hole(holes=[hole(80 - gap, 50, 20)], e_yy=0.01)
        yield Case(limit, f"hole {gap:g} mm from the edge", at(scene, 100 - gap, 50), ALL, {"slmm+ac": says})
    scene = gallery.circular_hole(holes=[hole(40, 50, 10), slot(56, 50, 10, 30, 2)], e_yy=0.01)
    yield Case(limit, "slot 1 mm in front of a hole", at(scene, 50, 50), ALL, {"slmm+ac": "no cell"})
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    for waves, height in ((9, 0.12), (24, 0.02), (40, 0.01)):
        r = 20 * (1 + height * np.cos(waves * angle))
        points = np.column_stack([50 + r * np.cos(angle), 50 + r * np.sin(angle)])
        scene = gallery.circular_hole(holes=[{"shape": "points", "points": points.tolist()}], e_yy=0.01)
        yield Case(limit, f"hole with {waves} waves", at(scene, 50 + 20 * (1 + height), 50), ALL)


def small_radii() -> Iterator[Case]:
    limit = "radius below the applicability limit"
    material = Material.from_name("PMMA")
    for share in (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0):
        r = material.irwin_length / share
        scene = gallery.circular_hole(r, 100 * r, load={"stress": 10.0})
        says = {"slmm": "longer than the cell"} if share >= 1.5 else {}
        says |= {"slmm+ac": "longer than the cell"} if share >= 3 else {}
        yield Case(limit, f"hole, l_ch = {share:g} r", at(scene, 51 * r, 50 * r), ALL, says)
    limit = "minute notches"
    for r in (0.3, 0.03):
        scene = gallery.circular_hole(r, e_yy=0.01)
        yield Case(limit, f"hole of {r:g} mm in 100 mm", at(scene, 50 + r, 50), ("slmm+ac", "dislocations"))
    for r in (0.2, 0.05, 0.02, 0.005):
        scene = at(gallery.v_notch(60.0, r), 10, 60)
        yield Case(limit, f"V-notch, root of {r:g} mm", scene, ("asymptotics", "dislocations"))


def ligaments() -> Iterator[Case]:
    for gap in (5.0, 1.0, 0.5, 0.2, 0.1):
        scene = at(gallery.two_holes(gap, e_yy=0.01), 50 - gap / 2, 50)
        says = {} if gap > 1 else {"slmm+ac": "no cell"}
        yield Case("thin ligament", f"{gap:g} mm between holes of 10 mm", scene, ALL, says)


def poissons_ratios() -> Iterator[Case]:
    for nu, state, says in (
        (0.49, "plane strain", ""),
        (0.495, "plane strain", "holds the effective Poisson's ratios"),
        (0.4999, "plane strain", "holds the effective Poisson's ratios"),
        (-0.5, "plane stress", ""),
        (-0.9, "plane stress", ""),
        (-0.95, "plane stress", "holds the effective Poisson's ratios"),
        (-0.99, "plane strain", ""),
    ):
        limit = "nearly incompressible" if nu > 0 else "Poisson's ratio below zero"
        material = {"E": 2960.0, "nu": nu, "sigma_c": 70.5, "K_Ic": 1.96, "state": state}
        scene = at(gallery.circular_hole(5.0, material=material, load={"stress": 10.0}), 55, 50)
        yield Case(limit, f"nu = {nu:g}, {state}", scene, ALL, dict.fromkeys(STRESS + CELLS, says))


def loads() -> Iterator[Case]:
    for limit, name, load in (
        ("pure compression", "side of a hole", {"stress": -100.0}),
        ("pure compression", "hole, all round", {"strain": [-0.01, -0.01, 0.0]}),
        ("biaxial tension", "hole", {"strain": [0.01, 0.01, 0.0]}),
    ):
        yield Case(limit, name, at(gallery.circular_hole(5.0, load=load), 55, 50), ALL)
    pole = at(gallery.circular_hole(5.0, load={"stress": -100.0}), 50, 55)
    yield Case("pure compression", "pole of a hole, in tension", pole, ALL)


def voxels() -> Iterator[Case]:
    scene = at(gallery.circular_hole(), 70, 50)
    for void in (1e-9, 1e-6, 1e-3, 0.01, 0.1):
        softer = scene.with_(analysis={"void_stiffness": void})
        yield Case("void stiffness", f"{void:g}", softer, ("slmm+ac",))
    for n in (32, 64, 128, 256, 512):
        coarse = scene.with_(analysis={"voxels": n * n})
        yield Case("coarse voxels", f"hole of 20 mm, {n} x {n} voxels", coarse, ("slmm+ac",))
    scene = at(gallery.circular_hole(5.0), 55, 50)
    for n in (64, 128, 256):
        coarse = scene.with_(analysis={"voxels": n * n})
        yield Case("coarse voxels", f"hole of 5 mm, {n} x {n} voxels", coarse, ("slmm+ac",))


def cracks_beside_holes() -> Iterator[Case]:
    for gap in (10.0, 2.0, 1.0):
        cracks = [{"points": [[0.0, 50.0], [40.0 - gap, 50.0]]}]
        scene = gallery.circular_hole(holes=[hole(50, 50, 10)], cracks=cracks, load={"stress": 10.0})
        yield Case("crack beside a hole", f"tip {gap:g} mm before the hole", at(scene, 40 - gap, 50), OURS)
        yield Case("crack beside a hole", f"far side of the hole, {gap:g} mm", at(scene, 60, 50), OURS)
    notch = gallery.circular_hole(holes=[hole(0, 50, 10)], e_yy=0.01)
    yield Case("notch meets the edge", "0.5 mm from a held edge", at(notch, 0.5, 59.98), OURS)


def pictures(folder: Path) -> Iterator[Case]:
    """Holes drawn in black and white, in grey, with noise of 5 % and as a bad JPEG."""
    exact = at(gallery.circular_hole(), 70, 50)
    lobed = gallery.lobed_notch()
    result = failure_indices(lobed, "dislocations", positions=50)
    tip = int(np.nanargmax(result.failure_index.values))
    bent = at(lobed, float(result.x[tip]), float(result.y[tip]))
    for n in (50, 100, 200, 400):
        for kind in ("black and white", "grey", "noise", "bad jpeg"):
            for name, true in (("disc", exact), ("lobes", bent)):
                file = folder / f"{name} {n} {kind}.{'jpg' if kind == 'bad jpeg' else 'png'}"
                draw_hole(file, name == "lobes", n, kind)
                scene = true.with_(holes=[{"shape": "image", "file": str(file), "pixel_size": 100 / n}])
                yield Case(
                    "picture of a hole",
                    f"{name}, {n} pixels, {kind}",
                    scene,
                    ("slmm+ac", "dislocations"),
                    true=true,
                    strict=n >= 200,
                )


def draw_hole(file: Path, lobed: bool, n: int, kind: str) -> None:
    """A picture of the gallery's hole of 20 mm, or of its lobed notch."""
    each = 1 if kind == "black and white" else 8
    x = (np.arange(n * each) + 0.5) / (n * each) * 100 - 50
    angle, r = np.arctan2(-x[:, None], x[None]), np.hypot(x[None], x[:, None])
    inside = r < 20 * (1 + lobed * (0.1 * np.cos(3 * angle) + 0.12 * np.cos(5 * angle + 0.5)))
    grey = 255 * (1 - inside.reshape(n, each, n, each).mean(axis=(1, 3)))
    if kind == "noise":
        grey = grey + np.random.default_rng(0).normal(0, 0.05 * 255, grey.shape)
    picture = Image.fromarray(np.round(np.clip(grey, 0, 255)).astype(np.uint8))
    picture.save(file, **({"quality": 50} if kind == "bad jpeg" else {}))


def asked(case: Case, method: str) -> Row:
    """What a method says at the case's position."""
    try:
        result = failure_indices(case.scene, method).isel(position=0)
    except (ValueError, RuntimeError) as error:
        status = str(error).removeprefix(f"{Path.cwd()}/")
        return {"FI": np.nan, "estimate": np.nan, "status": status, "used_method": method, "reason": ""}
    return {
        "FI": float(result.failure_index),
        "estimate": float(result.failure_index_error),
        "status": str(result.status.values),
        "used_method": str(result.used_method.values),
        "reason": str(result.reason.values),
    }


def rows_of(case: Case) -> list[Row]:
    true = failure_indices(case.true or case.scene, "full-fea").isel(position=0)
    truth = float(true.failure_index)
    rows = []
    for method in (*case.methods, "auto"):
        said = asked(case, method)
        FI = float(str(said["FI"]))
        error = abs(FI / truth - 1) if truth else abs(FI)  # NaN without truth
        rows.append({"limit": case.limit, "case": case.name, "truth": truth, "method": method} | said)
        rows[-1] |= {"error": error, "estimate": float(str(said["estimate"])) / (truth or 1.0)}
    return rows


def beams() -> tuple[list[Row], list[Check]]:
    """Beams in bending: the stress sinks to zero at half their height h, the edge crack's energy is Tada's."""
    material = Material.from_name("PMMA")
    l_ch = material.irwin_length / np.pi
    rows: list[Row] = []
    checks = []
    for share in (1.0, 1.5, 2.0, 4.0, 10.0, 40.0):
        h = share * l_ch
        eta = np.linspace(0, h, 401)
        x = np.linspace(0, 0.6, 400)
        F = 1.122 - 1.40 * x + 7.33 * x**2 - 13.08 * x**3 + 14.0 * x**4
        steps = np.concatenate([[0.0], np.cumsum(0.5 * (x * F**2)[1:] + 0.5 * (x * F**2)[:-1]) * x[1]])
        G_inc = np.pi * h / material.E * np.divide(steps, x, out=np.zeros_like(x), where=x > 0)
        found = coupled_criterion(x * h, G_inc, 1 - 2 * x, material)
        values = {
            "point": point_method(eta, 1 - 2 * eta / h, material),
            "line": line_method(eta, 1 - 2 * eta / h, material),
            "coupled criterion": material.sigma_c / found.load_factor,
        }
        rows += [
            {"limit": "bending beam", "case": f"h = {share:g} l_ch", "method": method, "FI": value}
            for method, value in values.items()
        ]
        if share <= 2:
            methods = ("point", "line") if share == 1 else ("line",)
            checks += [
                Check(
                    f"beam, h = {share:g} l_ch",
                    f"{m} method gives a stress",
                    0.0,
                    float(np.isfinite(values[m])),
                    0.0,
                )
                for m in methods
            ]
        checks.append(
            Check(
                f"beam, h = {share:g} l_ch",
                "coupled criterion: stress at initiation over sigma_c, 1 at least",
                1.0,
                float(values["coupled criterion"]),
                rule="at most",
            )
        )
    return rows, checks


def judged(case: Case, rows: list[Row]) -> list[Check]:
    checks = []
    for method, words in case.says.items():
        if words:
            status = next(str(row["status"]) for row in rows if row["method"] == method)
            told = float(words in status)
            checks.append(Check(f"{case.limit}: {case.name}", f"{method} says '{words}'", 1.0, told, 0.0))
    auto = rows[-1]
    error, estimate = float(str(auto["error"])), float(str(auto["estimate"]))
    name, used = f"{case.limit}: {case.name}", auto["used_method"]
    if not np.isfinite(float(str(auto["truth"]))):  # full FEA has no value either
        return [
            *checks,
            Check(name, f"auto says '{auto['status']}'", 1.0, float(auto["status"] != "ok"), 0.0),
        ]
    rule = "at most" if case.strict else "told"
    checks.append(Check(name, f"error of auto ({used})", 0.02, error, rule=rule))
    if case.true is None:
        allowed = estimate + TRUTH_ERROR
        checks.append(Check(name, "error of auto and what it says", allowed, error, rule="at most"))
    return checks


def honest(rows: list[Row], methods: tuple[str, ...]) -> list[Check]:
    """Of the values that the methods give, how many are farther off than they say."""
    checks = []
    for method in methods:
        given = [
            (float(str(row["error"])), float(str(row["estimate"])))
            for row in rows
            if row["method"] == method and row["status"] == "ok" and row["limit"] != "picture of a hole"
        ]
        off = np.mean([error > estimate + TRUTH_ERROR for error, estimate in given]) if given else 0.0
        checks.append(
            Check(
                f"{method}, {len(given)} values",
                "share farther off than said",
                0.05,
                float(off),
                rule="at most",
            )
        )
    return checks


def draw(rows: list[Row]) -> None:
    """Errors of every method by limit; a cross at the top where it says that it does not apply."""
    limits = list(dict.fromkeys(str(row["limit"]) for row in rows if row["limit"] != "bending beam"))
    methods = {
        "line": "0.6",
        "slmm": "#CC79A7",
        "slmm+ac": "#0072B2",
        "dislocations": "#009E73",
        "auto": "#D55E00",
    }
    figure, axis = plt.subplots(figsize=(11, 5.5), layout="constrained")
    for k, (method, colour) in enumerate(methods.items()):
        for i, limit in enumerate(limits):
            mine = [row for row in rows if row["limit"] == limit and row["method"] == method]
            x = i + (k - 2) * 0.15 + np.linspace(-0.05, 0.05, len(mine) + 2)[1:-1]
            error = np.array([float(str(row["error"])) for row in mine])
            said = np.isfinite(error)
            label = method if i == 0 else None
            axis.plot(x[said], np.maximum(error[said], 1e-5), "o", ms=4, color=colour, label=label)
            axis.plot(x[~said], np.full((~said).sum(), 3.0), "x", ms=5, color=colour)
    axis.axhline(0.02, color="0.7", lw=1, zorder=0)
    axis.set(yscale="log", ylim=(7e-6, 6), ylabel="error of the failure index (cross: status, no value)")
    axis.set_xticks(range(len(limits)), limits, rotation=25, ha="right")
    axis.legend(frameon=False, ncol=5, loc="lower left", bbox_to_anchor=(0, 1))
    figure.savefig(RESULTS / "limits.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    rows, checks = beams()
    with tempfile.TemporaryDirectory() as folder:
        chapters = [cracks_and_corners(), poissons_ratios(), loads()]
        if not quick:
            chapters += [cells_that_do_not_fit(), small_radii(), ligaments(), voxels(), cracks_beside_holes()]
            chapters.append(pictures(Path(folder)))
        for chapter in chapters:
            for case in list(chapter)[: 2 if quick else None]:
                found = rows_of(case)
                rows += found
                checks += judged(case, found)
    checks += honest(rows, OURS)
    show("Where methods fail", checks)
    if not quick:
        keys = dict.fromkeys(key for row in rows for key in row)
        save("limits", [{key: row.get(key, "") for key in keys} for row in rows])
        draw([row for row in rows if "error" in row])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
