"""Where simulated fracture is hard: closing faces, crossing and branching cracks, ties, tips that graze a hole.

Each scene by both engines: U_T with its estimated error, how it ended, and what the result says - events that compete,
faces that hold each other, or why there is no result. Required: none is quietly wrong, which is to say that engines
differ by more than both estimates and 0.5 % and neither has said that the path may fork, that it failed or that a part
cannot be simulated. Writes validation/results/fracture_limits.csv, three minutes of CPU; ``--quick`` does one scene of
closing faces and one that branches, and writes nothing.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from checks import Check, run, save, show

from slmm.fracture import simulate
from slmm.fracture.history import Outcome
from slmm.scene.gallery import tensile_plate
from slmm.scene.scene import Scene

#: relative difference of U_T that counts; required
TOLERANCE = 5e-3
#: what ends a simulation as it should
WHOLE = (Outcome.SEVERED, Outcome.LARGEST)
#: a material that cracks at tips alone
STRONG = {"E": 3000.0, "nu": 0.35, "sigma_c": 500.0, "K_Ic": 2.0}

Asked = tuple[str, str, Scene, dict[str, Any]]


def bent_bar() -> Scene:
    """A bar in pure bending, whose crack reaches into the side that is pressed."""
    ends = (([20, 120], [0, 120]), ([40, 120], [20, 120]), ([0, 0], [20, 0]), ([20, 0], [40, 0]))
    edges = [(*stretch, t) for stretch, t in zip(ends, (1.0, -1.0, -1.0, 1.0), strict=True)]
    return Scene.from_dict(
        {
            "plate": {"width": 40.0, "height": 120.0},
            "cracks": [{"points": [[5.0, 60.0], [30.0, 60.0]]}],
            "material": STRONG,
            "boundary": [{"from": a, "to": b, "traction": [0.0, t]} for a, b, t in edges],
        }
    )


def plate(*lines: list[list[float]], holes: tuple[tuple[float, float, float], ...] = ()) -> Scene:
    """A plate of Paper D with cracks along lines and holes (x, y, radius)."""
    return tensile_plate(list(holes), cracks=[{"points": points} for points in lines])


def scenes() -> Iterator[Asked]:
    """Kind, name, scene, and how it is simulated."""
    pressed = {"load": {"stress": -10.0}, "material": {"sigma_c": 500.0}}
    inclined = tensile_plate(cracks=[{"points": [[35.0, 35.0], [45.0, 45.0]]}], **pressed)
    yield "contact", "wings of a closed crack", inclined, {"increment": 0.6, "largest_displacement": 0.61}
    edge = [[0.0, 40.0], [10.0, 40.0]]
    yield (
        "branching",
        "edge crack with a branch",
        plate([[0.0, 40.0], [20.0, 40.0]], [[12.0, 40.0], [18.0, 47.0]]),
        {},
    )
    across = tensile_plate(cracks=[{"points": [[30.0, 40.0], [50.0, 40.0]]}], **pressed)
    yield "contact", "crack pressed across", across, {"largest_displacement": 0.5}
    line = [[30.0, 32.0], [38.0, 40.0], [46.0, 39.0], [52.0, 46.0]]
    kinked = tensile_plate(cracks=[{"points": line}], **pressed)
    yield "contact", "kinked crack, wings", kinked, {"increment": 0.6, "largest_displacement": 0.72}
    yield "contact", "crack in bending", bent_bar(), {"increment": 2.0}
    yield "crossing", "at right angles", plate([[25.0, 40.0], [45.0, 40.0]], [[35.0, 30.0], [35.0, 50.0]]), {}
    yield "crossing", "aslant", plate([[25.0, 35.0], [45.0, 45.0]], [[30.0, 48.0], [40.0, 32.0]]), {}
    yield "crossing", "by 0.1 mm", plate([[0.0, 40.0], [20.1, 40.0]], [[20.0, 33.0], [20.0, 49.0]]), {}
    arms = [[[32.0, 40.0], end] for end in ([20.0, 40.0], [38.0, 46.0], [38.0, 33.0])]
    yield "branching", "star of three", plate(*arms), {}
    corners = [[30.0, 30.0], [50.0, 30.0], [40.0, 48.0]]
    sides = [[corners[k - 1], corners[k]] for k in range(3)]
    yield "branching", "triangle cut out", plate(*sides), {}
    yield "ties", "two holes alike", tensile_plate([(40.0, 25.0, 6.0), (40.0, 55.0, 6.0)], cracks=[]), {}
    yield "ties", "cracks from both sides", plate(edge, [[80.0, 40.0], [70.0, 40.0]]), {}
    yield (
        "ties",
        "cracks above each other",
        plate([[0.0, 34.0], [10.0, 34.0]], [[0.0, 46.0], [10.0, 46.0]]),
        {},
    )
    for off in (2.0, 0.5):
        between = ((30.0, 46.0 + off, 6.0), (30.0, 34.0 - off, 6.0))
        yield "grazing", f"between two holes at {off:g} mm", plate(edge, holes=between), {}
    yield (
        "grazing",
        "above a hole at 0.3 mm",
        plate([[0.0, 40.0], [20.0, 40.0]], holes=((20.0, 33.7, 6.0),)),
        {},
    )
    four = ((24.0, 44.0, 4.5), (42.0, 33.0, 5.5), (55.0, 50.0, 5.0), (68.0, 39.0, 4.0))
    yield "grazing", "four holes where paths fork", plate(edge, holes=four), {}


def simulated(scene: Scene, engine: str, settings: dict[str, Any]) -> dict[str, Any]:
    """What one engine gives and says."""
    begin = time.process_time()
    try:
        result = simulate(scene, engine=engine, **settings)
    except (ValueError, ArithmeticError, RuntimeError) as error:
        spent = time.process_time() - begin
        return {
            "U_T": np.nan,
            "error": np.nan,
            "steps": 0,
            "says": f"refused: {error}",
            "cpu": spent,
            "warned": True,
        }
    outcome, words = result.attrs["outcome"], []
    if outcome not in WHOLE:
        words.append(outcome)
    if outcome == Outcome.SEVERED and not result.sizes["step"]:
        words.append("in pieces before anything happens")
    if competing := result.attrs["competing_events"]:
        words.append(f"{competing} competing")
    if "excluded_starts" in result.attrs:
        words.append(result.attrs["excluded_starts"])
    warned = bool(words)
    closed = f"closed over {float(result.closed.max()):.1f} mm" if result.touches.any() else ""
    return {
        "U_T": float(result.U_T),
        "error": float(result.U_T_error),
        "steps": result.sizes["step"],
        "says": "; ".join([*words, *filter(None, [closed])]),
        "cpu": time.process_time() - begin,
        "warned": warned,
    }


def compared(kind: str, name: str, scene: Scene, settings: dict[str, Any]) -> dict[str, Any]:
    """Both engines on a scene, side by side."""
    one, other = (simulated(scene, engine, settings) for engine in ("boundary", "fem"))
    warned = any([found.pop("warned") for found in (one, other)])
    row: dict[str, Any] = {"kind": kind, "scene": name}
    for engine, found in (("boundary", one), ("fem", other)):
        row |= {f"{key}_{engine}": value for key, value in found.items()}
    apart, estimates = abs(other["U_T"] - one["U_T"]), one["error"] + other["error"]
    row["difference"] = other["U_T"] / one["U_T"] - 1 if one["U_T"] else other["U_T"]
    row["over_estimates"] = (
        apart / estimates if estimates else np.nan
    )  # of parts that nothing cracks none is told
    row["warned"] = warned
    off = not (abs(row["difference"]) <= TOLERANCE or row["over_estimates"] <= 1)
    row["quietly_wrong"] = int(off and not warned)
    print(f"{kind}, {name}: {100 * row['difference']:+.3f} %, {one['says']} | {other['says']}", flush=True)
    return row


def checks_of(row: dict[str, Any]) -> list[Check]:
    """Difference of both engines, required where nothing warns, and whether it is quietly wrong."""
    case, rule = f"{row['kind']}: {row['scene']}", "told" if row["warned"] else "equal"
    U_T = Check(case, "U_T, mJ", row["U_T_boundary"], row["U_T_fem"], TOLERANCE, rule)
    return [U_T, Check(case, "quietly wrong", 0.0, row["quietly_wrong"], rule="at most")]


def main(quick: bool = False) -> list[Check]:
    asked = list(scenes())
    rows = [compared(*each) for each in (asked[:2] if quick else asked)]
    checks = [check for row in rows for check in checks_of(row)]
    show("Where simulated fracture is hard", checks)
    if not quick:
        save("fracture_limits", rows)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
