"""What every validation script shares: a check against a wanted value, its table and its file."""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from rich import box
from rich.console import Console
from rich.table import Table

from slmm import Scene
from slmm.initiation.positions import find_positions

RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Check:
    """One value of ours beside the required or published one.

    Parameters
    ----------
    case, quantity : str
        Of what, and which value.
    wanted : float
        The required or published value.
    ours : float
        What this package gives.
    tolerance : float
        Relative, for ``rule = "equal"``.
    rule : {"equal", "at most", "told"}
        "told" compares without a verdict: the published value is doubted, or not ours to meet.
    source : str
        Where the wanted value comes from.
    """

    case: str
    quantity: str
    wanted: float
    ours: float
    tolerance: float = math.nan
    rule: Literal["equal", "at most", "told"] = "equal"
    source: str = ""

    @property
    def difference(self) -> float:
        """Ours over the wanted value, less one."""
        return self.ours / self.wanted - 1 if self.wanted else self.ours

    @property
    def holds(self) -> bool:
        """Whether the requirement is met; NaN never meets one."""
        if self.rule == "told":
            return True
        if self.rule == "at most":
            return self.ours <= self.wanted
        return abs(self.difference) <= self.tolerance

    def row(self) -> dict[str, object]:
        """As a line of a file."""
        return asdict(self) | {"difference": self.difference, "holds": self.holds}


def show(title: str, checks: Iterable[Check]) -> None:
    """Print wanted value, ours, difference and tolerance."""
    table = Table("case", "quantity", title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("wanted", "ours", "difference", "tolerance"):
        table.add_column(heading, justify="right")
    table.add_column("")
    for c in checks:
        limit = {"equal": f"{100 * c.tolerance:g} %", "at most": "at most", "told": ""}[c.rule]
        verdict = "" if c.holds else "FAILS"
        difference = "" if c.rule == "at most" else _text(100 * c.difference, "+.2f", " %")
        table.add_row(
            c.case, c.quantity, _text(c.wanted, ".4g"), _text(c.ours, ".4g"), difference, limit, verdict
        )
    Console(width=140).print(table)


def _text(value: float, digits: str, unit: str = "") -> str:
    return "" if math.isnan(value) else format(value, digits) + unit


def at_spread_positions(scene: Scene, count: int) -> Scene:
    """The scene with its equally spaced positions as given points, which no method adds to."""
    return scene.with_(analysis={"points": find_positions(scene, count).points.tolist()})


def save(name: str, rows: Iterable[Mapping[str, object]]) -> None:
    """Write rows with the same keys to results/name.csv."""
    (RESULTS / f"{name}.csv").unlink(missing_ok=True)
    append(name, rows)


def append(name: str, rows: Iterable[Mapping[str, object]]) -> None:
    """Write rows with the same keys below those of results/name.csv."""
    rows = list(rows)
    RESULTS.mkdir(exist_ok=True)
    with open(RESULTS / f"{name}.csv", "a", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        if not file.tell():
            writer.writeheader()
        for row in rows:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


def saved(name: str) -> list[dict[str, str]]:
    """The rows of results/name.csv; none where there is no such file."""
    path = RESULTS / f"{name}.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def run(main: Callable[[bool], list[Check]], doc: str | None) -> None:
    """Command line of a script: ``--quick``; ends with 1 where a requirement is not met."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a small part, a minute at most, no files")
    checks = main(parser.parse_args().quick)
    raise SystemExit(0 if all(check.holds for check in checks) else 1)
