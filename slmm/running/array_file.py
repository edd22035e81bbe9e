"""Arrays in npz files as numpy writes them, of which nothing is trusted when they are read again."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from slmm.running.input_file import input_problem, shown


def read_arrays(path: Path, names: Iterable[str], what: str) -> dict[str, np.ndarray]:
    """All arrays of a file that `numpy.savez` has written.

    Parameters
    ----------
    path : Path
    names : iterable of str
        Those that must be there, and no others.
    what : str
        What the file should be, for the message.

    Raises
    ------
    ValueError
        When it is no such file, or damaged.
    """
    try:
        if problem := input_problem(path):
            raise ValueError(problem)
        with zipfile.ZipFile(path) as archive:
            # savez does not compress: an array takes as much memory as the file has bytes, and no more
            if any(member.compress_type != zipfile.ZIP_STORED for member in archive.infolist()):
                raise ValueError("it is compressed")
            if sorted(archive.namelist()) != sorted(f"{name}.npy" for name in names):
                raise ValueError("it holds other arrays")
        with np.load(path) as known:
            return {name: known[name] for name in names}
    except (
        Exception
    ) as error:  # zipfile and numpy meet a damaged file with any, MemoryError and TypeError too
        raise ValueError(f"{shown(path)}: is no {what} ({error or type(error).__name__})") from error
