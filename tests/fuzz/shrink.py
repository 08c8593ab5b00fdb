"""The smallest lines of a program that still show what the whole one shows (delta debugging)."""

from __future__ import annotations

from collections.abc import Callable


def smallest(program: bytes, shows: Callable[[bytes], bool]) -> bytes:
    """The program with as many lines taken out as possible.

    Examples
    --------
    >>> smallest(b"a\\nb\\nc\\nd", lambda text: b"c" in text)
    b'c'
    """
    lines, size = program.split(b"\n"), 2
    while len(lines) > 1:
        step = max(1, len(lines) // size)
        for at in range(0, len(lines), step):
            fewer = lines[:at] + lines[at + step :]
            if shows(b"\n".join(fewer)):
                lines, size = fewer, max(size - 1, 2)
                break
        else:
            if step == 1:
                break
            size *= 2
    return b"\n".join(lines)
