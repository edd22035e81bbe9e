"""A search that is killed at random moments ends, resumed, with the result of an undisturbed one, to the bit.

A TBFSL on 16 x 8 cells, evaluations slowed down so that it takes a few seconds, gets SIGKILL twenty times, each time
somewhat later than it started to work. Required: the last start prints what an undisturbed run prints. Two minutes;
``--quick`` kills three times.
"""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from checks import Check, run, save, show

KILLS = 20
SEARCH = """
import sys, time
from slmm.optimization import Cantilever, search
class Slow:
    def __init__(self, beam):
        self.beam = beam
    def evaluate(self, designs):
        time.sleep(0.001 * len(designs))
        return self.beam.evaluate(designs)
    def __repr__(self):
        return "Slow"
    def __getattr__(self, name):
        if name in ("neighbours", "beam") or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.beam, name)
r = search(Slow(Cantilever(16, 8)), "tbfsl", depth=2, radius=2, seed=8, journal=sys.argv[1], resume=True)
print(r.value.hex(), r.simulations, r.best_design.astype(int).ravel().tolist(), [v.hex() for v in r.history.value])
"""


def started(journal: Path) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-c", SEARCH, str(journal)], stdout=subprocess.PIPE, text=True)


def main(quick: bool = False) -> list[Check]:
    dice, kills = random.Random(0), 0
    with tempfile.TemporaryDirectory() as name:
        undisturbed, _ = started(Path(name) / "calm.sqlite").communicate()
        journal = Path(name) / "killed.sqlite"
        for _ in range(3 if quick else KILLS):
            process = started(journal)
            while not journal.exists() and process.poll() is None:
                time.sleep(0.005)
            time.sleep(dice.uniform(0.0, 1.5))
            if process.poll() is None:
                kills += 1
            process.send_signal(signal.SIGKILL)
            process.communicate()
        resumed, _ = started(journal).communicate()
    checks = [
        Check("TBFSL(2, 2) on 16 x 8", "resumed runs that differ", 0.0, float(resumed != undisturbed or not resumed),
              rule="at most", source="required"),
        Check("TBFSL(2, 2) on 16 x 8", "kills that hit a running search", 3.0 if quick else KILLS, kills, rule="told"),
    ]  # fmt: skip
    show("Killed searches", checks)
    if not quick:
        save("killed_searches", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
