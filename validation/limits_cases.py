"""Cases in which methods are at their limits, each with what their status must say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

from slmm import Material, Scene, failure_indices
from slmm.scene import gallery

STRESS = ("rankine", "point", "line")
CELLS = ("slmm", "slmm+ac")
OURS = ("slmm+ac", "asymptotics", "dislocations")
ALL = STRESS + CELLS + ("asymptotics", "dislocations")


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
