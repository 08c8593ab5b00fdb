"""Names of contours in a program, where it cannot hold them as they are, and the map from the one to the other.

    (NAME 1 Plita-7.outer IS =D0=9F=D0=BB=D0=B8=D1=82=D0=B0.outer)

A name is kept as it is where the check finds its contour by it: plain characters, short, and unlike every other name.
Any other is replaced by one that is; the map tells the name in UTF-8, bytes that are no letter, digit, `.` or `-` as
`=` and two hexadecimal digits. A name that has no room on one line goes on in the next comment with the same number.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping

from kerfwise.encoder.nest import Nest
from kerfwise.postproc.dialects import Dialect

from .blocks import comment, plain, room_for

_LONGEST_BESIDE = len("(BROKEN 123456  ZONE 123 CCW PIERCE -12345.123456 -12345.123456)")
_KEPT = 24
_ZONE = re.compile(r"\bZONE\b|\bLEAD\b|\bPIERCE\b", re.IGNORECASE)


def program_names(nest: Nest, dialect: Dialect) -> Mapping[str, str]:
    """Contour id → its name in the program: short, of plain characters, and its own."""
    ids = [contour.id for contour in nest.contours]
    seen = Counter(map(_folded, ids))
    most = max(dialect.max_line - _LONGEST_BESIDE, 12)
    names: dict[str, str] = {}
    for number, name in enumerate(ids, 1):
        if seen[_folded(name)] == 1 and len(name) <= most and not _ZONE.search(name) and _kept_as_it_is(name):
            names[name] = plain(name)
        else:
            base = re.sub(r"[^A-Za-z0-9.]+", "_", plain(name)).strip("_.")[: min(_KEPT, most - 8)]
            names[name] = _free(f"{base}-{number}" if base else f"contour-{number}", seen)
            seen[_folded(names[name])] += 1
    return names


def name_comments(names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """The map, for the names that are replaced."""
    replaced = [(name, told) for name, told in names.items() if told != plain(name)]
    for number, (name, told) in enumerate(replaced, 1):
        head = f"NAME {number} {told} IS"
        room = room_for(dialect, head)
        line = ""
        for char in _spelt(name):
            if line and len(line) + len(char) > room:
                yield comment(dialect, head, line)
                line = ""
            line += char
        yield comment(dialect, head, line)


def _kept_as_it_is(name: str) -> bool:
    told = plain(name)
    return told == told.strip() and _folded(told) == _folded(name) and bool(re.search(r"[A-Za-z0-9]", told))


def _free(name: str, seen: Mapping[str, int]) -> str:
    while seen.get(_folded(name), 0):
        name += "x"
    return name


def _spelt(name: str) -> Iterator[str]:
    for byte in name.encode("utf-8", "surrogatepass"):
        char = chr(byte)
        yield char if char.isascii() and (char.isalnum() or char in ".-") else f"={byte:02X}"


def _folded(name: str) -> str:
    """What the check keeps of a name."""
    return re.sub(r"[^A-Za-z0-9.]+", "_", name).upper()
