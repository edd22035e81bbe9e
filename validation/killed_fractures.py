"""A simulation of fracture that is killed at random moments ends, resumed, with the result of an undisturbed one.

Two plates are broken by ``slmm fracture --resume``, which gets SIGKILL twenty times each, at a random moment after it
has come farther than ever before. Required: the last start writes a netCDF file with the values of an undisturbed run,
to the bit, and each kill hit a simulation at work. Eight minutes of CPU; ``--quick`` kills one of them three times.
"""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import xarray as xr
from checks import Check, run, save, show

KILLS = 20
#: a kill comes at most so long after a simulation has come farther than before, s
LATEST = 0.6
#: how long a simulation may take to come farther, s
PATIENCE = 600.0
SCENE = """
[plate]
width = 80.0
height = 80.0
{holes}
[[cracks]]
points = [[0.0, 40.0], [10.0, 40.0]]
[material]
E = 2960.0
nu = 0.38
sigma_c = 70.5
K_Ic = 1.96
state = "plane strain"
[load]
displacement = 1.0
"""
CIRCLE = '[[holes]]\nshape = "circle"\ncenter = [{}, {}]\nradius = {}\n'
ELLIPSE = '[[holes]]\nshape = "ellipse"\ncenter = [62.0, 45.0]\nsemi_axes = [6.0, 4.0]\nangle = 10.0\n'
PLATES = {
    "two circles": (CIRCLE.format(46, 45, 12) + CIRCLE.format(24, 36, 4), "0.25"),
    "two circles and an ellipse": (
        CIRCLE.format(28, 44, 6) + CIRCLE.format(46, 30, 5) + ELLIPSE,
        "0.2",
    ),
}


def started(scene: Path, increment: str, output: Path) -> subprocess.Popen[bytes]:
    """The command at work."""
    command = "from slmm.command.cli import app; app()"
    arguments = ["fracture", scene, "--increment", increment, "-o", output, "--resume"]
    return subprocess.Popen(
        [sys.executable, "-c", command, *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def steps_in(journal: Path) -> int:
    """Whole lines of a journal but for the first."""
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.is_file() else 0


def killed(process: subprocess.Popen[bytes], journal: Path, wait: float, farthest: int) -> int:
    """How far a simulation has come that is killed so long after it has come farther; -1 if it ended before."""
    end = time.monotonic() + PATIENCE
    while process.poll() is None and steps_in(journal) <= farthest and time.monotonic() < end:
        time.sleep(0.005)
    time.sleep(wait)
    at_work = process.poll() is None
    process.send_signal(signal.SIGKILL)
    process.wait()
    return steps_in(journal) if at_work else -1


def values(output: Path) -> xr.Dataset:
    """A result without the command that wrote it."""
    with xr.open_dataset(output) as result:
        result.load().attrs.pop("command")
        return result


def main(quick: bool = False) -> list[Check]:
    dice, checks = random.Random(0), []
    kills = 3 if quick else KILLS
    for name, (holes, increment) in list(PLATES.items())[: 1 if quick else None]:
        increment = "0.5" if quick else increment
        case = f"{name}, increment {increment} mm"
        with tempfile.TemporaryDirectory() as folder:
            scene, calm, output = (Path(folder) / name for name in ("plate.toml", "calm.nc", "killed.nc"))
            scene.write_text(SCENE.format(holes=holes))
            started(scene, increment, calm).wait()
            journal = output.with_suffix(".jsonl")
            came = [0]
            for _ in range(kills):
                process = started(scene, increment, output)
                came.append(killed(process, journal, dice.uniform(0.0, LATEST), max(came)))
            written = output.exists()
            started(scene, increment, output).wait()
            undisturbed, resumed = values(calm), values(output)
            same = undisturbed.identical(resumed) and not written
            same = same and calm.with_suffix(".jsonl").read_bytes() == journal.read_bytes()
        hits = sum(far > 0 for far in came)
        checks += [
            Check(
                case, "resumed results that differ", 0.0, float(not same), rule="at most", source="required"
            ),
            Check(case, "kills that hit a simulation at work", kills, hits, 0.0, source="required"),
            Check(case, "steps at the last kill", undisturbed.sizes["step"], max(came), rule="told"),
        ]
    show("Killed simulations of fracture", checks)
    if not quick:
        save("killed_fractures", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
