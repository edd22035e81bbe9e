"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import zlib
from collections.abc import Iterator
from pathlib import Path

from slmm.running.input_file import shown


class NotWrittenError(OSError):
    """A file that could not be written; the message names it and says why."""


@contextlib.contextmanager
def whole_file(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """A name to write to; the file takes its place only when it is complete.

    Parameters
    ----------
    path : Path
        Where the file shall be.
    folder : Path, optional
        Where it grows, on the same file system; beside its place if not given.

    Raises
    ------
    NotWrittenError
        When writing fails, as on a full disk; nothing is left behind then.
    """
    # of a length of its own: a name may be as long as the file system allows
    name = f".{zlib.crc32(os.fsencode(path.name)):08x}.{os.getpid()}.partial"
    unfinished = (path.parent if folder is None else folder) / name
    try:
        yield unfinished
        os.replace(unfinished, path)
    except (OSError, RuntimeError) as error:  # HDF5 has errors of both kinds
        raise NotWrittenError(f"{shown(path)}: cannot be written: {_cause(unfinished, error)}") from error
    finally:
        with contextlib.suppress(OSError):  # it was never there, or its folder is gone
            unfinished.unlink()


def _cause(unfinished: Path, error: Exception) -> str:
    """What the system says; HDF5 does not tell it, so the system is asked by writing on."""
    if isinstance(error, OSError) and error.errno is not None and error.errno > 0:
        return error.strerror or str(error)
    try:
        with open(unfinished, "ab", buffering=0) as file:
            file.write(bytes(2**20))
            os.fsync(file.fileno())
    except OSError as again:
        return again.strerror or str(again)
    return str(error)
