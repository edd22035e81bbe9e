"""Random smooth outlines and loads: no crash, and every position ends with a value or a reason.

Outlines are random Fourier series around a centre; one scene in three has two holes, one in four a notch that cuts the
plate's edge. Loads are random strains, a displacement or a stress, also compressive; material, plane state, Poisson's
ratio and toughness are random too. Outlines that `Scene` refuses (they cross, or cut the plate apart) are drawn again.

Writes validation/results/stability.csv (one line for each scene), stability_statuses.csv and stability.png; a few
minutes, ``--quick`` takes 10 of the 200 scenes and writes nothing.
"""

from __future__ import annotations

import time
import traceback
from collections import Counter

import matplotlib
import numpy as np
from checks import RESULTS, Check, run, save, show

from slmm import Scene, SceneError, failure_indices

matplotlib.use("Agg")
import matplotlib.pyplot as plt

SCENES, QUICK = 200, 10
POSITIONS = 24
SIDE = 60.0
Random = np.random.Generator


def outline(rng: Random, centre: tuple[float, float], radius: float) -> dict[str, object]:
    """A smooth closed curve: a circle with random waves up to the seventh order."""
    angle = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    order = np.arange(1, 8)[:, None]
    size = rng.uniform(0, 0.35) * rng.normal(size=(7, 1)) / order**1.3
    wave = (size * np.cos(order * angle + rng.uniform(0, 2 * np.pi, (7, 1)))).sum(axis=0)
    wave *= min(1.0, 0.7 / max(-wave.min(), 1e-9))  # stays a smooth curve around the centre
    r = radius * (1 + wave)
    points = np.column_stack([centre[0] + r * np.cos(angle), centre[1] + r * np.sin(angle)])
    return {"shape": "points", "points": points.tolist()}


def holes(rng: Random, under_stress: bool) -> list[dict[str, object]]:
    kind = rng.random()
    if kind < 0.25:  # cuts the left or the lower edge
        along = rng.uniform(0.35, 0.65) * SIDE
        # a notch in one of two pulled edges would leave the stress without balance, which is refused
        centre = (0.0, along) if under_stress or rng.random() < 0.5 else (along, 0.0)
        return [outline(rng, centre, rng.uniform(0.08, 0.25) * SIDE)]
    if kind < 0.58:
        lower = outline(rng, (0.3 * SIDE, rng.uniform(0.25, 0.4) * SIDE), rng.uniform(0.05, 0.15) * SIDE)
        upper = outline(rng, (0.7 * SIDE, rng.uniform(0.6, 0.75) * SIDE), rng.uniform(0.05, 0.15) * SIDE)
        return [lower, upper]
    return [outline(rng, tuple(rng.uniform(0.4, 0.6, 2) * SIDE), rng.uniform(0.05, 0.3) * SIDE)]


def load(rng: Random) -> dict[str, object]:
    kind = rng.integers(3)
    if kind == 0:
        return {"strain": rng.normal(0, 0.01, 3).tolist()}
    return {"displacement": float(rng.normal(0, 0.5))} if kind == 1 else {"stress": float(rng.normal(0, 20))}


def scene(rng: Random) -> Scene:
    """A scene that is geometrically possible."""
    while True:
        pull = load(rng)
        tables = {
            "plate": {"width": SIDE, "height": SIDE},
            "holes": holes(rng, "stress" in pull),
            "material": {
                "E": 3000.0,
                "nu": float(rng.uniform(-0.3, 0.48)),
                "sigma_c": 50.0,
                "G_c": float(np.exp(rng.uniform(np.log(0.05), np.log(5.0)))),
                "state": str(rng.choice(["plane stress", "plane strain"])),
            },
            "load": pull,
            "analysis": {"positions": POSITIONS},
        }
        try:
            return Scene.from_dict(tables)
        except SceneError:
            continue


def examine(number: int) -> tuple[dict[str, object], Counter]:
    """Run one scene; how many positions have a value, a reason, or neither."""
    part = scene(np.random.default_rng(number))
    method = ("slmm+ac", "slmm")[number % 4 == 3]
    row: dict[str, object] = {"scene": number, "method": method, "holes": len(part.outlines)}
    row["load"] = next(k for k in ("strain", "displacement", "stress") if getattr(part.load, k) is not None)
    start = time.perf_counter()
    try:
        result = failure_indices(part, method, curves=True)
    except Exception:
        traceback.print_exc()
        return row | {
            "crash": 1,
            "positions": 0,
            "values": 0,
            "reasons": 0,
            "neither": 0,
            "seconds": 0.0,
        }, Counter()
    FI, status = result.failure_index.values, result.status.values
    ok = status == "ok"
    value = ok & np.isfinite(FI) & (FI >= 0)
    reason = ~ok & np.isnan(FI) & (status != "")
    row |= {
        "crash": 0,
        "positions": len(FI),
        "values": int(value.sum()),
        "reasons": int(reason.sum()),
        "neither": int((~value & ~reason).sum()),
        "seconds": time.perf_counter() - start,
    }
    return row, Counter(status.tolist())


def draw(counts: Counter) -> None:
    figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
    names = [name for name, _ in counts.most_common()][::-1]
    bars = axis.barh(names, [counts[name] for name in names], color="0.6")
    axis.bar_label(bars)
    axis.set(xlabel="positions")
    figure.savefig(RESULTS / "stability.png", dpi=150)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    counts: Counter = Counter()
    rows = []
    for number in range(QUICK if quick else SCENES):
        row, found = examine(number)
        rows.append(row)
        counts += found
    positions = sum(row["positions"] for row in rows)
    case = f"{len(rows)} random scenes, {positions} positions"
    checks = [
        Check(case, "crashes", 0, sum(row["crash"] for row in rows), rule="at most"),
        Check(
            case, "positions without value or reason", 0, sum(row["neither"] for row in rows), rule="at most"
        ),
    ]
    for status, number in counts.most_common():
        checks.append(Check(case, f"status: {status}", positions, number, rule="told"))
    show("Stability", checks)
    if not quick:
        save("stability", rows)
        save("stability_statuses", [{"status": name, "positions": n} for name, n in counts.most_common()])
        draw(counts)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
