"""What a drawing writes, and its points: letters as single strokes by the font Newstroke, on layers for marks."""

from __future__ import annotations

import unicodedata
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import cast

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.contour_checks import metal_of
from kerfwise.encoder.nest import Contour, Note, Part
from kerfwise.encoder.questions import Asking, Choice, Question

from .by_layer import WORDS, ByLayer, Use, look_of, use_of
from .drawing import DrawnCurve, DrawnText
from .layers import Purpose
from .options import ReadOptions
from .reading import Taken, Writing

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


FIRST = 3
"""So many texts and places are shown in a message."""


@dataclass(frozen=True, eq=False)
class Engraved:
    """The texts and points that are engraved, those that are not, and why; `notes` say so."""

    marked: tuple[DrawnText, ...]
    left_out: tuple[DrawnText, ...]
    taken: tuple[Taken, ...]
    notes: tuple[Note, ...]


def engraved(texts: Sequence[DrawnText], layers: ByLayer, options: ReadOptions, asking: Asking) -> Engraved:
    """What becomes of texts and points, by the use of their layers; an answer for those of a layer goes before it.

    Raises InputError for an answer that is none of the choices.
    """
    marked: list[DrawnText] = []
    failed: list[tuple[DrawnText, str]] = []
    left: dict[str, list[DrawnText]] = {"text": [], "point": []}
    rows: Counter[tuple[str, str, str]] = Counter()
    silent: list[DrawnText] = []
    for text in texts:
        use = _use(text, layers, options, asking)
        if use.purpose == "mark" and (why := _why_not(text)):
            failed.append((text, why))
        elif use.purpose == "mark":
            marked.append(text)
            rows[text.look.layer, use.because, "text" if text.text else "point"] += 1
        elif use.purpose == "ignore":
            silent.append(text)
        else:
            left[_what(text)].append(text)
    notes = [note for those in left.values() if those for note in _not_marked(those)]
    notes += [Note("warning", f"left out, as {why}: the {text.place}") for text, why in failed[:MOST_NOTES]]
    if len(failed) > MOST_NOTES:
        notes.append(Note("warning", f"left out, as those before: {len(failed) - MOST_NOTES} more texts"))
    taken = [Taken(layer, "mark", because, n, what=what) for (layer, because, what), n in sorted(rows.items())]
    gone = (*(text for text, _ in failed), *silent, *(text for those in left.values() for text in those))
    return Engraved(tuple(marked), gone, tuple(taken), tuple(notes))


def _why_not(text: DrawnText) -> str:
    """Why a text cannot be engraved, and what to do; "" where it can."""
    if text.text and not text.trouble and text.height_mm < SMALLEST_MM:
        return f"its capitals are {text.height_mm:.3g} mm tall, less than {SMALLEST_MM:g} mm"
    why = text.trouble or ("" if text.strokes else "it has no strokes")
    return f"{why} (turn it into lines in CAD)" if why else ""


SMALLEST_MM = 0.5
"""Nobody reads smaller letters, and no torch writes them."""
MOST_NOTES = 20


def question_of(text: DrawnText) -> str:
    """The id of the answer for the texts, or the points, of a layer: nobody is asked, for without one all is said."""
    return f"{_what(text)}:{text.look.layer}"


def _what(text: DrawnText) -> str:
    return "text" if text.text else "point"


def _use(text: DrawnText, layers: ByLayer, options: ReadOptions, asking: Asking) -> Use:
    """By the answer for its layer, or for all texts or points, else by what its layer is for."""
    name = next((one for one in (question_of(text), _what(text)) if asking.answered(one) is not None), None)
    if name is not None:
        choices = tuple(Choice(purpose, WORDS[purpose]) for purpose in ("mark", "ignore"))
        answer = asking.ask(Question(name, f"what are the {_what(text)}s of layer '{text.look.layer}'", choices))
        return Use(cast(Purpose, answer), asking.because(name), True)
    look = look_of(text.look)
    return layers.uses[look] if look in layers.uses else use_of(look, text.look, options, asking)


def _not_marked(texts: Sequence[DrawnText]) -> list[Note]:
    """How many texts, or points, are left out on which layers, what the first ones say, and what engraves them."""
    layers = sorted({text.look.layer for text in texts})
    if len(layers) > MOST_LAYERS:
        names = f"{', '.join(repr(layer) for layer in layers[:FIRST])}, …"
        return [_note(texts, f"the {len(layers)} layers {names} are", _what(texts[0]))]
    return [
        _note(those, f"layer '{layer}' is" if layer else "what stands in no group is", question_of(those[0]))
        for layer in layers
        for those in [[text for text in texts if text.look.layer == layer]]
    ]


