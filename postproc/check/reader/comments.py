"""Comments of a row apart from its words; those that a control obeys are refused."""

from __future__ import annotations

import re
from typing import NamedTuple

from kerfwise.encoder.errors import InputError

_OBEYED = re.compile(
    r"\s*(?P<word>abort,|debug,|print,|log,|logopen,|logappend,|logclose\s*$|py,|pyrun,|pyreload|probeopen|probeclose)",
    re.IGNORECASE,
)
"""What LinuxCNC's interpreter and its machine do not pass over; `msg,` only shows its text."""
_COMMENTED = re.compile(r"[();]")
_NO_BLANKS = str.maketrans("", "", " \t")
COMMENT = " "
"""Stands for a comment between words: no number goes on behind it."""


class Row(NamedTuple):
    """A row of a program: `code` are its characters outside comments, without blanks, in capitals; a comment between
    words is one `COMMENT`.

    `columns` are the places of these characters, from 1, `comment_at` that of the first comment, if any.
    """

    code: str
    columns: tuple[int, ...]
    comments: tuple[str, ...]
    comment_at: int | None = None

    @property
    def trailing(self) -> bool:
        """Whether a comment stands behind words."""
        return self.comment_at is not None and bool(self.columns) and self.columns[0] < self.comment_at


def row_of(text: str, line: int) -> Row:
    """Take the comments off a row.

    Raises
    ------
    InputError
        With line and column, for a comment that is not closed, is in another, or that the control obeys; for
        characters that are not ASCII outside comments.

    Examples
    --------
    >>> row_of("g1 x 10.5 (to the corner)", 1).code
    'G1X10.5'
    """
    if text.isascii() and not _COMMENTED.search(text):  # most rows
        solid = [k for k, char in enumerate(text, 1) if char not in " \t"]
        return Row(text.translate(_NO_BLANKS).upper(), tuple(solid), ())
    code: list[str] = []
    columns: list[int] = []
    comments: list[str] = []
    at, comment_at = 0, None
    while at < len(text):
        char, start = text[at], at
        at += 1
        if char in "(;":
            at = _end(text, start, line)
            body = text[start + 1 : at - 1] if char == "(" else text[start + 1 :]
            _harmless(body, line, start + 1)
            if char == "(" or body.strip():
                comments.append(body.strip())
            comment_at = comment_at or start + 1
            code.append(COMMENT)
            columns.append(start + 1)
        elif char == ")":
            raise InputError("a ')' that closes no comment: not supported here; delete it", line=line, column=at)
        elif char not in " \t":
            if not char.isascii():
                raise InputError(
                    f"'{char}' (U+{ord(char):04X}) outside a comment: not supported here; write it in ASCII",
                    line=line,
                    column=at,
                )
            code.append(char.upper())
            columns.append(at)
    kept = len("".join(code).rstrip(COMMENT))
    begin = kept - len("".join(code[:kept]).lstrip(COMMENT))
    return Row("".join(code[begin:kept]), tuple(columns[begin:kept]), tuple(comments), comment_at)


def _end(text: str, start: int, line: int) -> int:
    """Where the comment that begins at `start` has ended."""
    if text[start] == ";":
        return len(text)
    end, inner = text.find(")", start), text.find("(", start + 1)
    if 0 <= inner < end or (end < 0 and inner >= 0):
        raise InputError(
            "a comment inside a comment: not supported here; take the inner ( and ) out",
            line=line,
            column=inner + 1,
        )
    if end < 0:
        raise InputError(
            "the comment is not closed: not supported here; write ) at its end", line=line, column=start + 1
        )
    return end + 1


def _harmless(body: str, line: int, column: int) -> None:
    if found := _OBEYED.match(body):
        raise InputError(
            f"the comment '{body.strip()[:40]}' is a command to the control ({found['word'].strip(' ,').upper()}), not "
            "supported here; take it out, or begin the comment with another word",
            line=line,
            column=column,
        )
