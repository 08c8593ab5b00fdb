"""Letters as single strokes: what a drawing writes is engraved by the font Newstroke, whatever font it names.

Newstroke (`newstroke.txt`) is by Vladimir Uryvaev, who released it under CC0. It has all letters of the Latin, Greek
and Cyrillic alphabets, with their accents, digits, and the signs of drawings. It is made for thick pens, so that its
letters stand wide apart; here they stand nearer, so that a word is about as long as it is in Arial.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from kerfwise.arrays import Floats

NEWSTROKE = Path(__file__).with_name("newstroke.txt")
_CAPITAL, _BASE_Y, _ZERO = 21, 9, ord("R")
"""How tall capitals are, in steps of the font, the y of their feet, and the sign that stands for 0."""
_NEARER = 3
"""How many steps letters stand nearer to each other than the font has them."""

DESCENDER = 1 / 3
"""How far letters such as g reach below the base line, as a share of the height of capitals."""

SYMBOL_FONTS = (
    "gdt", "wingding", "webding", "symbol", "syastro", "symap", "symath", "symeteo", "symusic", "zapfdingbat",
)  # fmt: skip
"""How the names of fonts go that show something else for a letter: an `n` of them may be a diameter sign."""


@dataclass(frozen=True, slots=True)
class Letter:
    """One sign: how far the next one is, and its strokes, arrays (n, 2), y up; a capital is 1 tall."""

    advance: float
    strokes: tuple[Floats, ...]


@dataclass(frozen=True, slots=True)
class Lettering:
    """A line of writing from (0, 0) on along x: its width and its strokes; a capital is 1 tall.

    `lacks` are the letters that the font does not have; nothing stands for them.
    """

    width: float
    strokes: tuple[Floats, ...]
    lacks: str = ""


def lettering(text: str) -> Lettering:
    """The strokes of a line of writing.

    Examples
    --------
    >>> made = lettering("Tő")
    >>> len(made.strokes), round(made.width, 2), made.lacks
    (5, 1.38, '')
    >>> lettering("N 漢").lacks
    '漢'
    """
    x, strokes, lacks = 0.0, list[Floats](), ""
    for letter, sign in _letters(text):
        if letter is None:
            lacks += sign if sign not in lacks else ""
            continue
        strokes += [stroke + np.array([x, 0.0]) for stroke in letter.strokes]
        x += letter.advance
    return Lettering(x, tuple(strokes), lacks)


def width_of(text: str) -> float:
    """How wide a line of writing is, in heights of a capital."""
    return sum(letter.advance for letter, _ in _letters(text) if letter is not None)


def is_of_symbols(font: str) -> bool:
    """Whether a font, by its name, shows signs in the place of letters.

    Examples
    --------
    >>> is_of_symbols("AMGDT.ttf"), is_of_symbols("arial.ttf"), is_of_symbols("Segoe UI Symbol")
    (True, False, False)
    """
    name = font.lower()
    return any(word in name for word in SYMBOL_FONTS) and "segoe ui" not in name


def lacking(signs: str) -> str:
    """That the font does not have these letters.

    Examples
    --------
    >>> lacking("漢字")
    "the font has no letters '漢', '字'"
    """
    return f"the font has no letter{'s' if len(signs) > 1 else ''} {', '.join(repr(sign) for sign in signs)}"


@lru_cache(maxsize=4096)
def _letters(text: str) -> tuple[tuple[Letter | None, str], ...]:
    """Each sign with its letter; one that the font lacks as those that it is made of, such as № as No."""
    found: list[tuple[Letter | None, str]] = []
    for sign in unicodedata.normalize("NFC", text):
        if (letter := _letter(sign)) is not None:
            found.append((letter, sign))
            continue
        parts = unicodedata.normalize("NFKD", sign)
        letters = [_letter(part) for part in parts]
        if parts != sign and all(letters):
            found += zip(letters, parts, strict=True)
        elif not (unicodedata.category(sign) == "Cf" or unicodedata.category(sign).startswith("Z")):
            found.append((None, sign))
        elif unicodedata.category(sign).startswith("Z"):
            found.append((_letter(" "), " "))
    return tuple(found)


@lru_cache(maxsize=4096)
def _letter(sign: str) -> Letter | None:
    drawn = _font().get(sign)
    if drawn is None:
        return None
    left, right = (ord(edge) - _ZERO for edge in drawn[:2])
    corner = np.array([left + _NEARER / 2, _BASE_Y])
    runs = [np.array([ord(number) - _ZERO for number in run]).reshape(-1, 2) for run in drawn[2:].split(" R") if run]
    strokes = [(run - corner) * (1, -1) / _CAPITAL for run in runs]
    return Letter((right - left - _NEARER) / _CAPITAL, tuple(_in_one_go(strokes)))


@cache
def _font() -> dict[str, str]:
    rows = [row.partition(" ") for row in NEWSTROKE.read_text(encoding="ascii").splitlines() if not row.startswith("#")]
    return {chr(int(code, 16)): drawn for code, _, drawn in rows}


def _in_one_go(strokes: Sequence[Floats]) -> Iterable[Floats]:
    """Strokes of which one begins or ends where another does are drawn without lifting the pen."""
    left = [stroke for stroke in strokes if len(stroke) > 1]
    while left:
        whole = left.pop(0)
        while (found := _next(whole, left)) is not None:
            k, more, ahead = found
            del left[k]
            whole = np.concatenate([more[:-1], whole] if ahead else [whole, more[1:]])
        yield whole


def _next(whole: Floats, left: Sequence[Floats]) -> tuple[int, Floats, bool] | None:
    for k, stroke in enumerate(left):
        for way in (stroke, stroke[::-1]):
            if (way[0] == whole[-1]).all():
                return k, way, False
            if (way[-1] == whole[0]).all():
                return k, way, True
    return None
