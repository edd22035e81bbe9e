"""TOML files as tables, and what is wrong with those that are none."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from slmm.running.input_file import read_text

#: a scene that lists the 100,000 points of the longest outline has 4 MB; chosen
MOST = 20_000_000
#: more digits than Python makes a number of
_ENDLESS = re.compile(r"\d[\d_]{4299,}")
_KEY = re.compile(r"""\s*([\w."'-]+)\s*=""")


def read_toml(path: str | Path) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises
    ------
    ValueError
        When the file cannot be read, or is no TOML; the message does not name it.
    """
    text = read_text(path, MOST, "TOML file")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        says = str(error)
        # a repeated key stands in it, as long as it may be
        raise ValueError(
            f"is not a TOML file: {says if len(says) <= 200 else says[:100] + '...' + says[-60:]}"
        ) from None
    except RecursionError:
        raise ValueError(
            "is not a TOML file that can be read: its lists or tables are nested too deeply"
        ) from None
    except ValueError as error:  # an integer of more digits than Python reads, or a date that no calendar has
        raise ValueError(f"is not a TOML file that can be read: {_endless_number(text) or error}") from None


def _endless_number(text: str) -> str:
    """Where a number of too many digits stands."""
    number = _ENDLESS.search(text)
    if number is None:
        return ""
    start = text.rfind("\n", 0, number.start()) + 1
    line, key = text.count("\n", 0, start) + 1, _KEY.match(text, start)
    at = f"line {line}" if key is None else f"line {line}, {key[1][:60]}"
    return f"{at}: a whole number of {len(number[0].replace('_', ''))} digits; a number has at most 4300"
