"""Random plates with one to four holes and notches of every shape, near edges and near each other, also as pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import stability
from PIL import Image
from skimage.draw import polygon2mask

from slmm import Scene, SceneError

Random = np.random.Generator
Table = dict[str, object]

#: points of a picture's pixel along each side that decide its grey
PER_PIXEL = 6
#: Irwin's length over the radius of one of the notches
SHORTEST_IRWIN, LONGEST_IRWIN = 0.02, 5.0


@dataclass(frozen=True)
class Part:
    """A drawn scene.

    Attributes
    ----------
    scene : Scene
        With the outlines as they were drawn.
    shapes : str
        Of its holes.
    pixel_size : float
        Of a picture of it, mm.
    irwin_over_radius : float
        Irwin's length over the radius of one of its notches.
    """

    scene: Scene
    shapes: str
    pixel_size: float
    irwin_over_radius: float


def drawn(rng: Random) -> Part:
    """A part that is geometrically possible; those that `Scene` refuses are drawn again."""
    while True:
        pixel = float(rng.uniform(0.1, 0.2))
        width, height = (float(n * pixel) for n in rng.integers(300, 600, 2))
        holes: list[Table] = []
        radii: list[float] = []
        taken: list[tuple[np.ndarray, float]] = []
        for _ in range(rng.choice([1, 2, 3, 4], p=[0.4, 0.3, 0.2, 0.1])):
            around = float(rng.uniform(0.05, 0.18)) * min(width, height)
            centre = place(rng, (width, height), around, taken)
            hole, radius = shape(rng, (width, height), centre, around)
            taken.append((centre, around))
            holes.append(hole)
            radii.append(radius)
        material, share = tough(rng, float(rng.choice(radii)))
        tables = {
            "plate": {"width": width, "height": height},
            "holes": holes,
            "material": material,
            "load": stability.load(rng),
        }
        try:
            scene = Scene.from_dict(tables)
        except SceneError:
            continue
        if scene.load.stress is None or not cuts_pulled_edge(scene):
            return Part(scene, " ".join(str(hole["shape"]) for hole in holes), pixel, share)


def cuts_pulled_edge(scene: Scene) -> bool:
    """Whether a notch opens to the top or bottom edge, where a stress would be left without balance."""
    y = np.concatenate([outline.polygon(400)[:, 1] for outline in scene.outlines])
    return bool(y.min() <= 0 or y.max() >= scene.plate.height)


def place(
    rng: Random, plate: tuple[float, float], around: float, taken: list[tuple[np.ndarray, float]]
) -> np.ndarray:
    """Centre of a hole with a radius, mm: anywhere, beside an edge, cutting it, or beside a hole that is there."""
    sides = np.array(plate)
    anywhere = rng.uniform(1.1 * around, sides - 1.1 * around)
    kind, gap = rng.random(), float(np.exp(rng.uniform(np.log(0.1), 0.0))) * around
    if kind < 0.35 and taken:
        centre, other = taken[int(rng.integers(len(taken)))]
        angle = rng.uniform(0, 2 * np.pi)
        return centre + (other + gap + around) * np.array([np.cos(angle), np.sin(angle)])
    if kind < 0.65:
        axis, far = int(rng.integers(2)), rng.random() < 0.5
        off = around + gap if kind < 0.55 else rng.uniform(-0.3, 0.3) * around
        anywhere[axis] = sides[axis] - off if far else off
    return anywhere


def shape(rng: Random, plate: tuple[float, float], centre: np.ndarray, around: float) -> tuple[Table, float]:
    """A hole within a circle, mm, and the radius of its bends; where they are sharp that of the circle."""
    kind = rng.integers(6)
    at = centre.tolist()
    if kind == 0:
        return {"shape": "circle", "center": at, "radius": around}, around
    angle = float(rng.uniform(0, 180))
    if kind == 1:
        minor = around * float(rng.uniform(0.25, 1.0))
        return {
            "shape": "ellipse",
            "center": at,
            "semi_axes": [around, minor],
            "angle": angle,
        }, minor**2 / around
    sharp, roundness = rng.random() < 0.5, float(np.exp(rng.uniform(np.log(0.05), np.log(0.5))))
    if kind == 2:
        turn = rng.uniform(0.25, 0.8)
        size = [2 * around * float(np.cos(turn)), 2 * around * float(np.sin(turn))]
        radius = 0.0 if sharp else roundness * min(size)
        turned = float(rng.choice([0.0, 90.0, angle]))
        table = {"shape": "rectangle", "center": at, "size": size, "corner_radius": radius, "angle": turned}
        return table, radius or around
    if kind == 3:
        corners = int(rng.integers(3, 7))
        turn = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) / corners
        r = around * rng.uniform(0.6, 1.0, corners)
        points = centre + np.column_stack([r * np.cos(turn), r * np.sin(turn)])
        radius = 0.0 if sharp else 0.3 * roundness * around
        return {"shape": "polygon", "points": points.tolist(), "corner_radius": radius}, radius or around
    if kind == 4:
        side = int(rng.integers(4))
        depth = float(rng.uniform(0.5, 2.0)) * around
        tip = rng.uniform(0.2, 0.8, 2) * plate
        axis = side % 2
        tip[axis] = depth if side < 2 else plate[axis] - depth
        direction = 90.0 * side + float(rng.uniform(-15, 15))
        radius = 0.0 if sharp else roundness * around
        opening = float(rng.uniform(10, 100))
        notch = {"shape": "v-notch", "tip": tip.tolist(), "direction": direction, "opening": opening}
        return notch | {"radius": radius}, radius or depth
    return stability.outline(rng, (at[0], at[1]), 0.75 * around), 0.4 * around


def tough(rng: Random, radius: float) -> tuple[Table, float]:
    """A material, and its Irwin's length over a radius (mm)."""
    share = float(np.exp(rng.uniform(np.log(SHORTEST_IRWIN), np.log(LONGEST_IRWIN))))
    constants: Table = {
        "E": 3000.0,
        "nu": float(rng.uniform(0.0, 0.45)),
        "sigma_c": 50.0,
        "state": str(rng.choice(["plane stress", "plane strain"])),
    }
    nu = float(str(constants["nu"]))
    stiffness = 3000.0 / (1 - nu**2) if constants["state"] == "plane strain" else 3000.0
    return constants | {"G_c": share * radius * 50.0**2 / stiffness}, share


def picture(part: Part, file: Path) -> Scene:
    """The same scene with its holes in one picture, written to a file: dark, their edges grey as area demands."""
    plate, h = part.scene.plate, part.pixel_size / PER_PIXEL
    columns, rows = round(plate.width / part.pixel_size), round(plate.height / part.pixel_size)
    dark = np.zeros((rows * PER_PIXEL, columns * PER_PIXEL), dtype=bool)
    for outline in part.scene.outlines:
        x, y = outline.polygon(2000).T
        dark |= polygon2mask(dark.shape, np.column_stack([(plate.height - y) / h - 0.5, x / h - 0.5]))
    grey = 255 * (1 - dark.reshape(rows, PER_PIXEL, columns, PER_PIXEL).mean(axis=(1, 3)))
    Image.fromarray(np.round(grey).astype(np.uint8)).save(file)
    return part.scene.with_(holes=[{"shape": "image", "file": str(file), "pixel_size": part.pixel_size}])
