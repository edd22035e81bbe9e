"""The picture of the chart: error against time with the Pareto front, from results/chart_methods.csv.

`chart.py` measures and draws; alone this draws what was measured last.
"""

from __future__ import annotations

import csv

import matplotlib
import numpy as np
from checks import RESULTS
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

matplotlib.use("Agg")
import matplotlib.pyplot as plt

#: groups of configurations that turn one knob of a method, drawn small
KNOBS = ("voxels", "modes", "cell choice", "mesh", "mesh of dislocations", "tolerance")
#: of a label, decades
LABEL_WIDTH, LABEL_HEIGHT = 0.36, 0.085

Line = dict[str, str]

COLOURS = {
    "stress": "#56B4E9",
    "paper": "#CC79A7",
    "cells": "#0072B2",
    "voxels": "#0072B2",
    "modes": "#0072B2",
    "cell choice": "#0072B2",
    "mesh": "#0072B2",
    "dislocations": "#009E73",
    "mesh of dislocations": "#009E73",
    "auto": "#D55E00",
    "tolerance": "#D55E00",
    "full FEA": "black",
}


def front(lines: list[Line], error: str) -> list[Line]:
    """Configurations that no other beats in time and error, by time; those that answer nearly everywhere."""
    known = [line for line in lines if float(line["answered"]) > 0.9 and np.isfinite(float(line[error]))]
    known.sort(key=lambda line: float(line["seconds"]))
    kept: list[Line] = []
    for line in known:
        if not kept or float(line[error]) < float(kept[-1][error]):
            kept.append(line)
    return kept


def draw() -> None:
    """Draw results/chart.png."""
    with open(RESULTS / "chart_methods.csv", newline="") as file:
        lines = [{key: value or "nan" for key, value in line.items()} for line in csv.DictReader(file)]
    figure, axes = plt.subplots(1, 2, figsize=(13, 6), layout="constrained")
    for axis, what, error in (
        (axes[0], "critical failure index", "FI_error"),
        (axes[1], "$G_{inc}$ up to $2\\,a_c$ at the critical position", "G_inc_error"),
    ):
        draw_panel(axis, lines, error)
        axis.set(xscale="log", yscale="log", xlabel="time for 20 positions on each hole, s", title=what)
    axes[0].set_ylabel("error: median (marker) and 90 % (bar)")
    figure.suptitle("Error against time, 15 smooth scenes, $l_{ch}$ a fifth of the notch radius")
    figure.savefig(RESULTS / "chart.png", dpi=130)
    plt.close(figure)


def draw_panel(axis: Axes, lines: list[Line], error: str) -> None:
    best = front(lines, f"{error}_90")
    axis.plot(
        [float(line["seconds"]) for line in best],
        [float(line[f"{error}_90"]) for line in best],
        color="0.8",
        lw=6,
        zorder=0,
        solid_joinstyle="round",
        label="Pareto front (90 %)",
    )
    placed: list[tuple[float, float]] = []  # logarithms of where labels stand
    for line in sorted(lines, key=lambda line: -float(line[f"{error}_median"])):
        x, y, top = (float(line[key]) for key in ("seconds", f"{error}_median", f"{error}_90"))
        if not np.isfinite(y):
            continue
        knob = line["group"] in KNOBS
        colour = COLOURS[str(line["group"])]
        axis.plot([x, x], [y, top], color=colour, lw=1.0, alpha=0.6)
        axis.plot(x, y, "o", ms=4 if knob else 8, color=colour, mfc="white" if knob else colour)
        answered = "" if float(line["answered"]) > 0.995 else f" ({100 * float(line['answered']):.0f} %)"
        height = np.log10(y)
        for at, taken in placed:
            if abs(np.log10(x) - at) < LABEL_WIDTH and height > taken - LABEL_HEIGHT:
                height = min(height, taken - LABEL_HEIGHT)
        placed.append((float(np.log10(x)), float(height)))
        axis.annotate(
            f"{line['configuration']}{answered}",
            (x * 1.02, y),
            (x * 1.12, 10**height),
            va="center",
            arrowprops={"arrowstyle": "-", "lw": 0.4, "color": colour, "shrinkA": 0},
            fontsize=6.5 if knob else 8.5,
            color=colour,
        )
    axis.grid(True, which="major", color="0.93")
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.legend(frameon=False, loc="lower left")


if __name__ == "__main__":
    draw()
