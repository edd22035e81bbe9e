"""What a sweep found, on the terminal: a line for each variant, or the extremes of many."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from slmm.command.terminal import console, number_text, table_box
from slmm.initiation.record import plain
from slmm.initiation.summary import status_counts

if TYPE_CHECKING:
    from slmm.running.labelled import LabelledArrays

#: variants that are listed; of more the extremes
LISTED = 24


def variant_records(result: LabelledArrays) -> list[dict[str, Any]]:
    """Each variant with its keys and all that was found; None where there is no value."""
    dims, shape = result["failure_index"].dims, result["failure_index"].values.shape
    grids = dict(zip(dims, np.meshgrid(*(result[key].values for key in dims), indexing="ij"), strict=True))
    columns = grids | {
        name: variable.values
        for name, variable in result.variables.items()
        if variable.dims == dims and name not in dims
    }
    return [{name: plain(values[at]) for name, values in columns.items()} for at in np.ndindex(*shape)]


def is_answered(result: LabelledArrays) -> bool:
    """Whether every variant has a value that nothing leaves open."""
    return bool((result["status"].values == "ok").all())


def as_json(result: LabelledArrays) -> str:
    """All variants as JSON; null where a value is missing."""
    content = plain(dict(result.attrs)) | {
        "units": {name: variable.attrs["units"] for name, variable in result.variables.items()},
        "status_counts": status_counts(result),
        "variants": variant_records(result),
    }
    return json.dumps(content, indent=2, allow_nan=False)


def write_csv(result: LabelledArrays, path: Path) -> None:
    """All variants as lines; nothing stands where a value is missing."""
    records = variant_records(result)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(records[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(records)


def print_sweep(result: LabelledArrays) -> None:
    """A table of the variants, and how many have a value."""
    records, keys = variant_records(result), result["failure_index"].dims
    shown = records if len(records) <= LISTED else _extremes(records)
    what = f"{len(records)} variants" if shown is records else f"the extremes of {len(records)} variants"
    out = console()
    title = result.attrs.get("title") or "Failure indices"
    table = Table(title=f"{title} ({result.attrs['method']}): {what}", box=table_box(out))
    for key in keys:
        units = result[key].attrs["units"]
        table.add_column(key.replace(".", ".\n", 1) + ("" if units == "1" else f"\n{units}"), justify="right")
    columns = [
        ("load_factor", "load\nfactor", ".4g"),
        ("failure_index", "failure\nindex", ".4g"),
        ("failure_index_error", "error\n±", ".1g"),
        ("crack_length", "crack\nlength\nmm", ".4g"),
        ("x", "x\nmm", ".2f"),
        ("y", "y\nmm", ".2f"),
    ]
    for _, heading, _ in columns:
        table.add_column(heading, justify="right", no_wrap=True)
    open_ones = not is_answered(result)
    if open_ones:
        table.add_column("status")
    for record in shown:
        given = [value if isinstance(value := record[key], str) else f"{value:.6g}" for key in keys]
        row = [*given, *(number_text(record[name], digits) for name, _, digits in columns)]
        table.add_row(*row, *([str(record["status"])] if open_ones else []))
    out.print(table)
    counts = "; ".join(f"{count} {status}" for status, count in status_counts(result).items())
    out.print(f"Variants: {counts}.", soft_wrap=True)
    index = result["failure_index"].values
    starts = int(np.count_nonzero(np.nan_to_num(index) >= 1))
    out.print(
        f"A crack starts in {starts} of {len(records)}. Curves were computed for {result.attrs['answered']} of them; "
        "the others follow.",
        soft_wrap=True,
    )


def _extremes(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The variants with the lowest and the highest load factor, and one of each kind without a value."""
    known = [record for record in records if record["load_factor"] is not None]
    known.sort(key=lambda record: record["load_factor"])
    half = LISTED // 4
    ends = known if len(known) <= 2 * half else known[:half] + known[-half:]
    others = {record["status"]: record for record in records if record["load_factor"] is None}
    return ends + list(others.values())[:half]
