"""Comments at the top of a program: names of contours, how the machine is to be set, how the drawing was understood."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.reading import DONE
from kerfwise.postproc.dialects import Dialect
from kerfwise.rules.profile.values import ProfileValues

from .gcode import comment, number, plain, room_for
from .toolpaths import SHA_DIGITS

# Names of contours in a program, where it cannot hold them as they are, and the map from the one to the other.
#
# (NAME 1 Plita-7.outer IS =D0=9F=D0=BB=D0=B8=D1=82=D0=B0.outer)
#
# A name is kept as it is where the check finds its contour by it: plain characters, short, and unlike every other
# name. Any other is replaced by one that is; the map tells the name in UTF-8, bytes that are no letter, digit, `.` or
# `-` as `=` and two hexadecimal digits. A name that has no room on one line goes on in the next comment with the same
# number.

_LONGEST_BESIDE = len("(BROKEN 123456  ZONE 123 CCW PIERCE -12345.123456 -12345.123456)")
_KEPT = 24
_ZONE = re.compile(r"\bZONE\b|\bLEAD\b|\bPIERCE\b", re.IGNORECASE)


def program_names(nest: Nest, dialect: Dialect) -> Mapping[str, str]:
    """Contour id → its name in the program: short, of plain characters, and its own."""
    ids = [contour.id for contour in nest.contours]
    seen = Counter(map(_folded, ids))
    most = max(dialect.max_line - _LONGEST_BESIDE, 12)
    names: dict[str, str] = {}
    for count, name in enumerate(ids, 1):
        if seen[_folded(name)] == 1 and len(name) <= most and not _ZONE.search(name) and _needs_no_change(name):
            names[name] = plain(name)
        else:
            base = re.sub(r"[^A-Za-z0-9.]+", "_", plain(name)).strip("_.")[: min(_KEPT, most - 8)]
            names[name] = _free(f"{base}-{count}" if base else f"contour-{count}", seen)
            seen[_folded(names[name])] += 1
    return names


def name_comments(names: Mapping[str, str], dialect: Dialect) -> Iterator[str]:
    """The map, for the names that are replaced."""
    replaced = [(name, spelling) for name, spelling in names.items() if spelling != plain(name)]
    for count, (name, spelling) in enumerate(replaced, 1):
        head = f"NAME {count} {spelling} IS"
        room = room_for(dialect, head)
        line = ""
        for char in _spelt_name(name):
            if line and len(line) + len(char) > room:
                yield comment(dialect, head, line)
                line = ""
            line += char
        yield comment(dialect, head, line)


def _needs_no_change(name: str) -> bool:
    spelling = plain(name)
    return (
        spelling == spelling.strip()
        and _folded(spelling) == _folded(name)
        and bool(re.search(r"[A-Za-z0-9]", spelling))
    )


def _free(name: str, seen: Mapping[str, int]) -> str:
    while seen.get(_folded(name), 0):
        name += "x"
    return name


def _spelt_name(name: str) -> Iterator[str]:
    for byte in name.encode("utf-8", "surrogatepass"):
        char = chr(byte)
        yield char if char.isascii() and (char.isalnum() or char in ".-") else f"={byte:02X}"


def _folded(name: str) -> str:
    """What the check keeps of a name."""
    return re.sub(r"[^A-Za-z0-9.]+", "_", name).upper()


# What a program says of how the machine is to be set, and of the chart that says so; an operator reads it.
#
# (CHART shop.csv ROW S235, 8 MM SHA256 1a2b3c4d5e6f) (INTERPOLATED KERF 1.7 MM BETWEEN 6 MM AND 10 MM) (NOT OF THE
# CHART KERF 1.8 MM) (SET 85 A, GAS O2/AIR, PIERCE HEIGHT 3.8 MM, CUT HEIGHT 1.5 MM)


def setting_comments(profile: ProfileValues, dialect: Dialect) -> Iterator[str]:
    """The comments; none where the profile has no chart and says nothing of the machine's setting."""
    use = profile.chart
    if use is not None:
        yield comment(dialect, "CHART", f"{use.name} ROW {use.row}", f"SHA256 {use.sha256[:SHA_DIGITS]}")
        for one in use.interpolated:
            between = f"BETWEEN {' AND '.join(one.between).upper()}"
            yield comment(dialect, f"INTERPOLATED {_spoken(one.column)}", one.text.upper(), between)
        for column, _, own in use.beaten:
            yield comment(dialect, f"NOT OF THE CHART {_spoken(column)}", own.upper())
    line = ""
    for text in _settings(profile):
        if line and len(line) + 2 + len(text) > room_for(dialect, "SET"):
            yield comment(dialect, "SET", line)
            line = ""
        line = f"{line}, {text}" if line else text
    if line:
        yield comment(dialect, "SET", line)


def _settings(profile: ProfileValues) -> Iterator[str]:
    material = profile.material
    quantities = (
        ("{} A", material.amps),
        ("{} V", material.volts),
        ("POWER {} PERCENT", material.power),
        ("PIERCE POWER {} PERCENT", material.pierce_power),
        ("MARK POWER {} PERCENT", material.mark_power),
        ("PIERCE HEIGHT {} MM", material.pierce_height_mm),
        ("CUT HEIGHT {} MM", material.cut_height_mm),
    )
    yield from (text.format(number(value, 3)) for text, value in quantities if value is not None)
    if material.gas is not None:
        yield f"GAS {material.gas.upper()}"


def _spoken(column: str) -> str:
    return column.replace("_", " ").upper()


# How the drawing was understood, at the top of a program: units, sheet, and what each layer was taken for.

MOST = 8
"""Layers that a program names; `kerfwise read` names all."""


def reading_comments(nest: Nest, dialect: Dialect) -> Iterator[str]:
    """A comment on units and sheet of a drawing, and one for each layer; none for a nest that says what it is."""
    reading = nest.reading
    if reading is None or not reading.taken:
        return
    assumed = ", ASSUMED" if reading.assumed else ""
    yield comment(
        dialect,
        f"DRAWING READ IN {reading.units.upper()}, SHEET {plain(reading.sheet.replace('×', 'x')).upper()}{assumed}",
    )
    count: Counter[tuple[str, str]] = Counter()
    for row in reading.taken:
        what = "" if row.what == "line" else f"{row.what}s "
        count[row.layer, what + DONE[row.purpose]] += row.count
    rows = sorted(count.items())
    for (layer, done), lines in rows[:MOST]:
        yield comment(dialect, "LAYER", layer, f"{plain(done).upper()} {lines}")
    if len(rows) > MOST:
        yield comment(dialect, f"AND {len(rows) - MOST} MORE LAYERS")
    for question, choice in sorted(reading.answers.items()):
        yield comment(dialect, "ANSWERED", question, plain(choice).upper())
