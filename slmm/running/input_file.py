"""Files that are read: regular ones, and no more of them than they can have to say."""

from __future__ import annotations

import os
import stat
from pathlib import Path

#: what a name may stand for that is no file to read: a pipe would be waited for, a device never ends
_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def input_problem(path: str | Path) -> str:
    """What keeps a name from being that of a regular file, in words; empty when nothing does.

    Examples
    --------
    >>> input_problem("README.md"), input_problem("slmm"), input_problem("x" * 5000)
    ('', 'it is a folder, not a regular file', 'File name too long')
    """
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return "there is no such file"
    except OSError as error:
        return error.strerror or str(error)
    except ValueError:  # a NUL in the name
        return "there is no such file"
    return (
        "" if stat.S_ISREG(mode) else f"it is {_KINDS.get(stat.S_IFMT(mode), 'special')}, not a regular file"
    )


def check_input(path: str | Path) -> None:
    """Refuse a name that is not that of a regular file.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    ValueError
        When it is a folder, a pipe, a device, a socket, or has an impossible name.
    """
    if problem := input_problem(path):
        missing = problem == "there is no such file"
        raise (FileNotFoundError if missing else ValueError)(f"{shown(path)}: {problem}")


def read_text(path: str | Path, most: int, what: str) -> str:
    """The text of a regular UTF-8 file, with or without byte order mark.

    Parameters
    ----------
    path : path
    most : int
        Size in bytes beyond which it cannot be what is wanted, and is not read.
    what : str
        What it should be, for the message.

    Raises
    ------
    ValueError
        When it is no regular file, unreadable, larger, or not UTF-8; the message does not name it.
    """
    if problem := input_problem(path):
        raise ValueError(f"cannot be read: {problem}")
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)  # what /proc holds has the size 0
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror or error}") from error
    if len(content) > most:
        raise ValueError(f"is not a {what}: it is larger than {most / 1e6:g} MB")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ValueError(
            f"is not a {what}: byte {content[error.start]:#04x} in line {line} is no UTF-8"
        ) from None


def shown(path: str | Path) -> str:
    """A name for a message: the end of it, where it is long."""
    name = str(path)
    return name if len(name) <= 300 else f"...{name[-100:]}"
