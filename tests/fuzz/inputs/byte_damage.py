"""Small damages to the bytes of a file, whatever it holds."""

from __future__ import annotations

import codecs
import gzip
import re
from collections.abc import Callable, Sequence
from random import Random

NUMBERS = (
    *tuple(
        b"0 -1 1 2 -0 0.5 1e10 -1e10 1e15 1e308 -1e308 1e-308 1e400 nan inf -inf NaN Infinity .nan .inf 0x10 1_000 "
        b"5. .5 +7 "
        b"1e5 007 1:30 --1 1/0 2147483648 4294967296 9223372036854775807 9223372036854775808 1,5 1e 1e1e1".split()
    ),
    b"9" * 40,
    b"9" * 5000,
    b"0." + b"0" * 400 + b"1",
    "٣".encode(),
    "½".encode(),
    b"",
)
ODD = (
    b"\0",
    b"\x01",
    b"\x07",
    b"\x1b[31m",
    b"\x1b]0;x\x07",
    b"\r",
    b"\x0b",
    b"\x0c",
    b"\x7f",
    b"\x85",
    b"\xff",
    b"\xfe\xff",
    b"\xc3",
    b"\xed\xa0\x80",
    "\u202e".encode(),
    "\u2028".encode(),
    "\u200b".encode(),
    "\ufeff".encode(),
    "é№漢".encode(),
    "\U0001f600".encode(),
    b"\t",
    b"'",
    b'"',
    b"\\",
    b"\\u0000",
    b"\\ud800",
    b"&#0;",
    b"&#x202e;",
    b"%s%n",
    b"{0}",
    b"{text}",
    b"()",
    b"<",
    b"]]>",
    b"-",
    b",",
    b"\n",
    b"\r\n",
    b" ",
)
Damage = Callable[[bytes, Random], bytes]
_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+")
_WORD = re.compile(rb"[A-Za-z_$][\w$-]*")


def damaged(data: bytes, rnd: Random, words: Sequence[bytes] = ()) -> bytes:
    """The bytes with one to three small damages; `words` are of the format.

    Examples
    --------
    >>> damaged(b"a: 1", Random(5)) == damaged(b"a: 1", Random(5))
    True
    """
    for _ in range(rnd.choice((1, 1, 1, 2, 3))):
        data = rnd.choice(_DAMAGES)(data, rnd) if not words or rnd.random() < 0.7 else _known(data, rnd, words)
    if rnd.random() < 0.04:
        data = rnd.choice(_WHOLE)(data, rnd)
    return data


def truncated_gzip(data: bytes, rnd: Random) -> bytes:
    """The bytes in a gzip file, mostly a damaged one."""
    packed = gzip.compress(data, mtime=0)
    return rnd.choice(
        (packed, packed[: rnd.randrange(len(packed) + 1)], _flip(packed, rnd), packed + b"x", packed + packed)
    )


def _place(data: bytes, rnd: Random) -> int:
    return rnd.randrange(len(data) + 1)


def _flip(data: bytes, rnd: Random) -> bytes:
    if not data:
        return b"\0"
    at = rnd.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << rnd.randrange(8))]) + data[at + 1 :]


def _cut(data: bytes, rnd: Random) -> bytes:
    return data[: _place(data, rnd)]


def _without(data: bytes, rnd: Random) -> bytes:
    at = _place(data, rnd)
    return data[:at] + data[at + rnd.choice((1, 1, 2, 5, 20, 200)) :]


def _odd(data: bytes, rnd: Random) -> bytes:
    at = _place(data, rnd)
    return data[:at] + rnd.choice(ODD) + data[at + rnd.choice((0, 0, 1)) :]


def _number(data: bytes, rnd: Random) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return _odd(data, rnd)
    place = rnd.choice(found)
    new = rnd.choice(NUMBERS)
    if rnd.random() < 0.35:
        with_sign = float(place.group())
        new = b"%g" % rnd.choice((-with_sign, with_sign * 1000, with_sign / 1000, with_sign + 1, with_sign + 1e-7))
    return data[: place.start()] + new + data[place.end() :]


