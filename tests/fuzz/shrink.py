"""The fewest pieces of something that still show what the whole shows (delta debugging)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

Piece = TypeVar("Piece")


def fewest(pieces: Sequence[Piece], shows: Callable[[list[Piece]], bool], least: int = 0) -> list[Piece]:
    """Halves, quarters … and single pieces left out as long as what is left shows; `least` are left in any case.

    Examples
    --------
    >>> fewest("abcdefgh", lambda left: "c" in left and "f" in left)
    ['c', 'f']
    """
    left, size = list(pieces), 2
    while len(left) > least:
        step = max(1, len(left) // size)
        for at in range(0, len(left), step):
            fewer = left[:at] + left[at + step :]
            if shows(fewer):
                left, size = fewer, max(size - 1, 2)
                break
        else:
            if step == 1:
                break
            size *= 2
    return left


def smallest(program: bytes, shows: Callable[[bytes], bool]) -> bytes:
    """The program with as many lines taken out as possible.

    Examples
    --------
    >>> smallest(b"a\\nb\\nc\\nd", lambda text: b"c" in text)
    b'c'
    """
    return b"\n".join(fewest(program.split(b"\n"), lambda lines: shows(b"\n".join(lines)), least=1))
