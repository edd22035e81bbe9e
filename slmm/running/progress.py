"""How a long job tells how far it has come."""

from __future__ import annotations

from collections.abc import Callable

#: is told the share that is done, from 0 to 1, and a word on what is being done
Progress = Callable[[float, str], None]


def silent(share: float, text: str) -> None:
    """The progress that nobody looks at.

    Parameters
    ----------
    share : float
        What is done, from 0 to 1.
    text : str
        A word on what is being done.

    Examples
    --------
    >>> def squares(numbers, progress: Progress = silent):
    ...     for k, number in enumerate(numbers):
    ...         progress(k / len(numbers), f"number {k + 1} of {len(numbers)}")
    ...         yield number**2
    >>> list(squares([1, 2]))
    [1, 4]
    >>> list(squares([1, 2], lambda share, text: print(f"{share:.0%}: {text}")))
    0%: number 1 of 2
    50%: number 2 of 2
    [1, 4]
    """
