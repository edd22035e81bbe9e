"""What every command shares: refusals, targets of files, progress on the terminal."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import typer
from rich.console import Console

BAD_INPUT = 2
FILE_WIDTH = 100  # columns where there is no terminal


def console() -> Console:
    """For tables."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else FILE_WIDTH)


def errors() -> Console:
    """For what is not a result."""
    return Console(stderr=True, highlight=False)


@contextlib.contextmanager
def refusals() -> Iterator[None]:
    """Bad input ends with a sentence and code 2, a failed computation with a sentence and code 1."""
    try:
        yield
    except (ValueError, ImportError) as error:  # SceneError, DatabaseError; an extra that is not installed
        say_error(str(error))
        raise typer.Exit(BAD_INPUT) from None
    except (RuntimeError, OSError, MemoryError) as error:
        if isinstance(error, typer.Exit):  # is a RuntimeError
            raise
        say_error(str(error) or type(error).__name__)
        raise typer.Exit(1) from None


def say_error(text: str) -> None:
    """One red sentence on stderr."""
    # no markup: [0] in a message is an index, not a style
    errors().print(f"error: {text}", style="red", markup=False, soft_wrap=True)


def check_target(path: Path | None, formats: tuple[str, ...], option: str) -> None:
    """Refuse before the long work what could not be written after it."""
    if path is None:
        return
    if path.suffix.lower() not in formats:
        raise ValueError(f"{option} {path}: the name must end with {' or '.join(formats)}")
    if path.is_dir():
        raise ValueError(f"{option} {path}: is a folder")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(f"{option} {path}: the folder {path.parent} is not writable")


def check_no_input(inputs: list[Path | str | None], targets: dict[str, Path | None]) -> None:
    """A result must not take the place of what it is made from, as a notch's picture."""
    for option, target in targets.items():
        for file in inputs:
            if target is not None and file is not None and Path(file).resolve() == target.resolve():
                raise ValueError(f"{option} {target}: is an input of this run and would be overwritten")


@contextlib.contextmanager
def progress_bar() -> Iterator[Callable[[float, str], None]]:
    """A progress bar on stderr, on a terminal only."""
    stream = errors()
    if not stream.is_terminal:
        yield lambda fraction, text: None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    with Progress(*columns, console=stream, transient=True) as bar:
        task = bar.add_task("start", total=1.0)
        yield lambda fraction, text: bar.update(task, completed=fraction, description=text)


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
