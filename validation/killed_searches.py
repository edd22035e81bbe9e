"""A search that is killed at random moments ends, resumed, with the result of an undisturbed one, to the bit.

Three searches get SIGKILL twenty times each, at a random moment after they have come farther than before: a TBFSL on
16 x 8 cells whose evaluations are slowed down, one on 30 x 12 cells, most of whose neighbours a quick model judges, and
one among hole patterns of 3 x 3 points.
Required: the last start prints what an undisturbed run prints, and each kill hit a search at work. Five minutes;
``--quick`` kills less deep ones three times.
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
#: a kill comes at most so long after a search has come farther than before, s
LATEST = 1.0
BEGIN = """
import sys, time
from slmm.optimization import Cantilever, HolePattern, search
class Slow:
    def __init__(self, beam):
        self.beam = beam
    def evaluate(self, designs):
        time.sleep(0.002 * len(designs))
        return self.beam.evaluate(designs)
    def __repr__(self):
        return "Slow"
    def __getattr__(self, name):
        if name in ("neighbours", "beam") or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.beam, name)
"""
END = """
r = search(problem, "tbfsl", depth=depth, radius=2, seed=8, journal=sys.argv[1], resume=True,
           progress=lambda n, value: print(n, flush=True))
print(r.value.hex(), r.simulations, r.best_design.astype(int).ravel().tolist(), [v.hex() for v in r.history.value])
"""
SEARCHES = {
    "TBFSL(3, 2) on 16 x 8, slow": "problem, depth = Slow(Cantilever(16, 8)), 3",
    "TBFSL(3, 2) on 30 x 12, quick model": "problem, depth = Cantilever(30, 12), 3",
    "TBFSL(3, 2) on hole patterns, full 3": "problem, depth = HolePattern(3, 'full', 4.0), 3",
}
QUICK = {
    "TBFSL(2, 2) on 16 x 8, slow": "problem, depth = Slow(Cantilever(16, 8)), 2",
    "TBFSL(2, 2) on 24 x 10, quick model": "problem, depth = Cantilever(24, 10), 2",
}


def started(problem: str, journal: Path) -> subprocess.Popen[str]:
    """A process that prints the number of simulations again and again, and the result."""
    return subprocess.Popen(
        [sys.executable, "-c", BEGIN + problem + END, str(journal)], stdout=subprocess.PIPE, text=True
    )


def result(problem: str, journal: Path) -> str:
    """What a search prints last."""
    printed, _ = started(problem, journal).communicate()
    return printed.splitlines()[-1]


def killed(problem: str, journal: Path, wait: float, farthest: int) -> int:
    """How far a search has come that was killed so long after it had come farther than before; -1 if it has ended.

    Parameters
    ----------
    farthest : int
        Number of simulations at the kill before.
    """
    process = started(problem, journal)
    assert process.stdout is not None
    for line in process.stdout:
        if not line.strip().isdigit() or int(line) > farthest:
            break
    time.sleep(wait)
    at_work = process.poll() is None
    process.send_signal(signal.SIGKILL)
    rest = process.communicate()[0].splitlines()
    # the last line may be cut
    numbers = [int(text) for text in [line, *rest[:-1]] if text.strip().isdigit()]
    return max(numbers, default=-1) if at_work else -1


def main(quick: bool = False) -> list[Check]:
    dice, checks = random.Random(0), []
    kills = 3 if quick else KILLS
    for name, problem in (QUICK if quick else SEARCHES).items():
        with tempfile.TemporaryDirectory() as folder:
            undisturbed = result(problem, Path(folder) / "calm.sqlite")
            journal = Path(folder) / "killed.sqlite"
            came = [0]
            for _ in range(kills):
                came.append(killed(problem, journal, dice.uniform(0.0, LATEST), max(came)))
            resumed = result(problem, journal)
        hits = sum(far > 0 for far in came)
        differ = float(resumed != undisturbed)
        checks += [
            Check(name, "resumed runs that differ", 0.0, differ, rule="at most", source="required"),
            Check(name, "kills that hit a search at work", kills, hits, 0.0, source="required"),
            Check(name, "simulations at the last kill", int(undisturbed.split()[1]), max(came), rule="told"),
        ]
    show("Killed searches", checks)
    if not quick:
        save("killed_searches", [check.row() for check in checks])
    return checks


if __name__ == "__main__":
    run(main, __doc__)
