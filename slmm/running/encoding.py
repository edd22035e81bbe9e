"""Text for terminals and files whose encoding does not have all of our characters."""

from __future__ import annotations

import codecs
import contextlib
import re
import unicodedata
from typing import Any

#: what stands for the characters that tables, sentences and designs have; all others become their escapes
ASCII_FORMS = {
    "±": "+-",
    "√": " sqrt ",
    "×": "x",
    "·": ".",
    "█": "#",
    "²": "2",
    "³": "3",
    "°": " deg",
    "−": "-",
    "–": "-",
    "—": "-",
    "…": "...",
    "─": "-",
    "━": "-",
    "σ": "sigma",
    "µ": "u",
    "μ": "u",
}

_NAME = "slmm.ascii"


def fitting(text: str, encoding: str) -> str:
    """The text with what an encoding lacks in ASCII, as long as tables have not been laid out yet.

    Examples
    --------
    >>> fitting("0.5 ± 0.1 MPa√mm", "utf-8"), fitting("0.5 ± 0.1 MPa√mm", "cp1252"), fitting("±", "ascii")
    ('0.5 ± 0.1 MPa√mm', '0.5 ± 0.1 MPa sqrt(mm)', '+-')
    """
    codecs.register_error(_NAME, _ascii_form)
    if "√" in text and not has(encoding, "√"):
        text = re.sub(r"√(\w+)", r" sqrt(\1)", text)
    return text.encode(encoding, _NAME).decode(encoding)


def has(encoding: str, character: str) -> bool:
    """Whether an encoding has a character."""
    try:
        character.encode(encoding)
    except UnicodeEncodeError:
        return False
    return True


def _ascii_form(error: UnicodeError) -> tuple[str | bytes, int]:
    """What to write in place of characters that an encoding does not have."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(
        ASCII_FORMS.get(c) or c.encode("ascii", "backslashreplace").decode()
        for c in error.object[error.start : error.end]
    ), error.end


def replace_what_cannot_be_encoded(stream: Any) -> None:
    """Let a text stream write characters that its encoding lacks in ASCII.

    Examples
    --------
    >>> import io
    >>> stream = io.TextIOWrapper(io.BytesIO(), encoding="cp1252")
    >>> replace_what_cannot_be_encoded(stream)
    >>> _ = stream.write("0.5 ± 0.1 █"), stream.flush()
    >>> stream.buffer.getvalue().decode("cp1252")
    '0.5 ± 0.1 #'
    """
    codecs.register_error(_NAME, _ascii_form)
    with contextlib.suppress(AttributeError):  # a stream of another kind, as in notebooks
        stream.reconfigure(errors=_NAME)


def without_control(text: str) -> str:
    """The text with its control characters but line ends and tabs as numbers: they could steer a terminal.

    Examples
    --------
    >>> without_control("a" + chr(27) + "[2Jb")
    'a<1b>[2Jb'
    """
    return "".join(
        c if c in "\n\t" or unicodedata.category(c) not in ("Cc", "Cs") else f"<{ord(c):02x}>" for c in text
    )
