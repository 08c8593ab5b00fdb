"""The rows of a program as its control splits them: at LF and CRLF, and nowhere else."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager

from kerfwise.encoder.errors import InputError

LONGEST = 252
"""Bytes of a row without its LF: LinuxCNC stops at a longer one, in the middle of a sheet (`LINELEN` in its source)."""
_NEVER_SHOWN = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories of controls, of marks that turn or join text, of halves of characters, and of separators."""


@contextmanager
def in_file(file: str) -> Iterator[None]:
    """What is refused meanwhile is refused with the file's name, where it has one."""
    try:
        yield
    except InputError as error:
        raise InputError(error.message, file=file or None, line=error.line, column=error.column) from None


def rows_of(text: str, longest: int = LONGEST, obeyed: str = "") -> Iterator[tuple[int, str]]:
    """The rows, numbered from 1, without their line ends; none is over `longest` bytes.

    `obeyed` are characters that the control takes for commands wherever they stand.

    Raises
    ------
    InputError
        With line and column, for a row that is too long, and for characters that programs treat differently.

    Examples
    --------
    >>> list(rows_of("G21\\r\\nM2\\n"))
    [(1, 'G21'), (2, 'M2')]
    """
    rows = text.split("\n")
    if text.isascii() and "".join(rows).isprintable() and len(max(rows, key=len)) <= longest and not obeyed:
        yield from enumerate(rows if rows[-1] else rows[:-1], 1)  # most programs
        return
    for line, row in enumerate(rows, 1):
        if line == len(rows):  # what follows the last LF
            if row:
                yield line, _plain(row, line, 0, longest, obeyed)
        else:
            bare = row.removesuffix("\r")
            yield line, _plain(bare, line, len(row) - len(bare), longest, obeyed)


def _plain(row: str, line: int, cr: int, longest: int, obeyed: str) -> str:
    for column, char in enumerate(row, 1) if obeyed else ():
        if char in obeyed or not char.isascii():
            raise InputError(
                f"'{char}' (U+{ord(char):04X}), which the control takes for a command wherever it stands, comments "
                "included: not supported here; delete it",
                line=line,
                column=column,
            )
    if row.isascii() and row.isprintable() and len(row) + cr <= longest:
        return row
    for column, char in enumerate(row, 1):
        if char != "\t" and unicodedata.category(char) in _NEVER_SHOWN:
            raise InputError(_found(char), line=line, column=column)
    if (size := len(row.encode()) + cr) > longest:
        raise InputError(
            f"the line has {size} bytes: more than {longest} are not supported here, nor by controls; write it shorter",
            line=line,
            column=longest + 1,
        )
    return row


def _found(char: str) -> str:
    if char == "\r":
        return (
            "a carriage return (CR) in the middle of a line: some programs end the line there, the control does not; "
            "not supported here; save the program with line ends LF or CRLF"
        )
    if char == "\ufeff":
        return "a byte order mark (U+FEFF), not supported here; save the program as UTF-8 without it"
    return (
        f"the character U+{ord(char):04X}, which is not shown and which programs treat differently; not supported "
        "here; delete it"
    )
