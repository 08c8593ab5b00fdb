"""Blocks of a program as text: numbers, comments, and N words."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Iterator

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import Dialect


def number(value: float, decimals: int) -> str:
    """A number as a control reads it.

    Examples
    --------
    >>> number(-0.00001, 4), number(12.5, 4), number(100, 4)
    ('0', '12.5', '100')
    """
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def plain(text: str) -> str:
    """`text` without anything a control could take for more than a comment: ASCII letters, digits and ` ._+:,/=-`.

    Examples
    --------
    >>> plain("Плита (20 мм) №3; Ø12 é")
    '_____ _20 ___ No3_ _12 e'
    """
    ascii_text = unicodedata.normalize("NFKD", text)
    ascii_text = "".join(c for c in ascii_text if not unicodedata.combining(c))
    return re.sub(r"[^A-Za-z0-9 ._+:,/=-]", "_", ascii_text)


def comment(dialect: Dialect, head: str, text: str = "", tail: str = "") -> str:
    """A comment block; where it is too long for the control, `text` is cut short. "" where there are no comments."""
    if dialect.comment is None:
        return ""
    words = (head, plain(text)[: max(room_for(dialect, head, tail), 0)], tail)
    return dialect.comment.format(text=" ".join(w for w in words if w))


def room_for(dialect: Dialect, head: str, tail: str = "") -> int:
    """How many characters fit into a comment between two texts."""
    return dialect.max_line - len((dialect.comment or "{text}").format(text=f"{head}  {tail}"))


def is_comment(block: str, dialect: Dialect) -> bool:
    """Whether only a person reads the block."""
    return not block or (dialect.comment is not None and block.startswith(dialect.comment.partition("{text}")[0]))


def numbered(blocks: Iterable[str], dialect: Dialect) -> Iterator[str]:
    """The blocks with their N words, empty ones left out; comments have none.

    Raises
    ------
    InputError
        For a block longer than the control takes.
    """
    rule = dialect.line_numbers
    count = 0
    for block in filter(None, blocks):
        line = block
        if rule is not None and not is_comment(block, dialect) and block != "%":
            line = f"N{rule.start + rule.step * count} {block}"
            count += 1
        if len(line.encode()) > dialect.max_line:
            raise InputError(f"dialect '{dialect.name}': block longer than max_line {dialect.max_line}: {line}")
        yield line


def seconds_text(seconds: float) -> str:
    """A time for a person to read.

    Examples
    --------
    >>> seconds_text(4383.2)
    '1 H 13 MIN 04 S'
    """
    minutes, rest = divmod(math.ceil(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} H {minutes:02d} MIN {rest:02d} S"
