"""Small damages to a program, by seed: to its bytes, words, numbers, lines, comments and line ends."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from kerfwise.tests.fuzz.vocabulary import BYTES, COMMENTS, ENDS, LINES, WORDS

_WORD = re.compile(rb"[A-Za-z$][ \t]*[-+]?[0-9]*\.?[0-9]+")
_NUMBER = re.compile(rb"[-+]?[0-9]*\.?[0-9]+")
Random = random.Random
Damage = Callable[[bytes, Random], bytes]


def mutated(program: bytes, rnd: Random) -> bytes:
    """The program with one to four damages."""
    for _ in range(rnd.choice((1, 1, 1, 1, 1, 2, 2, 3, 4))):
        program = rnd.choice(_DAMAGES)(program, rnd)
    return program


def _byte(program: bytes, rnd: Random) -> bytes:
    at, new = rnd.randrange(len(program) + 1), bytes([rnd.choice(BYTES)])
    return rnd.choice(
        (program[:at] + new + program[at:], program[:at] + new + program[at + 1 :], program[:at] + program[at + 1 :])
    )


def _word(program: bytes, rnd: Random) -> bytes:
    found = rnd.choice(list(_WORD.finditer(program)) or [re.match(b"", program)])
    assert found is not None
    word, old = rnd.choice(WORDS), found[0]
    new = rnd.choice(
        (word, word, old + b" " + word, word + old, b"", old + old, old.lower(), b" ".join(bytes([c]) for c in old))
    )
    return program[: found.start()] + new + program[found.end() :]


def _number(program: bytes, rnd: Random) -> bytes:
    found = rnd.choice(list(_NUMBER.finditer(program)) or [re.match(b"", program)])
    assert found is not None
    old = found[0]
    value = float(old or b"1")
    new = rnd.choice(
        (
            b"+" + old,
            b"-" + old,
            b"00" + old,
            old + b".",
            old + b".0",
            old.lstrip(b"0"),
            b"[%b]" % old,
            b"[%b+1]" % old,
            b"#1",
            b"#<x>",
            b"%be0" % old,
            b"%be1" % old,
            b"%b,5" % old,
            b"--" + old,
            b"+-" + old,
            b"%b %b" % (old[:1], old[1:]),
            b"1" + old,
            b"%.17g" % value,
            b"%.1f" % value,
            b"%.9f" % (value + 1e-7),
            b"%.4f" % (value + 1e-4),
            b"%.3f" % (value + 0.003),
            b"%.2f" % (value + 0.02),
            b"%g" % (value + 1),
            b"%g" % -value,
            b"0",
            b"",
            b"9" * 40,
            b"0." + b"0" * 40 + b"1",
            old + b"0" * 250,
            b".",
            b"abs[%b]" % old,
            "\u0661".encode(),
            b"%g" % (value * 25.4),
        )
    )
    return program[: found.start()] + new + program[found.end() :]


def _line(program: bytes, rnd: Random) -> bytes:
    lines = program.split(b"\n")
    at, other = rnd.randrange(len(lines)), rnd.randrange(len(lines))
    what = rnd.randrange(7)
    if what == 0:
        del lines[at]
    elif what == 1:
        lines.insert(other, lines[at])
    elif what == 2:
        lines[at], lines[other] = lines[other], lines[at]
    elif what == 3 and at + 1 < len(lines):
        lines[at : at + 2] = [lines[at] + rnd.choice((b"", b" ")) + lines[at + 1]]
    elif what == 4:
        cut = rnd.randrange(len(lines[at]) + 1)
        lines[at : at + 1] = [lines[at][:cut], lines[at][cut:]]
    else:
        lines.insert(at, rnd.choice(LINES))
    return b"\n".join(lines)


def _comment(program: bytes, rnd: Random) -> bytes:
    lines, new = program.split(b"\n"), rnd.choice(COMMENTS)
    at = rnd.randrange(len(lines))
    cut = rnd.choice((0, len(lines[at]), len(lines[at]), rnd.randrange(len(lines[at]) + 1)))
    lines[at : at + 1] = rnd.choice(([lines[at][:cut] + new + lines[at][cut:]], [lines[at], new]))
    return b"\n".join(lines)


def _end(program: bytes, rnd: Random) -> bytes:
    if rnd.random() < 0.2:
        return program.replace(b"\n", rnd.choice(ENDS[:4]))
    places = [k for k, byte in enumerate(program) if byte == 10]
    at = rnd.choice(places or [len(program)])
    return program[:at] + rnd.choice(ENDS) + program[at + 1 :]


def _head(program: bytes, rnd: Random) -> bytes:
    lines = program.split(b"\n")
    at = rnd.randrange(len(lines))
    lines[at] = (
        rnd.choice((b"/", b"N10 ", b"n", b"N", b" ", b"\t", b"%", b"\xef\xbb\xbf", b"N10.5", b"N 5 ", b"o", b"N007"))
        + lines[at]
    )
    return b"\n".join(lines)


_DAMAGES: tuple[Damage, ...] = (_byte, _word, _word, _number, _number, _line, _line, _comment, _end, _head)