def _gentle_number(data: bytes, rnd: Random) -> bytes:
    """A number a little larger or smaller, or that of another place."""
    found = list(_NUMBER.finditer(data))
    if not found:
        return _odd(data, rnd)
    place = rnd.choice(found)
    value = float(place.group()) * rnd.choice((0.5, 0.9, 0.999, 1.001, 1.1, 2))
    whole = place.group().lstrip(b"+-").isdigit()
    new = rnd.choice((b"%d" % value if whole and abs(value) < 1e15 else b"%g" % value, rnd.choice(found).group()))
    return data[: place.start()] + new + data[place.end() :]


def _swap(data: bytes, rnd: Random) -> bytes:
    """Two words change places."""
    found = list(_WORD.finditer(data))
    if len(found) < 2:
        return _without(data, rnd)
    a, b = sorted(rnd.sample(range(len(found)), 2))
    one, two = found[a], found[b]
    return data[: one.start()] + two.group() + data[one.end() : two.start()] + one.group() + data[two.end() :]


def _line(data: bytes, rnd: Random) -> bytes:
    lines = data.split(b"\n")
    at, other = rnd.randrange(len(lines)), rnd.randrange(len(lines))
    match rnd.randrange(6):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            lines[at : at + 2] = [b"".join(lines[at : at + 2])]
        case 4:
            lines[at:at] = [lines[at]] * rnd.choice((2, 20, 60))
        case _:
            lines[at] = rnd.choice((b"  ", b"\t", b"# ", b"- ", b"")) + lines[at].lstrip()
    return b"\n".join(lines)


def _repeat(data: bytes, rnd: Random) -> bytes:
    """A run of bytes many times over."""
    at = _place(data, rnd)
    piece = data[at : at + rnd.choice((1, 1, 2, 8, 60))]
    return data[:at] + piece * rnd.choice((2, 3, 50, 2000)) + data[at:]


def _moved(data: bytes, rnd: Random) -> bytes:
    """A run of bytes, once more, somewhere else."""
    at, there = _place(data, rnd), _place(data, rnd)
    piece = data[at : at + rnd.choice((3, 10, 40, 200))]
    return data[:there] + piece + data[there:]


def _deep(data: bytes, rnd: Random) -> bytes:
    opens, closes = rnd.choice(((b"[", b"]"), (b"{", b"}"), (b'{"a":', b"}"), (b"(", b")"), (b"<g>", b"</g>")))
    depth, at = rnd.choice((2, 30, 300, 5000, 100_000)), _place(data, rnd)
    return data[:at] + opens * depth + (b"1" + closes * depth if rnd.random() < 0.7 else b"") + data[at:]


def _known(data: bytes, rnd: Random, words: Sequence[bytes]) -> bytes:
    """A word of the format, put in or in place of another."""
    found = list(_WORD.finditer(data))
    if found and rnd.random() < 0.6:
        place = rnd.choice(found)
        return data[: place.start()] + rnd.choice(words) + data[place.end() :]
    at = _place(data, rnd)
    if rnd.random() < 0.5:
        at = data.find(b"\n", at) + 1
    return data[:at] + rnd.choice(words) + data[at:]


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


_DAMAGES: tuple[Damage, ...] = (
    _flip, _cut, _without, _odd, _odd, _number, _number, _number, _number, _gentle_number, _gentle_number, _swap, _line,
    _line, _line, _repeat, _moved, _moved, _deep,
)  # fmt: skip
_WHOLE: tuple[Damage, ...] = (
    lambda data, rnd: b"",
    lambda data, rnd: b"\n",
    lambda data, rnd: codecs.BOM_UTF8 + data,
    lambda data, rnd: _text(data).encode("utf-16"),
    lambda data, rnd: _text(data).encode("utf-16-be"),
    lambda data, rnd: _text(data).encode("utf-32"),
    lambda data, rnd: _text(data).encode("latin-1", "replace"),
    lambda data, rnd: _text(data).encode("cp037", "replace"),
    lambda data, rnd: data.replace(b"\n", rnd.choice((b"\r\n", b"\r", b"\n\n", b"\x0b", b"\n\r", b" "))),
    lambda data, rnd: data + data,
    lambda data, rnd: gzip.compress(data, mtime=0),
    lambda data, rnd: bytes(rnd.randrange(256) for _ in range(rnd.choice((1, 30, 300)))),
    lambda data, rnd: b"\0" * rnd.choice((1, 4096)),
    lambda data, rnd: data.upper(),
    lambda data, rnd: data[::-1],
)