MOST_LAYERS = 3
"""Texts on more layers than this are told together."""


def _note(texts: Sequence[DrawnText], where: str, question: str) -> Note:
    what, one = _what(texts[0]), len(texts) == 1
    shown = [_short(text.text) for text in texts if text.text][:FIRST]
    quoted = f" ({', '.join(shown)}{', …' if len(texts) > len(shown) else ''})" if shown else ""
    flag = Question(question, "", ()).flag(Choice("mark", ""))
    which = f"1 {what}" if one else f"{len(texts)} {what}s"
    done = "engraves" if what == "text" else "marks"
    return Note(
        "warning", f"left out, as {where} not for marks: {which}{quoted}; {flag} {done} {'it' if one else 'them'}"
    )


def _short(text: str) -> str:
    line = " ".join(text.split())
    return f"'{line}'" if len(line) <= 24 else f"'{line[:23]}…'"


# Which part a mark belongs to.


def with_marks(
    parts: Sequence[Part], marks: Sequence[DrawnCurve], texts: Sequence[DrawnText] = ()
) -> tuple[tuple[Part, ...], list[Note], tuple[Writing, ...]]:
    """The parts with these marks, those of writing last; notes on marks that are on no part, and what is written where.

    A mark belongs to the part that has most of it. Of a text that lies on no part, or only partly on one, what is off
    is left out.
    """
    strokes = [stroke for text in texts for stroke in text.strokes]
    if not marks and not strokes:
        return tuple(parts), [], ()
    owner = _owners(parts, [*marks, *strokes])
    new_marks: list[list[Contour]] = [[] for _ in parts]

    def add(n: int, mark: DrawnCurve, text: str = "") -> str:
        part, own = parts[owner[n]].id, new_marks[owner[n]]
        source = replace(mark.source, text=" ".join(text.split()))
        own.append(Contour(f"{part}.mark{len(own) + 1}", part, "mark", mark.curve, source=source))
        return own[-1].id

    for n, mark in enumerate(marks):
        if n in owner:
            add(n, mark)
    notes = [
        Note("warning", f"the mark {m.place} is on no part: left out") for n, m in enumerate(marks) if n not in owner
    ]
    writings, off, partly = list[Writing](), list[DrawnText](), list[str]()
    n = len(marks)
    for text in texts:
        names = [add(n + k, stroke, text.text) for k, stroke in enumerate(text.strokes) if n + k in owner]
        n += len(text.strokes)
        if not names:
            off.append(text)
            continue
        if len(names) < len(text.strokes):
            partly.append(f"the {text.place}: {len(text.strokes) - len(names)} of {len(text.strokes)} strokes")
        writings.append(Writing(text.text, text.look.layer, text.look.curve.start, text.height_mm, tuple(names)))
    notes += _on_no_part(off)
    if partly:
        listed = "; ".join(partly[:FIRST]) + ("; …" if len(partly) > FIRST else "")
        notes.append(Note("warning", f"left out, as it lies in waste: {listed}"))
    found = tuple(replace(p, marks=tuple(own)) for p, own in zip(parts, new_marks, strict=True))
    return found, notes, tuple(writings)


def _owners(parts: Sequence[Part], marks: Sequence[DrawnCurve]) -> dict[int, int]:
    """Mark → the part that has most of it; nothing for one that is on no part."""
    metal = metal_of(parts)
    lines = np.array([m.curve.line() for m in marks], dtype=object)
    k, on = shapely.STRtree(metal).query(lines, predicate="intersects")
    shared = shapely.length(shapely.intersection(lines[k], metal[on]))
    most = np.lexsort((on, -shared, k))
    return {int(mark): int(part) for mark, part in zip(k[most][::-1], on[most][::-1], strict=True)}


def _on_no_part(texts: Iterable[DrawnText]) -> list[Note]:
    """A note for each layer with texts or points on no part."""
    by_layer: dict[str, list[DrawnText]] = defaultdict(list)
    for text in texts:
        by_layer[question_of(text)].append(text)
    notes = []
    for those in by_layer.values():
        if len(those) == 1:
            notes.append(Note("warning", f"left out, as it is on no part: the {those[0].place}"))
        else:
            what = f"{len(those)} {'texts' if those[0].text else 'points'} on layer '{those[0].look.layer}'"
            notes.append(Note("warning", f"left out, as they are on no part: {what}, the first the {those[0].place}"))
    return notes
