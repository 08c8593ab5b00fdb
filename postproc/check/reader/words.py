"""Blocks of an RS274 program as words: letters with numbers, comments apart."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError

_WORD = re.compile(r"([A-Z$])([-+]?(?:\d+\.?\d*|\.\d+))")
_LETTERS = frozenset("NGMXYZIJRFSPLQEDHT$")


@dataclass(frozen=True, slots=True)
class Block:
    """One line: its G and M words, its other words by letter, and its comments; `line` counts from 1."""

    line: int
    g: tuple[float, ...]
    m: tuple[float, ...]
    words: Mapping[str, float]
    comments: tuple[str, ...] = ()


def read_blocks(text: str) -> Iterator[Block]:
    """The blocks of a program up to the closing %, if it has one; empty lines are left out.

    Raises
    ------
    InputError
        With the line, for anything that is not a comment or a word this check understands: it refuses rather than
        guesses, because what it skips it would not have checked.

    Examples
    --------
    >>> [block.words for block in read_blocks("N10 g1 x 10.5 Y-.5 (to the corner)")]
    [{'N': 10.0, 'X': 10.5, 'Y': -0.5}]
    """
    percent = 0
    for line, raw in enumerate(text.splitlines(), 1):
        code, comments = _without_comments(raw, line)
        code = re.sub(r"\s+", "", code).upper()
        if code == "%":
            percent += 1
            if percent == 2:  # ends a program as M2 does
                yield Block(line, (), (2.0,), {})
                return
        elif code or comments:
            yield _block(line, code, comments)


def _without_comments(raw: str, line: int) -> tuple[str, tuple[str, ...]]:
    if "(" not in raw and ")" not in raw:
        code, _, rest = raw.partition(";")
        return code, (rest.strip(),) if rest.strip() else ()
    comments: list[str] = []
    code = ""
    rest = raw
    while rest:
        here = re.search(r"[();]", rest)
        if here is None:
            return code + rest, tuple(comments)
        code += rest[: here.start()]
        if here[0] == ";":
            comments.append(rest[here.end() :].strip())
            break
        body, closing, after = rest[here.end() :].partition(")")
        if here[0] == ")" or not closing:
            raise InputError("a comment is not closed, or closed without being opened", line=line)
        if "(" in body:
            raise InputError("a comment inside a comment; controls refuse it", line=line)
        comments.append(body.strip())
        rest = after
    return code, tuple(comments)


def _block(line: int, code: str, comments: tuple[str, ...]) -> Block:
    if code.startswith("/"):
        raise InputError(
            "an optional block (/): whether it runs is set on the machine, so it cannot be checked", line=line
        )
    if code.startswith("O"):
        raise InputError("an O word: subroutines and loops are not checked; post the program without", line=line)
    g: list[float] = []
    m: list[float] = []
    words: dict[str, float] = {}
    at = 0
    for found in _WORD.finditer(code):
        if found.start() != at or found[1] not in _LETTERS:
            break
        at = found.end()
        letter, value = found[1], float(found[2])
        if letter == "G":
            g.append(value)
        elif letter == "M":
            m.append(value)
        elif letter in words:
            raise InputError(f"two {letter} words in one block", line=line)
        else:
            words[letter] = value
    if at != len(code):
        raise InputError(f"cannot read '{code[at : at + 30]}': expected a word such as X12.5", line=line)
    return Block(line, tuple(g), tuple(m), words, comments)
