"""Valid programs, each changed as a hand or a faulty line may change it: one mutation a mutant."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

Lines = list[str]
_WORD = re.compile(r"([A-Z])([+-]?\d+(?:\.\d+)?)")
_MOVE = re.compile(r"\bG0?[0123]\b|\bX|\bY|^[+-]\d")
_COMMENT = re.compile(r"^\(.*\)$")
FURTHER = {
    "grbl": ["M8", "M3 S500", "S0", "G4 P1", "M5"],
    "eia": ["M50", "M51", "M36 T3", "M36 T1", "M37 T2", "M07", "M08", "G04 X1"],
    "burny": ["M14", "M15", "M04", "M03", "G04 F1"],
    "essi": ["7", "8", "53", "54", "45", "46", "41+1000", "5", "6"],
    "linuxcnc": ["M3 S1", "M5", "M64 P0", "M65 P0", "M8", "G4 P1", "M50 P0", "M53 P1"],
    "linuxcnc-qtplasmac": ["M3 $0 S1", "M5 $0", "M67 E3 Q50", "M52 P1", "G4 P1", "M3 $1 S1"],
}
"""Words of each control that a program does not say where they are put."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A program that was changed: what was done to which line, and its text."""

    kind: str
    line: int
    text: str


def _numbers(letters: str, change: Callable[[float], float]) -> Callable[[str], str | None]:
    """Changes the first number behind one of these letters."""

    def changed(row: str) -> str | None:
        for found in _WORD.finditer(row):
            if found[1] in letters and not row.startswith("("):
                value = change(float(found[2]))
                return f"{row[: found.start(2)]}{value:.4f}".rstrip("0").rstrip(".") + row[found.end(2) :]
        return None

    return changed


def _essi(change: Callable[[int], int], code: str = "") -> Callable[[str], str | None]:
    """Changes the first signed number of a move, or the value behind a code."""

    def changed(row: str) -> str | None:
        found = re.fullmatch(rf"({code}\+)(\d+)()" if code else r"([+-])(\d+)([+-].*)", row)
        return None if found is None else f"{found[1]}{change(int(found[2]))}{found[3]}"

    return changed


def _turned(row: str) -> str | None:
    for one, other in (("G2 ", "G3 "), ("G3 ", "G2 "), ("G02 ", "G03 "), ("G03 ", "G02 ")):
        if one in row:
            return row.replace(one, other, 1)
    return None


def _lit(row: str) -> str | None:
    return row.replace("G0 ", "G1 ", 1) if "G0 " in row else row.replace("G00 ", "G01 ", 1) if "G00 " in row else None


def _rapid(row: str) -> str | None:
    return row.replace("G1 ", "G0 ", 1) if "G1 " in row else row.replace("G01 ", "G00 ", 1) if "G01 " in row else None


IN_LINE: dict[str, Callable[[str], str | None]] = {
    "moved by 0.3 mm": _numbers("XY", lambda v: v + 0.3),
    "moved by 5 mm": _numbers("XY", lambda v: v + 5),
    "sign of a length": _numbers("XYIJR", lambda v: -v),
    "half the feed": _numbers("F", lambda v: v / 2),
    "twice the feed": _numbers("F", lambda v: v * 2),
    "half the power": _numbers("S", lambda v: v / 2),
    "another wait": _numbers("P", lambda v: v + 0.3),
    "arc the other way": _turned,
    "travel lit": _lit,
    "cut as travel": _rapid,
    "step moved": _essi(lambda v: v + 5),
    "half the feed, ESSI": _essi(lambda v: v // 2, "39"),
}


def _span(lines: Lines, at: int, by_torch: tuple[str, str]) -> tuple[int, int] | None:
    """First and last line of the burn around a line: between the torch's words."""
    on, off = by_torch
    begin = next((k for k in range(at, -1, -1) if on in lines[k].split(" ", 1)[-1] or lines[k] == on), None)
    end = next((k for k in range(at, len(lines)) if off in lines[k].split(" ", 1)[-1] or lines[k] == off), None)
    return None if begin is None or end is None or end <= begin else (begin, end)


TORCH = {
    "grbl": ("M4 S", "M5"),
    "eia": ("M07", "M08"),
    "burny": ("M04", "M03"),
    "essi": ("53", "54"),
    "linuxcnc": ("M3 S1", "M5"),
    "linuxcnc-qtplasmac": ("M3 $0", "M5 $0"),
}


def _rows(lines: Lines, dialect: str, at: int, rnd: random.Random) -> Iterator[tuple[str, Lines]]:
    """Mutations of whole lines."""
    yield "line dropped", lines[:at] + lines[at + 1 :]
    yield "line doubled", lines[: at + 1] + lines[at:]
    if at + 1 < len(lines):
        yield "lines swapped", [*lines[:at], lines[at + 1], lines[at], *lines[at + 2 :]]
    yield "word put in", [*lines[:at], rnd.choice(FURTHER[dialect]), *lines[at:]]
    span = _span(lines, at, TORCH[dialect])
    if span is not None:
        begin, end = span
        yield "torch never off", lines[:end] + lines[end + 1 :]
        yield "torch never on", lines[:begin] + lines[begin + 1 :]
        moves = [k for k in range(begin, end) if _MOVE.search(lines[k])]
        if len(moves) > 2:
            yield "overcut dropped", lines[: moves[-1]] + lines[moves[-1] + 1 :]
            half = moves[1 : 1 + len(moves) // 2]
            yield "half a round more", lines[:end] + [lines[k] for k in half] + lines[end:]
            yield "a round more", lines[:end] + [lines[k] for k in moves[1:]] + lines[end:]
            yield "round stops early", lines[: moves[-2]] + lines[end:]
        yield "burn twice", lines[: end + 1] + lines[max(begin - 1, 0) :]


def mutants(text: str, dialect: str, count: int, seed: int = 1) -> Iterator[Mutant]:
    """Mutants of a program, drawn evenly over kinds and lines."""
    rnd = random.Random(f"{dialect} {seed}")
    lines = text.rstrip("\n").split("\n")
    body = [k for k, row in enumerate(lines) if not _COMMENT.match(row)]
    made = 0
    while made < count:
        at = rnd.choice(body)
        found = [
            (kind, [*lines[:at], new, *lines[at + 1 :]])
            for kind, of in IN_LINE.items()
            if (new := of(lines[at])) is not None
        ]
        found += list(_rows(lines, dialect, at, rnd))
        kind, changed = rnd.choice(found)
        if changed != lines:
            made += 1
            yield Mutant(kind, at + 1, "\n".join(changed) + "\n")
