"""What every command shares: refusals, targets of files, what a terminal shows."""

from __future__ import annotations

import contextlib
import gc
import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer
from rich.box import SIMPLE_HEAD, Box
from rich.console import Console
from rich.text import Text

from slmm.running.encoding import fitting, replace_what_cannot_be_encoded, without_control
from slmm.running.input_file import check_input, shown
from slmm.running.progress import Progress, silent

BAD_INPUT = 2
#: how files that are written may end
RESULT_FORMATS = (".nc",)
MESH_FORMATS = (".vtu",)
PICTURE_FORMATS = (".png", ".pdf", ".svg")
#: rich would draw a frame in its place, and tables would not fit any more
ASCII_HEAD = Box("    \n    \n -- \n" + 5 * "    \n", ascii=True)
FILE_WIDTH = 100  # columns where there is no terminal
#: objects after which Python looks for cycles; imports and kernels make half a million, and all of them stay (chosen:
#: the answer of a circle needs no search)
SELDOM = 300_000
LONGEST_NAME = 255  # bytes; what all common file systems take


class Application(typer.Typer):
    """A command line whose output fits every terminal: what its encoding cannot hold is written in ASCII."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Run the command that the arguments name."""
        replace_what_cannot_be_encoded(sys.stdout)
        replace_what_cannot_be_encoded(sys.stderr)
        # read when numpy comes: on matrices as small as ours more threads only wait for each other
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        gc.set_threshold(SELDOM)
        try:
            return super().__call__(*arguments, **options)
        finally:
            # The process ends here, and all it holds with it. Python would search it for cycles first, several times,
            # which takes longer than the solve of a circle; files and processes are closed by their owners.
            gc.freeze()


class _Plain(Console):
    """Texts as they are, [0] an index and :x: no picture, in the characters that the stream has."""

    def __init__(self, **options: Any) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        return super().render_str(fitting(without_control(text), self.encoding), **options)


def console() -> Console:
    """For tables."""
    return _Plain(width=None if sys.stdout.isatty() else FILE_WIDTH)


def table_box(out: Console) -> Box:
    """A line below the head of a table."""
    return SIMPLE_HEAD if out.encoding.startswith("utf") else ASCII_HEAD


def number_text(value: float | None, digits: str) -> str:
    """A number in a table; a dash where there is none."""
    return "-" if value is None else format(value, digits)


def errors() -> Console:
    """For what is not a result."""
    return _Plain(stderr=True)


@contextlib.contextmanager
def refusals() -> Iterator[None]:
    """Bad input ends with a sentence and code 2, a failed computation with a sentence and code 1.

    Our own warnings are sentences on stderr, too.
    """
    try:
        with _said_warnings():
            yield
    # SceneError, DatabaseError; an extra that is not installed; what is written has an error of its own (whole_file),
    # so a file that is missing or locked is one that should have been read
    except (ValueError, ImportError, FileNotFoundError, PermissionError, IsADirectoryError) as error:
        say_error(str(error))
        raise typer.Exit(BAD_INPUT) from None
    except (RuntimeError, OSError, MemoryError) as error:
        if isinstance(error, typer.Exit):  # is a RuntimeError
            raise
        say_error(str(error) or type(error).__name__)
        raise typer.Exit(1) from None


@contextlib.contextmanager
def _said_warnings() -> Iterator[None]:
    """Warnings of this package as sentences, each once."""
    with warnings.catch_warnings():
        by_python, said = warnings.showwarning, set()

        def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            if not category.__module__.startswith("slmm."):
                by_python(message, category, *where, **more)
            elif str(message) not in said:
                said.add(str(message))
                errors().print(f"warning: {message}", style="yellow", soft_wrap=True)

        warnings.showwarning = show
        yield


def say_error(text: str) -> None:
    """One red sentence on stderr."""
    errors().print(f"error: {text}", style="red", soft_wrap=True)


def check_target(path: Path | None, formats: tuple[str, ...], option: str) -> None:
    """Refuse before the long work what could not be written after it."""
    if path is None:
        return
    name = f"{option} {shown(path)}"
    if path.suffix.lower() not in formats:
        raise ValueError(f"{name}: the name must end with {' or '.join(formats)}")
    if len(os.fsencode(path.name)) > LONGEST_NAME:
        raise ValueError(f"{name}: the name has more than {LONGEST_NAME} bytes")
    if os.path.isdir(path):
        raise ValueError(f"{name}: is a folder")
    if not os.path.isdir(path.parent):
        raise ValueError(f"{name}: there is no folder {shown(path.parent)}")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(f"{name}: the folder {shown(path.parent)} is not writable")


def check_target_folder(path: Path | None, option: str) -> None:
    """Refuse before the long work a folder in which no files could be made after it."""
    if path is None:
        return
    name = f"{option} {shown(path)}"
    if os.path.lexists(path) and not os.path.isdir(path):
        raise ValueError(f"{name}: must be a folder, and there is a file")
    if not os.path.isdir(path) and not os.path.isdir(path.parent):
        raise ValueError(f"{name}: there is no folder {shown(path.parent)}")
    above = path if os.path.isdir(path) else path.parent
    if not os.access(above, os.W_OK):
        raise ValueError(f"{name}: the folder {shown(above)} is not writable")


def check_no_input(inputs: list[Path | str | None], targets: dict[str, Path | None]) -> None:
    """Inputs must be files, and a result must not take the place of what it is made from, as a notch's picture."""
    files = [file for file in inputs if file is not None]
    for file in files:
        check_input(file)
    for option, target in targets.items():
        for file in files:
            if target is not None and os.path.realpath(file) == os.path.realpath(target):
                raise ValueError(f"{option} {target}: is an input of this run and would be overwritten")


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress]:
    """A progress bar on stderr, on a terminal only."""
    stream = errors()
    if not stream.is_terminal:
        yield silent
        return
    from rich.progress import (
        BarColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bar

    text = TextColumn("{task.description}", markup=False)
    columns = BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn(), text
    with Bar(*columns, console=stream, transient=True) as bar:
        task = bar.add_task("start", total=1.0)
        yield lambda share, text: bar.update(task, completed=share, description=text)


@contextlib.contextmanager
def word_on_compilation() -> Iterator[None]:
    """Say once when a kernel is compiled: numba tells, and only when its cache has none."""
    from numba.core import event

    class Teller(event.Listener):
        told = False

        def on_start(self, event: event.Event) -> None:
            if not self.told:
                self.told = True
                print(
                    "compiling kernels, once: this first start takes up to a minute longer", file=sys.stderr
                )

        def on_end(self, event: event.Event) -> None:
            pass

    with event.install_listener("numba:compile", Teller()):
        yield
