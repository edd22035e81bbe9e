"""Pictures as files."""

from __future__ import annotations

import io
from pathlib import Path

from matplotlib.figure import Figure

from slmm.running.whole_file import whole_file


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as its file's name asks (.png, .pdf, .svg), whole or not at all.

    Raises
    ------
    NotWrittenError
        When the file cannot be written.
    """
    # drawn in memory: on a full disk matplotlib fails in ways of its own, as with errors of zlib
    drawn = io.BytesIO()
    figure.savefig(drawn, format=path.suffix[1:].lower(), dpi=120)
    with whole_file(path) as unfinished:
        unfinished.write_bytes(drawn.getbuffer())
